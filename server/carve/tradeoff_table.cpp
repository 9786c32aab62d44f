// SPDX-License-Identifier: Apache-2.0
#include "server/carve/tradeoff_table.h"

#include <array>
#include <cstdio>
#include <sstream>

#include "server/carve/markup.h"

namespace kerf {
namespace {

bool dominates(const TradeoffRow& a, const TradeoffRow& b) {
  if (a.us_per_motion > b.us_per_motion || a.surface_max_mm > b.surface_max_mm) return false;
  return a.us_per_motion < b.us_per_motion || a.surface_max_mm < b.surface_max_mm;
}

bool equal_to_an_earlier(const std::vector<TradeoffRow>& rows, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    if (rows[i].skipped.empty() && rows[i].us_per_motion == rows[n].us_per_motion &&
        rows[i].surface_max_mm == rows[n].surface_max_mm)
      return true;
  }
  return false;
}

std::string figure(const std::optional<double>& value) {
  return value ? formatted("%.2g", *value) : "-";
}

std::string exact(double value) { return formatted("%.9g", value); }
std::string exact(const std::optional<double>& value) { return value ? exact(*value) : ""; }

}  // namespace

const char* motion_name(MotionModel motion) {
  return motion == MotionModel::kPaper ? "paper" : "tight";
}

void mark_front(std::vector<TradeoffRow>& rows) {
  for (std::size_t n = 0; n < rows.size(); ++n) {
    rows[n].front = rows[n].skipped.empty() && !equal_to_an_earlier(rows, n);
    for (const TradeoffRow& other : rows)
      if (other.skipped.empty() && dominates(other, rows[n])) rows[n].front = false;
  }
}

void mark_cheapest(std::vector<TradeoffRow>& rows, double target_mm) {
  TradeoffRow* cheapest = nullptr;
  for (TradeoffRow& row : rows) {
    row.cheapest = false;
    if (!row.skipped.empty() || row.surface_max_mm > target_mm) continue;
    if (cheapest == nullptr || row.us_per_motion < cheapest->us_per_motion) cheapest = &row;
  }
  if (cheapest != nullptr) cheapest->cheapest = true;
}

std::string tradeoff_text(const std::vector<TradeoffRow>& rows) {
  constexpr const char* kFormat = "%-2s %-9s %-6s %9s %11s %13s %13s %11s %9s %9s %11s %10s %12s\n";
  std::ostringstream out;
  const auto line = [&out](const std::array<std::string, 13>& c) {
    std::array<char, 400> text{};
    std::snprintf(text.data(), text.size(), kFormat, c[0].c_str(), c[1].c_str(), c[2].c_str(),
                  c[3].c_str(), c[4].c_str(), c[5].c_str(), c[6].c_str(), c[7].c_str(),
                  c[8].c_str(), c[9].c_str(), c[10].c_str(), c[11].c_str(), c[12].c_str());
    out << text.data();
  };
  line({"", "rays", "motion", "pitch", "tolerance", "surface max", "surface rms", "solid-mesh",
        "volume", "force", "us/motion", "MB", "sub-motions"});
  line({"", "", "", "mm", "mm", "mm", "mm", "mm", "relative", "relative", "CPU", "", ""});
  for (const TradeoffRow& row : rows) {
    if (!row.skipped.empty()) {
      out << "   " << to_string(row.rays) << ' ' << motion_name(row.motion) << " pitch "
          << formatted("%.4g", row.pitch_mm) << " tolerance " << formatted("%.3g", row.tolerance_mm)
          << ": " << row.skipped << '\n';
      continue;
    }
    line({std::string(row.front ? "*" : "") + (row.cheapest ? "<" : ""), to_string(row.rays),
          motion_name(row.motion), formatted("%.4g", row.pitch_mm),
          formatted("%.3g", row.tolerance_mm), formatted("%.5f", row.surface_max_mm),
          formatted("%.5f", row.surface_rms_mm), formatted("%.5f", row.missing_mm),
          figure(row.volume_error), figure(row.force_error), formatted("%.1f", row.us_per_motion),
          formatted("%.2f", 1e-6 * double(row.bytes)), std::to_string(row.sub_motions)});
  }
  return out.str();
}

std::string tradeoff_csv(const std::vector<TradeoffRow>& rows) {
  std::ostringstream out;
  out << "rays,motion,pitch_mm,tolerance_mm,surface_max_mm,surface_rms_mm,solid_to_mesh_mm,volume_"
         "error,"
         "force_error,us_per_motion,bytes,sub_motions,front,cheapest,skipped\n";
  for (const TradeoffRow& row : rows) {
    out << to_string(row.rays) << ',' << motion_name(row.motion) << ',' << exact(row.pitch_mm)
        << ',' << exact(row.tolerance_mm) << ',';
    if (row.skipped.empty()) {
      out << exact(row.surface_max_mm) << ',' << exact(row.surface_rms_mm) << ','
          << exact(row.missing_mm) << ',' << exact(row.volume_error) << ','
          << exact(row.force_error) << ',' << exact(row.us_per_motion) << ',' << row.bytes << ','
          << row.sub_motions << ',' << row.front << ',' << row.cheapest << ",\n";
    } else {
      out << ",,,,,,,,,,\"" << row.skipped << "\"\n";
    }
  }
  return out.str();
}

}  // namespace kerf
