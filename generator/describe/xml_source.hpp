// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// An XML file with the place of every element and attribute. tinyxml2 keeps lines only; the columns come from
// a scan of the same text, whose start tags follow each other in the order of the document.

#include <tinyxml2.h>

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "describe/location.hpp"

namespace anholon {

class XmlSource {
 public:
  /// @param file_name  stands in messages
  /// @throws ModelError where the text is not well-formed
  XmlSource(std::string_view text, std::string file_name);

  /// The outermost element.
  [[nodiscard]] const tinyxml2::XMLElement& root() const { return *document_.RootElement(); }
  /// Place of the element's '<'.
  [[nodiscard]] Location place(const tinyxml2::XMLElement& element) const;
  /// Place of an attribute's name; of the element where it has no such attribute.
  [[nodiscard]] Location place(const tinyxml2::XMLElement& element, std::string_view attribute) const;

 private:
  struct Attribute {
    std::string_view name;
    std::size_t offset;
  };
  struct Tag {
    std::size_t offset;
    std::vector<Attribute> attributes;
  };
  void scan();
  std::size_t scan_tag(std::size_t at);
  void number(const tinyxml2::XMLElement& element, std::size_t& next);
  [[nodiscard]] Location location(std::size_t offset) const;

  std::string text_;
  std::string file_name_;
  std::vector<std::size_t> line_starts_;
  std::vector<Tag> tags_;
  std::unordered_map<const tinyxml2::XMLElement*, std::size_t> tag_of_;
  tinyxml2::XMLDocument document_;
};

}  // namespace anholon
