// SPDX-License-Identifier: Apache-2.0
#include "server/feed/tile_runs.h"

#include <cmath>
#include <map>
#include <optional>

namespace kerf {
namespace {

/// Greatest deviation of a tile's position in a run, in steps, from rounding. A step is about 1/256
/// of the pitch.
constexpr double kPlaceSteps = 1.0 / 64;

class Runs {
 public:
  Runs(std::span<const EncodedTile* const> tiles, const MeshQuantization& quantization,
       bool same_digests)
      : tiles_(tiles),
        quantization_(quantization),
        same_digests_(same_digests),
        is_taken_(tiles.size()) {
    for (std::size_t n = 0; n < tiles.size(); ++n) numbers_[tiles[n]->tile] = n;
  }

  std::vector<TileRun> find() {
    std::vector<TileRun> runs;
    for (std::size_t n = 0; n < tiles_.size(); ++n) {
      if (is_taken_[n]) continue;
      TileRun run{n};
      while (continues(n, run.columns, 0)) ++run.columns;
      while (row_continues(run)) ++run.rows;
      take(run);
      runs.push_back(run);
    }
    return runs;
  }

 private:
  std::optional<std::size_t> number_of(std::size_t first, std::int32_t i, std::int32_t j) const {
    const TileIndex tile = tiles_[first]->tile;
    const auto found = numbers_.find({tile.x + i, tile.y + j});
    if (found == numbers_.end() || is_taken_[found->second]) return std::nullopt;
    return found->second;
  }

  bool continues(std::size_t first, std::int32_t i, std::int32_t j) const {
    const auto number = number_of(first, i, j);
    if (!number) return false;
    const EncodedTile& one = *tiles_[first];
    const EncodedTile& other = *tiles_[*number];
    if (same_digests_ && other.digest != one.digest) return false;
    return other.version == one.version && other.level == one.level &&
           other.shape_hash == one.shape_hash && other.has_shape_of(one) &&
           (one.vertices == 0 || is_moved_by(one, other, i, j));
  }

  bool is_moved_by(const EncodedTile& one, const EncodedTile& other, std::int32_t i,
                   std::int32_t j) const {
    const std::array<double, 3> move{i * quantization_.tile_mm, j * quantization_.tile_mm, 0};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double off = other.translation_mm[axis] - one.translation_mm[axis] - move[axis];
      if (std::abs(off) > kPlaceSteps * quantization_.step_mm) return false;
    }
    return true;
  }

  bool row_continues(const TileRun& run) const {
    for (std::int32_t i = 0; i < run.columns; ++i) {
      if (!continues(run.first, i, run.rows)) return false;
    }
    return true;
  }

  void take(const TileRun& run) {
    for (std::int32_t j = 0; j < run.rows; ++j) {
      for (std::int32_t i = 0; i < run.columns; ++i) {
        if (const auto number = number_of(run.first, i, j)) is_taken_[*number] = true;
      }
    }
  }

  std::span<const EncodedTile* const> tiles_;
  const MeshQuantization& quantization_;
  const bool same_digests_;
  std::map<TileIndex, std::size_t> numbers_;
  std::vector<bool> is_taken_;
};

}  // namespace

std::vector<TileRun> runs_of(std::span<const EncodedTile* const> tiles,
                             const MeshQuantization& quantization, bool same_digests) {
  return Runs(tiles, quantization, same_digests).find();
}

}  // namespace kerf
