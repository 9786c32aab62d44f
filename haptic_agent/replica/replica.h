// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <expected>
#include <optional>
#include <set>
#include <string_view>

#include "haptic_agent/replica/agreement.h"
#include "haptic_agent/replica/block_source.h"
#include "kernel/dexel/tile_region.h"
#include "server/convert/tool_track.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// A copy of the block, right near the tool: it takes each sample for the motion that the server
/// will take it for, cuts it at once, and answers what the server will answer a round trip later.
/// The server has the authority: it tells what others have cut, and what it answers is compared.
/// Not thread-safe; no clock.
class Replica {
 public:
  explicit Replica(BlockSource source);

  /// The next sample of the hand, in their order. Empty while it is not known what the tool may
  /// touch there, and over the next two pitches of a cut: what a force is made of goes back so far
  /// (TravelQueue).
  std::optional<wire::Result> move(const wire::MotionSample& sample);
  /// What tiles near the tool still hold. The error says what of the patch is wrong: nothing of
  /// that tile, nor of those behind it, has been taken.
  std::expected<void, std::string_view> take(const wire::StockPatch& patch);
  /// What the server answered to a sample that this has answered.
  void compare(const wire::Result& theirs) { agreement_.compare(theirs); }
  /// True once after the answers have differed for so long that the copy must begin afresh: the
  /// server is to be asked to.
  bool take_doubt() { return agreement_.take_doubt(); }

  const Agreement& agreement() const { return agreement_; }
  std::uint64_t tiles_known() const { return known_.size(); }
  /// The copy as it is, for tests.
  const Sculpture& block() const { return block_; }

 private:
  struct Cut {
    std::uint64_t time_us;
    MoveTool move;
  };
  /// Motions older than this have reached the server: no afresh copy lacks them.
  static constexpr std::uint64_t kRememberedUs = 4'000'000;

  bool knows(const MoveTool& motion);
  bool settles(const MoveTool& motion, bool known);
  bool knows(const DexelField& field, std::size_t n, const TileRegion& region);
  std::expected<void, std::string_view> take_tile(const wire::StockTile& tile);
  void cut_again(std::uint64_t server_has_us);

  BlockSource source_;
  Sculpture block_;
  ToolTrack track_;
  std::set<FieldTile> known_;
  /// The tiles of each field last asked for, all of which were known: most of the next ones are
  /// among them.
  std::array<TileRegion, 3> known_region_;
  std::deque<Cut> cuts_;
  /// Way of the tool until its force no longer holds anything of what was not known.
  double unsettled_mm_ = 0;
  Agreement agreement_;
};

}  // namespace kerf::agent
