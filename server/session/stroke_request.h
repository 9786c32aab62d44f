// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/history/stroke_table.h"
#include "server/rights/caller.h"

namespace kerf {

/// Strokes to undo or redo, and the author of the request.
struct StrokeRequest {
  bool undone = true;  ///< false: redo
  /// All of these change, or none if one does not exist or is already in that state. If empty: the
  /// newest stroke of `participant` that is not undone, or for a redo, its stroke that was undone
  /// last.
  std::vector<StrokeId> strokes = {};
  ParticipantId participant = 0;
  /// The last record when `participant` made the request: later strokes and changes do not count.
  /// Nullopt: the last record when StrokeChanges::change() is called.
  std::optional<std::uint64_t> at = std::nullopt;
  ParticipantId author = 0;  ///< the participant that makes the request; 0 if the caller is none
  Caller caller = {};        ///< used if `author` is 0
};

/// Maximum number of strokes in one request.
inline constexpr std::size_t kStrokesMax = 500;

/// The answer to a StrokeRequest.
struct StrokesChanged {
  std::vector<StrokeId> strokes;
  std::uint64_t sequence = 0;  ///< the record after which the block has changed
  std::size_t tiles = 0;       ///< number of tiles carved again
  double returned_mm3 = 0;     ///< volume that came back; negative if material was removed
  /// Why the journaled change is not in the block or not durable yet. It will be as soon as this
  /// obstacle is gone. Nullopt: it is both.
  std::optional<std::string> pending = std::nullopt;
};

/// A list entry for a stroke.
struct ListedStroke {
  Stroke stroke;
  bool is_undone = false;
};

}  // namespace kerf
