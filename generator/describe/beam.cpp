// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/beam.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "number/quadrature.hpp"

namespace anholon {
namespace {

constexpr unsigned digits_of_shapes = 128;  // f of mode 30 loses 41 of them where cosh and sinh cancel

struct Hyperbolic {
  Exact cosh, sinh;
  explicit Hyperbolic(const Exact& x) {
    const Exact e = exp(x);
    const Exact inverse = Exact(1) / e;
    cosh = (e + inverse) / Exact(2);
    sinh = (e - inverse) / Exact(2);
  }
};

/// Determinant of the boundary conditions over cosh b; its positive roots are the b. With C, S, c, s the
/// hyperbolic and circular functions of b: f'' = kappa b^4 f' and f''' = -mu b^4 f at the end give
/// 1 + C c - mu b (C s - S c) - kappa b^3 (S c + C s) + mu kappa b^4 (1 - C c).
double characteristic(double b, double mu, double kappa) {
  const double c = std::cos(b), s = std::sin(b), T = std::tanh(b), inverse = 1 / std::cosh(b);
  return inverse + c - mu * b * (s - c * T) - kappa * b * b * b * (T * c + s) +
         mu * kappa * b * b * b * b * (inverse - c);
}

Exact characteristic(const Exact& b, const Exact& mu, const Exact& kappa) {
  const Hyperbolic h(b);
  const Exact c = cos(b), s = sin(b), T = h.sinh / h.cosh, inverse = Exact(1) / h.cosh;
  return inverse + c - mu * b * (s - c * T) - kappa * b * b * b * (T * c + s) +
         mu * kappa * b * b * b * b * (inverse - c);
}

/// The index-th root: counted in double, then by the secant method.
Exact root(int index, const Exact& mu, const Exact& kappa) {
  const auto g = [m = mu.to_double(), k = kappa.to_double()](double b) { return characteristic(b, m, k); };
  constexpr double step = 1e-2;
  double low = 1e-3;
  for (int found = 0; found < index; low += step) {
    if ((g(low) > 0) != (g(low + step) > 0) && ++found == index) break;
    if (low > 200) throw std::domain_error("the shapes of the beam are not found");
  }
  double high = low + step;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    ((g(middle) > 0) == (g(low) > 0) ? low : high) = middle;
  }
  Exact a = Exact::from_double(low - 1e-9).as_float(), b = Exact::from_double(low + 1e-9).as_float();
  Exact g_a = characteristic(a, mu, kappa), g_b = characteristic(b, mu, kappa);
  const Exact end = Exact::from_decimal("1e-112");
  for (int i = 0; i < 30 && abs(b - a) > end && !(g_b - g_a).is_zero(); ++i) {
    const Exact next = b - g_b * (b - a) / (g_b - g_a);
    a = b, g_a = g_b;
    b = next, g_b = characteristic(b, mu, kappa);
  }
  return b;
}

/// A factor of a section at x, 1 where it is empty.
Exact factor(const BeamSection::Factor& f, const Exact& x, const char* of) {
  if (!f) return 1;
  const Exact value = f(x);
  if (value < Exact(0))
    throw std::domain_error(fmt::format("the {} is negative at x = {}", of, x.decimal(4)));
  return value;
}

/// Products of shapes with the wave number b are integrated by p points to (e b/(4 p))^(2 p), b up to n pi.
int points_for(std::size_t modes) { return 40 + 3 * static_cast<int>(modes); }

}  // namespace

Exact snapped(const Exact& x) {
  static const Exact close = Exact::from_decimal("1e-50");
  static const Exact denominator = 24;
  const Exact scaled = x * denominator;
  const double rounded = std::round(scaled.to_double());
  if (!(std::abs(rounded) < 1e6)) return x;
  const auto integer = static_cast<long>(rounded);
  if (abs(scaled - Exact::ratio(integer, 1)) < close) return Exact::ratio(integer, 24);
  return x;
}

ClampedMode clamped_mode(int index, const Exact& tip_mass, const Exact& tip_inertia) {
  if (index < 1 || index > 30) throw std::invalid_argument("modes are numbered from 1 to 30");
  const WorkingDigits digits(digits_of_shapes);
  ClampedMode mode;
  mode.b = root(index, tip_mass, tip_inertia);
  const Hyperbolic h(mode.b);
  const Exact c = cos(mode.b), s = sin(mode.b), k = tip_inertia * mode.b * mode.b * mode.b;
  mode.sigma = (h.cosh + c - k * (h.sinh + s)) / (h.sinh + s - k * (h.cosh - c));
  return mode;
}

BeamShape clamped_shape(const ClampedMode& mode) {
  const auto unscaled = [mode](const Exact& x) {
    const Exact bx = mode.b * x;
    const Hyperbolic h(bx);
    const Exact c = cos(bx), s = sin(bx);
    return std::array<Exact, 3>{h.cosh - c - mode.sigma * (h.sinh - s),
                                mode.b * (h.sinh + s - mode.sigma * (h.cosh - c)),
                                mode.b * mode.b * (h.cosh + c - mode.sigma * (h.sinh + s))};
  };
  const WorkingDigits digits(digits_of_shapes);
  const Exact tip = unscaled(Exact(1))[0];
  return [unscaled, tip](const Exact& x) {
    std::array<Exact, 3> f = unscaled(x);
    for (Exact& value : f) value /= tip;
    return f;
  };
}

BeamShape pinned_shape(int index) {
  return [index](const Exact& x) {
    const Exact b = Exact(index) * Exact::pi();
    const Exact s = sin(b * x);
    return std::array<Exact, 3>{s, b * cos(b * x), -(b * b * s)};
  };
}

