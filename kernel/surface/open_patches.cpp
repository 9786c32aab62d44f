// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/open_patches.h"

#include <algorithm>
#include <limits>

namespace kerf {

std::optional<StockFace> OpenPatches::side_between(std::int32_t i, std::int32_t j,
                                                   bool along_x) const {
  const std::uint8_t axis = along_x ? 0 : 1;
  if (cover_ == nullptr || !cover_->is_active({axis, false})) return std::nullopt;
  const std::int32_t at = along_x ? i : j;
  if (at == -1) return StockFace{axis, false};
  if (at == (along_x ? columns_x_ : columns_y_) - 1) return StockFace{axis, true};
  return std::nullopt;
}

bool OpenPatches::is_covered_at(StockFace side, std::int32_t sample) const {
  const std::int32_t n = sample / kTileSide;
  return side.axis == 0 ? is_covered(side, tile_.y, n) : is_covered(side, n, tile_.x);
}

OpenPatches::Samples OpenPatches::next(const std::optional<StockFace>& side, std::int32_t first,
                                       std::int32_t end) const {
  if (!side) return {first, end};
  const auto skip = [&](std::int32_t from, bool covered) {
    while (from < end && is_covered_at(*side, from) == covered) {
      from = std::min(end, (from / kTileSide + 1) * kTileSide);
    }
    return from;
  };
  const std::int32_t open = skip(first, true);
  return {open, skip(open, false)};
}

NextLayer OpenPatches::next_layer() const {
  if (cover_ == nullptr) return {};
  return [this](const LatticeCell& cell) {
    const std::int32_t samples = cover_->quads()[2];
    std::int32_t layer = std::numeric_limits<std::int32_t>::max();
    bool at_side = false;
    for (const bool along_x : {true, false}) {
      const auto side = side_between(cell.x, cell.y, along_x);
      if (!side) continue;
      at_side = true;
      // A cell has quadrangles of the samples below and above it.
      const std::int32_t open = next(side, cell.layer - 1, samples).first;
      if (open < samples) layer = std::min(layer, std::max(open, cell.layer));
    }
    return at_side ? layer : cell.layer;
  };
}

}  // namespace kerf
