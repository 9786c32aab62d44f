// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "kernel/sculpture_state.h"
#include "server/formats/program.h"
#include "server/formats/scene.h"
#include "web/wasm/files/journal_block.h"
#include "web/wasm/files/played_block.h"

namespace kerf::page {

/// The files of a block, by their names in the module's folder; "" for those that there are not.
struct BlockFiles {
  std::string program, scene, stock;
};

/// A program and its block, carved as kerf-carve does it with the same files: for a page without a
/// server. Steps are motions, and errors those of kerf-carve. It feels no forces.
class ProgramBlock final : public PlayedBlock {
 public:
  /// Reads scene and program. Without a scene it is derived from the program, or, if there is none,
  /// from the size of the stock.
  static std::expected<ProgramBlock, std::string> read(const BlockFiles& files);
  /// An accuracy that is a target is refined for thin walls before.
  std::expected<void, std::string> make() override;
  std::expected<void, std::string> carve(std::size_t motions, bool feels) override;
  /// Returns to a state that was kept, the last one before or at a motion.
  std::expected<void, std::string> seek(std::size_t motion) override;
  std::optional<double> next_s() const override;
  /// Returns a journal of the block, not made yet, for a hand that goes on: its scene, and the
  /// motions up to where it is as one stroke of participant 1. `wall_ms`: now, ms since 1970.
  std::expected<JournalBlock, std::string> as_journal(std::int64_t wall_ms) const;
  std::uint64_t hash() override { return sculpture_->state_hash(); }
  std::string about() const override;
  std::string progress() const override;
  std::string path() const override;

 protected:
  SolidSnapshot solid() override { return sculpture_->solid(); }
  std::string title() const override { return scene_.name; }

 private:
  /// A state to which seek() returns, and what the motions after it have changed, up to the next.
  struct Kept {
    SculptureState state;
    std::size_t carved = 0;
    double machining_s = 0;
    std::set<TileIndex> changed;
  };

  ProgramBlock() = default;
  std::expected<void, std::string> read_scene(const BlockFiles& files);
  std::expected<void, std::string> read_program(const BlockFiles& files);
  std::expected<void, std::string> settle();
  void refine_for_walls();
  void keep_state();
  void note(std::string text) { notes_.push_back(std::move(text)); }

  std::string label_;  ///< names the scene in errors
  Scene scene_;
  Program program_;
  std::vector<std::string> notes_;
  std::string derived_ = "null";  ///< JSON (derived_json.h), if the scene was derived
  std::optional<Sculpture> sculpture_;
  std::size_t carved_ = 0;
  double machining_s_ = 0;  ///< of the motions that are carved
  std::vector<Kept> kept_;
};

}  // namespace kerf::page
