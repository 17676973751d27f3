// SPDX-License-Identifier: GPL-2.0-or-later
#include "emit/template.hpp"

#include <fmt/format.h>

#include <kainjow/mustache.hpp>
#include <stdexcept>

namespace anholon {
namespace {

namespace mustache = kainjow::mustache;

/// A look-up that fails loudly.
class StrictContext : public mustache::context<std::string> {
 public:
  using context::context;
  const mustache::data* get(const std::string& name) const override {
    const mustache::data* found = context::get(name);
    if (found == nullptr)
      throw std::logic_error(fmt::format("the template asks for '{}', which nobody gave", name));
    return found;
  }
};

mustache::data converted(const nlohmann::json& value) {
  if (value.is_object()) {
    mustache::data object(mustache::data::type::object);
    for (const auto& [key, member] : value.items()) object.set(key, converted(member));
    return object;
  }
  if (value.is_array()) {
    mustache::data list(mustache::data::type::list);
    for (const auto& entry : value) list.push_back(converted(entry));
    return list;
  }
  if (value.is_boolean()) return mustache::data(value.get<bool>());
  if (value.is_string()) return mustache::data(value.get<std::string>());
  return mustache::data(value.dump());
}

/// No blank line at either end, and never two in a row.
std::string with_single_blank_lines(const std::string& text) {
  std::string result;
  std::size_t newlines = 2;
  for (const char c : text) {
    newlines = c == '\n' ? newlines + 1 : 0;
    if (newlines <= 2) result += c;
  }
  if (newlines >= 2) result.pop_back();
  return result;
}

}  // namespace

std::string fill_template(std::string_view text, const nlohmann::json& data) {
  mustache::mustache renderer{std::string(text)};
  if (!renderer.is_valid()) throw std::logic_error("template: " + renderer.error_message());
  renderer.set_custom_escape([](const std::string& value) { return value; });
  const mustache::data root = converted(data);
  StrictContext context(&root);
  const std::string result = renderer.render(context);
  if (!renderer.is_valid()) throw std::logic_error("template: " + renderer.error_message());
  return with_single_blank_lines(result);
}

}  // namespace anholon
