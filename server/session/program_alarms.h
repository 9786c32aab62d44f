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
  double collision_n = 0;           ///< of obstacles and stock at the end; 0 likewise
  std::optional<Gouge> gouge = {};  ///< into the part that the program is to make
};

enum class AlarmKind {
  kRapid,     ///< a rapid removed material; the amount is its volume, mm^3
  kShank,     ///< shank or holder entered the stock; the depth, mm
  kObstacle,  ///< the tool was pushed by an obstacle at the end of a motion; the force, N
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
  Vec3 tip_mm{};      ///< at the end of the motion with the greatest amount
  Vec3 at_mm{};       ///< of kGouge: the deepest place
};

/// Collects the alarms of a program while it is carved. It costs a few comparisons a motion: forces
/// are judged where they are computed anyway, at feed rate.
class ProgramAlarms {
 public:
  /// Alarms that are listed; further ones are counted.
  static constexpr std::size_t kListedMax = 100;

  static constexpr double kGougeGapPitches = 2;

  /// `force_limit_n`: nothing for no limit. `pitch_mm` is that of the block.
  explicit ProgramAlarms(std::optional<double> force_limit_n = {}, double pitch_mm = 0)
      : limit_n_(force_limit_n), gouge_gap_mm_(kGougeGapPitches * pitch_mm) {}
  /// Adds the next motion of the program.
  void follow(const ProgramMotion& motion, const CarvedMotion& carved);
  const std::vector<ProgramAlarm>& list() const { return list_; }
  std::size_t count() const { return count_; }

 private:
  void note(AlarmKind kind, const ProgramMotion& motion, double amount, Vec3 at_mm = {});
  bool is_in_gap(AlarmKind kind, const ProgramMotion& motion);

  struct Open {
    bool is_open = false;
    std::optional<std::size_t> listed = {};
    double greatest = 0;
  };
  std::optional<double> limit_n_;
  double gouge_gap_mm_;
  double without_gouge_mm_ = 0;  ///< path since the last gouge
  std::vector<ProgramAlarm> list_;
  std::size_t count_ = 0;
  Open open_[5];  ///< by kind: the run of motions that the last motion belongs to
};

}  // namespace kerf
