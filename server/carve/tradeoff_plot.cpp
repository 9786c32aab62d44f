// SPDX-License-Identifier: Apache-2.0
#include "server/carve/tradeoff_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <sstream>

#include "server/carve/markup.h"

namespace kerf {
namespace {

// Pixels.
constexpr double kPanelWidth = 440, kPanelHeight = 400;
constexpr double kLeft = 74, kRight = 18, kTop = 84, kBottom = 60;
constexpr double kLegend = 64;

struct Series {
  Rays rays;
  MotionModel motion;
  const char* color;  // distinguishable with color blindness (Okabe and Ito)
};
constexpr std::array kSeries{Series{Rays::kDexel, MotionModel::kTight, "#0072B2"},
                             Series{Rays::kDexel, MotionModel::kPaper, "#E69F00"},
                             Series{Rays::kTriDexel, MotionModel::kTight, "#009E73"},
                             Series{Rays::kTriDexel, MotionModel::kPaper, "#CC79A7"}};

const Series& series_of(const TradeoffRow& row) {
  for (const Series& series : kSeries)
    if (row.rays == series.rays && row.motion == series.motion) return series;
  return kSeries.front();
}

struct Point {
  double us, error;
  const TradeoffRow* row;
};

std::string number(double value, const char* format = "%.6g") { return formatted(format, value); }

// A logarithmic axis that covers the values and at least one decade.
struct Axis {
  double low, high;        // decimal logarithms of the ends
  double at_low, at_high;  // pixels

  double at(double value) const {
    return at_low + (std::log10(value) - low) / (high - low) * (at_high - at_low);
  }
};

Axis axis_of(std::vector<double> values, double at_low, double at_high) {
  const auto [least, greatest] = std::ranges::minmax(values);
  double low = std::log10(least) - 0.1, high = std::log10(greatest) + 0.1;
  if (high - low < 1) {
    const double middle = (low + high) / 2;
    low = middle - 0.5;
    high = middle + 0.5;
  }
  return {low, high, at_low, at_high};
}

// 1, 2 and 5 in each decade; only decades if there are many.
std::vector<double> ticks(const Axis& axis) {
  std::vector<double> values;
  const bool few = axis.high - axis.low < 3;
  for (int decade = int(std::floor(axis.low)); decade <= int(std::ceil(axis.high)); ++decade) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      if (digit > 1 && !few) continue;
      const double value = digit * std::pow(10, decade);
      const double log = std::log10(value);
      if (log >= axis.low && log <= axis.high) values.push_back(value);
    }
  }
  return values;
}

std::string text(double x, double y, const std::string& content, const char* more = "") {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\"" + more + ">" + escaped(content) +
         "</text>\n";
}

std::string line(double x1, double y1, double x2, double y2, const char* color) {
  return "<line x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) +
         "\" y2=\"" + number(y2) + "\" stroke=\"" + color + "\"/>\n";
}

class Panel {
 public:
  Panel(double x, std::string name, std::string unit, std::vector<Point> points)
      : x_(x), name_(std::move(name)), unit_(std::move(unit)), points_(std::move(points)) {
    std::erase_if(points_, [](const Point& p) { return !(p.us > 0 && p.error > 0); });
  }

  std::string draw() {
    const double left = x_ + kLeft, right = x_ + kPanelWidth - kRight;
    const double bottom = kTop + kPanelHeight - kBottom;
    out_ << text((left + right) / 2, kTop - 12, name_,
                 " text-anchor=\"middle\" font-weight=\"bold\"");
    if (points_.empty()) {
      out_ << text((left + right) / 2, (kTop + bottom) / 2, "nothing measured",
                   " text-anchor=\"middle\"");
      return out_.str();
    }
    std::vector<double> times, errors;
    for (const Point& p : points_) {
      times.push_back(p.us);
      errors.push_back(p.error);
    }
    across_ = axis_of(times, left, right);
    up_ = axis_of(errors, bottom, kTop);
    draw_axes(left, right, bottom);
    draw_front();
    for (const Point& p : points_) draw_point(p);
    return out_.str();
  }

 private:
  void draw_axes(double left, double right, double bottom) {
    for (const double t : ticks(across_)) {
      out_ << line(across_.at(t), kTop, across_.at(t), bottom, "#e4e4e4");
      out_ << text(across_.at(t), bottom + 18, number(t), " text-anchor=\"middle\"");
    }
    for (const double t : ticks(up_)) {
      out_ << line(left, up_.at(t), right, up_.at(t), "#e4e4e4");
      out_ << text(left - 6, up_.at(t) + 4, number(t), " text-anchor=\"end\"");
    }
    out_ << "<rect x=\"" << left << "\" y=\"" << kTop << "\" width=\"" << right - left
         << "\" height=\"" << bottom - kTop << "\" fill=\"none\" stroke=\"#555\"/>\n";
    out_ << text((left + right) / 2, bottom + 42, "CPU time per motion, µs",
                 " text-anchor=\"middle\"");
    const double y = (kTop + bottom) / 2;
    out_ << "<text transform=\"translate(" << x_ + 16 << ' ' << y
         << ") rotate(-90)\" text-anchor=\"middle\">" << escaped(unit_) << "</text>\n";
  }

