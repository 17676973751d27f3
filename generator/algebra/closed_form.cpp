// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/closed_form.hpp"

#include "algebra/lowering.hpp"
#include "algebra/ring.hpp"

namespace anholon {

std::optional<std::vector<NodeId>> closed_form(Tape& tape, const std::vector<NodeId>& roots,
                                               const ClosedFormLimits& limits) {
  if (tape.reachable(roots).size() > limits.nodes) return std::nullopt;
  try {
    Ring ring(tape, limits.terms, Ring::Beyond::give_up);
    std::vector<Fraction> values = ring.convert(roots);
    for (Fraction& f : values) f = ring.cancelled(f);

    Lowering lowering(tape, ring);
    std::vector<NodeId> best = lowering.fractions(values);  // each root in its own lightest form
    std::size_t least = operation_weight(tape, best);
    for (const std::uint32_t mask : ring.directions()) {  // all roots in one form, which share more
      std::vector<Fraction> directed;
      for (const Fraction& f : values)
        directed.push_back({ring.directed(f.numerator, mask), ring.directed(f.denominator, mask)});
      std::vector<NodeId> candidate = lowering.fractions(directed);
      const std::size_t weight = operation_weight(tape, candidate);
      if (weight < least) {
        best = std::move(candidate);
        least = weight;
      }
    }
    return best;
  } catch (const SizeLimitExceeded&) {
    return std::nullopt;
  } catch (const std::domain_error&) {  // a denominator that is zero by c^2 + s^2 = 1
    return std::nullopt;
  }
}

}  // namespace anholon
