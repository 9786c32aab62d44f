// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kernel/math/vec3.h"
#include "server/formats/program.h"
#include "server/verify/gouge_check.h"

namespace kerf {

/// What one motion of a program did: the parts of its MotionResult that alarms come from.
struct CarvedMotion {
  double removed_mm3 = 0;
  double stock_contact_mm = 0;      ///< greatest depth of shank or holder in the stock
  double cutting_n = 0;             ///< mean cutting force; 0 where forces are not computed
  double collision_n = 0;           ///< greatest push of obstacles along it; 0 likewise
  double film_mm3 = 0;              ///< AlarmLimits::film_mm3 of its tool
  std::optional<Gouge> gouge = {};  ///< into the part that the program is to make
};

enum class AlarmKind {
  kRapid,     ///< a rapid removed material; the amount is its volume, mm^3
  kShank,     ///< shank or holder entered the stock; the depth, mm
  kObstacle,  ///< the tool was pushed by an obstacle; the force, N
  kForce,     ///< the mean cutting force of a motion was above the limit; the force, N
  kGouge      ///< the motion cut below the part that the program is to make; the depth, mm
};
/// Returns "rapid", "shank", "obstacle", "force" or "gouge".
const char* to_string(AlarmKind kind);

/// Consecutive motions with the same alarm. Gouges less than ProgramAlarms::kGougeGapPitches apart
/// along the path are one: the rays meet a part of the motions only.
struct ProgramAlarm {
  AlarmKind kind = AlarmKind::kRapid;
  std::uint32_t from_line = 0, to_line = 0;
  ToolId tool = 0;
  double amount = 0;  ///< the greatest one; of kRapid the sum
  double limit = 0;   ///< that the amount of a motion exceeded, in its unit
  Vec3 tip_mm{};      ///< at the end of the motion with the greatest amount
  Vec3 at_mm{};       ///< of kGouge: the deepest place
};

/// Amounts up to which there is no alarm.
struct AlarmLimits {
  std::optional<double> force_n = {};  ///< nothing: any force
  /// Of the scene: surfaces are true to it, so that neither a depth nor a film of it means
  /// anything.
  double tolerance_mm = 0;
  double gouge_mm = 0;  ///< into the part that the program is to make
  double pitch_mm = 0;  ///< of the block

  /// The volume that a rapid removes where it leaves a surface that lies too high by the tolerance:
  /// below all of the tool, mm^3.
  double film_mm3(double tool_radius_mm) const;
};

/// Collects the alarms of a program while it is carved. It costs a few comparisons a motion: forces
/// are judged where they are computed anyway, at feed rate.
class ProgramAlarms {
 public:
  /// Alarms that are listed; further ones are counted.
  static constexpr std::size_t kListedMax = 100;

  static constexpr double kGougeGapPitches = 2;

  explicit ProgramAlarms(const AlarmLimits& limits = {}) : limits_(limits) {}
  /// Adds the next motion of the program.
  void follow(const ProgramMotion& motion, const CarvedMotion& carved);
  const std::vector<ProgramAlarm>& list() const { return list_; }
  std::size_t count() const { return count_; }

 private:
  void note(AlarmKind kind, const ProgramMotion& motion, double amount, double limit,
            Vec3 at_mm = {});
  bool is_in_gap(AlarmKind kind, const ProgramMotion& motion);

  struct Open {
    bool is_open = false;
    std::optional<std::size_t> listed = {};
    double greatest = 0;
  };
  AlarmLimits limits_;
  double without_gouge_mm_ = 0;  ///< path since the last gouge
  std::vector<ProgramAlarm> list_;
  std::size_t count_ = 0;
  Open open_[5];  ///< by kind: the run of motions that the last motion belongs to
};

}  // namespace kerf
