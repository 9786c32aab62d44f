// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "server/formats/program.h"

namespace kerf {

/// Divides the motions of a program into samples of 1/rate_hz seconds: add() motions until
/// can_sample(), then sample() until it is false. After the last motion end(). The last sample
/// before a jump or a tool change may be shorter, as may one during which more than kWindow motions
/// begin.
class FeedSampler {
 public:
  /// Most motions that are held.
  static constexpr std::size_t kWindow = 8192;

  explicit FeedSampler(double rate_hz) : rate_hz_(rate_hz) {}

  /// Precondition: not can_sample().
  void add(const ProgramMotion& motion);
  void end() { closed_ = ended_ = true; }
  bool can_sample() const;
  /// Appends the next sample, which is one motion unless it turns the axis far. Precondition:
  /// can_sample().
  void sample(std::vector<ProgramMotion>& out);
  /// Greatest distance of a corner of the path from the sample that spans it, mm.
  double corner_cut_mm() const { return corner_cut_mm_; }

 private:
  struct Part {
    ProgramMotion motion;
    double begin_s, end_s;  ///< since the start of the chain
  };
  double next_s() const { return static_cast<double>(tick_) / rate_hz_; }
  void begin(const ProgramMotion& motion);
  std::size_t part_at(double time_s) const;
  ToolPose pose_at(double time_s) const;
  void sample(double from_s, double to_s, int halvings, std::vector<ProgramMotion>& out);

  double rate_hz_;
  /// The rest of a run of motions of one tool, each of which starts at the end of the previous one.
  std::deque<Part> chain_;
  std::optional<ProgramMotion> next_chain_;  ///< its first motion
  bool closed_ = false;                      ///< the chain is complete
  bool ended_ = false;
  std::uint64_t tick_ = 1;
  double from_s_ = 0;
  ToolPose last_;
  double corner_cut_mm_ = 0;
};

/// Returns a warning if corners are cut off by more than 0.01 mm.
std::optional<std::string> warning_of_corners(const std::string& program, double corner_cut_mm);

}  // namespace kerf
