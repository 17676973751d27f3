// SPDX-License-Identifier: GPL-2.0-or-later

// Operations of the functions of every robot in a folder of URDF files: additions, multiplications and
// divisions together, sines and cosines apart. A robot whose name does not begin like an arm's on a pedestal
// has a free base.
//
//   operation_table [--routes] [--fixed NAME]... FOLDER

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "derive/tree_functions.hpp"
#include "describe/read_urdf.hpp"
#include "optimise/tape/count.hpp"

int main(int argc, char** argv) {
  using namespace anholon;
  std::set<std::string> fixed = {"double_pendulum", "iiwa", "panda", "ur5"};
  bool routes = false;
  std::string folder;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--routes") {
      routes = true;
    } else if (argument == "--fixed" && i + 1 < argc) {
      fixed.insert(argv[++i]);
    } else {
      folder = argument;
    }
  }
  if (folder.empty()) {
    std::fputs("usage: operation_table [--routes] [--fixed NAME]... FOLDER\n", stderr);
    return 2;
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".urdf") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());

  fmt::print("| robot |");
  for (const std::string& name : standard_tree_functions()) fmt::print(" {} |", name);
  fmt::print(" sin + cos | s |\n|---|");
  for (std::size_t i = 0; i < standard_tree_functions().size() + 2; ++i) fmt::print("---:|");
  fmt::print("\n");
  int status = 0;
  for (const auto& file : files) {
    try {
      UrdfOptions options;
      options.floating = !fixed.contains(file.stem().string());
      const auto start = std::chrono::steady_clock::now();
      const auto derivation = derive_tree(read_urdf(file, options));
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      fmt::print("| {} |", file.stem().string());
      int angles = 0;
      for (const std::string& name : standard_tree_functions()) {
        const auto function = std::ranges::find(derivation->program.functions, name, &Function::name);
        if (function == derivation->program.functions.end()) {
          fmt::print(" |");
          continue;
        }
        std::vector<NodeId> roots;
        for (const OutputBlock& b : function->outputs)
          roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
        const OperationCount count = count_operations(derivation->program.tape, roots);
        angles = std::max(angles, count.trigonometric());
        fmt::print(" {} |", count.total());
      }
      fmt::print(" {} | {:.2f} |\n", angles, elapsed.count());
      if (!routes) continue;
      for (const CandidateReport& c : derivation->candidates)
        fmt::print("    {} {:6} {}: {}\n", c.chosen ? '*' : ' ', c.operations, c.function, c.route);
    } catch (const std::exception& error) {
      fmt::print(stderr, "{}\n", error.what());
      status = 1;
    }
  }
  return status;
}
