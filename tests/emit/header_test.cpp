// SPDX-License-Identifier: GPL-2.0-or-later
// The emitted header: what it says, that it compiles alone, and that its text depends on the program only.

#include "emit/header.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "emit/c_abi.hpp"
#include "emit/pendulum_program.hpp"
#include "emit/plan.hpp"
#include "emit/random_program.hpp"
#include "emit/toolbox.hpp"

namespace anholon::header_test {
namespace {

constexpr const char* strict_flags =
    "-std=c++17 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -fno-exceptions -fno-rtti";

/// A source that instantiates every function of the header for a scalar.
std::string instantiation(const Program& program, const std::string& header,
                          const std::vector<std::string>& scalars) {
  const EmissionPlan plan = plan_emission(program);
  std::string text =
      fmt::format("#include \"{}\"\nnamespace {} {{\n", header, fmt::join(plan.name_space, "::"));
  for (const std::string& real : scalars) {
    text += fmt::format("template Prepared<{0}> prepare<{0}>(const Parameters<{0}>&) noexcept;\n", real);
    for (const PlannedFunction& function : plan.functions) {
      std::string arguments = fmt::format("const Prepared<{}>&", real);
      for (const std::size_t i : function.inputs) {
        arguments += fmt::format(", const {} (&)[{}]", real, program.inputs[i].rows * program.inputs[i].cols);
      }
      for (const PlannedOutput& output : function.outputs) {
        arguments += fmt::format(", {} (&)[{}]", real, output.block->rows * output.block->cols);
      }
      text += fmt::format("template void {}<{}>({}) noexcept;\n", function.name, real, arguments);
    }
  }
  return text + "}\n";
}

struct NamedProgram {
  const char* name;
  Program (*make)();
  StatementStyle style;
};

Program pendulum() { return test::cart_pendulum(); }
Program random_small() { return test::random_program({}, 1); }
Program no_parameters() {
  Program program = test::random_program({0, 3, 20, 2, 8}, 5);
  return program;
}
Program constants_only() {
  Program program;
  program.name_space = "constants";
  program.functions = {
      {"f",
       "",
       {{"y", "", "", 2, 1, {program.tape.constant(0), program.tape.constant(Exact::ratio(-1, 7))}}},
       ""}};
  return program;
}

Program turns() { return test::turns(3); }

const NamedProgram programs[] = {
    {"pendulum", pendulum, {}},
    {"split", pendulum, {NodeOrder::depth_first, 5, 4}},
    {"levels", random_small, {NodeOrder::levels, 5000, 1000}},
    {"every_operation", test::every_operation, {}},
    {"every_operation_split", test::every_operation, {NodeOrder::depth_first, 1, 3}},
    {"lifetimes", random_small, {NodeOrder::lifetimes, 5000, 1000}},
    {"batch", turns, {NodeOrder::by_length, 5000, 1000, SinCos::batch}},
    {"batch_split", turns, {NodeOrder::by_length, 5, 4, SinCos::batch}},
    {"no_parameters", no_parameters, {}},
    {"constants_only", constants_only, {}}};

class EveryProgram : public ::testing::TestWithParam<NamedProgram> {};
void PrintTo(const NamedProgram& program, std::ostream* out) { *out << program.name; }
INSTANTIATE_TEST_SUITE_P(Programs, EveryProgram, ::testing::ValuesIn(programs),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(EveryProgram, CompilesAloneAndNeedsNothingButTheMathLibrary) {
  const Program program = GetParam().make();
  const std::filesystem::path folder = test::test_folder();
  test::write_text(folder / "program.hpp", emit_header(program, GetParam().style));
  test::write_text(folder / "use.cpp",
                   instantiation(program, "program.hpp", {"float", "double", "long double"}));
  test::write_text(folder / "abi.cpp", emit_c_abi(program, "program.hpp"));
  static const std::regex libm(
      "(a?sin|a?cos|sincos|atan2|tanh?|exp|log|sqrt|fabs)[fl]?|_GLOBAL_OFFSET_TABLE_|memcpy|memset");
  for (const std::string& compiler : test::compilers()) {
    SCOPED_TRACE(compiler);
    const auto [status, text] = test::run(
        fmt::format("cd '{}' && {} {} -O1 -c use.cpp -o use.o", folder.string(), compiler, strict_flags),
        folder);
    ASSERT_EQ(status, 0) << text;
    for (const std::string& symbol : test::undefined_symbols(folder / "use.o")) {
      EXPECT_TRUE(std::regex_match(symbol, libm)) << symbol;
    }
    const auto [abi_status, abi_text] =
        test::run(fmt::format("cd '{}' && {} {} -I '{}/runtime/include' -fsyntax-only abi.cpp",
                              folder.string(), compiler, strict_flags, ANHOLON_SOURCE_DIR),
                  folder);
    ASSERT_EQ(abi_status, 0) << abi_text;
  }
}

/// Operations of each emitted function, counted in the text: one a line.
std::map<std::string, OperationCount> recount(const std::string& header) {
  static const std::regex head(
      R"(^(?:\[\[gnu::noinline\]\] )?inline (?:void|Prepared<Real>) (\w+?)(?:_block_\d+)?\()");
  static const std::regex statement(R"(^  const Real \w+ = (.*);$)");
  std::map<std::string, OperationCount> counts;
  std::string current;
  std::istringstream lines(header);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_search(line, match, head)) current = match[1];
    if (current.empty()) continue;
    OperationCount& count = counts[current];
    if (!std::regex_match(line, match, statement)) continue;
    std::string value = match[1];
    value = std::regex_replace(value, std::regex(R"(constant<Real>\([^)]*\))"), "K");
    if (value.front() == '-')
      ++count.negations;
    else if (value.rfind("sqrt(", 0) == 0)
      ++count.roots;
    else if (value.rfind("sin(", 0) == 0 || value.rfind("sine[", 0) == 0)  // one by one, or out of a batch
      ++count.sines;
    else if (value.rfind("cos(", 0) == 0 || value.rfind("cosine[", 0) == 0)
      ++count.cosines;
    else if (value.rfind("sum_error(", 0) == 0)
      count += {.additions = 5};
    else if (value.rfind("product_error(", 0) ==
             0)  // two halves of 3 additions each, and their four products
      count += {.additions = 10, .multiplications = 6};
    else if (value.rfind("quotient_error(", 0) == 0)
      count += {.additions = 12, .multiplications = 7, .divisions = 1};
    else if (value.find('(') != std::string::npos)
      ++count.other;
    else if (value.find(" * ") != std::string::npos)
      ++count.multiplications;
    else if (value.find(" / ") != std::string::npos)
      ++count.divisions;
    else if (value.find(" + ") != std::string::npos || value.find(" - ") != std::string::npos)
      ++count.additions;
    else
      ADD_FAILURE() << "no operation: " << line;
  }
  return counts;
}

TEST_P(EveryProgram, StatesTheOperationsThatItsTextHas) {
  const Program program = GetParam().make();
  const std::string header = emit_header(program, GetParam().style);
  const EmissionPlan plan = plan_emission(program);
  auto counts = recount(header);
  EXPECT_EQ(counts["prepare"], plan.prepare_operations);
  for (const PlannedFunction& function : plan.functions) {
    EXPECT_EQ(counts[function.name], function.operations)
        << function.name << ": " << counts[function.name].text();
    EXPECT_NE(header.find("/// operations: " + function.operations.text() + "\n"), std::string::npos);
  }
}

TEST_P(EveryProgram, HasLinesThatFitAndNoBlanksAtTheirEnds) {
  const std::string header = emit_header(GetParam().make(), GetParam().style);
  std::istringstream lines(header);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 110U + 8) << line;
    EXPECT_TRUE(line.empty() || (line.back() != ' ' && line.back() != '\\')) << line;
  }
  EXPECT_EQ(header.find("\n\n\n"), std::string::npos);
  EXPECT_EQ(header.find('\t'), std::string::npos);
  EXPECT_EQ(header.back(), '\n');
}

