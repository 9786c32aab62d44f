// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "haptic_agent/replica/other_tool.h"

namespace kerf::agent {

/// The tools of other participants near this agent's, and their expected cuts around this agent's
/// tool. At most the four nearest cutting tools are cut.
class OtherTools {
 public:
  /// The tool of this agent in its next motion.
  struct Own {
    Vec3 tip_mm;
    Bounds box;  ///< around the stock on which the force depends
  };

  /// A path that is more than a tenth of the pitch and 0.02 mm off its expectation is cut again.
  explicit OtherTools(double pitch_mm);

  /// Adds the poses from the server, at the time of this agent's newest sample, us. A tool that is
  /// not listed has gone. If a participant is listed twice, the first pose counts.
  void take(const wire::Intents& intents, std::uint64_t now_us);
  /// Forgets all poses, because the server may have undone their cuts.
  void forget();
  /// Returns whether a tool is near. Forgets the poses of silent tools.
  bool are_near(std::uint64_t now_us);
  /// Returns whether the block must be restored and cut again: a tool did not follow its expected
  /// path, has ended, or is no longer one of the nearest, or this agent's tool has left the
  /// surroundings in which the other tools are cut.
  bool are_off(std::uint64_t now_us, const Own& own);
  /// Call when the block has been restored without their cuts. Later cuts are made around `own`.
  void restart(std::uint64_t now_us, const Own& own);
  /// Removes the cuts of the chosen tools until now from `block` (OtherTool::cut).
  void cut(Sculpture& block, std::uint64_t now_us);

 private:
  std::vector<std::uint32_t> nearest(std::uint64_t now_us, const Own& own) const;
  bool choose(std::uint64_t now_us, const Own& own);

  double off_mm_;
  std::map<std::uint32_t, OtherTool> tools_;  ///< by participant
  std::vector<std::uint32_t> chosen_;         ///< participants whose tools are cut
  Bounds reach_;                              ///< chords outside are not cut
  bool is_new_ = false;                       ///< a frame has arrived since the last choice
  bool is_dropped_ = false;                   ///< the block has cuts of a tool that is gone
};

}  // namespace kerf::agent
