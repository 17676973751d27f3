// SPDX-License-Identifier: GPL-2.0-or-later
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/common.hpp"
#include "describe/location.hpp"
#include "describe/read_bytes.hpp"
#include "describe/sha256.hpp"
#include "emit/plan.hpp"
#include "emit/write_file.hpp"
#include "report/page.hpp"
#include "report/plot.hpp"
#include "report/record.hpp"

namespace anholon::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// One file of a robot, with its base: "panda.urdf" or "anymal.urdf:floating".
struct Subject {
  std::string file;
  bool is_floating = false;
};

Subject subject_of(const std::string& text) {
  const std::string suffix = ":floating";
  if (text.ends_with(suffix)) return {text.substr(0, text.size() - suffix.size()), true};
  return {text, false};
}

/// models/NAME/NAME.toml of the folder where the program runs.
std::vector<std::string> models_here() {
  std::vector<std::string> files;
  if (fs::is_directory("models")) {
    for (const fs::directory_entry& entry : fs::directory_iterator("models")) {
      const fs::path file = entry.path() / (entry.path().filename().string() + ".toml");
      if (fs::exists(file)) files.push_back(file.string());
    }
  }
  std::ranges::sort(files);
  if (files.empty()) throw std::invalid_argument("name models: there is no folder 'models' here");
  return files;
}

std::vector<fs::path> scenes_beside(const fs::path& model) {
  std::vector<fs::path> scenes;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(model.has_parent_path() ? model.parent_path() : fs::path("."))) {
    if (entry.path().string().ends_with(".scene.toml")) scenes.push_back(entry.path());
  }
  std::ranges::sort(scenes);
  return scenes;
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// Contents of all files that a model or a scene stands on.
template <class Load>
std::string contents_read(const Load& load) {
  const FilesRead read;
  (void)load();
  std::string contents;
  for (const fs::path& file : read.files()) contents += text_of(file);
  return contents;
}

ModelOptions options_of(const Subject& subject) {
  ModelOptions options;
  options.model = subject.file;
  options.robot.floating = subject.is_floating;
  return options;
}

/// The last line of the terminal says what is being done; without a terminal, a line for each part.
class Console {
 public:
  explicit Console(std::size_t parts) : parts_(parts) {}
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;
  ~Console() { clear(); }

  void begin(const std::string& part) { ++at_, part_ = part, watch_ = {}; }
  void stage(const std::string& what) {
    if (!terminal_ || (shown_.seconds() < 0.2 && what.starts_with("verifying,"))) return;
    fmt::print(stderr, "\r{:100s}\r[{}/{}] {}: {}", "", at_, parts_, part_, what);
    std::fflush(stderr);
    shown_ = {};
  }
  void end(const std::string& result) {
    clear();
    fmt::print("[{}/{}] {}: {}\n", at_, parts_, part_, result);
    std::fflush(stdout);
  }
  [[nodiscard]] double seconds() const { return watch_.seconds(); }

 private:
  void clear() const {
    if (terminal_) fmt::print(stderr, "\r{:100s}\r", "");
  }
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  std::size_t parts_, at_ = 0;
  std::string part_;
  Stopwatch watch_, shown_;
};

/// A part of the report, kept on disk: what an interrupted run has finished is not done again.
class Parts {
 public:
  explicit Parts(fs::path folder) : folder_(std::move(folder)) {}

  /// The record of an earlier run of the same inputs, or a new one.
  template <class Make>
  ordered_json get(const std::string& name, const std::string& inputs, Console& console, const Make& make) {
    console.begin(name);
    const fs::path file = folder_ / (name + ".json");
    const std::string key = sha256_of(inputs);
    if (fs::exists(file)) {
      const ordered_json kept = ordered_json::parse(text_of(file), nullptr, false);
      if (kept.is_object() && kept.value("key", "") == key) {
        console.end("kept from an earlier run");
        return kept.at("record");
      }
    }
    ordered_json record = make();
    write_file(file, ordered_json({{"key", key}, {"record", record}}).dump(1) + "\n");
    console.end(fmt::format("{:.1f} s", console.seconds()));
    return record;
  }

 private:
  fs::path folder_;
};

