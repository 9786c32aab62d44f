// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <string>
#include <vector>

#include "kernel/piece/tool_piece.h"
#include "kernel/tool/convex_part.h"
#include "kernel/tool/tool_shape.h"

namespace kerf {

/// A validated tool: the union of its convex pieces, tip at the origin, axis +Z. It holds lengths
/// only and no angles, so a journal that stores tools replays identically on every CPU,
/// independently of libm's trigonometry.
struct Tool {
  std::vector<ToolPiece> pieces;       ///< the cutting part, from the tip up
  double length_mm = 0;                ///< top of the highest cutting piece
  double radius_mm = 0;                ///< largest radius of any cutting piece
  std::vector<ToolPiece> non_cutting;  ///< shank and holder, upwards; they collide but never cut
  double whole_length_mm = 0;          ///< as length_mm and radius_mm, over all pieces
  double whole_radius_mm = 0;
  std::vector<ConvexPart> whole_parts;        ///< of all pieces, for contact (convex_parts)
  std::vector<ConvexPart> non_cutting_parts;  ///< likewise of shank and holder alone
  friend bool operator==(const Tool&, const Tool&) = default;
};

enum class ToolErrorCode {
  kNotFinite,
  kNotPositive,
  kOutOfRange,
  kTooShort,
  kTooManyPieces,
  kInconsistent  ///< each field is valid, but they contradict each other
};
struct ToolError {
  ToolErrorCode code;
  std::string field;   ///< the offending field as scenes name it, e.g. "diameter_mm"
  std::string reason;  ///< one sentence
};

/// Limits of every length of a tool.
inline constexpr double kToolLengthMaxMm = 5000;
inline constexpr double kToolLengthMinMm = 0.0001;
/// Maximum number of convex pieces of the cutting part, and of the non-cutting part.
inline constexpr std::size_t kToolPiecesMax = 1024;

/// Resolves a shape, and the shank and holder above it, into convex pieces. An error names the
/// invalid field.
std::expected<Tool, ToolError> make_tool(const ToolShape& shape, const ToolBody& body = {});

/// Makes a tool of pieces that come from a journal. Checks that they are finite, positive, ordered
/// and within the limits.
std::expected<Tool, ToolError> make_tool(std::vector<ToolPiece> cutting,
                                         std::vector<ToolPiece> non_cutting = {});

}  // namespace kerf
