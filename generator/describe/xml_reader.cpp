// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/xml_reader.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "describe/names.hpp"

namespace anholon {
namespace {

constexpr std::array<const char*, 11> numerals = {"no",  "one",   "two",   "three", "four", "five",
                                                  "six", "seven", "eight", "nine",  "ten"};

/// Larger numbers are taken for slips of the pen.
const Exact& largest_number() {
  static const Exact largest = Exact::from_decimal("1e30");
  return largest;
}

bool is_in(const std::vector<std::string>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

void XmlReader::check_attributes(const XMLElement& e, const std::string& what, const Names& known,
                                 const Names& ignored) {
  for (const auto* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
    if (is_in(known, a->Name())) continue;
    if (is_in(ignored, a->Name())) {
      leave_out(fmt::format("attribute(s) '{}' of <{}>", a->Name(), e.Name()));
      continue;
    }
    error(source_.place(e, a->Name()), fmt::format("{} has an unknown attribute '{}'", what, a->Name()),
          did_you_mean(a->Name(), known,
                       known.empty() ? "it has no attributes" : fmt::format("known are {}", listed(known))));
  }
}

void XmlReader::check_children(const XMLElement& e, const std::string& what, const Names& known,
                               const Names& ignored, bool repeated, const Refused& refused) {
  Names seen;
  Names all = known;
  all.insert(all.end(), ignored.begin(), ignored.end());
  for (const auto* node = e.FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (node->ToText() != nullptr)
      error(source_.place(e), fmt::format("{} has text in it", what),
            "remove the text; data stands in attributes or in elements of their own");
    const XMLElement* child = node->ToElement();
    if (child == nullptr) continue;
    if (const auto found = refused.find(child->Name()); found != refused.end()) {
      error(source_.place(*child),
            fmt::format("{} has an element <{}>, which is not supported", what, child->Name()),
            found->second);
    } else if (is_in(ignored, child->Name())) {
      leave_out(fmt::format("<{}>", child->Name()));
    } else if (!is_in(known, child->Name())) {
      error(source_.place(*child), fmt::format("{} has an unknown element <{}>", what, child->Name()),
            did_you_mean(child->Name(), all,
                         all.empty() ? "it has no elements" : fmt::format("known are {}", listed(all))));
    } else if (!repeated && is_in(seen, child->Name())) {
      error(source_.place(*child), fmt::format("{} has a second <{}>", what, child->Name()),
            "remove one of them");
    }
    seen.emplace_back(child->Name());
  }
}

std::string XmlReader::text(const XMLElement& e, const std::string& what, const Names& attributes) {
  check_attributes(e, what, attributes);
  std::string joined;
  for (const auto* node = e.FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (const auto* part = node->ToText()) joined += part->Value();
    if (const XMLElement* child = node->ToElement())
      error(source_.place(*child), fmt::format("{} has an unknown element <{}>", what, child->Name()),
            "it holds text alone");
  }
  std::string result;
  for (const std::string_view word : words(joined)) result += (result.empty() ? "" : " ") + std::string(word);
  return result;
}

std::string XmlReader::required(const XMLElement& e, const char* attribute, const std::string& what) {
  const char* value = e.Attribute(attribute);
  if (value != nullptr && *value != '\0') return value;
  error(source_.place(e, attribute),
        fmt::format("{} has {} '{}'", what, value == nullptr ? "no" : "an empty", attribute),
        fmt::format("write {}=\"...\"", attribute));
  return "";
}

std::optional<Exact> XmlReader::number_in(const Location& where, std::string_view label,
                                          std::string_view text, const std::string& what) {
  try {
    const Exact x = Exact::from_decimal(text);
    if (abs(x) <= largest_number()) return x;
    error(where, fmt::format("{} of {} is {}", label, what, text), "no number may exceed 1e30");
  } catch (const std::invalid_argument&) {
    error(where, fmt::format("{} of {} is '{}', not a finite decimal number", label, what, text),
          "write a number like -0.25 or 1.5e-3");
  }
  return std::nullopt;
}

std::optional<std::vector<Exact>> XmlReader::numbers_in(const Location& where, std::string_view label,
                                                        std::string_view text, const std::string& what,
                                                        std::size_t count) {
  const auto parts = words(text);
  if (parts.size() != count) {
    if (count == 1)
      error(where, fmt::format("{} of {} is '{}'", label, what, text), "write one number");
    else
      error(where, fmt::format("{} of {} has {} numbers", label, what, parts.size()),
            fmt::format("write {}", numerals.at(count)));
    return std::nullopt;
  }
  std::vector<Exact> numbers;
  for (const std::string_view part : parts) {
    const auto x = number_in(where, label, part, what);
    if (!x) return std::nullopt;
    numbers.push_back(*x);
  }
  return numbers;
}

Exact XmlReader::number(const XMLElement& e, const char* attribute, const std::string& what) {
  const std::string text = required(e, attribute, what);
  if (text.empty()) return 0;
  const auto numbers = numbers_in(source_.place(e, attribute), attribute, text, what, 1);
  return numbers ? numbers->front() : Exact(0);
}

Exact XmlReader::number(const XMLElement& e, const char* attribute, const std::string& what,
                        const Exact& otherwise) {
  return e.Attribute(attribute) == nullptr ? otherwise : number(e, attribute, what);
}

ExactVector XmlReader::vector(const XMLElement& e, const char* attribute, const std::string& what,
                              const ExactVector& otherwise) {
  const char* text = e.Attribute(attribute);
  if (text == nullptr) return otherwise;
  const auto v = numbers_in(source_.place(e, attribute), attribute, text, what, 3);
  return v ? ExactVector{(*v)[0], (*v)[1], (*v)[2]} : otherwise;
}

void XmlReader::check_not_negative(const Exact& x, const Location& where, std::string_view label,
                                   const std::string& what) {
  if (x < Exact(0))
    error(where, fmt::format("{} of {} is {}", label, what, x.decimal(8)), "it must not be negative");
}

void XmlReader::check_mass(const Exact& mass, const Location& where, const std::string& what) {
  if (mass < Exact(0))
    error(where, fmt::format("the mass of {} is {}", what, mass.decimal(8)), "it must not be negative");
}

void XmlReader::check_definite(const std::array<Exact, 6>& I, const Location& where, const std::string& what,
                               std::string_view order) {
  const auto& [xx, yy, zz, xy, xz, yz] = I;
  const Exact scale = abs(xx) + abs(yy) + abs(zz) + abs(xy) + abs(xz) + abs(yz);
  const Exact tolerance = Exact::from_decimal("1e-9");
  const Exact det = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  bool good = !(xx < Exact(0)) && !(yy < Exact(0)) && !(zz < Exact(0));
  for (const Exact& minor : {xx * yy - xy * xy, xx * zz - xz * xz, yy * zz - yz * yz})
    good = good && !(minor < -tolerance * scale * scale);
  good = good && !(det < -tolerance * scale * scale * scale);
  if (!good)
    error(where, fmt::format("{} is not positive semidefinite", what),
          fmt::format("check the signs and the order {}", order));
}

std::vector<std::string> XmlReader::dropped() const {
  Names notes;
  for (const auto& [what, number] : ignored_) notes.push_back(fmt::format("dropped: {} {}", number, what));
  return notes;
}

std::vector<std::string_view> XmlReader::words(std::string_view text) {
  std::vector<std::string_view> result;
  constexpr std::string_view spaces = " \t\n\r";
  for (std::size_t at = text.find_first_not_of(spaces); at < text.size();
       at = text.find_first_not_of(spaces, at)) {
    const std::size_t end = std::min(text.find_first_of(spaces, at), text.size());
    result.push_back(text.substr(at, end - at));
    at = end;
  }
  return result;
}

}  // namespace anholon
