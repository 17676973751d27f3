// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Classes of defaults in MJCF: what an element does not say, the <default> of its class says, and what that
// does not say, the class around it.

#include <map>
#include <string>
#include <vector>

#include "describe/xml_reader.hpp"

namespace anholon {

/// An attribute's value, and where it stands: in the element, or in a <default>.
struct MjcfValue {
  std::string text;
  Location where;
};
using MjcfAttributes = std::map<std::string, MjcfValue>;

/// The attributes of `e`; its own go before those that `defaults` has.
MjcfAttributes merged(const MjcfAttributes& defaults, const tinyxml2::XMLElement& e, const XmlSource& source);

/// Defaults by class and by element, "joint" say.
class MjcfClasses {
 public:
  /// @param e  a <default>; @param around  name of the class that it stands in; empty: it is the outermost
  void read(const tinyxml2::XMLElement& e, const std::string& around, const XmlSource& source,
            Findings& findings);
  [[nodiscard]] bool has(const std::string& name) const { return classes_.contains(name); }
  [[nodiscard]] std::vector<std::string> names() const;
  /// What a class says of an element. @param name  empty: the outermost class
  [[nodiscard]] MjcfAttributes defaults(const std::string& name, const std::string& element) const;

 private:
  std::string outermost_ = "main";
  std::map<std::string, std::map<std::string, MjcfAttributes>> classes_ = {{"main", {}}};
};

}  // namespace anholon
