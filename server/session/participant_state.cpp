// SPDX-License-Identifier: Apache-2.0
#include "server/session/participant_state.h"

#include <algorithm>

namespace kerf {
namespace {

/// After this time without samples, a tool is displayed without force.
constexpr std::chrono::milliseconds kForceDisplayTime{150};

}  // namespace

void ParticipantState::update_display(const wire::Result& result, const BatchSum& sum) {
  if (const auto& pose = track.pose()) {
    display.tip_mm = pose->tip_mm;
    display.axis = Vec3f(pose->axis);
  }
  display.participant = participant.id;
  display.status = result.status;
  display.force_n = result.force_n;
  display.torque_nmm = result.torque_nmm;
  display.removed_rate_mm3_per_s =
      sum.duration_s() > 0 ? static_cast<float>(sum.removed_mm3() / sum.duration_s()) : 0.0F;
  display_time = Clock::now();
}

void ParticipantState::show_at(const ToolPose& pose) {
  track.place(pose);
  display.tip_mm = pose.tip_mm;
  display.axis = Vec3f(pose.axis);
  display_time = Clock::now();
}

void ParticipantState::note_felt(const wire::MotionSample& newest) {
  const bool stated = (newest.buttons & wire::kButtonFelt) != 0;
  if (stated) display.status |= wire::kStatusFelt;
  display.felt_share = stated ? std::clamp(newest.felt_share, 0.0F, 1.0F) : 0.0F;
}

bool ParticipantState::has_recent_force(Clock::time_point now) const {
  return now - display_time <= kForceDisplayTime;
}

}  // namespace kerf
