// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Identifiers of generated code: names of the model as they are, made safe and unique.

#include <set>
#include <string>
#include <string_view>

namespace anholon {

/// The text as a C++ identifier that is no keyword, no macro of <cmath> and no name that generated code uses
/// itself. A safe identifier stays as it is.
std::string identifier(std::string_view text);

/// The same for a namespace in the global one, where functions of C lie about: "link" becomes "link_".
std::string namespace_identifier(std::string_view text);

/// Names that one scope of generated code has given away.
class NameScope {
 public:
  /// The identifier made of `wish`, with a number behind it if it is taken; it is taken from now on.
  std::string claim(std::string_view wish);
  [[nodiscard]] bool is_taken(const std::string& name) const { return taken_.contains(name); }

 private:
  std::set<std::string> taken_;
};

}  // namespace anholon
