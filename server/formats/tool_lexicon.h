// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace kerf {

/// The meaning of a word in the description of a tool, in English, German, French or Spanish.
enum class ToolWord {
  kUnknown,
  // Kinds of tools.
  kBall,
  kBull,
  kFlat,
  kEnd,   ///< end mills: flat, unless another word describes the end
  kFace,  ///< a flat one; "FACE 1" alone is an operation
  kSlot,  ///< likewise
  kDrill,
  kSpot,
  kVee,
  kChamfer,
  kCountersink,
  kTap,
  kThread,  ///< a mill for threads
  kReamer,
  kTaper,
  kForm,     ///< with an outline that words do not state: dovetail, lollipop, corner rounding
  kTurning,  ///< of a lathe
  // Other nouns, and words without a shape.
  kMill,  ///< mill, cutter
  kBit,
  kTool,
  kNoise,
  kGerund,     ///< an operation ("DRILLING"), or with a noun a tool ("DRILLING TOOL")
  kOperation,  ///< of a program: pocket, contour, pattern
  kNegation,   ///< "not", "or", "instead": another tool is described
  // Names of numbers.
  kDiameter,
  kCornerRadius,  ///< CR, RE
  kCorner,
  kRadius,
  kAngle,
  kPoint,  ///< the tip
  kHalf,   ///< of an angle of a side
  kLength,
  kShank,
  kFlutes,
  kCount,     ///< a number of flutes in words: "TWO", "SINGLE"
  kRegister,  ///< H, offsets
  kRate,      ///< feeds, speeds and depths
  kNumber,    ///< "NO": of a tool or a gauge
  kHelix,     ///< helix angle, not that of the tip
};

/// Returns the meaning of a word of ToolToken: upper case, ASCII.
ToolWord tool_word_meaning(std::string_view word);

}  // namespace kerf
