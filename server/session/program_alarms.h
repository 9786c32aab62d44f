// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kernel/math/vec3.h"
#include "server/formats/program.h"

namespace kerf {

/// What one motion of a program did: the parts of its MotionResult that alarms come from.
struct CarvedMotion {
  double removed_mm3 = 0;
  double stock_contact_mm = 0;  ///< greatest depth of shank or holder in the stock
  double cutting_n = 0;         ///< mean cutting force; 0 where forces are not computed
  double collision_n = 0;       ///< of obstacles and stock at the end; 0 likewise
};

enum class AlarmKind {
  kRapid,     ///< a rapid removed material; the amount is its volume, mm^3
  kShank,     ///< shank or holder entered the stock; the depth, mm
  kObstacle,  ///< the tool was pushed by an obstacle at the end of a motion; the force, N
  kForce      ///< the mean cutting force of a motion was above the limit; the force, N
};
/// Returns "rapid", "shank", "obstacle" or "force".
const char* to_string(AlarmKind kind);

/// Consecutive motions with the same alarm.
struct ProgramAlarm {
  AlarmKind kind = AlarmKind::kRapid;
  std::uint32_t from_line = 0, to_line = 0;
  ToolId tool = 0;
  double amount = 0;  ///< the greatest one; of kRapid the sum
  Vec3 tip_mm{};      ///< at the end of the motion with the greatest amount
};

/// Collects the alarms of a program while it is carved. It costs a few comparisons a motion: forces
/// are judged where they are computed anyway, at feed rate.
class ProgramAlarms {
 public:
  /// Alarms that are listed; further ones are counted.
  static constexpr std::size_t kListedMax = 100;

  /// `force_limit_n`: nothing for no limit.
  explicit ProgramAlarms(std::optional<double> force_limit_n = {}) : limit_n_(force_limit_n) {}
  /// Adds the next motion of the program.
  void follow(const ProgramMotion& motion, const CarvedMotion& carved);
  const std::vector<ProgramAlarm>& list() const { return list_; }
  std::size_t count() const { return count_; }

 private:
  void note(AlarmKind kind, const ProgramMotion& motion, double amount);

  struct Open {
    bool is_open = false;
    std::optional<std::size_t> listed = {};
    double greatest = 0;
  };
  std::optional<double> limit_n_;
  std::vector<ProgramAlarm> list_;
  std::size_t count_ = 0;
  Open open_[4];  ///< by kind: the run of motions that the last motion belongs to
};

}  // namespace kerf
