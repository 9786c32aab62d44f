// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <string>
#include <vector>

#include "kernel/piece/tool_piece.h"
#include "kernel/tool/tool_shape.h"

namespace kerf {

/// A validated tool: the union of its convex pieces, tip at the origin, axis +Z. Angles end here: a
/// tool holds lengths only, so that a journal that stores tools replays alike on every CPU (libm's
/// trigonometry does not).
struct Tool {
  std::vector<ToolPiece> pieces;       ///< what cuts, from the tip up
  double length_mm = 0;                ///< top of the highest cutting piece
  double radius_mm = 0;                ///< largest radius of any cutting piece
  std::vector<ToolPiece> non_cutting;  ///< shank and holder, from below: they collide, never cut
  double whole_length_mm = 0;          ///< as length_mm and radius_mm, over all pieces
  double whole_radius_mm = 0;
  friend bool operator==(const Tool&, const Tool&) = default;
};

enum class ToolErrorCode {
  kNotFinite,
  kNotPositive,
  kOutOfRange,
  kTooShort,
  kTooManyPieces,
  kInconsistent  ///< fields that are sound by themselves do not fit together
};
struct ToolError {
  ToolErrorCode code;
  std::string field;   ///< the offending field as scenes name it, e.g. "diameter_mm"
  std::string reason;  ///< one sentence
};

/// Largest and smallest length that any tool dimension may have.
inline constexpr double kToolLengthMaxMm = 5000;
inline constexpr double kToolLengthMinMm = 0.0001;
/// Most convex pieces that the cutting or the non-cutting part of a tool may have.
inline constexpr std::size_t kToolPiecesMax = 1024;

/// Resolves a shape, and the shank and holder above it, into convex pieces, or says which field is
/// wrong.
std::expected<Tool, ToolError> make_tool(const ToolShape& shape, const ToolBody& body = {});

/// Checks a tool that came as pieces (from a journal): finite, positive, ordered, within the
/// limits.
std::expected<Tool, ToolError> make_tool(std::vector<ToolPiece> cutting,
                                         std::vector<ToolPiece> non_cutting = {});

}  // namespace kerf
