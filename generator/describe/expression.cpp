// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/expression.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "describe/ascii.hpp"
#include "describe/names.hpp"

namespace anholon {
namespace {

constexpr std::size_t longest_text = 4096;
constexpr int deepest = 200;
constexpr std::size_t most_digits = 400;
constexpr int largest_exponent = 64;
constexpr int largest_angle = 1000000;
constexpr int largest_exponential = 600;

struct NamedOperation {
  std::string_view name;
  Op op;
};
constexpr auto functions = std::to_array<NamedOperation>({{"sin", Op::sin},
                                                          {"cos", Op::cos},
                                                          {"tan", Op::tan},
                                                          {"asin", Op::asin},
                                                          {"acos", Op::acos},
                                                          {"atan2", Op::atan2},
                                                          {"exp", Op::exp},
                                                          {"log", Op::log},
                                                          {"tanh", Op::tanh},
                                                          {"sqrt", Op::sqrt},
                                                          {"abs", Op::abs},
                                                          {"sign", Op::sign}});

bool starts_name(char c) { return is_letter(c) || c == '_'; }

/// Recursive descent; one function a level of precedence. Operands are read in sequenced statements, so that
/// the nodes come in the same order whatever the compiler.
class ExpressionReader {
 public:
  ExpressionReader(Tape& tape, std::string_view text, const Scope& scope, Allowed allowed)
      : tape_(tape), text_(text), scope_(scope), allowed_(allowed) {}

  Quantity read() {
    if (text_.size() > longest_text)
      fail(longest_text, fmt::format("the expression is longer than {} characters", longest_text),
           "split it with parameters or simplify it");
    skip_spaces();
    if (at_end()) fail(at_, "the expression is empty", "write a number, a name or a formula");
    Quantity result = sum();
    if (!at_end()) {
      if (peek() == ')') fail(at_, "')' closes nothing", "remove it or add '('");
      fail(at_, fmt::format("{} is not expected here", shown()),
           "write an operator + - * / ^ between two terms");
    }
    return result;
  }

 private:
  [[noreturn]] static void fail(std::size_t at, std::string fact, std::string mend) {
    throw ExpressionError(at, std::move(fact), std::move(mend));
  }

  [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }
  [[nodiscard]] char peek() const { return at_end() ? '\0' : text_[at_]; }
  void skip_spaces() {
    while (!at_end() && (peek() == ' ' || peek() == '\t' || peek() == '\n' || peek() == '\r')) ++at_;
  }
  bool take(char c) {
    if (at_end() || peek() != c) return false;
    ++at_;
    skip_spaces();
    return true;
  }
  [[nodiscard]] std::string shown() const {
    const auto c = static_cast<unsigned char>(peek());
    return c > ' ' && c < 127 ? fmt::format("'{}'", peek()) : fmt::format("the byte \\x{:02x}", c);
  }

  struct Depth {
    explicit Depth(ExpressionReader& reader) : reader_(reader) {
      if (++reader_.depth_ > deepest)
        fail(reader_.at_, fmt::format("more than {} levels of nesting", deepest), "simplify the expression");
    }
    ~Depth() { --reader_.depth_; }
    Depth(const Depth&) = delete;
    Depth& operator=(const Depth&) = delete;
    ExpressionReader& reader_;
  };

  // ---- grammar

  Quantity sum() {
    Quantity left = product();
    for (;;) {
      const std::size_t where = at_;
      if (take('+')) {
        left = added(where, Op::add, left, product());
      } else if (take('-')) {
        left = added(where, Op::sub, left, product());
      } else {
        return left;
      }
    }
  }

  Quantity product() {
    Quantity left = signed_power();
    for (;;) {
      const std::size_t where = at_;
      if (take('*')) {
        const Quantity right = signed_power();
        left = {apply(where, Op::mul, left.value, right.value), multiplied(left.unit, right.unit, false)};
      } else if (take('/')) {
        const Quantity right = signed_power();
        left = {apply(where, Op::div, left.value, right.value), multiplied(left.unit, right.unit, true)};
      } else {
        return left;
      }
    }
  }

