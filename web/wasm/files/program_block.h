// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "kernel/sculpture_state.h"
#include "kernel/surface/tile_mesh.h"
#include "server/formats/model/model_writer.h"
#include "server/formats/program.h"
#include "server/formats/scene.h"

namespace kerf::page {

/// The files of a block, by their names in the module's folder; "" for those that there are not.
struct BlockFiles {
  std::string program, scene, stock;
};

/// A program and its block, carved as kerf-carve does it with the same files: for a page without a
/// server. Errors are one line, that of kerf-carve. Not thread-safe.
class ProgramBlock {
 public:
  /// Reads scene and program. Without a scene it is derived from the program, or, if there is none,
  /// from the size of the stock.
  static std::expected<ProgramBlock, std::string> read(const BlockFiles& files);
  /// Makes the block. An accuracy that is a target is refined for thin walls before.
  std::expected<void, std::string> make();

  /// Carves the next motions, at most so many.
  std::expected<void, std::string> carve(std::size_t motions);
  /// Returns to a state that was kept, the last one before or at a motion; carve() then goes on.
  void seek(std::size_t motion);
  /// Returns the number of motions that the block has.
  std::size_t carved() const { return carved_; }

  /// Returns the tiles whose mesh has changed since the last call; the first time all.
  std::vector<TileIndex> changed();
  /// Returns the mesh of a tile, which must be in the grid, as the block was at the last changed().
  TileMesh mesh(TileIndex tile) const { return mesh_tile(shown_, tile); }
  std::uint64_t hash() { return sculpture_->state_hash(); }
  /// Writes the block as a model file into the module's folder.
  std::expected<void, std::string> write(ModelFormat format, const std::string& file);

  /// Returns JSON texts for the page (block_json.cpp): what was read and assumed; where the tool
  /// is; the path of the tip.
  std::string about() const;
  std::string progress() const;
  std::string path() const;

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
  std::optional<Sculpture> sculpture_;
  std::size_t carved_ = 0;
  double machining_s_ = 0;  ///< of the motions that are carved
  std::vector<Kept> kept_;
  std::set<TileIndex> changed_;  ///< since the last changed()
  SolidSnapshot shown_;          ///< at the last changed()
};

}  // namespace kerf::page
