// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Strict reading of XML elements, for the readers of all robot formats: what is not known is an error at its
// place, what is known and not used is counted, numbers are exact.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "describe/exact_rotation.hpp"
#include "describe/findings.hpp"
#include "describe/xml_source.hpp"

namespace anholon {

class XmlReader {
 protected:
  using XMLElement = tinyxml2::XMLElement;
  using Names = std::vector<std::string>;
  /// What cannot be used, and the way out.
  using Refused = std::map<std::string, std::string>;

  explicit XmlReader(const XmlSource& source) : source_(source) {}

  void error(Location where, std::string fact, std::string mend) {
    findings_.error(std::move(where), std::move(fact), std::move(mend));
  }

  /// @param ignored  attributes that are read over, with a note
  void check_attributes(const XMLElement& e, const std::string& what, const Names& known,
                        const Names& ignored = {});
  /// @param repeated  whether known elements may come more than once
  void check_children(const XMLElement& e, const std::string& what, const Names& known,
                      const Names& ignored = {}, bool repeated = false, const Refused& refused = {});
  /// An element that holds text alone: the text without the space around it.
  std::string text(const XMLElement& e, const std::string& what, const Names& attributes = {});

  std::string required(const XMLElement& e, const char* attribute, const std::string& what);

  /// Numbers of a text. @param label  names them in messages, as of `what`
  std::optional<Exact> number_in(const Location& where, std::string_view label, std::string_view text,
                                 const std::string& what);
  /// Exactly `count` of them, or nothing and an error
  std::optional<std::vector<Exact>> numbers_in(const Location& where, std::string_view label,
                                               std::string_view text, const std::string& what,
                                               std::size_t count);
  Exact number(const XMLElement& e, const char* attribute, const std::string& what);
  Exact number(const XMLElement& e, const char* attribute, const std::string& what, const Exact& otherwise);
  ExactVector vector(const XMLElement& e, const char* attribute, const std::string& what,
                     const ExactVector& otherwise);

  /// An error where x is negative. @param label  names x, as of `what`
  void check_not_negative(const Exact& x, const Location& where, std::string_view label,
                          const std::string& what);
  void check_mass(const Exact& mass, const Location& where, const std::string& what);
  /// Principal minors must not be negative. Rounding of the file's own figures is forgiven.
  /// @param inertia  xx yy zz xy xz yz; @param order  in which the file writes them
  void check_definite(const std::array<Exact, 6>& inertia, const Location& where, const std::string& what,
                      std::string_view order);

  /// Counts something that is left out.
  void leave_out(const std::string& what) { ++ignored_[what]; }
  /// "dropped: 3 <visual>" for all that was left out
  [[nodiscard]] Names dropped() const;

  static std::vector<std::string_view> words(std::string_view text);

  const XmlSource& source_;
  Findings findings_;

 private:
  std::map<std::string, int> ignored_;
};

}  // namespace anholon
