// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/formats/control/arc.h"

namespace kerf {

enum class GcodeFeedMode { kPerMinute, kInverseTime, kPerRevolution };
enum class GcodeSpindle { kStopped, kClockwise, kCounterClockwise };

/// The modal state other than offsets, which M70 to M73 save and restore.
struct GcodeModes {
  int motion = 800;  ///< active code of the motion group, times ten
  double unit_mm = 1;
  bool incremental = false;
  bool arc_absolute = false;
  GcodeFeedMode feed_mode = GcodeFeedMode::kPerMinute;
  double feed_mm = 0;   ///< F in mm per minute or revolution
  double feed_deg = 0;  ///< F as written: degrees per minute if only rotary axes move
  double spindle_rpm = 0;
  GcodeSpindle spindle = GcodeSpindle::kStopped;
  bool surface_speed = false;  ///< G96: S is a surface speed, not a rotational one
  ArcPlane plane = ArcPlane::kXy;
  bool retract_to_r = true;  ///< G99, LinuxCNC's initial mode
  int system = 1;            ///< 1 to 9: G54 to G59.3
  bool tool_length = false;  ///< G43
  bool mist = false, flood = false;
  bool feed_override = true, speed_override = true, adaptive_feed = false, feed_hold = true;
};

}  // namespace kerf
