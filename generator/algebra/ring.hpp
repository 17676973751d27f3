// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A tape's nodes as quotients of polynomials. The variables are the tape's inputs, cos x and sin x of each
// angle x, related by c^2 + s^2 = 1, and whatever else the polynomials cannot see into (sqrt, exp, ...).

#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include "algebra/polynomial.hpp"
#include "tape/tape.hpp"

namespace anholon {

struct Fraction {
  Polynomial numerator;
  Polynomial denominator = 1;
};

/// Variables cos x and sin x of one angle.
struct Circle {
  std::size_t cosine;
  std::size_t sine;
};

class Ring {
 public:
  /// What to do with an expression that outgrows max_terms.
  enum class Beyond { give_up, opaque };

  /// @param max_terms  bound of each numerator and denominator
  Ring(Tape& tape, std::size_t max_terms, Beyond beyond)
      : tape_(&tape), max_terms_(max_terms), beyond_(beyond) {}

  /// The nodes in terms of variables whose numbers follow from the nodes' structure alone; may be called
  /// once.
  /// @throws SizeLimitExceeded where the bound is passed and the ring is to give up
  std::vector<Fraction> convert(const std::vector<NodeId>& roots);

  /// Bound of what is computed from now on.
  void set_max_terms(std::size_t max_terms) { max_terms_ = max_terms; }

  [[nodiscard]] const std::vector<NodeId>& variables() const { return variables_; }
  [[nodiscard]] const std::vector<Circle>& circles() const { return circles_; }

  /// The one representative that is linear in every sine.
  [[nodiscard]] Polynomial normal(const Polynomial& p) const;
  /// Linear in the sine of circle i, or in its cosine where bit i of `mask` is set.
  [[nodiscard]] Polynomial directed(const Polynomial& p, std::uint32_t mask) const;
  /// Masks to try: all of them for few angles, else one angle at a time.
  [[nodiscard]] std::vector<std::uint32_t> directions() const;
  /// The lightest of p's directed forms.
  [[nodiscard]] Polynomial lightest(const Polynomial& p) const;
  /// Common factors cancelled in every direction, the lightest form kept; positive primitive denominator.
  [[nodiscard]] Fraction cancelled(const Fraction& f) const;

  // Field operations; numerators and denominators stay in normal form and within the bound.
  [[nodiscard]] Fraction sum(const Fraction& x, const Fraction& y) const;
  [[nodiscard]] Fraction product(const Fraction& x, const Fraction& y) const;
  /// @throws std::domain_error where y is zero by c^2 + s^2 = 1
  [[nodiscard]] Fraction quotient(const Fraction& x, const Fraction& y) const;

 private:
  struct Angle {
    NodeId cosine;
    NodeId sine;
  };
  using Known = std::unordered_map<NodeId, Fraction>;  // of the nodes before
  Fraction of_node(NodeId id, const Known& known);
  /// (cos, sin) of a node: angle sums and multiples are expanded.
  std::pair<Polynomial, Polynomial> turn(NodeId argument, const Fraction& value);
  std::pair<Polynomial, Polynomial> basic_turn(NodeId argument);
  std::size_t variable(NodeId id);
  /// Variable of an operation that polynomials cannot see into; equal operands make equal variables.
  std::size_t function_variable(NodeId id, const Known& known);
  NodeId monomial_node(const Monomial& monomial, const cln::cl_I& denominator);
  [[nodiscard]] bool is_opaque_constant(const Monomial& monomial) const;
  [[nodiscard]] Fraction reduced(Fraction f) const;
  [[nodiscard]] Polynomial checked(Polynomial p) const;

  Tape* tape_;
  std::size_t max_terms_;
  Beyond beyond_;
  std::vector<NodeId> variables_;
  std::map<NodeId, std::size_t> variable_of_;
  std::vector<Circle> circles_;
  std::map<std::pair<Op, std::vector<Polynomial>>, std::size_t> functions_;
  std::map<NodeId, std::size_t> circle_of_;  // by the angle's node
};

}  // namespace anholon