TEST(EmittedText, IsTheSameTwiceAndForEveryOrderOfCreationWithinASection) {
  EXPECT_EQ(emit_header(test::cart_pendulum()), emit_header(test::cart_pendulum()));
  EXPECT_EQ(emit_header(test::cart_pendulum(false)), emit_header(test::cart_pendulum(true)));
  EXPECT_EQ(emit_c_abi(test::cart_pendulum(false), "a.hpp"), emit_c_abi(test::cart_pendulum(true), "a.hpp"));
  EXPECT_EQ(describe_json(test::cart_pendulum(false)), describe_json(test::cart_pendulum(true)));
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const NodeOrder order : {NodeOrder::levels, NodeOrder::depth_first, NodeOrder::lifetimes}) {
      const StatementStyle style{order, seed % 2 == 0 ? 20U : 5000U, 7};
      EXPECT_EQ(emit_header(test::random_program({}, seed, false), style),
                emit_header(test::random_program({}, seed, true), style));
    }
  }
}

TEST(EmittedText, NamesItsOriginWithoutPathsAndStartsWithTheLicence) {
  Program program = test::cart_pendulum();
  program.source_file = "/home/someone/models/cart_pendulum.toml";
  const std::string header = emit_header(program);
  EXPECT_EQ(header.rfind("// SPDX-License-Identifier: MIT\n", 0), 0U);
  EXPECT_NE(header.find("//   source  cart_pendulum.toml\n//   sha256  " + program.source_sha256 + "\n"),
            std::string::npos);
  EXPECT_EQ(header.find("someone"), std::string::npos);
  EXPECT_NE(header.find("//   class: dynamic, m = 0\n"), std::string::npos);
  EXPECT_NE(header.find("#pragma once"), std::string::npos);
  EXPECT_EQ(emit_c_abi(program, "a.hpp").rfind("// SPDX-License-Identifier: MIT\n", 0), 0U);
}

