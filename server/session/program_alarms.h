// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kernel/math/vec3.h"
#include "server/formats/program.h"
#include "server/verify/gouge_check.h"

namespace kerf {

/// The parts of a motion's MotionResult from which alarms are derived.
struct CarvedMotion {
  double removed_mm3 = 0;
  double depth_mm = 0;              ///< depth of the cut (CutDepth); rapids only
  double stock_contact_mm = 0;      ///< maximum depth of shank or holder in the stock
  double cutting_n = 0;             ///< mean cutting force; 0 where forces are not computed
  double collision_n = 0;           ///< maximum push of obstacles; 0 without forces
  std::optional<Gouge> gouge = {};  ///< gouge of the target part
};

enum class AlarmKind {
  kRapid,     ///< a rapid cut into the stock; the depth, mm
  kShank,     ///< shank or holder entered the stock; the depth, mm
  kObstacle,  ///< the tool was pushed by an obstacle; the force, N
  kForce,     ///< the mean cutting force of a motion was above the limit; the force, N
  kGouge      ///< the motion cut below the target part; the depth, mm
};
/// Returns "rapid", "shank", "obstacle", "force" or "gouge".
const char* to_string(AlarmKind kind);

/// Consecutive motions with the same alarm. Gouges less than ProgramAlarms::kGougeGapPitches apart
/// along the path form one alarm, because the rays meet only a part of the motions.
struct ProgramAlarm {
  AlarmKind kind = AlarmKind::kRapid;
  std::uint32_t from_line = 0, to_line = 0;
  ToolId tool = 0;
  double amount = 0;       ///< maximum
  double limit = 0;        ///< the limit that the amount exceeded, in its unit
  double removed_mm3 = 0;  ///< by all its motions
  Vec3 tip_mm{};           ///< at the end of the motion with the greatest amount
  Vec3 at_mm{};            ///< deepest point; kGouge only
};

/// Thresholds of the alarms.
struct AlarmLimits {
  std::optional<double> force_n = {};  ///< nullopt: no limit
  /// The scene's tolerance. Surfaces are only accurate to it, so smaller depths mean nothing.
  double tolerance_mm = 0;
  double gouge_mm = 0;  ///< allowed depth below the target part
  double pitch_mm = 0;  ///< pitch of the block
};

/// Collects the alarms of a program while it is carved, at a few comparisons a motion. Forces are
/// judged only where they are computed anyway, at feed rate.
class ProgramAlarms {
 public:
  /// Number of alarms that are listed. Further ones are only counted.
  static constexpr std::size_t kListedMax = 100;

  static constexpr double kGougeGapPitches = 2;

  explicit ProgramAlarms(const AlarmLimits& limits = {}) : limits_(limits) {}
  /// Adds the next motion of the program.
  void follow(const ProgramMotion& motion, const CarvedMotion& carved);
  const std::vector<ProgramAlarm>& list() const { return list_; }
  std::size_t count() const { return count_; }

 private:
  void note(AlarmKind kind, const ProgramMotion& motion, double removed_mm3, double amount,
            double limit, Vec3 at_mm = {});
  bool is_in_gap(AlarmKind kind, const ProgramMotion& motion);

  struct Open {
    bool is_open = false;
    std::optional<std::size_t> listed = {};
    double greatest = 0;
  };
  AlarmLimits limits_;
  double without_gouge_mm_ = 0;  ///< path length since the last gouge
  std::vector<ProgramAlarm> list_;
  std::size_t count_ = 0;
  Open open_[5];  ///< by kind: the run that includes the last motion
};

}  // namespace kerf
