// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kernel/sculpture.h"

namespace kerf {

/// One way to carve a program, and what it costs and how far off it is.
struct TradeoffRow {
  Rays rays = Rays::kDexel;
  MotionModel motion = MotionModel::kTight;
  double pitch_mm = 0, tolerance_mm = 0;
  std::string skipped;  ///< why it was not carved; empty: it was

  double us_per_motion = 0;  ///< CPU time, force included
  std::uint64_t bytes = 0;   ///< of the stock
  std::uint64_t sub_motions = 0;
  double surface_max_mm = 0, surface_rms_mm = 0;
  std::optional<double> volume_error;  ///< relative to the removed volume; none without reference
  std::optional<double> force_error;   ///< relative rms over the program's time
  bool front = false;                  ///< none is both cheaper and nearer to the true surface
  bool cheapest = false;               ///< of those that meet the target
};

/// Marks the Pareto front of time per motion against greatest surface error: a row is on it unless
/// another one is at least as good in both and better in one. Of equal rows the first is marked.
void mark_front(std::vector<TradeoffRow>& rows);
/// Marks the row with the least time whose greatest surface error is at most `target_mm`, if any.
void mark_cheapest(std::vector<TradeoffRow>& rows, double target_mm);

/// For people: aligned columns, `*` for the front, `<` for the cheapest that meets the target.
std::string tradeoff_text(const std::vector<TradeoffRow>& rows);
/// For programs: a header line, one line a row, empty fields where nothing was measured.
std::string tradeoff_csv(const std::vector<TradeoffRow>& rows);

/// "tight" or "paper".
const char* motion_name(MotionModel motion);

}  // namespace kerf