TEST(EmittedText, HoldsOnlyWhatTheFunctionsNeed) {
  Program program = test::cart_pendulum();
  program.functions = {program.functions[0]};  // the mass matrix: no gravity, no rates, no force
  const std::string header = emit_header(program);
  EXPECT_EQ(header.find("r_dot["), std::string::npos);
  EXPECT_EQ(header.find("F["), std::string::npos);
  EXPECT_EQ(header.find("n_F"), std::string::npos);
  EXPECT_EQ(header.find("par.g"), std::string::npos);
  EXPECT_EQ(header.find("sin("), std::string::npos);
  EXPECT_NE(header.find("Real g = "), std::string::npos) << "all parameters stay in struct Parameters";
}

TEST(EmittedText, LeavesOutBlocksOfSizeZeroAndFunctionsWithoutOutputs) {
  Program program = test::cart_pendulum();
  program.functions.push_back({"empty", "Nothing.", {{"nothing", "", "", 0, 3, {}}}, ""});
  const std::string header = emit_header(program);
  EXPECT_EQ(header.find("lambda"), std::string::npos);
  EXPECT_EQ(header.find("empty"), std::string::npos);
}

TEST(EmittedText, UsesNamesOfTheModelMadeSafe) {
  const std::string header = emit_header(test::every_operation());
  EXPECT_NE(header.find("Real M_PI_ = "), std::string::npos);
  EXPECT_NE(header.find("const Real (&class_)[2]"), std::string::npos);
  EXPECT_NE(header.find("Real (&class_out)["), std::string::npos);
  EXPECT_NE(header.find("inline void sin_("), std::string::npos);
  EXPECT_NE(header.find("const Real s_a_b = sin(class_[0]);"), std::string::npos);
}

TEST(EmittedText, RefusesAnOutputThatNeedsAnInputNobodyPasses) {
  Program program = test::cart_pendulum();
  program.inputs.pop_back();
  try {
    (void)emit_header(program);
    FAIL();
  } catch (const std::logic_error& error) {
    EXPECT_NE(std::string(error.what()).find("'F'"), std::string::npos) << error.what();
  }
}

TEST(EmittedText, RefusesBlocksOfWrongSizeAndEqualNames) {
  Program wrong = test::cart_pendulum();
  wrong.inputs[0].rows = 3;
  EXPECT_THROW((void)emit_header(wrong), std::logic_error);
  Program twice = test::cart_pendulum();
  twice.functions[1].name = twice.functions[0].name;
  EXPECT_THROW((void)emit_header(twice), std::logic_error);
}