  Quantity signed_power() {
    const Depth depth(*this);
    const std::size_t where = at_;
    if (take('-')) {
      const Quantity operand = signed_power();
      return {apply(where, Op::neg, operand.value), operand.unit};
    }
    if (take('+')) return signed_power();
    const Quantity base = primary();
    const std::size_t hat = at_;
    if (!take('^')) return base;
    return power(hat, base, signed_power());
  }

  Quantity primary() {
    if (at_end())
      fail(at_, "the expression ends where a value is expected", "write a number or a name there");
    const std::size_t where = at_;
    if (is_digit(peek()) || peek() == '.') return number();
    if (starts_name(peek())) return name();
    if (take('(')) {
      const Quantity inner = sum();
      close(where);
      return inner;
    }
    fail(at_, fmt::format("{} is not expected here", shown()), "write a number or a name there");
  }

  void close(std::size_t open) {
    if (take(')')) return;
    if (at_end()) fail(open, "'(' is not closed", "add ')'");
    fail(at_, fmt::format("{} is not expected here", shown()), "write an operator or ')'");
  }

  Quantity number() {
    const std::size_t begin = at_;
    std::size_t digits = 0;
    int points = 0;
    for (; !at_end() && (is_digit(peek()) || peek() == '.'); ++at_) {
      if (peek() == '.') {
        ++points;
      } else {
        ++digits;
      }
    }
    if (digits == 0 || points > 1) fail(begin, "this is not a number", "write digits with at most one '.'");
    if (digits > most_digits)
      fail(begin, fmt::format("the number has more than {} digits", most_digits), "round it");
    if (!at_end() && (peek() == 'e' || peek() == 'E')) {
      ++at_;
      if (peek() == '+' || peek() == '-') ++at_;
      if (!is_digit(peek())) fail(at_, "the exponent of this number has no digits", "write for example 1e-3");
      while (is_digit(peek())) ++at_;
    }
    if (!at_end() && starts_name(peek()))
      fail(at_, fmt::format("{} is not expected behind a number", shown()), "write * between factors");
    const std::string_view digits_text = text_.substr(begin, at_ - begin);
    Exact value;
    try {
      value = Exact::from_decimal(digits_text);
    } catch (const std::invalid_argument&) {
      fail(begin, out_of_range, in_range);
    }
    check_size(begin, value);
    skip_spaces();
    return {Expr(tape_, tape_.constant(value)), std::nullopt};
  }

  Quantity name() {
    const std::size_t begin = at_;
    while (!at_end() && (starts_name(peek()) || is_digit(peek()))) ++at_;
    const std::string_view word = text_.substr(begin, at_ - begin);
    skip_spaces();
    if (peek() == '(') return call(begin, word);
    if (word == "pi") return {Expr(tape_, tape_.constant(Exact::pi())), Dimension{}};
    return looked_up(begin, word, scope_.find(word));
  }

  Quantity looked_up(std::size_t begin, std::string_view word, const Symbol* symbol) {
    if (symbol == nullptr) {
      if (std::any_of(functions.begin(), functions.end(),
                      [&](const NamedOperation& f) { return f.name == word; }))
        fail(begin, fmt::format("'{}' is a function", word), fmt::format("write {}(...)", word));
      const std::vector<std::string> known = scope_.names(allowed_);
      fail(begin, fmt::format("'{}' is not a known name", word),
           did_you_mean(
               word, known,
               known.empty() ? "only numbers are known here" : fmt::format("known here: {}", listed(known))));
    }
    if (!symbol->objection.empty())
      fail(begin, fmt::format("'{}' {}", word, symbol->objection), symbol->mend);
    if (!allowed_.contains(symbol->kind)) {
      fail(begin, fmt::format("'{}' is {}", word, description(symbol->kind)),
           fmt::format("only {} may stand here", description(allowed_)));
    }
    return symbol->quantity;
  }

