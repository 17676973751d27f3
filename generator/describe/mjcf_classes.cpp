// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/mjcf_classes.hpp"

#include <fmt/format.h>

namespace anholon {

MjcfAttributes merged(const MjcfAttributes& defaults, const tinyxml2::XMLElement& e,
                      const XmlSource& source) {
  MjcfAttributes result = defaults;
  for (const auto* a = e.FirstAttribute(); a != nullptr; a = a->Next())
    result[a->Name()] = {a->Value(), source.place(e, a->Name())};
  return result;
}

void MjcfClasses::read(const tinyxml2::XMLElement& e, const std::string& around, const XmlSource& source,
                       Findings& findings) {
  const char* given = e.Attribute("class");
  std::string name = given == nullptr ? "" : given;
  if (around.empty()) {
    if (name.empty()) name = outermost_;
    if (name != outermost_)
      classes_[name] = classes_[outermost_], classes_.erase(outermost_), outermost_ = name;
  } else if (name.empty()) {
    findings.error(source.place(e), "a <default> inside another has no 'class'", "write class=\"...\"");
    return;
  } else if (!classes_.try_emplace(name, classes_[around]).second) {
    findings.error(source.place(e, "class"), fmt::format("there is a second class '{}'", name), "rename one");
    return;
  }
  // What a class says itself, all classes inside it inherit, wherever in the class they stand.
  for (const auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    if (std::string_view(child->Name()) == "default") continue;
    MjcfAttributes& defaults = classes_[name][child->Name()];
    defaults = merged(defaults, *child, source);
  }
  for (const auto* child = e.FirstChildElement("default"); child != nullptr;
       child = child->NextSiblingElement("default"))
    read(*child, name, source, findings);
}

std::vector<std::string> MjcfClasses::names() const {
  std::vector<std::string> result;
  for (const auto& [name, elements] : classes_) result.push_back(name);
  return result;
}

MjcfAttributes MjcfClasses::defaults(const std::string& name, const std::string& element) const {
  const auto& elements = classes_.at(name.empty() ? outermost_ : name);
  const auto found = elements.find(element);
  return found == elements.end() ? MjcfAttributes{} : found->second;
}

}  // namespace anholon