TEST(EmittedHeader, RunsOnDualNumbersAndSimdPacks) {
  const std::filesystem::path folder = test::test_folder();
  test::write_text(folder / "program.hpp", emit_header(test::cart_pendulum()));
  test::write_text(folder / "main.cpp", R"cpp(
#include "program.hpp"
#include <cstdio>
#if __has_include(<experimental/simd>)
#include <experimental/simd>
#endif
    namespace g = cart_pendulum::standard;
    struct Dual {
      double v = 0, d = 0;
      Dual() = default;
      explicit constexpr Dual(double x) : v(x) {}
      Dual(double x, double y) : v(x), d(y) {}
    };
    Dual operator+(Dual a, Dual b) { return {a.v + b.v, a.d + b.d}; }
    Dual operator-(Dual a, Dual b) { return {a.v - b.v, a.d - b.d}; }
    Dual operator-(Dual a) { return {-a.v, -a.d}; }
    Dual operator*(Dual a, Dual b) { return {a.v * b.v, a.d * b.v + a.v * b.d}; }
    Dual operator/(Dual a, Dual b) { return {a.v / b.v, (a.d * b.v - a.v * b.d) / (b.v * b.v)}; }
    Dual sin(Dual a) { return {std::sin(a.v), std::cos(a.v) * a.d}; }
    Dual cos(Dual a) { return {std::cos(a.v), -std::sin(a.v) * a.d}; }

    template <class Real>
    Real energy(Real theta, Real rate) {
      const Real r[2] = {Real(0), theta}, r_dot[2] = {Real(0), rate};
      Real E[1];
      g::energies(g::prepare(g::Parameters<Real>{}), r, r_dot, E);
      return E[0];
    }

    int main() {
      // dE/dtheta = m_p g l sin(theta) at rest
      const Dual e = energy(Dual{0.3, 1.0}, Dual(0.0));
      if (std::fabs(e.d - 0.1 * 9.81 * 0.5 * std::sin(0.3)) > 1e-15) return 1;
#if __has_include(<experimental/simd>)
      using Pack = std::experimental::fixed_size_simd<double, 4>;
      Pack theta = 0.0;
      for (int i = 0; i < 4; ++i) theta[i] = 0.1 * i;
      const Pack packed = energy(theta, Pack(0.5));
      for (int i = 0; i < 4; ++i) {
        if (std::fabs(packed[i] - energy(0.1 * i, 0.5)) > 1e-15) return 2;
      }
      using Single = std::experimental::fixed_size_simd<float, 4>;
      if (std::fabs(energy(Single(0.5f), Single(0.5f))[0] - energy(0.5f, 0.5f)) > 1e-6f) return 3;
#endif
    }
  )cpp");
  const auto [status, text] = test::run(
      fmt::format("cd '{}' && g++ -std=c++17 -Wall -Wextra main.cpp -o main && ./main", folder.string()),
      folder);
  EXPECT_EQ(status, 0) << text;
}

/// A split function stores results as it goes; what it reads of its inputs by then it has kept.
TEST(EmittedHeader, LetsAnOutputOfASplitFunctionLieOverAnInput) {
  Program program = test::long_program(1000);
  Tape& tape = program.tape;
  const NodeId end = program.functions[0].outputs[0].nodes[0];
  NodeId middle = end;
  for (int i = 0; i < 500; ++i) {  // x = c x' - s y': of the factors of a product, the later node is x'
    const Node& product = tape.node(tape.node(middle).a);
    middle = std::max(product.a, product.b);
  }
  const NodeId late = tape.apply(Op::mul, end, program.inputs[1].nodes[0]);
  program.functions[0].outputs.push_back({"middle", "", "", 1, 1, {middle}});
  program.functions[0].outputs.push_back({"late", "", "", 1, 1, {late}});
  const std::string header = emit_header(program);
  // the case that is meant: the output is stored before the last use of the input
  ASSERT_LT(header.find("  middle[0] = "), header.find("  late[0] = "));
  const std::filesystem::path folder = test::test_folder();
  test::write_text(folder / "program.hpp", header);
  test::write_text(folder / "main.cpp", R"cpp(
#include "program.hpp"
    namespace g = rotations;
    int main() {
      const auto par = g::prepare(g::Parameters<double>{});
      const double q[1] = {0.1}, u[1] = {0.7};
      double both[1] = {0.7}, xy[2], middle[1], late[1], other_xy[2], other_late[1];
      g::turn(par, q, u, xy, middle, late);
      g::turn(par, q, both, other_xy, both, other_late);
      return both[0] != middle[0] || other_late[0] != late[0] || other_xy[0] != xy[0] || late[0] != xy[0] * 0.7;
    }
  )cpp");
  const auto [status, text] = test::run(
      fmt::format("cd '{}' && g++ -std=c++17 -O2 -Wall -Wextra main.cpp -o main && ./main", folder.string()),
      folder);
  EXPECT_EQ(status, 0) << text;
}

}  // namespace
}  // namespace anholon::header_test
