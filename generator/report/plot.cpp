// SPDX-License-Identifier: GPL-2.0-or-later
#include "report/plot.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "check/run_process.hpp"
#include "emit/write_file.hpp"

namespace anholon {
namespace {

namespace fs = std::filesystem;

/// Colours that print apart and that most colour-blind readers tell apart (Okabe and Ito, 2008).
constexpr const char* colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                   "#e69f00", "#56b4e9", "#000000"};

/// In gnuplot's double quotes; names are not marked up.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out + "\"";
}

bool is_drawn(const std::pair<double, double>& point, bool logarithmic_abscissa) {
  return std::isfinite(point.first) && std::isfinite(point.second) && point.second > 0 &&
         (!logarithmic_abscissa || point.first > 0);
}

std::string script_of(const LogPlot& plot, const fs::path& output) {
  std::string text = fmt::format(
      "set terminal svg size 560,400 dynamic noenhanced font 'sans-serif,12'\n"
      "set output {}\nset encoding utf8\nset title {}\nset xlabel {}\nset ylabel {}\n"
      "{}\n"
      "set grid linecolor '#dddddd'\nset key outside bottom center horizontal\n",
      quoted(output.string()), quoted(plot.title), quoted(plot.abscissa), quoted(plot.ordinate),
      plot.logarithmic_abscissa ? "set logscale xy\nset format '%.0e'"
                                : "set logscale y\nset format y '%.0e'");
  std::string curves;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    std::string data;
    for (const auto& point : plot.series[i].points) {
      if (is_drawn(point, plot.logarithmic_abscissa))
        data += fmt::format("{} {}\n", point.first, point.second);
    }
    if (data.empty()) continue;
    text += fmt::format("$s{} << EOD\n{}EOD\n", i, data);
    curves += fmt::format("{}$s{} with {} linecolor rgb '{}' pointtype {} pointsize 0.6 title {}",
                          curves.empty() ? "" : ", ", i, plot.joined ? "linespoints" : "points",
                          colours[i % std::size(colours)], i % 7 + 4, quoted(plot.series[i].name));
  }
  if (curves.empty()) return "";
  return text + "plot " + curves + "\n";
}

}  // namespace

std::string draw(const LogPlot& plot) {
  std::string pattern = (fs::temp_directory_path() / "anholon_plot.XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr)
    throw PlotError(fmt::format("cannot make a folder '{}' for a plot", pattern));
  const fs::path folder = pattern;
  struct Remove {
    const fs::path& folder;
    ~Remove() {
      std::error_code ignored;
      fs::remove_all(folder, ignored);
    }
  } const remove{folder};
  const fs::path picture = folder / "plot.svg";
  const std::string script = script_of(plot, picture);
  if (script.empty()) return "";
  write_file(folder / "plot.gp", script);
  int status = 0;
  try {
    status = run_process({"gnuplot", (folder / "plot.gp").string()}, folder / "messages");
  } catch (const std::system_error& error) {
    throw PlotError(fmt::format("cannot run gnuplot: {}; install it, on Debian the package gnuplot-nox",
                                error.code().message()));
  }
  const auto read = [](const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
  };
  if (status != 0)
    throw PlotError(fmt::format("gnuplot failed with status {}: {}", status, read(folder / "messages")));
  const std::string svg = read(picture);
  const std::size_t start = svg.find("<svg");
  return start == std::string::npos ? "" : svg.substr(start);
}

}  // namespace anholon
