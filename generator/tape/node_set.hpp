// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A set of nodes of a tape, one bit each: the nodes of one function are few among those of all functions, and
// going through the set takes the time of its members, not that of the tape.

#include <bit>
#include <cstdint>
#include <vector>

#include "tape/tape.hpp"

namespace anholon {

class NodeSet {
 public:
  explicit NodeSet(std::size_t nodes) : words_((nodes + 63) / 64, 0) {}

  void insert(NodeId id) { words_[id / 64] |= std::uint64_t{1} << id % 64; }
  [[nodiscard]] bool contains(NodeId id) const { return (words_[id / 64] >> id % 64 & 1) != 0; }

  /// Visits the members from the last to the first; `visit` may insert members before the one that it is
  /// given.
  template <class Visit>
  void visit_backwards(const Visit& visit) {
    for (std::size_t w = words_.size(); w-- > 0;) {
      for (std::uint64_t left = words_[w]; left != 0;) {
        const int bit = 63 - std::countl_zero(left);
        visit(static_cast<NodeId>(64 * w + static_cast<std::size_t>(bit)));
        left = words_[w] & ((std::uint64_t{1} << bit) - 1);
      }
    }
  }

  /// In order of creation.
  [[nodiscard]] std::vector<NodeId> members() const {
    std::size_t count = 0;
    for (const std::uint64_t word : words_) count += static_cast<std::size_t>(std::popcount(word));
    std::vector<NodeId> result;
    result.reserve(count);
    for (std::size_t w = 0; w < words_.size(); ++w) {
      for (std::uint64_t left = words_[w]; left != 0; left &= left - 1)
        result.push_back(static_cast<NodeId>(64 * w + static_cast<std::size_t>(std::countr_zero(left))));
    }
    return result;
  }

 private:
  std::vector<std::uint64_t> words_;
};

}  // namespace anholon
