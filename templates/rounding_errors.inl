// What rounding leaves of an operation, exact value minus rounded one, by error-free transformations. They ask for
// operations that are rounded one by one: no -ffast-math, and -ffp-contract=off where a processor has fused ones.

template <class Real>
constexpr int significant_bits(typename Real::value_type*) {
  return std::numeric_limits<typename Real::value_type>::digits;
}
template <class Real>
constexpr int significant_bits(...) {
  return std::numeric_limits<Real>::is_specialized ? std::numeric_limits<Real>::digits
                                                   : std::numeric_limits<double>::digits;
}

/// a + b = fl(a + b) + this (Knuth 1969).
template <class Real>
inline Real sum_error(const Real& a, const Real& b) noexcept {
  const Real sum = a + b;
  const Real part = sum - a;
  return (a - (sum - part)) + (b - part);
}

/// a b = fl(a b) + this, from halves of the operands' digits (Dekker 1971).
template <class Real>
inline Real product_error(const Real& a, const Real& b) noexcept {
  constexpr int half = (significant_bits<Real>(nullptr) + 1) / 2;
  const Real splitter = constant<Real>(static_cast<long double>((1ULL << half) + 1));
  const Real a_scaled = splitter * a;
  const Real b_scaled = splitter * b;
  const Real a_high = a_scaled - (a_scaled - a);
  const Real b_high = b_scaled - (b_scaled - b);
  const Real a_low = a - a_high;
  const Real b_low = b - b_high;
  return (((a_high * b_high - a * b) + a_high * b_low) + a_low * b_high) + a_low * b_low;
}

/// a / b = fl(a / b) + this, up to the rounding of this.
template <class Real>
inline Real quotient_error(const Real& a, const Real& b) noexcept {
  const Real quotient = a / b;
  return ((a - quotient * b) - product_error(quotient, b)) / b;
}
