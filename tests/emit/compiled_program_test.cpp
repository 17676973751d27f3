// SPDX-License-Identifier: GPL-2.0-or-later
// Emitted code, compiled and called: its values, and the cache that keeps it.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "check/compile_cache.hpp"
#include "emit/header.hpp"
#include "emit/pendulum_program.hpp"
#include "emit/random_program.hpp"
#include "emit/toolbox.hpp"
#include "tape/interpret.hpp"

namespace anholon::compiled_program_test {
namespace {

CompileOptions options_for_test() {
  CompileOptions options;
  options.cache = std::filesystem::path(ANHOLON_BINARY_DIR) / "test-scratch" / "compiled";
  return options;
}

/// Values of a function by the interpreter, all inputs of the tape by name of block.
template <class S>
std::vector<S> interpreted(const Program& program, const Function& function,
                           const CompiledProgram::Blocks& blocks) {
  std::vector<S> inputs(program.tape.inputs().size(), S(0));
  for (const ParameterInfo& p : program.parameters)
    inputs[program.tape.node(p.node).a] = FromExact<S>()(p.value);
  for (const InputBlock& block : program.inputs) {
    for (std::size_t i = 0; i < block.nodes.size(); ++i) {
      inputs[program.tape.node(block.nodes[i]).a] =
          FromExact<S>()(Exact::from_double(blocks.at(block.name)[i]));
    }
  }
  std::vector<NodeId> roots;
  for (const OutputBlock& o : function.outputs) roots.insert(roots.end(), o.nodes.begin(), o.nodes.end());
  return interpret<S>(program.tape, roots, inputs);
}

/// Compares all functions of a program with the interpreter at random states in [low, high].
void expect_values(const Program& program, const CompileOptions& options, double low, double high,
                   double tolerance) {
  const CompiledProgram compiled(program, options);
  test::Dice dice(11);
  const WorkingDigits digits(50);
  for (int sample = 0; sample < 20; ++sample) {
    SCOPED_TRACE(sample);
    CompiledProgram::Blocks inputs;
    for (const InputBlock& block : program.inputs) {
      for (std::size_t i = 0; i < block.nodes.size(); ++i)
        inputs[block.name].push_back(dice.uniform(low, high));
    }
    for (const Function& function : program.functions) {
      SCOPED_TRACE(function.name);
      const CompiledProgram::Blocks outputs = compiled.call(function.name, inputs);
      const std::vector<double> in_double = interpreted<double>(program, function, inputs);
      const std::vector<Exact> exact = interpreted<Exact>(program, function, inputs);
      std::size_t i = 0;
      for (const OutputBlock& block : function.outputs) {
        for (std::size_t j = 0; j < block.nodes.size(); ++j, ++i) {
          const double value = outputs.at(block.name)[j];
          EXPECT_DOUBLE_EQ(value, in_double[i]) << block.name << "[" << j << "]";  // the same operations
          EXPECT_NEAR(value, exact[i].to_double(), tolerance * (1 + std::fabs(value)))
              << block.name << "[" << j << "]";
        }
      }
    }
  }
}

TEST(CompiledProgram, GivesTheValuesOfTheInterpreter) {
  expect_values(test::cart_pendulum(), options_for_test(), -3, 3, 1e-14);  // about 20 operations of 1 ulp
}

TEST(CompiledProgram, KnowsEveryOperation) {
  expect_values(test::every_operation(), options_for_test(), 0.1, 0.9, 1e-15);
}

TEST(CompiledProgram, ComputesInFloatBehindTheSameInterface) {
  CompileOptions options = options_for_test();
  options.scalar = AbiScalar::is_float;
  const CompiledProgram::Blocks state = {{"r", {0, 0.3}}, {"r_dot", {0, 0}}, {"F", {0}}};
  const auto single = CompiledProgram(test::cart_pendulum(), options).call("mass_matrix", state)["M"];
  const auto twice =
      CompiledProgram(test::cart_pendulum(), options_for_test()).call("mass_matrix", state)["M"];
  for (std::size_t i = 0; i < single.size(); ++i) EXPECT_NEAR(single[i], twice[i], 1e-6);  // 10 ulps of float
  EXPECT_NE(single[1], twice[1]) << "a cosine has more digits than float";
  EXPECT_EQ(static_cast<float>(single[1]), single[1]);
}

TEST(CompiledProgram, GivesTheSameValuesInBlocks) {
  CompileOptions options = options_for_test();
  options.style = {NodeOrder::depth_first, 10, 7};
  expect_values(test::random_program({4, 6, 150, 6, 40}, 21), options, -1, 1, 1e-10);
  expect_values(test::cart_pendulum(), options, -3, 3, 1e-14);
}

TEST(CompiledProgram, GivesTheSameValuesWithTheBatchOfSinesAndCosines) {
  CompileOptions options = options_for_test();
  options.style.sincos = SinCos::batch;
  const Program program = test::turns(5);
  const CompiledProgram plain(program, options_for_test());
  const CompiledProgram batch(program, options);
  EXPECT_NE(emit_header(program, options.style).find("sines_cosines(angle, sine, cosine)"),
            std::string::npos);
  std::mt19937_64 random(11);
  // angles in use, beyond the range of the batch, and what is none: of infinity both make NaN
  for (const double size : {3.0, 1e5, 1e7, 1e300, HUGE_VAL}) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int trial = 0; trial < 50; ++trial) {
      CompiledProgram::Blocks inputs;
      for (int i = 0; i < 5; ++i) inputs["r"].push_back(size * uniform(random));
      const std::vector<double> x = batch.call("turn", inputs)["xy"];
      const std::vector<double> y = plain.call("turn", inputs)["xy"];
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(std::isnan(x[i]), size == HUGE_VAL);
        if (size != HUGE_VAL) {
          EXPECT_NEAR(x[i], y[i], 1e-14);  // ten turns of some ulp each, length 1
        }
      }
    }
  }
}

