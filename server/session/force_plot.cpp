// SPDX-License-Identifier: Apache-2.0
#include "server/session/force_plot.h"

#include <algorithm>
#include <ostream>
#include <string>

#include "server/formats/number_text.h"

namespace kerf {
namespace {

template <typename Text>
void write_array(std::ostream& out, const char* name, std::size_t count, Text&& text) {
  out << '"' << name << "\":[";
  for (std::size_t n = 0; n < count; ++n) out << (n == 0 ? "" : ",") << text(n);
  out << ']';
}

std::string vector_text(Vec3 v) {
  constexpr int kDigits = 6;
  return '[' + significant_text(v.x, kDigits) + ',' + significant_text(v.y, kDigits) + ',' +
         significant_text(v.z, kDigits) + ']';
}

}  // namespace

ForcePlot::ForcePlot(std::uint64_t first, std::uint64_t last, std::size_t points)
    : first_(first), last_(last) {
  if (first <= last) span_ = (last - first) / points + 1;
}

void ForcePlot::Range::add(double value, bool is_first) {
  min = is_first ? value : std::min(min, value);
  max = is_first ? value : std::max(max, value);
  sum += value;
}

void ForcePlot::add(const PlottedMotion& motion) {
  const std::uint64_t record = motion.record;
  if (record < first_ || record > last_) return;
  const std::uint64_t span = (record - first_) / span_;
  const bool is_first = points_.empty() || points_.back().span != span;
  if (is_first) points_.push_back({.span = span, .first = record, .time_ms = motion.wall_ms});
  Point& point = points_.back();
  point.last = record;
  ++point.motions;
  point.end_s = motion.end_s;
  point.removed_mm3 += motion.removed_mm3;
  const double force_n = length(motion.wrench.force_n);
  if (is_first || force_n > point.force_n.max) {
    point.peak_tip_mm = motion.tip_mm;
    point.peak = motion.wrench;
  }
  point.force_n.add(force_n, is_first);
  point.torque_nmm.add(length(motion.wrench.torque_nmm), is_first);
}

void ForcePlot::write(std::ostream& out) const {
  const std::size_t count = points_.size();
  const auto whole = [&](const char* name, auto Point::* member) {
    write_array(out, name, count, [&](std::size_t n) { return points_[n].*member; });
    out << ',';
  };
  const auto exact = [&](const char* name, double Point::* member) {
    write_array(out, name, count, [&](std::size_t n) { return exact_text(points_[n].*member); });
    out << ',';
  };
  const auto range = [&](const char* name, Range Point::* member) {
    out << '"' << name << "\":{";
    write_array(out, "min", count,
                [&](std::size_t n) { return exact_text((points_[n].*member).min); });
    out << ',';
    write_array(out, "mean", count, [&](std::size_t n) {
      return exact_text((points_[n].*member).sum / static_cast<double>(points_[n].motions));
    });
    out << ',';
    write_array(out, "max", count,
                [&](std::size_t n) { return exact_text((points_[n].*member).max); });
    out << '}';
  };
  out << "{\"span\":" << span_ << ',';
  whole("first", &Point::first);
  whole("last", &Point::last);
  whole("time_ms", &Point::time_ms);
  whole("motions", &Point::motions);
  exact("end_s", &Point::end_s);
  exact("removed_mm3", &Point::removed_mm3);
  range("force_n", &Point::force_n);
  out << ',';
  range("torque_nmm", &Point::torque_nmm);
  const auto peaks = [&](const char* name, auto vector_of) {
    write_array(out, name, count,
                [&](std::size_t n) { return vector_text(vector_of(points_[n])); });
  };
  out << ",\"peak\":{";
  peaks("tip_mm", [](const Point& point) { return point.peak_tip_mm; });
  out << ',';
  peaks("force_n", [](const Point& point) { return point.peak.force_n; });
  out << ',';
  peaks("torque_nmm", [](const Point& point) { return point.peak.torque_nmm; });
  out << "}}\n";
}

}  // namespace kerf
