// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/xml_source.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "describe/read_bytes.hpp"

namespace anholon {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::string syntax_fault(tinyxml2::XMLError error) {
  switch (error) {
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "the file has no element";
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "an element is closed by the tag of another one";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute is not of the form name=\"value\", or stands there twice";
    case tinyxml2::XML_ERROR_PARSING_ELEMENT:
      return "an element is not well-formed";
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      return "elements are nested too deeply";
    default:
      return fmt::format("the XML is not well-formed ({})", tinyxml2::XMLDocument::ErrorIDToName(error));
  }
}

}  // namespace

XmlSource::XmlSource(std::string_view text, std::string file_name)
    : text_(text), file_name_(std::move(file_name)) {
  if (text_.size() > largest_file)
    throw ModelError({file_name_, 1, 1}, fmt::format("the file is larger than {} bytes", largest_file),
                     "leave out what dynamics does not need, such as meshes written into it");
  line_starts_.push_back(0);
  for (std::size_t i = 0; i < text_.size(); ++i) {
    if (text_[i] == '\n') line_starts_.push_back(i + 1);
  }
  if (text_.find('\0') != std::string::npos)
    throw ModelError(location(text_.find('\0')), "the file contains a zero byte", "write it as plain text");
  const tinyxml2::XMLError error = document_.Parse(text_.data(), text_.size());
  if (error != tinyxml2::XML_SUCCESS || document_.RootElement() == nullptr) {
    const int line = std::max(1, document_.ErrorLineNum());
    throw ModelError({file_name_, line, 1}, syntax_fault(document_.ErrorID()),
                     "mend the XML there or in the lines above");
  }
  scan();
  std::size_t next = 0;
  number(root(), next);
}

/// Finds the start tags; the text is well-formed already.
void XmlSource::scan() {
  const auto skip = [&](std::size_t from, std::string_view end) {
    const std::size_t found = text_.find(end, from);
    return found == std::string::npos ? text_.size() : found + end.size();
  };
  for (std::size_t at = text_.find('<'); at < text_.size(); at = text_.find('<', at)) {
    const std::string_view rest = std::string_view(text_).substr(at);
    if (rest.starts_with("<!--")) {
      at = skip(at + 4, "-->");
    } else if (rest.starts_with("<![CDATA[")) {
      at = skip(at, "]]>");
    } else if (rest.starts_with("<?")) {
      at = skip(at, "?>");
    } else if (rest.starts_with("<!") || rest.starts_with("</")) {
      at = skip(at, ">");
    } else {
      at = scan_tag(at);
    }
  }
}

/// Reads a start tag; answers where it ends.
std::size_t XmlSource::scan_tag(std::size_t at) {
  Tag tag{at, {}};
  while (at < text_.size() && !is_space(text_[at]) && text_[at] != '>' && text_[at] != '/') ++at;
  while (at < text_.size() && text_[at] != '>') {
    if (is_space(text_[at]) || text_[at] == '/') {
      ++at;
      continue;
    }
    const std::size_t begin = at;
    while (at < text_.size() && text_[at] != '=' && !is_space(text_[at])) ++at;
    tag.attributes.push_back({std::string_view(text_).substr(begin, at - begin), begin});
    while (at < text_.size() && text_[at] != '"' && text_[at] != '\'') ++at;
    if (at >= text_.size()) break;
    at = text_.find(text_[at], at + 1);
    if (at == std::string::npos) at = text_.size();
    ++at;
  }
  tags_.push_back(std::move(tag));
  return std::min(at + 1, text_.size());
}

void XmlSource::number(const tinyxml2::XMLElement& element, std::size_t& next) {
  tag_of_[&element] = next++;
  for (const auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement())
    number(*child, next);
}

Location XmlSource::location(std::size_t offset) const {
  const auto after = std::upper_bound(line_starts_.begin(), line_starts_.end(), offset);
  const auto line = after - line_starts_.begin();
  return {file_name_, static_cast<int>(line), static_cast<int>(offset - *(after - 1)) + 1};
}

Location XmlSource::place(const tinyxml2::XMLElement& element) const {
  return location(tags_[tag_of_.at(&element)].offset);
}

Location XmlSource::place(const tinyxml2::XMLElement& element, std::string_view attribute) const {
  for (const Attribute& a : tags_[tag_of_.at(&element)].attributes) {
    if (a.name == attribute) return location(a.offset);
  }
  return place(element);
}

}  // namespace anholon