TEST(CompiledProgram, SplitsALongFunctionAndCompilesIt) {
  const Program program = test::long_program(1000);
  const std::string header = emit_header(program);
  EXPECT_NE(header.find("turn_block_6("), std::string::npos);
  expect_values(program, options_for_test(), -1, 1, 1e-12);  // 1000 turns of two roundings
}

TEST(CompileEffort, GrowsWithTheProgram) {
  const CompileEffort small = compile_effort(test::long_program(10), options_for_test());
  const CompileEffort large = compile_effort(test::long_program(1000), options_for_test());
  EXPECT_GT(small.seconds, 0);
  EXPECT_GT(large.object_bytes, small.object_bytes + 4 * 6000);  // 6000 operations of 4 bytes or more
}

TEST(CompiledProgram, SplitsTheResultsOfALongFunctionAndFillsInRunsOfConstants) {
  Program program = test::long_program(1000);
  const auto lines_of_last_block = [](const std::string& header) {
    const std::string tail = header.substr(header.find("_block_", header.rfind("noinline")));
    return std::ranges::count(tail.substr(0, tail.find("\n}")), '\n');
  };
  const NodeId zero = program.tape.constant(0);
  OutputBlock rows{"rows", "", "", 1000, 1, {}};
  for (int i = 0; i < 1000; ++i)
    rows.nodes.push_back(i % 20 < 8 ? program.functions[0].outputs[0].nodes[i % 2] : zero);
  program.functions[0].outputs.push_back(rows);
  const std::string header = emit_header(program);
  EXPECT_NE(header.find("  for (int i = 8; i < 20; ++i) rows[i] = constant<Real>(0.0L);\n"),
            std::string::npos);
  EXPECT_NE(header.find("rows[980] = "), std::string::npos);
  EXPECT_LE(lines_of_last_block(header), 300 + 4);           // StatementStyle::block_size and the head
  expect_values(program, options_for_test(), -1, 1, 1e-12);  // 1000 turns of two roundings
}

TEST(CompiledProgram, TakesParametersByNameAndByPosition) {
  CompiledProgram compiled(test::cart_pendulum(), options_for_test());
  const CompiledProgram::Blocks state = {{"r", {0, 0.3}}, {"r_dot", {0, 0}}, {"F", {0}}};
  EXPECT_DOUBLE_EQ(compiled.call("mass_matrix", state)["M"][0], 1.1);
  compiled.set_parameters({{"m_c", 4}});
  EXPECT_DOUBLE_EQ(compiled.call("mass_matrix", state)["M"][0], 4.1);
  std::vector<double> values = compiled.parameter_defaults();
  values[1] = 2;
  compiled.set_parameters(values);
  EXPECT_DOUBLE_EQ(compiled.call("mass_matrix", state)["M"][0], 3);
  EXPECT_THROW(compiled.set_parameters({{"mass", 1}}), std::out_of_range);
  EXPECT_THROW(compiled.set_parameters(std::vector<double>{1}), std::invalid_argument);
}

TEST(CompiledProgram, SaysWhatIsMissing) {
  const CompiledProgram compiled(test::cart_pendulum(), options_for_test());
  EXPECT_TRUE(compiled.has("energies"));
  EXPECT_FALSE(compiled.has("torques"));
  EXPECT_THROW((void)compiled.function("torques"), std::out_of_range);
  EXPECT_THROW((void)compiled.call("mass_matrix", {}), std::out_of_range);
  EXPECT_THROW((void)compiled.call("mass_matrix", {{"r", {1}}}), std::invalid_argument);
}

