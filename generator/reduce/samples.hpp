// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Configurations at which ranks and conditioning are judged: random ones in the working range, and the
// special ones (multiples of pi/4; all equal, opposite, straight) that random sampling misses.

#include <string>
#include <vector>

#include "anholon/mechanism.hpp"
#include "describe/model.hpp"

namespace anholon {

/// Where a coordinate stands at a sample.
struct SamplePlace {
  std::string coordinate;
  std::string value;     // "pi/2", "-0.42"
  bool special = false;  // chosen, not random
};

struct SampleState {
  std::vector<SamplePlace> places;  // of all coordinates
  State<Exact> state;  // exact binary values, so that double and exact evaluation see the same numbers
};

/// Reproducible on every machine: own mapping from a fixed 64-bit generator, no distribution of the standard
/// library.
class SampleSource {
 public:
  explicit SampleSource(std::uint64_t seed = 20130922) : state_(seed) {}
  /// Uniform in [lower, upper), rounded to a double.
  Exact uniform(const Exact& lower, const Exact& upper);
  double uniform();  // [0, 1)

 private:
  std::uint64_t state_;
};

/// Random state in the working range with velocities in +-1 (free components only); for a model that reads
/// the time within 10 s, else at t = 0.
State<Exact> random_state(const Model& model, SampleSource& source);

/// `random_count` random states and every special configuration of the angles.
std::vector<SampleState> sample_states(const Model& model, int random_count);

}  // namespace anholon
