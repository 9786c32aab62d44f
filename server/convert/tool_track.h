// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <variant>

#include "kernel/sculpture.h"
#include "server/convert/batch_sum.h"
#include "server/convert/rejection.h"
#include "server/wire/types.h"

namespace kerf {

/// Where one participant's tool is, and what its next sample asks of the block. One meaning for
/// everybody who holds a block: the session, and an agent with a copy of it.
class ToolTrack {
 public:
  /// The tool goes through the air and touches what it meets.
  struct Touch {
    ToolId tool = 0;
    ToolPose pose;
    double duration_s = 0;
  };
  /// Nothing: the tool has come, or rests.
  using Step = std::variant<std::monostate, Touch, MoveTool>;

  /// Takes the next sample. A rejection (a pose that is none, an unknown tool, a clock that stands
  /// still, a tip faster than `speed_max_mm_per_s` while cutting) says which sample and why; the
  /// tool is at a sound pose from then on, whatever becomes of the way to it.
  std::expected<Step, Rejection> take(const wire::MotionSample& sample, const Sculpture& sculpture,
                                      double speed_max_mm_per_s);
  /// The tool is nowhere: its next sample places it without a motion.
  void lift() { pose_.reset(); }
  /// The tool has been brought there in some other way.
  void place(const ToolPose& pose) { pose_ = pose; }

  const std::optional<ToolPose>& pose() const { return pose_; }
  ToolId tool() const { return tool_; }
  std::uint64_t time_us() const { return time_us_; }  ///< of the last sample taken

 private:
  std::optional<ToolPose> pose_;
  ToolId tool_ = 0;
  std::uint64_t time_us_ = 0;
};

/// Adds what the tool feels there to an answer: obstacles push it, and so does the stock.
void add_touch(BatchSum& sum, const Sculpture& sculpture, const ToolTrack::Touch& touch);
/// Adds a motion that was applied, and what touches the tool at its end.
void add_motion(BatchSum& sum, const Sculpture& sculpture, const MoveTool& move,
                const MotionResult& result);

}  // namespace kerf
