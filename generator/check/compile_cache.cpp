// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/compile_cache.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <mutex>
#include <new>
#include <sstream>
#include <system_error>

#include "check/run_process.hpp"
#include "emit/embedded.hpp"
#include "emit/header.hpp"
#include "emit/provenance.hpp"
#include "emit/write_file.hpp"

namespace anholon {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_message = 8000;  // of a compiler, kept in an error

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::string read_file(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// A folder of this process alone, gone at the end of the scope.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const fs::path& parent) {
    std::string pattern = (parent / "tmp.XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw CompileError(
          fmt::format("cannot make a folder in '{}': {}", parent.string(), std::strerror(errno)));
    }
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// @return the exit status of the compiler
int run(const std::vector<std::string>& command, const fs::path& printed) {
  try {
    return run_process(command, printed);
  } catch (const std::system_error& error) {
    throw CompileError(
        fmt::format("cannot run '{}': {}; set CXX to a C++ compiler", command[0], error.code().message()));
  }
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), std::istream_iterator<std::string>()};
}

std::vector<std::string> compiler_command(const CompileOptions& options) {
  std::string text = options.compiler.empty() ? environment("CXX") : options.compiler;
  if (text.empty()) text = "c++";
  if (fs::exists(text)) return {text};  // a path that may hold blanks
  return words_of(text);
}

fs::path cache_folder(const CompileOptions& options) {
  fs::path folder = options.cache;
  if (folder.empty()) folder = environment("ANHOLON_CACHE");
  if (folder.empty() && !environment("XDG_CACHE_HOME").empty())
    folder = fs::path(environment("XDG_CACHE_HOME")) / "anholon";
  if (folder.empty() && !environment("HOME").empty())
    folder = fs::path(environment("HOME")) / ".cache" / "anholon";
  if (folder.empty()) throw CompileError("no place for compiled code: set ANHOLON_CACHE to a folder");
  std::error_code error;
  if (!fs::is_directory(folder)) {
    fs::create_directories(folder, error);
    if (!error) fs::permissions(folder, fs::perms::owner_all, error);  // others must not plant libraries
  }
  if (error)
    throw CompileError(fmt::format("cannot make the folder '{}': {}", folder.string(), error.message()));
  return fs::absolute(folder);
}

/// What `compiler --version` prints, asked once a process.
std::string compiler_version(const std::vector<std::string>& compiler, const fs::path& cache) {
  static std::mutex mutex;
  static std::map<std::vector<std::string>, std::string> known;
  const std::lock_guard lock(mutex);
  const auto [found, is_new] = known.try_emplace(compiler);
  if (is_new) {
    const TemporaryFolder folder(cache);
    std::vector<std::string> command = compiler;
    command.emplace_back("--version");
    try {
      const int status = run(command, folder.path() / "version");
      found->second = fmt::format("{}\n{}", status, read_file(folder.path() / "version"));
    } catch (...) {
      known.erase(found);
      throw;
    }
  }
  return found->second;
}

/// Writes header and source to the folder and compiles them to the output file.
void compile(std::vector<std::string> command, const std::vector<std::string>& flags,
             const std::string& header, const std::string& source, const fs::path& folder,
             const fs::path& output) {
  write_file(folder / "program.hpp", header);
  write_file(folder / "program.cpp", source);
  write_file(folder / "anholon" / "abi.hpp", embedded::abi_header);
  command.insert(command.end(), flags.begin(), flags.end());
  for (const std::string& word : {std::string("-I"), folder.string(), std::string("-o"), output.string(),
                                  (folder / "program.cpp").string()}) {
    command.push_back(word);
  }
  const fs::path messages = folder.string() + ".messages";
  if (const int status = run(command, messages); status != 0) {
    std::string text = read_file(messages);
    if (text.size() > longest_message) text = text.substr(0, longest_message) + "\n...";
    std::string shown;
    for (const std::string& word : command) shown += (shown.empty() ? "" : " ") + word;
    throw CompileError(
        fmt::format("the compiler failed with status {} on generated code:\n{}\n{}", status, shown, text));
  }
}

