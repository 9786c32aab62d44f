#include "kernel/cut/end_normals.h"

#include <bit>

#include "kernel/dexel/tile_index.h"

namespace kerf {
namespace {

/// Gives the ends of one kind of eight neighbouring columns their normals. `code_of(c)` is where
/// column c's is kept; only columns with a bit in `ends` have one.
template <class CodeOf>
void note_ends(const RemovedGroup& group, const std::int32_t* depths, unsigned ends, double towards,
               const DexelGrid& grid, const SweptSurface& surface, const CodeOf& code_of) {
  if (ends == 0) return;
  const Lanes places(HalfLanes{0.5, 1.5, 2.5, 3.5}, HalfLanes{4.5, 5.5, 6.5, 7.5});
  Vec3Lanes at{
      grid.origin_mm.x + (double(group.i) + places) * grid.pitch_mm, Lanes(grid.y_mm(group.j)), {}};
  for (int c = 0; c < kLanes; ++c) at.z.set(c, grid.z_mm(depths[c]));
  NormalCode codes[kLanes];
  surface.stock_normals(at, ends, towards, codes);
  for (unsigned left = ends; left != 0; left &= left - 1) {
    const int c = std::countr_zero(left);
    *code_of(c) = codes[c];
  }
}

/// Columns whose topmost element now has its top (bottom) where the removed one began (ended).
struct NewEnds {
  unsigned tops = 0, bottoms = 0;
};
NewEnds new_ends(const DexelTile& tile, std::size_t first, const RemovedGroup& group) {
  NewEnds ends;
  for (unsigned c = 0; c < kLanes; ++c) {
    const std::int32_t bottom = tile.bottom[first + c], top = tile.top[first + c];
    const bool any = (group.bottom[c] < group.top[c]) & (bottom < top);
    ends.tops |= unsigned(any & (top == group.bottom[c])) << c;
    ends.bottoms |= unsigned(any & (bottom == group.top[c])) << c;
  }
  return ends;
}

}  // namespace

void note_normals(DexelTile& tile, const DexelGrid& grid, std::span<const RemovedGroup> removed,
                  const SweptSurface& surface) {
  for (const RemovedGroup& group : removed) {
    const std::int32_t row = group.j % kTileSide;
    const int first = row * kTileSide + group.i % kTileSide;
    const NewEnds topmost = new_ends(tile, std::size_t(first), group);
    const auto element = [&](int c) { return &tile.topmost_codes[std::size_t(first + c)]; };
    note_ends(group, group.bottom, topmost.tops, 1, grid, surface,
              [&](int c) { return &element(c)->top; });
    note_ends(group, group.top, topmost.bottoms, -1, grid, surface,
              [&](int c) { return &element(c)->bottom; });
    const unsigned split = tile.split[std::size_t(row)] >> (group.i % kTileSide) & 0xFFU;
    if (split == 0) continue;
    NormalCode *tops[kLanes] = {}, *bottoms[kLanes] = {};
    NewEnds lower;
    for (int c = 0; c < kLanes; ++c) {
      if ((split >> c & 1) == 0 || group.bottom[c] >= group.top[c]) continue;
      tops[c] = tile.lower_top_code(first + c, group.bottom[c]);
      bottoms[c] = tile.lower_bottom_code(first + c, group.top[c]);
      lower.tops |= unsigned(tops[c] != nullptr) << c;
      lower.bottoms |= unsigned(bottoms[c] != nullptr) << c;
    }
    note_ends(group, group.bottom, lower.tops, 1, grid, surface, [&](int c) { return tops[c]; });
    note_ends(group, group.top, lower.bottoms, -1, grid, surface,
              [&](int c) { return bottoms[c]; });
  }
}

}  // namespace kerf
