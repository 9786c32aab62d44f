// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

#include "kernel/sculpture_result.h"
#include "server/history/stroke_table.h"

namespace kerf {

struct DexelTile;

/// A tile after the motions of an era, without some strokes.
struct EraTile {
  bool is_carved = false;
  std::shared_ptr<const DexelTile> tile = nullptr;  ///< null: whole
  std::vector<StrokeId> without = {};               ///< of those that reach the tile; ascending
  std::uint64_t last = 0;                           ///< record of its last motion
  std::uint64_t used = 0;                           ///< when it was last used
};

/// Caches tiles after eras of equal numbers of records. Eras grow with the journal, so that there
/// are at most kErasMax. Growing clears the cache, because two eras may have been carved without
/// different strokes.
class EraTiles {
 public:
  static constexpr std::uint64_t kErasMax = 64;
  static constexpr std::uint64_t kRecords = 8192;  ///< of an era, initially

  /// Makes eras long enough for so many records.
  void grow(std::uint64_t records);
  /// Records of an era.
  std::uint64_t length() const { return length_; }
  std::size_t era_of(std::uint64_t record) const {
    return static_cast<std::size_t>((record - 1) / length_);
  }
  /// Returns the entry of a tile in an era. The reference is valid until grow() or forget_oldest().
  EraTile& of(FieldTile at, std::size_t era) { return tiles_[at][era]; }
  /// Bytes of all entries, carved or not.
  std::size_t bytes() const;
  /// Forgets the entries that are not carved, then the least recently used ones, until at most so
  /// many bytes remain.
  void forget_oldest(std::size_t bytes);

 private:
  struct TileHash {
    std::size_t operator()(const FieldTile& at) const {
      constexpr std::uint64_t kSpread = 0x9e3779b97f4a7c15;
      const auto x = static_cast<std::uint32_t>(at.tile.x);
      const auto y = static_cast<std::uint32_t>(at.tile.y);
      const auto axis = static_cast<std::uint64_t>(at.axis);
      return static_cast<std::size_t>(((std::uint64_t{x} << 32U | y) ^ axis << 62U) * kSpread >>
                                      20U);
    }
  };
  using Eras = std::map<std::size_t, EraTile>;

  std::uint64_t length_ = kRecords;
  std::unordered_map<FieldTile, Eras, TileHash> tiles_;
};

}  // namespace kerf
