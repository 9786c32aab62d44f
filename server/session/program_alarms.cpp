// SPDX-License-Identifier: Apache-2.0
#include "server/session/program_alarms.h"

namespace kerf {
namespace {

/// Removed volumes below this are rounding on a surface that was cut before, mm^3.
constexpr double kNothingRemovedMm3 = 1e-6;

}  // namespace

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
  const bool cuts = carved.removed_mm3 > kNothingRemovedMm3;
  note(AlarmKind::kRapid, motion, motion.rapid && cuts ? carved.removed_mm3 : 0);
  note(AlarmKind::kShank, motion, carved.stock_contact_mm);
  // Stock pushes shank and holder too; that is the alarm above.
  note(AlarmKind::kObstacle, motion, carved.stock_contact_mm > 0 ? 0 : carved.collision_n);
  note(AlarmKind::kForce, motion, limit_n_ && carved.cutting_n > *limit_n_ ? carved.cutting_n : 0);
  const Gouge gouge = carved.gouge.value_or(Gouge());
  note(AlarmKind::kGouge, motion, gouge.depth_mm, gouge.at_mm);
}

/// Whether a motion without an alarm does not end it.
bool ProgramAlarms::is_in_gap(AlarmKind kind, const ProgramMotion& motion) {
  if (kind != AlarmKind::kGouge) return false;
  without_gouge_mm_ += length(motion.to.tip_mm - motion.from.tip_mm);
  return without_gouge_mm_ <= gouge_gap_mm_;
}

void ProgramAlarms::note(AlarmKind kind, const ProgramMotion& motion, double amount, Vec3 at_mm) {
  Open& open = open_[static_cast<std::size_t>(kind)];
  if (!(amount > 0)) {
    if (!is_in_gap(kind, motion)) open = {};
    return;
  }
  if (kind == AlarmKind::kGouge) without_gouge_mm_ = 0;
  if (!open.is_open) {
    open.is_open = true;
    ++count_;
    if (list_.size() < kListedMax) {
      open.listed = list_.size();
      list_.push_back({.kind = kind, .from_line = motion.line, .tool = motion.tool});
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
