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

/// Strokes to undo or to redo, and who asks.
struct StrokeRequest {
  bool undone = true;  ///< false: redo
  /// All of them, or none if one does not exist or is so already. Empty: the newest stroke of
  /// `participant` that is not undone; or the one of its strokes that was undone last.
  std::vector<StrokeId> strokes = {};
  ParticipantId participant = 0;
  /// The last record when `participant` asked: strokes that begin later and later changes do not
  /// count. Nullopt: the one when change_strokes() is called.
  std::optional<std::uint64_t> at = std::nullopt;
  ParticipantId author = 0;  ///< the participant that asks; 0: a caller who is none
  Caller caller = {};        ///< of an author 0
};

/// Strokes that one request may name.
inline constexpr std::size_t kStrokesMax = 500;

/// The answer to a StrokeRequest.
struct StrokesChanged {
  std::vector<StrokeId> strokes;
  std::uint64_t sequence = 0;  ///< the record after which the block is the new one
  std::size_t tiles = 0;       ///< that were carved again
  double returned_mm3 = 0;     ///< volume that came back; negative: that was removed
  /// Why the block has not changed yet, although the journal says so: it will, as soon as that is
  /// over. Nullopt: it has.
  std::optional<std::string> pending = std::nullopt;
};

/// A stroke, as a list of them shows it.
struct ListedStroke {
  Stroke stroke;
  bool is_undone = false;
};

}  // namespace kerf