  Quantity call(std::size_t begin, std::string_view word) {
    const std::size_t open = at_;
    take('(');
    if (word == "dot") return rate(begin, open);
    const auto* function = std::find_if(functions.begin(), functions.end(),
                                        [&](const NamedOperation& f) { return f.name == word; });
    if (function == functions.end()) {
      if (scope_.find(word) != nullptr)
        fail(open, fmt::format("'{}' is not a function", word), "write * between factors");
      std::vector<std::string> known{"dot"};
      for (const NamedOperation& f : functions) known.emplace_back(f.name);
      fail(begin, fmt::format("'{}' is not a known function", word),
           did_you_mean(word, known, "docs/model-file.md lists the functions"));
    }
    const std::size_t first_at = at_;
    const Quantity first = sum();
    if (info(function->op).arity == 2) {
      const std::size_t comma = at_;
      if (!take(',')) fail(comma, fmt::format("'{}' takes two arguments", word), "write atan2(y, x)");
      const Quantity second = sum();
      close(open);
      if (first.unit && second.unit && *first.unit != *second.unit) {
        fail(comma, fmt::format("{} of {} and {}", word, first.unit->text(), second.unit->text()),
             "both need the same unit");
      }
      return {apply(begin, function->op, first.value, second.value), Dimension{}};
    }
    if (peek() == ',') fail(at_, fmt::format("'{}' takes one argument", word), "remove the other");
    close(open);
    return {apply(begin, function->op, first.value), unit_of(function->op, word, first_at, first.unit)};
  }

  /// dot(name)
  Quantity rate(std::size_t begin, std::size_t open) {
    const std::size_t inner = at_;
    while (!at_end() && (starts_name(peek()) || is_digit(peek()))) ++at_;
    const std::string_view word = text_.substr(inner, at_ - inner);
    skip_spaces();
    if (word.empty() || is_digit(word[0]))
      fail(inner, "dot takes the name of a coordinate", "write for example dot(r1)");
    const Symbol* symbol = scope_.find_rate(word);
    if (symbol == nullptr) {
      const std::vector<std::string> known = scope_.names_with_rate();
      fail(inner, fmt::format("'{}' is not a coordinate", word),
           did_you_mean(word, known,
                        known.empty() ? "there are none" : fmt::format("coordinates are {}", listed(known))));
    }
    if (!allowed_.contains(symbol->kind)) looked_up(begin, fmt::format("dot({})", word), symbol);
    if (peek() != ')' && !at_end()) fail(at_, "dot takes the name of a coordinate", "write dot(name)");
    close(open);
    return symbol->quantity;
  }

  // ---- units

  Quantity added(std::size_t where, Op op, const Quantity& left, const Quantity& right) {
    if (left.unit && right.unit && *left.unit != *right.unit) {
      fail(where,
           fmt::format("{} of {} and {}", op == Op::add ? "sum" : "difference", left.unit->text(),
                       right.unit->text()),
           "all terms of a sum need the same unit");
    }
    return {apply(where, op, left.value, right.value), left.unit ? left.unit : right.unit};
  }

  static std::optional<Dimension> multiplied(const std::optional<Dimension>& a,
                                             const std::optional<Dimension>& b, bool divide) {
    if (!a || !b) return std::nullopt;
    return bounded(divide ? *a / *b : *a * *b);
  }

  static std::optional<Dimension> bounded(const Dimension& unit) {
    for (const int power : unit.power) {
      if (power > 1000 || power < -1000) return std::nullopt;
    }
    return unit;
  }

  /// Unit of a function's value; its argument must be a plain number, but for sqrt, abs and sign.
  static std::optional<Dimension> unit_of(Op op, std::string_view word, std::size_t argument,
                                          const std::optional<Dimension>& unit) {
    if (op == Op::abs) return unit;
    if (op == Op::sign) return Dimension{};
    if (op == Op::sqrt) return unit ? root(*unit) : std::nullopt;
    if (unit && !unit->is_number()) {
      fail(argument, fmt::format("{} of a quantity in {}", word, unit->text()),
           "its argument must be a plain number or an angle");
    }
    return unit;
  }

  static std::optional<Dimension> root(Dimension unit) {
    for (int& power : unit.power) {
      if (power % 2 != 0) return std::nullopt;
      power /= 2;
    }
    return unit;
  }

  // ---- values

  static constexpr const char* out_of_range = "the number is out of range";
  static constexpr const char* in_range = "numbers lie between 1e-300 and 1e300";

  void check_size(std::size_t where, const Exact& value) const {
    static const Exact largest = Exact::from_decimal("1e300");
    static const Exact smallest = Exact::from_decimal("1e-300");
    if (value.is_zero()) return;
    const Exact size = abs(value);
    if (size > largest || size < smallest) fail(where, out_of_range, in_range);
  }

