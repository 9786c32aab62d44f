// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "haptic_agent/replica/other_tool.h"

namespace kerf::agent {

/// The tools of other participants near this agent's, and what they are about to cut where this
/// agent's tool is. Cuts at most the four nearest that cut.
class OtherTools {
 public:
  /// The tool of this agent in its next motion.
  struct Own {
    Vec3 tip_mm;
    Bounds box;  ///< around the stock on which the force depends
  };

  /// A path that is expected more than a tenth of the pitch and 0.02 mm off is cut again.
  explicit OtherTools(double pitch_mm);

  /// Takes the poses that the server has sent, at the time of this agent's newest sample, us. A
  /// tool that is not listed has gone; of a participant that is listed twice, the first pose
  /// counts.
  void take(const wire::Intents& intents, std::uint64_t now_us);
  /// Forgets all poses: the server has taken back what was cut.
  void forget();
  /// Returns whether a tool is near; forgets the poses of those that have gone silent.
  bool are_near(std::uint64_t now_us);
  /// Returns whether the block must be restored and cut again: a tool has not gone where it was
  /// expected, has ended, or is no longer one of the nearest, or this agent's tool has left the
  /// surroundings in which the others are cut.
  bool are_off(std::uint64_t now_us, const Own& own);
  /// The block no longer has what was cut for them. Cuts are made around `own` from now on.
  void restart(std::uint64_t now_us, const Own& own);
  /// Removes from `block` what they cut until now (OtherTool::cut).
  void cut(Sculpture& block, std::uint64_t now_us);

 private:
  std::vector<std::uint32_t> nearest(std::uint64_t now_us, const Own& own) const;
  bool choose(std::uint64_t now_us, const Own& own);

  double off_mm_;
  std::map<std::uint32_t, OtherTool> tools_;  ///< by participant
  std::vector<std::uint32_t> chosen_;         ///< participants whose tools are cut
  Bounds reach_;                              ///< chords outside of it are not cut
  bool is_new_ = false;                       ///< a frame has arrived since the last choice
  bool is_dropped_ = false;                   ///< the block has cuts of a tool that has gone
};

}  // namespace kerf::agent
