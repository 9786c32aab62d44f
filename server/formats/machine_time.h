// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/formats/program.h"
#include "server/formats/scene.h"

namespace kerf {

/// The limits of a machine's axes, and the look-ahead of its control.
struct MachineDynamics {
  Vec3 speed_max_mm_per_s{1e4 / 60, 1e4 / 60, 1e4 / 60};  ///< of each linear axis
  Vec3 acceleration_mm_per_s2{3000, 3000, 3000};          ///< of each linear axis
  /// Limits of the tool's axis in the workpiece, which rotary axes turn.
  double turn_max_rad_per_s = 1, turn_acceleration_rad_per_s2 = 10;
  /// Rounding of the path at a corner, mm, which determines the speed there.
  double corner_mm = 0.01;

  /// Look-ahead of the control in blocks. It can always stop within them.
  static constexpr std::size_t kLookAhead = 100;
};

/// Returns the dynamics of a scene's machine.
MachineDynamics dynamics_of(const Machine& machine);

/// Computes the time of a program from the limits of a machine's axes. Each motion is accelerated
/// and braked at a constant rate, no faster than programmed and than the slowest axis permits in
/// its direction. The speed between two motions is that of an arc that leaves the corner by
/// corner_mm at this acceleration. Dwells count as programmed. Motions that do not continue each
/// other begin and end at rest.
class MachineTime {
 public:
  explicit MachineTime(const MachineDynamics& dynamics = {}) : dynamics_(dynamics) {}

  /// Adds the next motion.
  void add(const ProgramMotion& motion);
  /// Returns the time of all motions so far, s, with a stop after the last one.
  double total_s() const;
  /// Returns a question, as one line, if a feed is too fast for any machine: above
  /// kFeedMaxMmPerMin.
  std::optional<std::string> feed_question(const std::string& program) const;
  static constexpr double kFeedMaxMmPerMin = 200'000;

 private:
  /// A motion along a coordinate: mm of travel, or rad of a turn without travel.
  struct Block {
    Vec3 direction;     ///< of the travel; zero for a turn without travel
    double length = 0;  ///< > 0
    double speed = 0;   ///< greatest, per s
    double acceleration = 0;
    double entry_max = 0;  ///< greatest speed at its beginning
  };
  Block block_of(const ProgramMotion& motion) const;
  double corner_speed(const Block& from, const Block& to) const;
  std::vector<double> entries(std::size_t count) const;
  double time_of(std::size_t first, std::size_t end, const std::vector<double>& entry) const;
  void settle(std::size_t count);

  MachineDynamics dynamics_;
  std::vector<Block> ahead_;  ///< not timed yet
  double entered_ = 0;        ///< speed at the beginning of the first of them
  double total_s_ = 0;        ///< of those before
  std::optional<ProgramMotion> last_;
  double fastest_mm_per_s_ = 0;  ///< of a feed
  std::uint32_t fastest_line_ = 0;
};

}  // namespace kerf
