// SPDX-License-Identifier: Apache-2.0
#include "server/session/program_alarms.h"

#include <algorithm>
#include <limits>
#include <numbers>

namespace kerf {
namespace {

/// Removed volumes below this, mm^3, are rounding on a surface that was cut before.
constexpr double kNothingRemovedMm3 = 1e-6;

}  // namespace

double AlarmLimits::film_mm3(double tool_radius_mm) const {
  return std::max(kNothingRemovedMm3,
                  tolerance_mm * std::numbers::pi * tool_radius_mm * tool_radius_mm);
}

const char* to_string(AlarmKind kind) {
  switch (kind) {
    case AlarmKind::kRapid:
      return "rapid";
    case AlarmKind::kShank:
      return "shank";
    case AlarmKind::kObstacle:
      return "obstacle";
    case AlarmKind::kForce:
      return "force";
    case AlarmKind::kGouge:
      return "gouge";
  }
  return "force";
}

void ProgramAlarms::follow(const ProgramMotion& motion, const CarvedMotion& carved) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  note(AlarmKind::kRapid, motion, motion.rapid ? carved.removed_mm3 : 0, carved.film_mm3);
  note(AlarmKind::kShank, motion, carved.stock_contact_mm, limits_.tolerance_mm);
  note(AlarmKind::kObstacle, motion, carved.collision_n, 0);
  note(AlarmKind::kForce, motion, carved.cutting_n, limits_.force_n.value_or(kAny));
  // The check only reports gouges deeper than the part's tolerance.
  const Gouge gouge = carved.gouge.value_or(Gouge());
  note(AlarmKind::kGouge, motion, gouge.depth_mm, limits_.gouge_mm, gouge.at_mm);
}

/// Whether an alarm continues across a motion without one.
bool ProgramAlarms::is_in_gap(AlarmKind kind, const ProgramMotion& motion) {
  if (kind != AlarmKind::kGouge) return false;
  without_gouge_mm_ += length(motion.to.tip_mm - motion.from.tip_mm);
  return without_gouge_mm_ <= kGougeGapPitches * limits_.pitch_mm;
}

void ProgramAlarms::note(AlarmKind kind, const ProgramMotion& motion, double amount, double limit,
                         Vec3 at_mm) {
  Open& open = open_[static_cast<std::size_t>(kind)];
  if (!(amount > limit)) {
    if (!is_in_gap(kind, motion)) open = {};
    return;
  }
  if (kind == AlarmKind::kGouge) without_gouge_mm_ = 0;
  if (!open.is_open) {
    open.is_open = true;
    ++count_;
    if (list_.size() < kListedMax) {
      open.listed = list_.size();
      list_.push_back(
          {.kind = kind, .from_line = motion.line, .tool = motion.tool, .limit = limit});
    }
  }
  if (!open.listed) return;
  ProgramAlarm& alarm = list_[*open.listed];
  alarm.to_line = motion.line;
  if (amount > open.greatest) {
    open.greatest = amount;
    alarm.tip_mm = motion.to.tip_mm;
    alarm.at_mm = at_mm;
  }
  alarm.amount = kind == AlarmKind::kRapid ? alarm.amount + amount : open.greatest;
}

}  // namespace kerf
