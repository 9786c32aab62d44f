// SPDX-License-Identifier: Apache-2.0
#include "server/carve/load_plot.h"

#include <algorithm>
#include <functional>

#include "server/carve/markup.h"
#include "server/carve/verdict.h"

namespace kerf {
namespace {

// Pixels.
constexpr double kPlotWidth = 960, kPlotHeight = 200, kPlotLeft = 70, kPlotRight = 34,
                 kPlotTop = 34, kPlotBottom = 30;
constexpr int kPlotTicks = 4;

using LoadValue = std::function<double(const LoadInterval&)>;

std::string pixels(double value) { return formatted("%.2f", value); }

std::string plot_text(double x, double y, const std::string& content, const char* more) {
  return "<text x=\"" + pixels(x) + "\" y=\"" + pixels(y) + "\" " + more + ">" + escaped(content) +
         "</text>\n";
}

std::string plot_line(double x1, double y1, double x2, double y2) {
  return "<line x1=\"" + pixels(x1) + "\" y1=\"" + pixels(y1) + "\" x2=\"" + pixels(x2) +
         "\" y2=\"" + pixels(y2) + "\" stroke=\"#ccc\"/>\n";
}

struct LoadPanel {
  const char* title;
  const char* color;
  LoadValue value;
};

std::string draw_panel(const LoadPanel& panel, double top, const LoadCurve& loads,
                       const Program& program) {
  const auto& intervals = loads.intervals();
  const double bottom = top + kPlotHeight, high = top + kPlotTop, low = bottom - kPlotBottom;
  const double right = kPlotWidth - kPlotRight;
  double most = 0;
  std::size_t worst = 0;
  for (std::size_t n = 0; n < intervals.size(); ++n) {
    const double value = panel.value(intervals[n]);
    if (value > most) most = value, worst = n;
  }
  const double scale = most > 0 ? most : 1;
  const double end_s = loads.end_s() > 0 ? loads.end_s() : 1;
  const auto x_at = [&](double seconds) {
    return kPlotLeft + (right - kPlotLeft) * seconds / end_s;
  };
  const auto y_at = [&](double value) { return low - (low - high) * value / scale; };
  std::string out = plot_text(kPlotLeft, top + 20, panel.title, "font-weight=\"bold\"");
  for (int tick = 0; tick <= kPlotTicks; ++tick) {
    const double share = static_cast<double>(tick) / kPlotTicks;
    out += plot_line(kPlotLeft, y_at(scale * share), right, y_at(scale * share));
    out += plot_text(kPlotLeft - 6, y_at(scale * share) + 4, formatted("%.3g", scale * share),
                     "text-anchor=\"end\"");
    out += plot_text(x_at(end_s * share), low + 18, clock_text(end_s * share),
                     "text-anchor=\"middle\"");
  }
  std::string path = "M" + pixels(kPlotLeft) + " " + pixels(low);
  for (std::size_t n = 0; n < intervals.size(); ++n) {
    const double from = loads.interval_s() * static_cast<double>(n);
    const double to = std::min(from + loads.interval_s(), end_s);
    const std::string y = pixels(y_at(panel.value(intervals[n])));
    path += "L" + pixels(x_at(from)) + " " + y + "L" + pixels(x_at(to)) + " " + y;
  }
  path += "L" + pixels(x_at(std::min(end_s, loads.end_s()))) + " " + pixels(low) + "Z";
  out += "<path d=\"" + path + "\" fill=\"" + panel.color + "\" stroke=\"none\"/>\n";
  if (most > 0) {
    const double x = x_at((static_cast<double>(worst) + 0.5) * loads.interval_s());
    const LoadInterval& interval = intervals[worst];
    out += plot_text(std::min(x, right), high - 4,
                     formatted("%.3g, ", most) + place_of(program, interval.file, interval.line),
                     x > kPlotWidth / 2 ? "text-anchor=\"end\"" : "text-anchor=\"start\"");
  }
  return out;
}

}  // namespace

std::string load_svg(const LoadCurve& loads, const Program& program) {
  const double interval_s = loads.interval_s();
  const LoadPanel panels[] = {
      {"Force, N: the greatest in each interval", "#0072B2",
       [](const LoadInterval& interval) { return interval.force_n; }},
      {"Removal, mm3/s: the mean of each interval", "#E69F00",
       [interval_s](const LoadInterval& interval) { return interval.removed_mm3 / interval_s; }}};
  const double height = 2 * kPlotHeight;
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " +
                    pixels(kPlotWidth) + " " + pixels(height) +
                    "\" role=\"img\" aria-label=\"Force and removal over the time of the "
                    "program\" font-family=\"sans-serif\" font-size=\"13\">\n";
  double top = 0;
  for (const LoadPanel& panel : panels) {
    out += draw_panel(panel, top, loads, program);
    top += kPlotHeight;
  }
  return out + "</svg>\n";
}

}  // namespace kerf