ordered_json measured_model(const ReportOptions& options, const Subject& subject, const Stage& stage) {
  ModelOptions one = options_of(subject);
  const Model model = load_model(one);
  stage("deriving");
  const Stopwatch watch;
  AnyDerivation derivation = derive_any(one, model);
  const double seconds = watch.seconds();
  derivation = derive_any(one, model, true);  // once more, with what each pass does
  GeneratedModel generated{model, derivation.reduction.get(), derivation.tree.get(), seconds};
  for (const OptimiseFor mode :
       {OptimiseFor::nothing, OptimiseFor::speed, OptimiseFor::balanced, OptimiseFor::accuracy}) {
    stage(fmt::format("optimising for {}", name(mode)));
    one.optimise = name(mode);
    std::optional<AnyDerivation> other;
    if (mode != OptimiseFor::balanced) other = derive_any(one, model, true);
    ModeResult result{mode, {}};
    std::ranges::copy_if((other ? *other : derivation).candidates(), std::back_inserter(result.kept),
                         &CandidateReport::chosen);
    generated.modes.push_back(std::move(result));
  }
  MeasureOptions measure;
  measure.samples = options.samples;
  return model_record(generated, measure, stage);
}

/// With the operations of forward_dynamics, of what the scene leaves of the model.
ordered_json measured_motion(const fs::path& file, const Stage& stage) {
  ModelOptions one;
  one.model = file.string();
  one.functions = {"forward_dynamics"};
  const Scene scene = read_scene(file.string());
  ordered_json operations;
  stage("deriving");
  try {
    const AnyDerivation derivation = derive_any(one, load_model(one));
    const EmissionPlan plan = plan_emission(derivation.reduction->program);
    for (const PlannedFunction& f : plan.functions)
      operations[f.function->name] = operations_record(f.operations);
  } catch (const UnsupportedError&) {  // the motion of what has no such function may still be simulated
  }
  ordered_json record = motion_record(scene, stage);
  if (!operations.is_null()) record["operations"] = operations;
  return record;
}

}  // namespace

int report(const ReportOptions& options) {
  const Stopwatch watch;
  (void)draw({"", "", "", {{"", {{1, 1}}}}});  // a missing gnuplot is to show before an hour of measuring
  std::vector<Subject> subjects;
  for (const std::string& text : options.models.empty() ? models_here() : options.models)
    subjects.push_back(subject_of(text));
  std::vector<std::pair<Subject, std::vector<fs::path>>> work;
  std::size_t parts = 0;
  for (const Subject& subject : subjects) {
    if (!fs::exists(subject.file))
      throw std::invalid_argument(fmt::format("there is no file '{}'", subject.file));
    work.emplace_back(subject, options.motions ? scenes_beside(subject.file) : std::vector<fs::path>{});
    parts += 1 + work.back().second.size();
  }

  const fs::path folder = options.output;
  Parts kept(folder / "parts");
  Console console(parts);
  const Stage stage = [&](const std::string& what) { console.stage(what); };
  const std::string program = sha256_of(text_of("/proc/self/exe"));  // the machine record names its version
  const MeasureOptions defaults;
  ordered_json result = {{"schema", "anholon.report/1"},    {"machine", machine_record()},
                         {"samples", options.samples},      {"states", defaults.states},
                         {"models", ordered_json::array()}, {"motions", ordered_json::array()}};
  std::vector<std::string> failures;
  for (const auto& item : work) {
    const Subject& subject = item.first;  // clang++ 14 captures no structured bindings
    const std::vector<fs::path>& scenes = item.second;
    const fs::path file = subject.file;
    const std::string with = program + (subject.is_floating ? "floating" : "") + result["machine"].dump();
    const std::string inputs = contents_read([&] { return load_model(options_of(subject)); });
    const ordered_json model = kept.get(file.stem().string(), with + inputs + std::to_string(options.samples),
                                        console, [&] { return measured_model(options, subject, stage); });
    if (!model.at("verification").at("passed").get<bool>()) failures.push_back(file.string());
    result["models"].push_back(model);
    for (const fs::path& scene : scenes) {
      const std::string name = fmt::format("{}.{}", file.stem().string(), scene.stem().stem().string());
      ordered_json motion = kept.get(name, with + contents_read([&] { return read_scene(scene); }), console,
                                     [&]() -> ordered_json {
                                       try {
                                         return measured_motion(scene, stage);
                                       } catch (const UnsupportedError& error) {
                                         return {{"left_out", error.what()}};
                                       }
                                     });
      if (!motion.contains("scene")) {
        motion["scene"] = scene.stem().stem().string();
        motion["model"] = model.at("model");
      }
      result["motions"].push_back(motion);
    }
  }
  write_file(folder / "report.json", result.dump(1) + "\n");
  write_file(folder / "index.html", report_page(result));
  fmt::print("wrote {} and {} in {:.0f} s\n", (folder / "index.html").string(),
             (folder / "report.json").string(), watch.seconds());
  for (const std::string& failure : failures)
    fmt::print("FAILED: errors of {} beyond their bounds\n", failure);
  return failures.empty() ? ok : check_failed;
}

}  // namespace anholon::cli
