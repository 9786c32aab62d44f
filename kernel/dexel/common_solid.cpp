// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/common_solid.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
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

/// Reads a column with its codes, from the bottom up. In a tile without normals, the codes are
/// those of the stock.
void read_coded(const DexelTile& tile, int column, std::vector<CodedDexel>& out) {
  out.clear();
  const ColumnView view = tile.view(column);
  for (std::size_t n = 0; n < view.lower.size(); ++n) {
    out.push_back({view.lower[n], tile.keeps_normals() ? view.lower_codes[n] : EndCodes{}});
  }
  if (view.topmost.bottom < view.topmost.top) out.push_back({view.topmost, view.topmost_codes});
}

/// Both lists are sorted, so one pass finds the intersection.
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

/// Both lists are sorted. Each element of `a` loses the parts that `b` covers.
void subtract_coded(std::span<const CodedDexel> a, std::span<const CodedDexel> b,
                    std::vector<Dexel>& elements, std::vector<EndCodes>& codes) {
  elements.clear();
  codes.clear();
  for (CodedDexel rest : a) {
    for (const CodedDexel& gone : b) {
      if (gone.at.top <= rest.at.bottom || gone.at.bottom >= rest.at.top) continue;
      if (gone.at.bottom > rest.at.bottom) {
        elements.push_back({rest.at.bottom, gone.at.bottom});
        codes.push_back({rest.codes.bottom, gone.codes.bottom});
      }
      rest.at.bottom = gone.at.top;
      rest.codes.bottom = gone.codes.top;
    }
    if (rest.at.bottom >= rest.at.top) continue;
    elements.push_back(rest.at);
    codes.push_back(rest.codes);
  }
}

/// Merges two sorted lists. If both have an element at the same depth, that of `a` is first.
void unite_coded(std::span<const CodedDexel> a, std::span<const CodedDexel> b,
                 std::vector<Dexel>& elements, std::vector<EndCodes>& codes) {
  elements.clear();
  codes.clear();
  for (std::size_t i = 0, j = 0; i < a.size() || j < b.size();) {
    const bool of_a = j == b.size() || (i < a.size() && a[i].at.bottom <= b[j].at.bottom);
    const CodedDexel& next = of_a ? a[i++] : b[j++];
    if (elements.empty() || next.at.bottom > elements.back().top) {
      elements.push_back(next.at);
      codes.push_back(next.codes);
    } else if (next.at.top > elements.back().top || (of_a && next.at.top == elements.back().top)) {
      elements.back().top = next.at.top;
      codes.back().top = next.codes.top;
    }
  }
}

/// Combines two columns, with codes.
using Combine = void (*)(std::span<const CodedDexel>, std::span<const CodedDexel>,
                         std::vector<Dexel>&, std::vector<EndCodes>&);

/// Combines columns of any number of elements.
class SplitColumns {
 public:
  SplitColumns(DexelTile& tile, const DexelTile& other, Combine rule)
      : tile_(tile), other_(other), combine_(rule) {}

  void combine_all() {
    for (int column = 0; column < kTileColumns; ++column) combine(column);
    tile_.update_bounds();
  }
  void combine(int column) {
    read_coded(tile_, column, mine_);
    read_coded(other_, column, others_);
    combine_(mine_, others_, elements_, codes_);
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
  Combine combine_;
  std::vector<CodedDexel> mine_, others_;
  std::vector<Dexel> elements_;
  std::vector<EndCodes> codes_;
};

}  // namespace

void keep_common(DexelTile& tile, const DexelTile& other) {
  SplitColumns split_columns(tile, other, intersect_coded);
  for (int row = 0; row < kTileSide; ++row) {
    const int first = row * kTileSide;
    const auto r = std::size_t(row);
    if ((tile.split[r] | other.split[r]) == 0) {
      keep_common_row(tile, other, std::size_t(first));
      continue;
    }
    for (int c = 0; c < kTileSide; ++c) split_columns.combine(first + c);
  }
  tile.update_bounds();
}

void remove_common(DexelTile& tile, const DexelTile& other) {
  SplitColumns(tile, other, subtract_coded).combine_all();
}

void add_solid(DexelTile& tile, const DexelTile& other) {
  SplitColumns(tile, other, unite_coded).combine_all();
}

std::vector<BoxStock> solid_boxes(const DexelTile& tile, TileIndex at, const DexelGrid& grid) {
  struct Range {
    std::int32_t low = INT32_MAX, high = 0;
  };
  std::array<Range, kTileBlocks> ranges;
  for (int column = 0; column < kTileColumns; ++column) {
    const auto c = std::size_t(column);
    if (tile.bottom[c] >= tile.top[c]) continue;
    const std::int32_t bottom =
        tile.is_split(column) ? tile.lower.of(column).front().bottom : tile.bottom[c];
    const int block = column / (8 * kTileSide) * kTileBlocksAcross + column % kTileSide / 8;
    Range& range = ranges[std::size_t(block)];
    range = {std::min(range.low, bottom), std::max(range.high, tile.top[c])};
  }
  std::vector<BoxStock> boxes;
  for (int block = 0; block < kTileBlocks; ++block) {
    const Range& range = ranges[std::size_t(block)];
    if (range.low >= range.high) continue;
    const std::int32_t i = at.x * kTileSide + block % kTileBlocksAcross * 8;
    const std::int32_t j = at.y * kTileSide + block / kTileBlocksAcross * 8;
    boxes.push_back({{grid.x_mm(i), grid.y_mm(j), grid.z_mm(range.low)},
                     {grid.x_mm(i + 7), grid.y_mm(j + 7), grid.z_mm(range.high)}});
  }
  return boxes;
}

}  // namespace kerf
