// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <variant>

#include "kernel/sculpture.h"
#include "server/convert/batch_sum.h"
#include "server/convert/held_cut.h"
#include "server/convert/rejection.h"
#include "server/wire/types.h"

namespace kerf {

/// Whether the motion to a sample cuts.
inline bool cuts(const wire::MotionSample& sample) {
  return (sample.buttons & wire::kButtonCutting) != 0;
}

/// The pose of one participant's tool, and the conversion of its samples to steps. The session and
/// an agent's replica both use it, so that they interpret samples identically.
class ToolTrack {
 public:
  /// The tool moves without cutting. Obstacles and stock push it.
  struct Touch {
    ToolId tool = 0;
    ToolPose pose;
    double duration_s = 0;
  };
  /// The tool rests while it cuts, out of reach of obstacles, after it has come there by a motion.
  /// Any other rest is a motion, which removes the material inside the tool.
  struct Rest {
    ToolId tool = 0;
    ToolPose pose;
    double duration_s = 0;
  };
  /// std::monostate without a motion, because the tool was just placed.
  using Step = std::variant<std::monostate, Touch, Rest, MoveTool>;

  /// Converts the next sample to a step. Rejects invalid poses, unknown tools, timestamps that do
  /// not advance, and a tip faster than `speed_max_mm_per_s` while cutting. If pose and tool are
  /// valid, the tool moves to that pose even if the motion is rejected.
  std::expected<Step, Rejection> take(const wire::MotionSample& sample, const Sculpture& sculpture,
                                      double speed_max_mm_per_s);
  /// Returns whether `take` would return a motion for this sample, if it is valid.
  bool would_move(const wire::MotionSample& sample) const;
  /// Drops the last pose. The next sample places the tool without a motion.
  void lift() { pose_.reset(); }
  /// Sets the pose without a sample, as if a motion of the tool had reached it.
  void place(const ToolPose& pose) {
    pose_ = pose;
    has_cut_here_ = true;
  }

  const std::optional<ToolPose>& pose() const { return pose_; }
  ToolId tool() const { return tool_; }
  std::uint64_t time_us() const { return time_us_; }  ///< of the last sample taken

 private:
  std::optional<ToolPose> pose_;
  ToolId tool_ = 0;
  std::uint64_t time_us_ = 0;
  bool has_cut_here_ = false;  ///< a motion of the tool has ended at the pose
};

/// Adds the contact force of obstacles and stock at the pose of `touch` to a result.
void add_touch(BatchSum& sum, const Sculpture& sculpture, const ToolTrack::Touch& touch);
/// Adds an applied motion and the contact planes at its end. Records its force in the participant's
/// `held`.
void add_motion(BatchSum& sum, const Sculpture& sculpture, const MoveTool& move,
                const MotionResult& result, HeldCut& held);
/// Adds contact and held force if the step is a rest. Drops the latter if the step neither rests
/// nor cuts.
void add_rest(BatchSum& sum, const Sculpture& sculpture, const ToolTrack::Step& step,
              HeldCut& held);

}  // namespace kerf
