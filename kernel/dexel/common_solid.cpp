// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/common_solid.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "kernel/dexel/dexel_tile.h"

namespace kerf {
namespace {

/// An element with the codes of its ends.
struct CodedDexel {
  Dexel at;
  EndCodes codes;
};

/// Reads a column with its codes, from the bottom up; codes are those of the stock in a tile that
/// keeps no normals.
void read_coded(const DexelTile& tile, int column, std::vector<CodedDexel>& out) {
  out.clear();
  const ColumnView view = tile.view(column);
  for (std::size_t n = 0; n < view.lower.size(); ++n) {
    out.push_back({view.lower[n], tile.keeps_normals() ? view.lower_codes[n] : EndCodes{}});
  }
  if (view.topmost.bottom < view.topmost.top) out.push_back({view.topmost, view.topmost_codes});
}

/// Both are sorted, so one pass finds the intersection.
void intersect_coded(std::span<const CodedDexel> a, std::span<const CodedDexel> b,
                     std::vector<Dexel>& elements, std::vector<EndCodes>& codes) {
  elements.clear();
  codes.clear();
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const bool bottom_of_a = a[i].at.bottom >= b[j].at.bottom;
    const bool top_of_a = a[i].at.top <= b[j].at.top;
    const Dexel common{bottom_of_a ? a[i].at.bottom : b[j].at.bottom,
                       top_of_a ? a[i].at.top : b[j].at.top};
    if (common.bottom < common.top) {
      elements.push_back(common);
      codes.push_back({bottom_of_a ? a[i].codes.bottom : b[j].codes.bottom,
                       top_of_a ? a[i].codes.top : b[j].codes.top});
    }
    (a[i].at.top < b[j].at.top ? i : j) += 1;
  }
}

/// Intersects the columns of a row in which neither tile has lower elements.
void keep_common_row(DexelTile& tile, const DexelTile& other, std::size_t first) {
  const bool coded = tile.keeps_normals();
  for (std::size_t c = first; c < first + kTileSide; ++c) {
    const bool bottom_of_tile = tile.bottom[c] >= other.bottom[c];
    const bool top_of_tile = tile.top[c] <= other.top[c];
    const std::int32_t bottom = bottom_of_tile ? tile.bottom[c] : other.bottom[c];
    const std::int32_t top = top_of_tile ? tile.top[c] : other.top[c];
    const bool any = bottom < top;
    tile.bottom[c] = any ? bottom : 0;
    tile.top[c] = any ? top : 0;
    if (!coded) continue;
    if (!bottom_of_tile) tile.topmost_codes[c].bottom = other.topmost_codes[c].bottom;
    if (!top_of_tile) tile.topmost_codes[c].top = other.topmost_codes[c].top;
  }
}

/// Intersects columns of several elements.
class SplitColumns {
 public:
  SplitColumns(DexelTile& tile, const DexelTile& other) : tile_(tile), other_(other) {}

  void keep_common(int column) {
    read_coded(tile_, column, mine_);
    read_coded(other_, column, others_);
    intersect_coded(mine_, others_, elements_, codes_);
    tile_.write(column, elements_);
    if (!tile_.keeps_normals() || codes_.empty()) return;
    tile_.topmost_codes[std::size_t(column)] = codes_.back();
    if (!tile_.is_split(column)) return;
    std::ranges::copy(std::span(codes_).first(codes_.size() - 1),
                      tile_.lower_codes.edit(column).begin());
  }

 private:
  DexelTile& tile_;
  const DexelTile& other_;
  std::vector<CodedDexel> mine_, others_;
  std::vector<Dexel> elements_;
  std::vector<EndCodes> codes_;
};

}  // namespace

void keep_common(DexelTile& tile, const DexelTile& other) {
  SplitColumns split_columns(tile, other);
  for (int row = 0; row < kTileSide; ++row) {
    const int first = row * kTileSide;
    const auto r = std::size_t(row);
    if ((tile.split[r] | other.split[r]) == 0) {
      keep_common_row(tile, other, std::size_t(first));
      continue;
    }
    for (int c = 0; c < kTileSide; ++c) split_columns.keep_common(first + c);
  }
  tile.update_bounds();
}

}  // namespace kerf
