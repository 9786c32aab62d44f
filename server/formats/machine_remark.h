// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace kerf {

/// A message of a program to the machine or its operator, other than a motion.
struct MachineRemark {
  enum class Kind {
    kSpindleClockwise,         ///< M3, with `rpm`
    kSpindleCounterClockwise,  ///< M4, with `rpm`
    kSpindleStop,              ///< M5
    kMist,                     ///< M7
    kFlood,                    ///< M8
    kCoolantOff,               ///< M9
    kStop,                     ///< M0: until the operator resumes
    kOptionalStop,             ///< M1
    kComment                   ///< with `text`
  };
  Kind kind = Kind::kComment;
  double rpm = 0;  ///< 0: not stated
  std::string text = {};
  friend bool operator==(const MachineRemark&, const MachineRemark&) = default;
};

/// Whether the remark starts something that a tool change would end.
inline bool starts_something(const MachineRemark& remark) {
  using Kind = MachineRemark::Kind;
  return remark.kind == Kind::kSpindleClockwise || remark.kind == Kind::kSpindleCounterClockwise ||
         remark.kind == Kind::kMist || remark.kind == Kind::kFlood;
}

/// A remark of a program and the number of motions before it.
struct ProgramRemark {
  std::size_t motions = 0;
  MachineRemark said;
  friend bool operator==(const ProgramRemark&, const ProgramRemark&) = default;
};

/// Most remarks kept of a program. Later ones are dropped.
inline constexpr std::size_t kProgramRemarksMax = 20'000;
/// Most bytes kept of a comment.
inline constexpr std::size_t kRemarkTextMax = 120;

}  // namespace kerf