  /// Constants within a node stay bounded, so that reading stays fast.
  void check_constants(std::size_t where, const Expr& x) const {
    NodeId id = x.id(tape_);
    if (tape_.node(id).op == Op::neg) id = tape_.node(id).a;
    const Node& node = tape_.node(id);
    if (node.op == Op::constant) {
      check_size(where, tape_.value(id));
    } else if (info(node.op).arity == 2) {
      if (tape_.is_constant(node.a)) check_size(where, tape_.value(node.a));
      if (tape_.is_constant(node.b)) check_size(where, tape_.value(node.b));
    }
  }

  Expr apply(std::size_t where, Op op, const Expr& a, const Expr& b = 0) {
    const NodeId left = a.id(tape_);
    const NodeId right = info(op).arity == 2 ? b.id(tape_) : 0;
    if (tape_.is_constant(left)) {
      const Exact size = abs(tape_.value(left));
      if ((op == Op::sin || op == Op::cos || op == Op::tan) && size > Exact(largest_angle))
        fail(where, "the angle is out of range", "angles lie between -1e6 and 1e6 rad");
      if (op == Op::exp && size > Exact(largest_exponential))
        fail(where, "the exponential is out of range", "its argument lies between -600 and 600");
    }
    try {
      const Expr result(tape_, tape_.apply(op, left, right));
      check_constants(where, result);
      return result;
    } catch (const std::domain_error& error) {
      fail(where, error.what(), "mend this constant part of the expression");
    }
  }

  /// Integer powers by repeated squaring, half-integer ones with a square root, others by exp(y log(x)).
  Quantity power(std::size_t where, const Quantity& base, const Quantity& exponent) {
    if (exponent.unit && !exponent.unit->is_number()) {
      fail(where, fmt::format("a power in {}", exponent.unit->text()), "the exponent must be a plain number");
    }
    const NodeId id = exponent.value.id(tape_);
    if (!tape_.is_constant(id) || !(tape_.value(id) + tape_.value(id)).is_integer()) {
      const Expr log_base = apply(where, Op::log, base.value);
      const Expr scaled = apply(where, Op::mul, exponent.value, log_base);
      return {apply(where, Op::exp, scaled), base.unit && base.unit->is_number() ? base.unit : std::nullopt};
    }
    const Exact twice_exact = tape_.value(id) + tape_.value(id);
    if (abs(twice_exact) > Exact(2 * largest_exponent)) {
      fail(where, fmt::format("the exponent is beyond {}", largest_exponent),
           "use exp(y*log(x)) if you mean it");
    }
    const int twice = static_cast<int>(twice_exact.to_double());
    const int n = (twice < 0 ? -twice : twice) / 2;
    Expr result = integer_power(where, base.value, n);
    if (twice % 2 != 0) {
      const Expr base_root = apply(where, Op::sqrt, base.value);
      result = apply(where, Op::mul, result, base_root);
    }
    if (twice < 0) result = apply(where, Op::div, Expr(1), result);
    return {result, base.unit ? powered(*base.unit, twice) : std::nullopt};
  }

  Expr integer_power(std::size_t where, Expr square, int n) {
    Expr result(tape_, tape_.constant(1));
    for (bool first = true; n > 0; n /= 2, first = false) {
      if (!first) square = apply(where, Op::mul, square, square);
      if (n % 2 == 1) result = apply(where, Op::mul, result, square);
    }
    return result;
  }

  static std::optional<Dimension> powered(Dimension unit, int twice) {
    for (int& power : unit.power) {
      if (power * twice % 2 != 0) return std::nullopt;
      power = power * twice / 2;
    }
    return bounded(unit);
  }

  Tape& tape_;
  std::string_view text_;
  const Scope& scope_;
  Allowed allowed_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

Quantity read_expression(Tape& tape, std::string_view text, const Scope& scope, Allowed allowed) {
  return ExpressionReader(tape, text, scope, allowed).read();
}

const std::vector<std::string>& expression_words() {
  static const std::vector<std::string> words = [] {
    std::vector<std::string> list{"pi", "dot", "ddot"};
    for (const NamedOperation& f : functions) list.emplace_back(f.name);
    return list;
  }();
  return words;
}

}  // namespace anholon
