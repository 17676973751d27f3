// SPDX-License-Identifier: GPL-2.0-or-later

// Puts the figures of docs/report/ into README and docs/:
//
//   insert_figures PROJECT

#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <iterator>

#include "emit/write_file.hpp"
#include "figures.hpp"

int main(int argc, char** argv) {
  using namespace anholon;
  if (argc != 2) {
    std::fputs("usage: insert_figures PROJECT\n", stderr);
    return 2;
  }
  const std::filesystem::path project = argv[1];
  std::filesystem::path file = project;
  try {
    const bench::Figures figures = bench::figures_of(project / "docs" / "report");
    for (const std::filesystem::path& document : bench::documents_with_figures(project)) {
      file = document;
      std::ifstream stream(file, std::ios::binary);
      const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
      const std::string fresh = bench::with_figures(text, figures);
      fmt::print("{}: {}\n", file.string(), fresh == text ? "as they were" : "new figures");
      if (fresh != text) write_file(file, fresh);
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", file.string(), error.what());
    return 1;
  }
  return 0;
}
