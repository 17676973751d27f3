// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Reads the LaTeX of equation pages back, so that tests see what a reader sees: sums, products by
// juxtaposition, \frac, powers, \sin and its kin, \left( \right). Over any scalar; symbols are matched by
// their LaTeX text.

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace anholon::test {

template <class T>
using LatexSymbols = std::map<std::string, T>;

template <class T>
class LatexReader {
 public:
  LatexReader(const LatexSymbols<T>& symbols, std::string_view text) : symbols_(symbols), text_(text) {}

  T read() {
    T value = sum();
    if (!rest().empty()) fail("text after the formula");
    return value;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument(what + " at '" + std::string(text_.substr(at_, 40)) + "' of " +
                                std::string(text_));
  }
  std::string_view rest() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    return text_.substr(at_);
  }
  bool take(std::string_view token) {
    if (!rest().starts_with(token)) return false;
    at_ += token.size();
    return true;
  }
  void expect(std::string_view token) {
    if (!take(token)) fail("expected " + std::string(token));
  }

  T sum() {
    const bool negative = take("-");
    T value = product();
    if (negative) value = -value;
    while (true) {
      if (take("+")) {
        value = value + product();
      } else if (take("-")) {
        value = value - product();
      } else {
        return value;
      }
    }
  }

  T product() {
    T value = factor();
    for (std::string_view next = rest();
         !next.empty() && std::string_view("+-})&").find(next.front()) == std::string_view::npos &&
         !next.starts_with("\\right");
         next = rest())
      value = value * factor();
    return value;
  }

  int exponent() {
    if (!take("^{")) return 1;
    const int n = std::stoi(std::string(rest()));
    at_ = text_.find('}', at_) + 1;
    return n;
  }
  static T power(const T& base, int n) {
    T value = T(1);
    for (int i = 0; i < n; ++i) value = value * base;
    return value;
  }

  T group() {
    expect("\\left(");
    T value = sum();
    expect("\\right)");
    return value;
  }

  T factor() {
    using std::cos;
    using std::sin;
    using std::tan;
    if (take("\\frac{")) {
      const T above = sum();
      expect("}{");
      const T below = sum();
      expect("}");
      return above / below;
    }
    for (const auto& [name, call] : std::initializer_list<std::pair<const char*, T (*)(const T&)>>{
             {"\\sin", [](const T& x) { return T(sin(x)); }},
             {"\\cos", [](const T& x) { return T(cos(x)); }},
             {"\\tan", [](const T& x) { return T(tan(x)); }}}) {
      if (!take(name)) continue;
      const int n = exponent();
      return power(call(rest().starts_with("\\left(") ? group() : symbol()), n);
    }
    if (rest().starts_with("\\left(")) {
      const T value = group();
      return power(value, exponent());
    }
    if (std::isdigit(static_cast<unsigned char>(rest().empty() ? ' ' : rest().front())) != 0) return number();
    const T value = symbol();
    return power(value, exponent());
  }

  /// A decimal, exactly: digits over a power of ten.
  T number() {
    T value = T(0), scale = T(1);
    bool fraction = false;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '.') {
        fraction = true;
      } else if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
        value = value * T(10) + T(c - '0');
        if (fraction) scale = scale * T(10);
      } else {
        break;
      }
    }
    return value / scale;
  }

  /// The longest symbol that fits.
  T symbol() {
    const std::string_view next = rest();
    const std::pair<const std::string, T>* best = nullptr;
    for (const auto& entry : symbols_) {
      if (next.starts_with(entry.first) && (best == nullptr || entry.first.size() > best->first.size()))
        best = &entry;
    }
    if (best == nullptr) fail("no symbol");
    at_ += best->first.size();
    return best->second;
  }

  const LatexSymbols<T>& symbols_;
  std::string_view text_;
  std::size_t at_ = 0;
};

/// The entries of "\begin{bmatrix} a & b \\ c & d \end{bmatrix}", or the one of a bare formula.
template <class T>
std::vector<std::vector<T>> read_latex_matrix(const LatexSymbols<T>& symbols, std::string text) {
  const std::string begin = "\\begin{bmatrix} ", end = " \\end{bmatrix}";
  if (!text.starts_with(begin)) return {{LatexReader<T>(symbols, text).read()}};
  text = text.substr(begin.size(), text.size() - begin.size() - end.size());
  const auto parts = [](const std::string& of, const std::string& by) {
    std::vector<std::string> result;
    for (std::size_t from = 0, to = 0; to != std::string::npos; from = to + by.size()) {
      to = of.find(by, from);
      result.push_back(of.substr(from, to == std::string::npos ? to : to - from));
    }
    return result;
  };
  std::vector<std::vector<T>> rows;
  for (const std::string& row : parts(text, " \\\\ ")) {
    rows.emplace_back();
    for (const std::string& entry : parts(row, " & "))
      rows.back().push_back(LatexReader<T>(symbols, entry).read());
  }
  return rows;
}

/// The formulas of a page's math blocks, in order: {left side, right side}.
inline std::vector<std::pair<std::string, std::string>> equations_of_page(const std::string& page) {
  std::vector<std::pair<std::string, std::string>> equations;
  const std::string begin = "```math\n", end = "\n```";
  for (std::size_t at = 0; (at = page.find(begin, at)) != std::string::npos;) {
    at += begin.size();
    const std::string formula = page.substr(at, page.find(end, at) - at);
    const std::size_t sign = formula.find(" = ");
    equations.emplace_back(formula.substr(0, sign), formula.substr(sign + 3));
  }
  return equations;
}

}  // namespace anholon::test
