// SPDX-License-Identifier: GPL-2.0-or-later
// The program `anholon`: reads the command line and calls the verb.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "check/compile_cache.hpp"
#include "cli/commands.hpp"
#include "describe/location.hpp"
#include "describe/names.hpp"
#include "report/plot.hpp"

int main(int argc, char** argv) {
  using namespace anholon;
  namespace cli = anholon::cli;
  CLI::App app(
      "Symbolic generator of reduced multibody dynamics: from one description of a robot to C++ functions.",
      "anholon");
  app.require_subcommand(1);
  app.option_defaults()->always_capture_default();
  app.set_version_flag("--version", ANHOLON_VERSION);
  app.footer(
      "Exit status: 0 ok, 1 a check failed, 2 usage, 3 bad input, 4 unsupported, 5 compiling, plotting or "
      "writing failed, 70 a fault of this program.\n\n"
      "Environment, for generated code that verify, evaluate, simulate and report compile: CXX, the "
      "compiler; "
      "ANHOLON_CXXFLAGS, flags after its own, such as -march=native; ANHOLON_CACHE, the folder that keeps "
      "what "
      "was compiled.");
  std::function<int()> run;

  const auto optimise_option = [](CLI::App* verb, std::string& optimise) {
    verb->add_option("--optimise", optimise,
                     "for accuracy, speed, or balanced: what is fastest and loses no digits to speak of")
        ->check(CLI::IsMember({"accuracy", "balanced", "speed"}));
  };
  const auto model_options = [&](CLI::App* verb, cli::ModelOptions& o, bool functions) {
    verb->add_option("MODEL", o.model,
                     "description of the robot or a scene of it (TOML), or its URDF, SDFormat or MJCF file")
        ->required();
    verb->add_option("--scene", o.scene, "scene file: what is frozen, locked, kept, driven");
    verb->add_option(
        "--inverse", o.inverse,
        "generalised inverse where rows are redundant: pseudo, or leading:ROW[,ROW...] (from 1)");
    verb->add_option("--count", o.counts, "numbers for counts of the description: N=12")
        ->delimiter(',')
        ->default_str("");
    verb->add_option("--contacts", o.contacts, "contact set of the scene; default: that of its first phase");
    optimise_option(verb, o.optimise);
    if (functions)
      verb->add_option(
              "--functions", o.functions,
              "functions to generate, separated by commas; default: all, or of a robot file the five "
              "of docs/robot-files.md; 'all' for every one there")
          ->delimiter(',')
          ->default_str("");
    verb->add_flag("--floating", o.robot.floating, "URDF: the root link moves freely");
    verb->add_flag("--as-written", o.robot.as_written,
                   "robot file: angles and axes exactly as their digits say");
    verb->add_flag("--symbolic-inertia", o.robot.symbolic_inertia,
                   "robot file: inertial figures become parameters");
    verb->add_option("--gravity", o.gravity,
                     "robot file: acceleration along -z of the world, m/s^2; default: the file's, or 9.81");
    verb->add_flag_callback(
        "--no-search", [&o] { o.search = false; },
        "robot file: take the first formulation instead of the cheapest");
  };

  cli::CheckOptions check;
  auto* verb = app.add_subcommand(
      "check", "Sizes, class of Table I, kernel and its conditioning, what reading assumed");
  model_options(verb, check, false);
  verb->add_flag("--json", check.json, "print JSON, schema anholon.check/1");
  verb->callback([&] { run = [&] { return cli::check(check); }; });

  cli::GenerateOptions generate;
  verb = app.add_subcommand("generate", "Write the C++ header of a model");
  model_options(verb, generate, true);
  verb->add_option("-o,--output", generate.output, "folder to write to, or a file ending in .hpp");
  verb->add_option("--sincos", generate.sincos,
                   "sines and cosines: cmath, one by one, or batch, those of all angles by one loop that "
                   "compilers vectorise")
      ->check(CLI::IsMember({"cmath", "batch"}));
  verb->add_option("--order", generate.order,
                   "of operations: sections as derived, lifetimes as processors like it, or auto: lifetimes "
                   "in long functions")
      ->check(CLI::IsMember({"auto", "sections", "lifetimes"}));
  verb->add_option("--depfile", generate.depfile,
                   "also write the files that were read, as a rule of make: for build systems");
  verb->add_flag("--c-abi", generate.c_abi, "also write a source with a flat C interface, and its JSON");
  verb->add_flag(
      "--passes", generate.passes,
      "print the operations and the rounding error of every route that was tried, after each pass, and what "
      "compiling takes");
  verb->callback([&] { run = [&] { return cli::generate(generate); }; });

  cli::ExplainOptions explain;
  verb = app.add_subcommand("explain", "Write the symbolic equations as Markdown with LaTeX");
  model_options(verb, explain, false);
  verb->add_option("-o,--output", explain.output, "file to write; default: standard output");
  verb->add_flag("--brief", explain.brief, "without title, and of long equations only the size");
  verb->callback([&] { run = [&] { return cli::explain(explain); }; });

  cli::EvaluateOptions evaluate;
  verb = app.add_subcommand("evaluate", "Evaluate a model at given states");
  model_options(verb, evaluate, true);
  verb->add_option("STATES", evaluate.states, "states (JSON), docs/evaluate.md")->required();
  verb->add_option("--with", evaluate.method, "generated, recursion or exact")
      ->check(CLI::IsMember({"generated", "recursion", "exact"}));
  verb->add_option("--digits", evaluate.digits, "decimal digits of the exact method")
      ->check(CLI::Range(15, 1000));
  verb->add_option("-o,--output", evaluate.output, "file to write; default: standard output");
  verb->callback([&] { run = [&] { return cli::evaluate(evaluate); }; });

  cli::VerifyOptions verify;
  verb = app.add_subcommand(
      "verify", "Compare generated code with exact arithmetic and the recursion at random states");
  model_options(verb, verify, true);
  verb->add_option("--samples", verify.samples, "random states; beyond 1000, long double is the judge")
      ->check(CLI::Range(1, 10000000));
  verb->add_option("--bound", verify.bound_ulps,
                   "largest error in ulps of the natural scale, 2^-52; beyond it 10 eps kappa. 450 are 1e-13")
      ->check(CLI::PositiveNumber);
  verb->add_flag("--json", verify.json, "print JSON, schema anholon.verify/1");
  verb->callback([&] { run = [&] { return cli::verify(verify); }; });

  cli::SimulateOptions simulate;
  verb = app.add_subcommand("simulate", "Generate, compile and integrate a scene");
  verb->add_option("SCENE", simulate.scene, "scene file (TOML)")->required();
  verb->add_option("-o,--output", simulate.output,
                   "folder for the trajectory and its summary; default: out/<model>_<scene>");
  optimise_option(verb, simulate.optimise);
  auto* ladder = verb->add_flag("--work-precision", simulate.work_precision,
                                "error against CPU time over a ladder of tolerances");
  auto* path = verb->add_flag("--conditioning", simulate.conditioning,
                              "conditioning and error of the accelerations along the path, as CSV and SVG")
                   ->excludes(ladder);
  auto* stiffen =
      verb->add_option("--stiffen", simulate.stiffen,
                       "shares of elastic contacts at these factors of their stiffness, beside rigid ones")
          ->delimiter(',')
          ->check(CLI::PositiveNumber)
          ->excludes(ladder)
          ->excludes(path);
  verb->add_option(
          "--stiffness-cost", simulate.stiffness_cost,
          "cost of the same accuracy as parameters grow 1e8-fold, each to its exponent (EI:1,c:0.5): "
          "stiff and explicit method")
      ->delimiter(',')
      ->default_str("")
      ->excludes(ladder)
      ->excludes(path)
      ->excludes(stiffen);
  verb->callback([&] { run = [&] { return cli::simulate(simulate); }; });

  cli::ReportOptions report;
  verb = app.add_subcommand(
      "report", "Measure models and their motions: a page of speed against error, and its figures as JSON");
  verb->add_option("MODELS", report.models,
                   "descriptions or robot files, 'FILE:floating' for a robot whose root link moves freely; "
                   "default: models/NAME/NAME.toml of this folder")
      ->default_str("");
  verb->add_option("-o,--output", report.output,
                   "folder for index.html and report.json; an interrupted run "
                   "goes on where it was");
  verb->add_option("--samples", report.samples, "random states at which errors are measured")
      ->check(CLI::Range(1, 10000000));
  verb->add_flag_callback(
      "--no-motions", [&report] { report.motions = false; },
      "leave out the motions of the scenes beside the models");
  verb->callback([&] { run = [&] { return cli::report(report); }; });

  std::vector<std::string> verbs;
  for (const CLI::App* known : app.get_subcommands({})) verbs.push_back(known->get_name());
  if (argc > 1 && argv[1][0] != '-' && std::ranges::find(verbs, argv[1]) == verbs.end()) {
    const std::string near = closest_name(argv[1], verbs);
    fmt::print(stderr, "anholon: there is no '{}'; {}choose from {}\n", argv[1],
               near.empty() ? "" : fmt::format("did you mean '{}'? ", near), fmt::join(verbs, ", "));
    return cli::usage;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? cli::ok : cli::usage;
  }
  try {
    const int status = run();
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
    fmt::print(stderr, "anholon: cannot write standard output\n");
    return cli::environment;
  } catch (const ModelError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return cli::bad_input;
  } catch (const UnsupportedError& error) {
    fmt::print(stderr, "anholon: unsupported: {}\n", error.what());
    return cli::unsupported;
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "anholon: {}\n", error.what());
    return cli::usage;
  } catch (const CompileError& error) {
    fmt::print(stderr, "anholon: {}\n", error.what());
    return cli::environment;
  } catch (const PlotError& error) {
    fmt::print(stderr, "anholon: {}\n", error.what());
    return cli::environment;
  } catch (const std::system_error& error) {
    fmt::print(stderr, "anholon: {}\n", error.what());
    return cli::environment;
  } catch (const std::exception& error) {
    fmt::print(stderr, "anholon: internal error: {}\n", error.what());
    return cli::internal_error;
  }
}
