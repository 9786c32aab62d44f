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
#include "kernel/surface/tile_mesh.h"
#include "server/feed/column_digest.h"
#include "server/formats/model/model_writer.h"

namespace kerf::page {

/// A block in a page that goes along its steps, forth and back: the motions of a program, the
/// records of a journal. Errors are one line. Not thread-safe.
class PlayedBlock {
 public:
  virtual ~PlayedBlock() = default;

  /// Makes the block of what was read. All others need it.
  virtual std::expected<void, std::string> make() = 0;
  /// Carries out the next steps, at most so many; with or without the forces of their motions.
  virtual std::expected<void, std::string> carve(std::size_t steps, bool feels) = 0;
  /// Goes to a step, or to one before it from which carve() then goes on.
  virtual std::expected<void, std::string> seek(std::size_t step) = 0;

  /// Returns when the next step ends on the block's own clock, s: of feeds, or of a journal;
  /// nothing at the end.
  virtual std::optional<double> next_s() const = 0;
  /// Carries out, with forces, the next steps that end by a time, at most so many.
  std::expected<void, std::string> play(double until_s, std::size_t steps);

  /// Returns the tiles whose mesh has changed since the last call; the first time all.
  std::vector<TileIndex> changed();
  /// Returns the mesh of a tile, which must be in the grid, as the block was at the last changed().
  TileMesh mesh(TileIndex tile) const { return mesh_tile(shown_, tile); }
  /// Returns the digest of a tile's columns, likewise, as the server states it beside the mesh.
  std::uint64_t digest(TileIndex tile) const { return column_digest(shown_, tile); }
  virtual std::uint64_t hash() = 0;
  /// Writes the block as a model file into the module's folder.
  std::expected<void, std::string> write(ModelFormat format, const std::string& file);

  /// Return JSON texts for the page (block_json.cpp): what was read and assumed; where the tools
  /// are; the path of the tip.
  virtual std::string about() const = 0;
  virtual std::string progress() const = 0;
  virtual std::string path() const = 0;

 protected:
  PlayedBlock() = default;
  PlayedBlock(PlayedBlock&&) = default;
  PlayedBlock& operator=(PlayedBlock&&) = default;

  virtual SolidSnapshot solid() = 0;
  /// The title of model files.
  virtual std::string title() const = 0;
  /// Marks all tiles of a block that was made.
  void mark_all(const DexelGrid& grid);
  template <class Tiles>
  void mark(const Tiles& tiles) {
    changed_.insert(tiles.begin(), tiles.end());
  }

 private:
  std::set<TileIndex> changed_;  ///< since the last changed()
  SolidSnapshot shown_;          ///< at the last changed()
};

}  // namespace kerf::page