BeamShape fixed_free_shape(int index) {
  return [index](const Exact& x) {
    const Exact b = Exact::ratio(2 * index - 1, 2) * Exact::pi();
    const Exact sign = index % 2 == 1 ? 1 : -1;
    const Exact s = sign * sin(b * x);
    return std::array<Exact, 3>{s, sign * b * cos(b * x), -(b * b * s)};
  };
}

BeamIntegrals beam_integrals(const std::vector<BeamMode>& modes, const std::vector<BeamSection>& sections) {
  const WorkingDigits digits(digits_of_shapes);
  const std::size_t n = modes.size();
  const std::vector<QuadraturePoint> rule = gauss_legendre(points_for(n));
  BeamIntegrals I;
  I.mean.assign(n, 0), I.moment.assign(n, 0);
  I.overlap.assign(n, std::vector<Exact>(n, 0));
  I.stiffness = I.shortening = I.shortening_moment = I.overlap;

  const auto mass_from = [&](const BeamSection& section, const Exact& from) {  // int m, int m x up to its end
    std::array<Exact, 2> sum = {0, 0};
    for (const QuadraturePoint& q : rule) {
      const Exact x = from + (section.to - from) * q.x;
      const Exact m = q.weight * (section.to - from) * factor(section.mass, x, "mass");
      sum[0] += m, sum[1] += m * x;
    }
    return sum;
  };
  std::array<Exact, 2> outside = {0, 0};  // mass beyond the present section
  for (std::size_t i = sections.size(); i-- > 0;) {
    const BeamSection& section = sections[i];
    const Exact from = i == 0 ? Exact(0) : sections[i - 1].to;
    for (const QuadraturePoint& q : rule) {
      const Exact length = section.to - from;
      const Exact x = from + length * q.x;
      const Exact w = q.weight * length;
      const Exact m = w * factor(section.mass, x, "mass");
      const Exact polar = w * factor(section.polar_inertia, x, "polar inertia");
      const std::array<Exact, 4> stiffness = {w * factor(section.bending_y, x, "bending stiffness"),
                                              w * factor(section.bending_z, x, "bending stiffness"),
                                              w * factor(section.torsion, x, "torsion stiffness"),
                                              w * factor(section.axial, x, "axial stiffness")};
      I.mass[0] += m, I.mass[1] += m * x, I.mass[2] += m * x * x;
      I.polar += polar;
      std::array<Exact, 2> beyond = outside;
      if (!section.mass) {  // uniform: no need of a sum
        beyond[0] += section.to - x;
        beyond[1] += (section.to * section.to - x * x) / Exact(2);
      } else {
        const std::array<Exact, 2> rest = mass_from(section, x);
        beyond[0] += rest[0], beyond[1] += rest[1];
      }
      std::vector<std::array<Exact, 3>> f;
      for (const BeamMode& mode : modes) f.push_back(mode.shape(x));
      for (std::size_t j = 0; j < n; ++j) {
        const BeamFamily family = modes[j].family;
        const Exact& weight = family == BeamFamily::torsion ? polar : m;
        I.mean[j] += weight * f[j][0];
        I.moment[j] += weight * x * f[j][0];
        for (std::size_t l = 0; l <= j; ++l) {
          const bool same = modes[l].family == family;
          const bool twists = family == BeamFamily::torsion || modes[l].family == BeamFamily::torsion;
          if (same || !twists) I.overlap[j][l] += weight * f[j][0] * f[l][0];
          if (!same) continue;
          const std::size_t order = bends(family) ? 2 : 1;
          I.stiffness[j][l] += stiffness[static_cast<std::size_t>(family)] * f[j][order] * f[l][order];
          if (!bends(family)) continue;
          const Exact slopes = w * f[j][1] * f[l][1];  // int m G dx = int G' (mass beyond) dx
          I.shortening[j][l] += slopes * beyond[0];
          I.shortening_moment[j][l] += slopes * beyond[1];
        }
      }
    }
    const std::array<Exact, 2> own = mass_from(section, from);
    outside[0] += own[0], outside[1] += own[1];
  }
  for (Exact& x : I.mass) x = snapped(x);
  I.polar = snapped(I.polar);
  for (auto* list : {&I.mean, &I.moment}) {
    for (Exact& x : *list) x = snapped(x);
  }
  for (auto* matrix : {&I.overlap, &I.stiffness, &I.shortening, &I.shortening_moment}) {
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t l = 0; l <= j; ++l) (*matrix)[l][j] = (*matrix)[j][l] = snapped((*matrix)[j][l]);
    }
  }
  return I;
}

std::vector<std::vector<Exact>> shortening_up_to(const Exact& x, const std::vector<BeamMode>& modes) {
  const WorkingDigits digits(digits_of_shapes);
  const std::size_t n = modes.size();
  std::vector<std::vector<Exact>> sum(n, std::vector<Exact>(n, 0));
  for (const QuadraturePoint& q : gauss_legendre(points_for(n))) {
    std::vector<Exact> slope;
    for (const BeamMode& mode : modes) slope.push_back(mode.shape(x * q.x)[1]);
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t l = 0; l <= j; ++l) {
        if (modes[l].family == modes[j].family && bends(modes[j].family))
          sum[j][l] += q.weight * x * slope[j] * slope[l];
      }
    }
  }
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t l = 0; l <= j; ++l) sum[l][j] = sum[j][l] = snapped(sum[j][l]);
  }
  return sum;
}

}  // namespace anholon
