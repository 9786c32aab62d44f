// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <expected>
#include <optional>
#include <set>
#include <span>
#include <string_view>

#include "haptic_agent/replica/agreement.h"
#include "haptic_agent/replica/block_source.h"
#include "haptic_agent/replica/other_tools.h"
#include "kernel/dexel/tile_region.h"
#include "server/convert/tool_track.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// Replica of the block, exact near the tool. It interprets each sample as the server will, cuts it
/// at once, and returns the answer that the server will give a round trip later. The server is
/// authoritative: it sends the cuts of other participants, and its answers are compared with the
/// replica's. Not thread-safe; uses no clock.
class Replica {
 public:
  explicit Replica(BlockSource source);

  /// Applies the next sample. Returns the answer. Empty while tiles that the tool may touch are
  /// unknown, and over the following two pitches of travel, because the force depends on the stock
  /// cut over that length (TravelQueue).
  std::optional<wire::Result> move(const wire::MotionSample& sample);
  /// Applies the contents of tiles near the tool. On an error, neither the faulty tile nor later
  /// ones of the patch are applied.
  std::expected<void, std::string_view> take(const wire::StockPatch& patch);
  /// Adds the poses of other tools nearby. The force of the next samples is that of a block without
  /// their expected cuts.
  void take(const wire::Intents& intents) { others_.take(intents, track_.time_us()); }
  /// Defines the tools of a `tools` message that are new. The error is one sentence.
  std::expected<void, std::string> define_tools(std::string_view message);
  /// Compares the force of an answer of the server; see Agreement::compare.
  void compare(std::uint64_t agent_time_us, Vec3 force_n) {
    agreement_.compare(agent_time_us, force_n);
  }
  /// Returns true once after the replica has diverged. It then needs a reset from the server.
  bool take_divergence() { return agreement_.take_divergence(); }

  const Agreement& agreement() const { return agreement_; }
  std::uint64_t tiles_known() const { return known_.size(); }
  /// Returns the replica of the server's block, without the expected cuts of other tools. For
  /// tests.
  const Sculpture& block() const { return stock_ ? *stock_ : block_; }
  /// Returns a view of that block.
  SolidSnapshot solid() { return (stock_ ? *stock_ : block_).solid(); }
  /// Returns a copy of that block for experiments.
  Sculpture copy();
  /// The cut of the newest sample. Null if its motion does not cut, or was rejected.
  struct NewestCut {
    MoveTool move;
    MotionResult result;
  };
  const NewestCut* newest_cut() const { return newest_cut_ ? &*newest_cut_ : nullptr; }
  /// Returns whether the server has sent a tile.
  bool knows(FieldTile at) const { return known_.contains(at); }
  /// Returns whether the server has sent all tiles on which the surface of a tile of the field
  /// along Z depends: in each field, those through its columns and one pitch around them.
  bool knows_around(TileIndex tile) const;

 private:
  struct Cut {
    std::uint64_t time_us;
    MoveTool move;
  };
  /// Motions older than this have reached the server, so a reset already contains them.
  static constexpr std::uint64_t kRememberedUs = 4'000'000;

  std::optional<wire::Result> answer(const wire::MotionSample& sample);
  bool is_known(const MoveTool& motion);
  bool is_settled(const MoveTool& motion, bool known);
  bool is_known(const DexelField& field, std::size_t n, const TileRegion& region);
  std::expected<void, std::string_view> take_tile(const wire::StockTile& tile);
  std::expected<void, std::string_view> take_returned(const wire::StockPatch& patch);
  std::expected<const DexelField*, std::string_view> field_of(FieldTile at) const;
  void forget_others();
  void cut_again(std::uint64_t server_has_us);
  void replace(std::span<const TileReplacement> tiles, std::uint64_t server_has_us);
  bool is_near(FieldTile at) const;
  /// Travel over which the force depends on stock cut earlier.
  double settling_mm() const { return 2 * block_.settings().pitch_mm; }
  OtherTools::Own own_tool(const wire::MotionSample& sample) const;
  void look_ahead(const wire::MotionSample& sample);

  BlockSource source_;
  /// The block that gives the force.
  Sculpture block_;
  /// While other tools are near: the replica. block_ is then a copy without their expected cuts.
  std::optional<Sculpture> stock_;
  OtherTools others_;
  ToolTrack track_;
  HeldCut held_;
  std::set<FieldTile> known_;
  /// Per field, the region of the last query, in which all tiles are known. The next query mostly
  /// overlaps it.
  std::array<TileRegion, 3> known_region_;
  std::deque<Cut> cuts_;
  std::optional<NewestCut> newest_cut_;
  /// Remaining travel until the force no longer depends on unknown stock.
  double unsettled_mm_ = 0;
  Agreement agreement_;
};

}  // namespace kerf::agent
