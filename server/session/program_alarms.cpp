// SPDX-License-Identifier: Apache-2.0
#include "server/session/program_alarms.h"

#include <algorithm>
#include <limits>

#include "server/verify/cut_depth.h"

namespace kerf {
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
  const auto follow_one = [&](AlarmKind kind, double amount, double limit, Vec3 at_mm = {}) {
    note(kind, motion, carved.removed_mm3, amount, limit, at_mm);
  };
  follow_one(AlarmKind::kRapid, motion.rapid ? carved.depth_mm : 0,
             rapid_limit_mm(limits_.tolerance_mm));
  follow_one(AlarmKind::kShank, carved.stock_contact_mm, limits_.tolerance_mm);
  follow_one(AlarmKind::kObstacle, carved.collision_n, 0);
  follow_one(AlarmKind::kForce, carved.cutting_n, limits_.force_n.value_or(kAny));
  // The check only reports gouges deeper than the part's tolerance.
  const Gouge gouge = carved.gouge.value_or(Gouge());
  follow_one(AlarmKind::kGouge, gouge.depth_mm, limits_.gouge_mm, gouge.at_mm);
}

/// Whether an alarm continues across a motion without one.
bool ProgramAlarms::is_in_gap(AlarmKind kind, const ProgramMotion& motion) {
  if (kind != AlarmKind::kGouge) return false;
  without_gouge_mm_ += length(motion.to.tip_mm - motion.from.tip_mm);
  return without_gouge_mm_ <= kGougeGapPitches * limits_.pitch_mm;
}

void ProgramAlarms::note(AlarmKind kind, const ProgramMotion& motion, double removed_mm3,
                         double amount, double limit, Vec3 at_mm) {
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
  alarm.amount = open.greatest;
  alarm.removed_mm3 += removed_mm3;
}

}  // namespace kerf
