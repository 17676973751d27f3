// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Generated code as a loaded library: compiled once, kept in a cache, called by the names of functions and
// blocks.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "anholon/abi.hpp"
#include "emit/c_abi.hpp"
#include "emit/statements.hpp"
#include "tape/interface.hpp"

namespace anholon {

struct CompileOptions {
  std::string compiler;  // empty: environment CXX, else c++; may carry arguments, "ccache g++"
  std::vector<std::string> flags = {"-O2",
                                    "-std=c++17",
                                    "-fPIC",
                                    "-shared",
                                    "-fno-math-errno",
                                    "-fno-trapping-math",
                                    "-ffp-contract=off",
                                    "-fvisibility=hidden"};
  std::filesystem::path cache;  // empty: $ANHOLON_CACHE, $XDG_CACHE_HOME/anholon or ~/.cache/anholon
  StatementStyle style;
  AbiScalar scalar = AbiScalar::is_double;
};

/// Those of the options, then the words of $ANHOLON_CXXFLAGS: of two that contradict each other compilers
/// take the last.
std::vector<std::string> flags_of(const CompileOptions& options);

/// The compiler refused, could not be run, or its library could not be loaded; what() carries its messages.
class CompileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A shared library made of `source`, which may include `header` as "program.hpp" and "anholon/abi.hpp".
struct CompiledFile {
  std::filesystem::path library;
  bool was_cached = false;
};

/// Compiles, or finds what an earlier call with the same text, compiler, compiler version and flags has left.
/// Safe with parallel processes: each compiles in a folder of its own, which is then renamed into place.
/// @throws CompileError
CompiledFile compile_cached(const std::string& header, const std::string& source,
                            const CompileOptions& options = {});

/// What it takes to compile the functions of double to an object file; never from the cache.
struct CompileEffort {
  double seconds = 0;  // of processor time
  std::uintmax_t object_bytes = 0;
};
/// @throws CompileError
CompileEffort compile_effort(const Program& program, const CompileOptions& options = {});

/// The first line that the compiler prints of its version.
std::string compiler_name(const CompileOptions& options = {});

/// A program that runs. Not copied; a copy of the code stays loaded as long as this lives.
class CompiledProgram {
 public:
  using Blocks = std::map<std::string, std::vector<double>, std::less<>>;

  /// Emits, compiles (or finds in the cache), loads and prepares with the default parameters.
  /// @throws CompileError
  explicit CompiledProgram(const Program& program, const CompileOptions& options = {});
  /// Loads a library that exports anholon_program_table.
  explicit CompiledProgram(const std::filesystem::path& library);

  [[nodiscard]] const anholon_program& table() const { return *table_; }
  [[nodiscard]] bool was_cached() const { return was_cached_; }

  /// One value per parameter, in the order of the table.
  void set_parameters(std::span<const double> values);
  /// Values by name; those that are not named get their defaults. @throws std::out_of_range for an unknown
  /// name
  void set_parameters(const std::map<std::string, double, std::less<>>& values);
  [[nodiscard]] std::vector<double> parameter_defaults() const;

  [[nodiscard]] bool has(std::string_view function) const { return find(function) != nullptr; }
  /// @throws std::out_of_range naming the function
  [[nodiscard]] const anholon_function& function(std::string_view name) const;

  /// Fast call: one pointer per block, in the order of the table.
  void call(const anholon_function& function, const double* const* inputs, double* const* outputs) const {
    function.call(prepared_.get(), inputs, outputs);
  }
  /// Convenient call: blocks by name. Inputs that the function doesn't read are ignored.
  /// @throws std::out_of_range for a block that is missing, std::invalid_argument for one of wrong size
  [[nodiscard]] Blocks call(std::string_view name, const Blocks& inputs) const;

 private:
  struct CloseLibrary {
    void operator()(void* handle) const;
  };
  struct FreePrepared {
    void operator()(std::byte* storage) const;
  };
  void load(const std::filesystem::path& library);
  [[nodiscard]] const anholon_function* find(std::string_view function) const;

  std::unique_ptr<void, CloseLibrary> library_;
  const anholon_program* table_ = nullptr;
  std::unique_ptr<std::byte, FreePrepared> prepared_;
  bool was_cached_ = false;
};

}  // namespace anholon