/// Processor time of the processes that ended.
double seconds_of_children() {
  rusage used{};
  ::getrusage(RUSAGE_CHILDREN, &used);
  const auto of = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return of(used.ru_utime) + of(used.ru_stime);
}

/// What of the processor decides what -march=native means.
std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  std::string result, line;
  while (std::getline(info, line) && !line.empty()) {  // up to the second processor
    for (const char* key : {"model name", "flags", "Features", "CPU part"}) {
      if (line.starts_with(key)) result += line + "\n";
    }
  }
  return result;
}

/// Every part with its length, so that no two lists of parts give the same text.
void append(std::string& text, std::string_view part) { text += fmt::format("{}:{}\n", part.size(), part); }

}  // namespace

std::vector<std::string> flags_of(const CompileOptions& options) {
  std::vector<std::string> flags = options.flags;
  for (std::string& word : words_of(environment("ANHOLON_CXXFLAGS"))) flags.push_back(std::move(word));
  return flags;
}

CompiledFile compile_cached(const std::string& header, const std::string& source,
                            const CompileOptions& options) {
  const std::vector<std::string> compiler = compiler_command(options);
  const std::vector<std::string> flags = flags_of(options);
  const fs::path cache = cache_folder(options);
  std::string identity;
  append(identity, header);
  append(identity, source);
  append(identity, embedded::abi_header);
  for (const std::string& word : compiler) append(identity, word);
  append(identity, compiler_version(compiler, cache));
  for (const std::string& flag : flags) append(identity, flag);
  if (std::ranges::any_of(flags, [](const std::string& f) { return f.ends_with("=native"); }))
    append(identity, processor());  // the folder may be shared by different machines
  const fs::path folder = cache / sha256_hex(identity);
  const fs::path library = folder / "program.so";
  if (fs::exists(library)) return {library, true};

  const TemporaryFolder scratch(cache);
  const fs::path work = scratch.path() / "program";
  compile(compiler, flags, header, source, work, work / "program.so");
  std::error_code error;
  fs::rename(work, folder, error);
  if (error && !fs::exists(library)) {  // what a cleaner left of the folder
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    fs::rename(work, folder, error);
  }
  if (error && !fs::exists(library)) {  // else another process was faster, with the same bytes
    throw CompileError(
        fmt::format("cannot move compiled code to '{}': {}", folder.string(), error.message()));
  }
  return {library, false};
}

CompileEffort compile_effort(const Program& program, const CompileOptions& options) {
  const std::vector<std::string> compiler = compiler_command(options);
  const TemporaryFolder scratch(cache_folder(options));
  std::vector<std::string> flags = flags_of(options);
  std::erase(flags, "-shared");
  flags.emplace_back("-c");
  const fs::path object = scratch.path() / "program.o";
  const double before = seconds_of_children();
  compile(compiler, flags, emit_header(program, options.style),
          emit_c_abi(program, "program.hpp", options.scalar), scratch.path() / "program", object);
  return {seconds_of_children() - before, fs::file_size(object)};
}

std::string compiler_name(const CompileOptions& options) {
  std::istringstream text(compiler_version(compiler_command(options), cache_folder(options)));
  std::string line;
  std::getline(text, line);  // the status
  std::getline(text, line);
  return line;
}

void CompiledProgram::CloseLibrary::operator()(void* handle) const { ::dlclose(handle); }

void CompiledProgram::FreePrepared::operator()(std::byte* storage) const {
  ::operator delete (storage, std::align_val_t{alignof(std::max_align_t)});
}

CompiledProgram::CompiledProgram(const Program& program, const CompileOptions& options) {
  const std::string header = emit_header(program, options.style);
  const std::string source = emit_c_abi(program, "program.hpp", options.scalar);
  CompiledFile file = compile_cached(header, source, options);
  try {
    load(file.library);
  } catch (const CompileError&) {
    if (!file.was_cached) throw;
    std::error_code ignored;  // a damaged file in the cache: once more from the start
    fs::remove_all(file.library.parent_path(), ignored);
    file = compile_cached(header, source, options);
    load(file.library);
  }
  was_cached_ = file.was_cached;
}

