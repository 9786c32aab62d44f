// SPDX-License-Identifier: Apache-2.0
#include "web/wasm/files/played_block.h"

#include <utility>

namespace kerf::page {

void PlayedBlock::mark_all(const DexelGrid& grid) {
  for (std::int32_t y = 0; y < grid.tiles_y(); ++y)
    for (std::int32_t x = 0; x < grid.tiles_x(); ++x) changed_.insert({x, y});
}

std::expected<void, std::string> PlayedBlock::play(double until_s, std::size_t steps) {
  for (; steps > 0; --steps) {
    const auto next = next_s();
    if (!next || *next > until_s) return {};
    if (auto carved = carve(1, true); !carved) return carved;
  }
  return {};
}

std::vector<TileIndex> PlayedBlock::changed() {
  shown_ = solid();  // first: it may mark tiles
  const std::set<TileIndex> changed = std::exchange(changed_, {});
  return tiles_to_remesh(shown_.fields.front().grid(), {changed.begin(), changed.end()});
}

std::expected<void, std::string> PlayedBlock::write(ModelFormat format, const std::string& file) {
  SnapshotMesh mesh(solid());
  const auto written = write_model(file, mesh, {.format = format, .title = title()});
  if (!written) return std::unexpected(written.error().reason);
  return {};
}

}  // namespace kerf::page
