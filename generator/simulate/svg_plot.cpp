// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/svg_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace anholon {
namespace {

constexpr double width = 640, left = 64, right = 16, top = 34, panel_height = 190, gap = 46;
constexpr const char* colours[] = {"#1a4f8b", "#a33", "#2a7a3b", "#8a5a00", "#6a3d9a", "#777"};

/// Text of an XML element.
std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '<') {
      safe += "&lt;";
    } else if (c == '&') {
      safe += "&amp;";
    } else {
      safe += c;
    }
  }
  return safe;
}

bool is_drawn(const Panel& panel, double value) {
  return std::isfinite(value) && (panel.is_linear || value > 0);
}

/// A step of 1, 2 or 5 times a power of ten that divides the range into about six.
double round_step(double range) {
  const double rough = range / 6, power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10 * power;
}

/// What an ordinate spans, in the unit of its ticks: decades, or the quantity itself.
struct Ordinate {
  double low, high, tick;
};

/// Around all values of a panel, from tick to tick.
Ordinate ordinate_of(const Panel& panel) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Curve& curve : panel.curves) {
    for (const double v : curve.values) {
      if (is_drawn(panel, v)) low = std::min(low, v), high = std::max(high, v);
    }
  }
  if (low > high) return {-1, 1, 1};
  if (panel.is_linear) {
    const double tick = round_step(std::max(high - low, 1e-300));
    return {std::floor(low / tick) * tick, std::ceil(high / tick) * tick, tick};
  }
  const double from = std::floor(std::log10(low)), to = std::max(from + 1, std::ceil(std::log10(high)));
  return {from, to, std::max(1.0, std::floor((to - from + 7) / 8))};
}

}  // namespace

std::string svg_plot(const std::string& title, const std::string& abscissa, const std::vector<double>& x,
                     const std::vector<Panel>& panels) {
  if (x.empty()) return {};
  const double height = top + static_cast<double>(panels.size()) * (panel_height + gap);
  const double x_low = x.front(), x_high = std::max(x.back(), x.front() + 1e-300);
  const auto across = [&](double value) {
    return left + (width - left - right) * (value - x_low) / (x_high - x_low);
  };
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
      "height=\"{1:g}\" "
      "role=\"img\">\n<title>{2}</title>\n<style>text{{font:11px sans-serif;fill:#222}}"
      ".g{{stroke:#ddd}}.f{{fill:none;stroke:#222}}.c{{fill:none;stroke-width:1.4}}</style>\n"
      "<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"#fff\"/>\n<text x=\"{3:g}\" y=\"16\">{2}</text>\n",
      width, height, escaped(title), left);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const double above = top + static_cast<double>(p) * (panel_height + gap), below = above + panel_height;
    const Ordinate ordinate = ordinate_of(panels[p]);
    const auto raised = [&](double tick) {
      return below - panel_height * (tick - ordinate.low) / (ordinate.high - ordinate.low);
    };
    const auto up = [&](double value) { return raised(panels[p].is_linear ? value : std::log10(value)); };
    const int ticks = static_cast<int>(std::floor((ordinate.high - ordinate.low) / ordinate.tick + 1e-9));
    for (int i = 0; i <= ticks; ++i) {
      const double tick = ordinate.low + i * ordinate.tick, y = raised(tick);
      svg += fmt::format("<path class=\"g\" d=\"M{:g} {:.1f}H{:g}\"/>\n", left, y, width - right);
      svg +=
          fmt::format("<text x=\"{:g}\" y=\"{:.1f}\" text-anchor=\"end\">{}{:.6g}</text>\n", left - 6, y + 4,
                      panels[p].is_linear ? "" : "1e", std::abs(tick) < 1e-9 * ordinate.tick ? 0.0 : tick);
    }
    const double step = round_step(x_high - x_low);
    for (double tick = std::ceil(x_low / step) * step; tick <= x_high * (1 + 1e-12); tick += step) {
      svg += fmt::format("<path class=\"g\" d=\"M{:.1f} {:g}V{:g}\"/>\n", across(tick), above, below);
      svg += fmt::format("<text x=\"{:.1f}\" y=\"{:g}\" text-anchor=\"middle\">{:.6g}</text>\n", across(tick),
                         below + 14, std::abs(tick) < step * 1e-9 ? 0.0 : tick);
    }
    svg += fmt::format("<rect class=\"f\" x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\"/>\n", left,
                       above, width - left - right, panel_height);
    double legend = left + 8;
    for (std::size_t c = 0; c < panels[p].curves.size(); ++c) {
      const Curve& curve = panels[p].curves[c];
      const char* colour = colours[c % std::size(colours)];
      std::string line;
      bool drawing = false;
      for (std::size_t i = 0; i < x.size() && i < curve.values.size(); ++i) {
        if (!is_drawn(panels[p], curve.values[i])) {
          drawing = false;
          continue;
        }
        line += fmt::format("{}{:.1f} {:.1f}", drawing ? "L" : "M", across(x[i]), up(curve.values[i]));
        drawing = true;
      }
      svg += fmt::format("<path class=\"c\" stroke=\"{}\" d=\"{}\"/>\n", colour, line);
      svg += fmt::format("<text x=\"{:g}\" y=\"{:g}\" style=\"fill:{}\">{}</text>\n", legend, below + 28,
                         colour, escaped(curve.name));
      legend += 12 + 6.0 * static_cast<double>(curve.name.size());
    }
    svg += fmt::format("<text x=\"{:g}\" y=\"{:g}\" text-anchor=\"end\">{}, over {}</text>\n", width - right,
                       above - 5, escaped(panels[p].title), escaped(abscissa));
  }
  return svg + "</svg>\n";
}

}  // namespace anholon
