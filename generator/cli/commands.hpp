// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// One function a verb of the program; each returns the exit status.

#include <set>
#include <string>
#include <vector>

#include "describe/read_robot.hpp"

namespace anholon::cli {

// Exit statuses of every verb.
inline constexpr int ok = 0;
inline constexpr int check_failed = 1;
inline constexpr int usage = 2;
inline constexpr int bad_input = 3;
inline constexpr int unsupported = 4;
inline constexpr int environment = 5;  // no compiler, no gnuplot, nowhere to write
inline constexpr int internal_error = 70;

struct ModelOptions {
  std::string model;  // path of a description or scene
  std::string scene;  // path, empty: standard
  std::vector<std::string> functions;
  std::string inverse = "pseudo";     // or "leading:ROW[,ROW...]"
  RobotOptions robot;                 // of a robot file
  std::string gravity;                // of a robot file, m/s^2 along -z; empty: its own or the default
  bool search = true;                 // of a tree: try every formulation
  std::vector<std::string> counts;    // of a model file: "N=12"
  std::string contacts;               // of a scene: its contact set; empty: the first phase's
  std::string optimise = "balanced";  // or "accuracy", "speed"
};

struct CheckOptions : ModelOptions {
  bool json = false;
};
struct GenerateOptions : ModelOptions {
  std::string output = ".";
  std::string sincos = "cmath";  // or "batch"
  std::string order = "auto";    // or "sections", "lifetimes"
  std::string depfile;           // empty: none
  bool c_abi = false;
  bool passes = false;
};
struct EvaluateOptions : ModelOptions {
  std::string states;
  std::string method = "generated";
  std::string output;  // empty: standard output
  unsigned digits = 50;
};
struct VerifyOptions : ModelOptions {
  int samples = 1000;
  double bound_ulps = 450;  // 1e-13
  bool json = false;
};
struct ExplainOptions : ModelOptions {
  std::string output;
  bool brief = false;
};
struct SimulateOptions {
  std::string scene;
  std::string output;
  bool work_precision = false;
  bool conditioning = false;
  std::vector<double> stiffen;              // factors of the stiffness of elastic contacts
  std::vector<std::string> stiffness_cost;  // parameters, each with its exponent: "EI:1"
  std::string optimise = "balanced";        // or "accuracy", "speed"
};
struct ReportOptions {
  std::vector<std::string> models;  // files, of robot files with ":floating" behind; empty: models/*/*.toml
  std::string output = "out/report";
  int samples = 1000;
  bool motions = true;
};

int check(const CheckOptions& options);
int generate(const GenerateOptions& options);
int evaluate(const EvaluateOptions& options);
int verify(const VerifyOptions& options);
int explain(const ExplainOptions& options);
int simulate(const SimulateOptions& options);
int report(const ReportOptions& options);

}  // namespace anholon::cli
