// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/cut.h"

#include <vector>

#include "kernel/cut/tile_cutter.h"

namespace kerf {
namespace {

void cut_each(DexelField& field, const SweptTool& swept, NormalCode end_code,
              std::span<const TileIndex> tiles, Removal& removal) {
  RemovedPart& removed = removal.start(1).front();
  TileCutter cutter;
  for (const TileIndex tile : tiles) {
    cutter.begin(field, tile);
    cutter.cut(swept, end_code, removed);
  }
  cutter.put_tiles();
}

}  // namespace

std::int64_t cut(DexelField& field, const SweptTool& swept, Removal& removal) {
  std::vector<TileIndex> tiles;
  const ReachSize reach = find_tiles(field.grid(), swept, {}, tiles);
  cut_each(field, swept, kStockNormal, tiles, removal);
  return reach.tiles;
}

std::int64_t cut(DexelField& field, LazyNormals& normals, const Tool& tool, const SubMotion& part,
                 Removal& removal, TileRun run) {
  std::vector<TileIndex> tiles;
  const ReachSize reach = find_tiles(field.grid(), part.swept, run, tiles);
  cut_tiles(field, normals, tool, part, tiles, removal);
  return reach.tiles;
}

void cut_tiles(DexelField& field, LazyNormals& normals, const Tool& tool, const SubMotion& part,
               std::span<const TileIndex> tiles, Removal& removal) {
  const NormalCode end_code = normals.add_sweep(field, tool, part.motion);
  cut_each(field, part.swept, end_code, tiles, removal);
  for (const RemovedPart& removed : removal.parts()) {
    for (const RemovedPart::Tile& tile : removed.tiles) normals.add_tile(tile.index);
  }
}

}  // namespace kerf