  // Steps, because points between two measured ones may not be reachable.
  void draw_front() {
    std::vector<Point> sorted = points_;
    std::ranges::sort(sorted, [](const Point& a, const Point& b) {
      return a.us != b.us ? a.us < b.us : a.error < b.error;
    });
    std::string path;
    double best = 0, last_y = 0;
    for (const Point& p : sorted) {
      if (!path.empty() && p.error >= best) continue;
      const double x = across_.at(p.us), y = up_.at(p.error);
      path += path.empty()
                  ? "M" + number(x) + " " + number(y)
                  : "L" + number(x) + " " + number(last_y) + "L" + number(x) + " " + number(y);
      best = p.error;
      last_y = y;
      on_front_.push_back(p.row);
    }
    out_ << "<path class=\"front\" d=\"" << path
         << "\" fill=\"none\" stroke=\"#222\" stroke-width=\"1.3\" stroke-dasharray=\"5 3\"/>\n";
  }

  void draw_point(const Point& p) {
    const double x = across_.at(p.us), y = up_.at(p.error);
    const bool front = std::ranges::find(on_front_, p.row) != on_front_.end();
    const char* color = series_of(*p.row).color;
    out_ << "<circle cx=\"" << number(x) << "\" cy=\"" << number(y) << "\" r=\""
         << (front ? 5.5 : 4) << "\" fill=\"" << (front ? color : "white") << "\" stroke=\""
         << color << "\" stroke-width=\"1.6\"><title>"
         << escaped(std::string(to_string(p.row->rays)) + " " + motion_name(p.row->motion) +
                    ", pitch " + number(p.row->pitch_mm, "%.4g") + " mm, tolerance " +
                    number(p.row->tolerance_mm, "%.3g") + " mm: " + number(p.error, "%.3g") + ", " +
                    number(p.us, "%.3g") + " µs")
         << "</title></circle>\n";
    if (front && labelled_.insert(p.row->pitch_mm).second)
      out_ << text(x + 8, y - 6, number(p.row->pitch_mm, "%.3g"), " font-size=\"11\"");
  }

  double x_;
  std::string name_, unit_;
  std::vector<Point> points_;
  Axis across_{}, up_{};
  std::vector<const TradeoffRow*> on_front_;
  std::set<double> labelled_;  // pitches
  std::ostringstream out_;
};

std::string legend(const std::vector<TradeoffRow>& rows, double y) {
  std::ostringstream out;
  double x = kLeft;
  for (const Series& series : kSeries) {
    if (!std::ranges::any_of(rows, [&](const TradeoffRow& row) {
          return row.skipped.empty() && &series_of(row) == &series;
        }))
      continue;
    out << "<circle cx=\"" << x << "\" cy=\"" << y - 4 << "\" r=\"5\" fill=\"white\" stroke=\""
        << series.color << "\" stroke-width=\"1.6\"/>\n";
    out << text(x + 12, y, std::string(to_string(series.rays)) + ", " + motion_name(series.motion));
    x += 150;
  }
  out << "<path d=\"M" << x << ' ' << y - 4 << "h28\" stroke=\"#222\" stroke-width=\"1.3\" "
      << "stroke-dasharray=\"5 3\"/>\n";
  out << text(x + 36, y, "Pareto front (filled; labelled with the pitch in mm)");
  return out.str();
}

}  // namespace

std::string tradeoff_svg(const std::vector<TradeoffRow>& rows, const std::string& title,
                         const std::string& note) {
  using Value = std::function<double(const TradeoffRow&)>;
  const auto panel = [&rows](int place, const char* name, const char* unit, const Value& value) {
    std::vector<Point> points;
    for (const TradeoffRow& row : rows)
      if (row.skipped.empty()) points.push_back({row.us_per_motion, value(row), &row});
    return Panel(place * kPanelWidth, name, unit, std::move(points)).draw();
  };
  const double width = 3 * kPanelWidth, height = kTop + kPanelHeight + kLegend;
  std::ostringstream out;
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << width << ' ' << height
      << "\" width=\"" << width << "\" height=\"" << height
      << "\" font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" "
         "fill=\"white\"/>\n";
  out << text(kLeft, 28, title, " font-size=\"18\" font-weight=\"bold\"");
  out << text(kLeft, 48, note, " fill=\"#555\"");
  out << panel(0, "surface", "greatest surface error, mm",
               [](const TradeoffRow& row) { return row.surface_max_mm; });
  out << panel(1, "volume", "volume error / removed volume",
               [](const TradeoffRow& row) { return row.volume_error.value_or(0); });
  out << panel(2, "force", "force error, rms / rms",
               [](const TradeoffRow& row) { return row.force_error.value_or(0); });
  out << legend(rows, kTop + kPanelHeight + 12);
  out << "</svg>\n";
  return out.str();
}

}  // namespace kerf
