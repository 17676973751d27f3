// Sines and cosines of n numbers. For double both come from one polynomial pair, which compilers vectorise;
// every other scalar uses the functions of <cmath>. So does double where the compiler says that it reorders
// sums or keeps more digits than a double has: (x + round) - round is no integer then. clang does not say
// that -funsafe-math-optimizations reorders; from 14 on a pragma keeps the order here.
//
// Method: x = k pi/2 + r, |r| <= pi/4, with pi/2 in four parts (Cody and Waite 1980) so that r + tail has far
// more digits than a double; sin r and cos r by minimax polynomials; k mod 4 says which is which, and the
// signs. Error below 0.9 ulp for |x| <= 2^20; beyond, and where x is not finite, <cmath> is called.
template <class Real, int n>
inline void sines_cosines(const Real (&x)[n], Real (&sine)[n], Real (&cosine)[n]) noexcept {
  using std::cos;
  using std::sin;
  for (int i = 0; i < n; ++i) {
    sine[i] = sin(x[i]);
    cosine[i] = cos(x[i]);
  }
}
#if !defined(__FAST_MATH__) && !defined(__ASSOCIATIVE_MATH__) && __FLT_EVAL_METHOD__ + 0 == 0
template <int n>
inline void sines_cosines(const double (&__restrict x)[n], double (&__restrict sine)[n],
                          double (&__restrict cosine)[n]) noexcept {
#if defined(__clang__) && __clang_major__ >= 14
#pragma clang fp reassociate(off)
#endif
  constexpr double largest = 0x1p20;
  constexpr double round = 0x1.8p52;  // added and taken off: leaves the nearest integer
  constexpr double half_pi_1 = 0x1.921fb544p+0, half_pi_2 = 0x1.0b4611a6p-34;  // 33 bits each: k times them
  constexpr double half_pi_3 = 0x1.3198a2ep-69, half_pi_4 = 0x1.b839a252049c1p-104;  // is exact
#if defined(__clang__)
#pragma clang loop vectorize(enable)
#endif
  for (int i = 0; i < n; ++i) {
    const double k = (x[i] * 0x1.45f306dc9c883p-1 + round) - round;
    const double a = x[i] - k * half_pi_1;
    const double b = a - k * half_pi_2;
    const double c = b - k * half_pi_3;
    const double rest =
        ((a - b) - k * half_pi_2) + (((b - c) - k * half_pi_3) - k * half_pi_4);
    const double r = c + rest;
    const double tail = (c - r) + rest;

    const double z = r * r;
    const double zz = z * z;
    const double p = (-0x1.5555555555548p-3 + z * 0x1.111111110f7cdp-7) +
                     zz * ((-0x1.a01a019bfd87fp-13 + z * 0x1.71de356775f62p-19) +
                           zz * (-0x1.ae5e5a459a954p-26 + z * 0x1.5d8fbae72081p-33));
    const double q = (0x1.555555555554bp-5 + z * -0x1.6c16c16c14f8ep-10) +
                     zz * ((0x1.a01a019c83efdp-16 + z * -0x1.27e4f7ea7e127p-22) +
                           zz * (0x1.1ee9d783bcbeap-29 + z * -0x1.8fa4800322be2p-37));
    const double half = 0.5 * z;
    const double one = 1.0 - half;
    const double s = r + (z * r * p + tail * one);                         // sin(r + tail)
    const double t = one + (((1.0 - one) - half) + (zz * q - r * tail));  // cos(r + tail)

    const double turn = k - 4.0 * ((0.25 * k + round) - round);  // k mod 4, in -2 .. 2
    const double distance = std::fabs(turn);
    const double first = distance == 1.0 ? t : s;
    const double second = distance == 1.0 ? s : t;
    sine[i] = turn == -1.0 || distance == 2.0 ? -first : first;
    cosine[i] = turn == 1.0 || distance == 2.0 ? -second : second;
  }
  for (int i = 0; i < n; ++i) {
    if (std::fabs(x[i]) <= largest) continue;
    sine[i] = std::sin(x[i]);
    cosine[i] = std::cos(x[i]);
  }
}
#endif
