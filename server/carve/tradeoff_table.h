// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kernel/sculpture.h"

namespace kerf {

/// One configuration with its cost and error.
struct TradeoffRow {
  Rays rays = Rays::kDexel;
  MotionModel motion = MotionModel::kTight;
  double pitch_mm = 0, tolerance_mm = 0;
  std::string skipped;  ///< why it was not carved or not measured, as "skipped, …"; else empty

  double us_per_motion = 0;  ///< CPU time, force included
  std::uint64_t bytes = 0;   ///< of the stock
  std::uint64_t sub_motions = 0;
  double surface_max_mm = 0;  ///< greatest distance between mesh and true solid, in both directions
  double surface_rms_mm = 0;  ///< from the mesh to the true solid
  double missing_mm = 0;      ///< greatest distance from the true solid to the mesh
  std::optional<double>
      volume_error;                   ///< relative to the removed volume; empty without a reference
  std::optional<double> force_error;  ///< relative rms over the program's time
  bool front = false;                 ///< no other row is both cheaper and more accurate
  bool cheapest = false;              ///< cheapest row that meets the target
};

/// Marks the Pareto front of time per motion and greatest surface error: the rows for which no
/// other is at least as good in both and better in one. The first of equal rows is marked.
void mark_front(std::vector<TradeoffRow>& rows);
/// Marks the fastest row whose greatest surface error is at most `target_mm`, if any.
void mark_cheapest(std::vector<TradeoffRow>& rows, double target_mm);

/// Returns a text table: `*` marks the front, `<` the cheapest row that meets the target.
std::string tradeoff_text(const std::vector<TradeoffRow>& rows);
/// Returns CSV: a header line, one line per row, empty fields for values that were not measured.
std::string tradeoff_csv(const std::vector<TradeoffRow>& rows);

/// Returns "tight" or "paper".
const char* motion_name(MotionModel motion);

}  // namespace kerf