TEST(CompiledProgram, CarriesTheTableOfTheProgram) {
  const CompiledProgram compiled(test::every_operation(), options_for_test());
  const anholon_program& table = compiled.table();
  EXPECT_STREQ(table.name_space, "every_operation");
  ASSERT_EQ(table.parameter_count, 1);
  EXPECT_STREQ(table.parameters[0].name, "M_PI");
  EXPECT_EQ(table.parameters[0].value, 1.0 / 3);
  EXPECT_STREQ(table.parameters[0].meaning, "a macro as a name \\");
  ASSERT_EQ(table.function_count, 1);
  EXPECT_STREQ(table.functions[0].name, "sin");
  EXPECT_STREQ(table.functions[0].inputs[0].meaning, "one\nline \\");
  EXPECT_STREQ(table.functions[0].outputs[0].name, "class");
}

TEST(CompiledProgram, MayWriteAnOutputOverAnInput) {
  const CompiledProgram compiled(test::cart_pendulum(), options_for_test());
  double r[2] = {0.1, 0.7}, r_dot[2] = {0.4, -0.3}, F[1] = {2}, apart[2];
  const double* const inputs[] = {r, r_dot, F};
  double* outputs[] = {apart};
  const anholon_function& f = compiled.function("forward_dynamics");
  compiled.call(f, inputs, outputs);
  outputs[0] = r_dot;
  compiled.call(f, inputs, outputs);
  EXPECT_EQ(r_dot[0], apart[0]);
  EXPECT_EQ(r_dot[1], apart[1]);
}

TEST(CompileCache, CompilesOnceForOneTextAndCompilerAndFlags) {
  CompileOptions options = options_for_test();
  options.cache = test::test_folder() / "cache with blanks";
  EXPECT_FALSE(CompiledProgram(test::cart_pendulum(), options).was_cached());
  EXPECT_TRUE(CompiledProgram(test::cart_pendulum(), options).was_cached());
  options.flags[0] = "-O1";
  EXPECT_FALSE(CompiledProgram(test::cart_pendulum(), options).was_cached());
  ::setenv("ANHOLON_CXXFLAGS", "-O0  -DANY", 1);
  EXPECT_FALSE(CompiledProgram(test::cart_pendulum(), options).was_cached());
  EXPECT_EQ(flags_of(options).back(), "-DANY");
  ::unsetenv("ANHOLON_CXXFLAGS");
  std::size_t entries = 0;
  for (const auto& entry : std::filesystem::directory_iterator(options.cache)) {
    ++entries;
    EXPECT_EQ(entry.path().filename().string().size(), 64U) << "a temporary stays: " << entry.path();
  }
  EXPECT_EQ(entries, 3U);
}

TEST(CompileCache, RepairsADamagedLibrary) {
  CompileOptions options = options_for_test();
  options.cache = test::test_folder();
  (void)CompiledProgram(test::cart_pendulum(), options);
  for (const auto& entry : std::filesystem::directory_iterator(options.cache)) {
    std::filesystem::resize_file(entry.path() / "program.so", 100);
  }
  const CompiledProgram compiled(test::cart_pendulum(), options);
  EXPECT_FALSE(compiled.was_cached());
  EXPECT_TRUE(compiled.has("energies"));
}

TEST(CompileCache, ServesParallelProcesses) {
  CompileOptions options = options_for_test();
  options.cache = test::test_folder();
  options.flags[0] = "-O0";
  std::vector<pid_t> children;
  for (int i = 0; i < 4; ++i) {
    const pid_t child = ::fork();
    if (child == 0) {
      try {
        const CompiledProgram compiled(test::cart_pendulum(), options);
        ::_exit(compiled.has("energies") ? 0 : 1);
      } catch (...) {
        ::_exit(2);
      }
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = -1;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
  }
  EXPECT_TRUE(CompiledProgram(test::cart_pendulum(), options).was_cached());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(options.cache), {}), 1);
}

TEST(CompileCache, PassesOnWhatTheCompilerSays) {
  CompileOptions options = options_for_test();
  options.cache = test::test_folder();
  try {
    (void)compile_cached("", "int broken = ;\n", options);
    FAIL();
  } catch (const CompileError& error) {
    EXPECT_NE(std::string(error.what()).find("program.cpp:1:"), std::string::npos) << error.what();
  }
  options.compiler = "no-such-compiler-anywhere";
  try {
    (void)compile_cached("", "", options);
    FAIL();
  } catch (const CompileError& error) {
    EXPECT_NE(std::string(error.what()).find("set CXX"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(std::filesystem::is_empty(options.cache)) << "half-written folders stay";
}

}  // namespace
}  // namespace anholon::compiled_program_test