CompiledProgram::CompiledProgram(const std::filesystem::path& library) { load(library); }

void CompiledProgram::load(const std::filesystem::path& library) {
  library_.reset(::dlopen(fs::absolute(library).c_str(), RTLD_NOW | RTLD_LOCAL));
  if (library_ == nullptr) throw CompileError(fmt::format("cannot load compiled code: {}", ::dlerror()));
  void* const symbol = ::dlsym(library_.get(), "anholon_program_table");
  if (symbol == nullptr)
    throw CompileError(fmt::format("'{}' holds no anholon_program_table", library.string()));
  table_ = reinterpret_cast<anholon_program_table_function>(symbol)();
  if (table_->abi_version != ANHOLON_ABI_VERSION) {
    throw CompileError(fmt::format("'{}' has version {} of the C interface, this program reads {}",
                                   library.string(), table_->abi_version, ANHOLON_ABI_VERSION));
  }
  prepared_.reset(static_cast<std::byte*>(
      ::operator new (table_->prepared_size, std::align_val_t{alignof(std::max_align_t)})));
  set_parameters(parameter_defaults());
}

std::vector<double> CompiledProgram::parameter_defaults() const {
  std::vector<double> values;
  for (int i = 0; i < table_->parameter_count; ++i) values.push_back(table_->parameters[i].value);
  return values;
}

void CompiledProgram::set_parameters(std::span<const double> values) {
  if (values.size() != static_cast<std::size_t>(table_->parameter_count)) {
    throw std::invalid_argument(
        fmt::format("{} values for {} parameters", values.size(), table_->parameter_count));
  }
  table_->prepare(values.data(), prepared_.get());
}

void CompiledProgram::set_parameters(const std::map<std::string, double, std::less<>>& values) {
  std::vector<double> all = parameter_defaults();
  std::size_t used = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (const auto found = values.find(table_->parameters[i].name); found != values.end()) {
      all[i] = found->second;
      ++used;
    }
  }
  if (used != values.size()) {
    for (const auto& [name, value] : values) {
      bool known = false;
      for (std::size_t i = 0; i < all.size(); ++i) known = known || name == table_->parameters[i].name;
      if (!known)
        throw std::out_of_range(fmt::format("'{}' has no parameter '{}'", table_->name_space, name));
    }
  }
  set_parameters(all);
}

const anholon_function* CompiledProgram::find(std::string_view function) const {
  for (int i = 0; i < table_->function_count; ++i) {
    if (function == table_->functions[i].name) return &table_->functions[i];
  }
  return nullptr;
}

const anholon_function& CompiledProgram::function(std::string_view name) const {
  const anholon_function* const found = find(name);
  if (found == nullptr)
    throw std::out_of_range(fmt::format("'{}' has no function '{}'", table_->name_space, name));
  return *found;
}

CompiledProgram::Blocks CompiledProgram::call(std::string_view name, const Blocks& inputs) const {
  const anholon_function& callee = function(name);
  std::vector<const double*> in;
  for (int i = 0; i < callee.input_count; ++i) {
    const anholon_block& block = callee.inputs[i];
    const auto found = inputs.find(std::string_view(block.name));
    if (found == inputs.end())
      throw std::out_of_range(fmt::format("function '{}' needs input '{}'", name, block.name));
    const auto size = static_cast<std::size_t>(block.rows) * static_cast<std::size_t>(block.cols);
    if (found->second.size() != size) {
      throw std::invalid_argument(fmt::format("input '{}' of function '{}' has {} entries, not {}",
                                              block.name, name, size, found->second.size()));
    }
    in.push_back(found->second.data());
  }
  Blocks result;
  std::vector<double*> out;
  for (int i = 0; i < callee.output_count; ++i) {
    const anholon_block& block = callee.outputs[i];
    auto& values = result[block.name];
    values.resize(static_cast<std::size_t>(block.rows) * static_cast<std::size_t>(block.cols));
    out.push_back(values.data());
  }
  call(callee, in.data(), out.data());
  return result;
}

}  // namespace anholon
