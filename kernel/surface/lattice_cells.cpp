// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/lattice_cells.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace kerf {
namespace {

constexpr std::int32_t kNever = std::numeric_limits<std::int32_t>::max();

/// Iterates upwards over a column's changes between empty and solid samples.
class RunCursor {
 public:
  explicit RunCursor(std::span<const SolidRun> runs) : runs_(runs) {}
  /// Returns the next sample that differs from the one below it, or kNever.
  std::int32_t next() const {
    const std::size_t run = position_ / 2;
    if (run >= runs_.size()) return kNever;
    return position_ % 2 == 0 ? runs_[run].first : runs_[run].end;
  }
  void advance() { ++position_; }

 private:
  std::span<const SolidRun> runs_;
  std::size_t position_ = 0;
};

}  // namespace

LatticeCells::LatticeCells(const ColumnWindow& window, std::int32_t first_x, std::int32_t first_y,
                           std::int32_t side, const NextLayer& next_needed)
    : window_(window), first_x_(first_x), first_y_(first_y), side_(side) {
  const auto columns = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  start_.reserve(columns + 1);
  layer_.reserve(3 * columns);
  configuration_.reserve(3 * columns);
  flipped_.reserve(3 * columns);
  for (std::int32_t y = first_y; y < first_y + side; ++y) {
    for (std::int32_t x = first_x; x < first_x + side; ++x) {
      start_.push_back(static_cast<std::uint32_t>(layer_.size()));
      append_cells(x, y, next_needed);
    }
  }
  start_.push_back(static_cast<std::uint32_t>(layer_.size()));
}

void LatticeCells::append_cells(std::int32_t x, std::int32_t y, const NextLayer& next_needed) {
  std::array<RunCursor, 4> cursors{RunCursor(window_.runs(x, y)), RunCursor(window_.runs(x + 1, y)),
                                   RunCursor(window_.runs(x, y + 1)),
                                   RunCursor(window_.runs(x + 1, y + 1))};
  unsigned below = 0;  // corners that are solid at the sample under the next change
  const auto next_change = [&cursors] {
    return std::min({cursors[0].next(), cursors[1].next(), cursors[2].next(), cursors[3].next()});
  };
  for (std::int32_t layer = next_change(); layer != kNever;) {
    unsigned above = below;
    for (unsigned c = 0; c < 4; ++c) {
      if (cursors[c].next() != layer) continue;
      above ^= 1U << c;
      cursors[c].advance();
    }
    append_cell(x, y, layer, static_cast<std::uint8_t>(below | above << 4));
    below = above;
    const std::int32_t next = next_change();
    if (below != 0 && below != 15) {
      const auto needed = [&](std::int32_t from) {
        return next_needed ? next_needed({x, y, from}) : from;
      };
      for (layer = needed(layer + 1); layer < next; layer = needed(layer + 1)) {
        append_cell(x, y, layer, static_cast<std::uint8_t>(below | below << 4));
      }
    }
    layer = next;
  }
}

void LatticeCells::append_cell(std::int32_t x, std::int32_t y, std::int32_t layer,
                               std::uint8_t configuration) {
  layer_.push_back(layer);
  configuration_.push_back(configuration);
  flipped_.push_back(must_flip({x, y, layer}, configuration));
}

bool LatticeCells::must_flip(const LatticeCell& cell, std::uint8_t configuration) const {
  const int face = sheets_of(configuration).doubled_face;
  if (face < 0) return false;
  LatticeCell beyond = cell;
  (face < 2 ? beyond.x : face < 4 ? beyond.y : beyond.layer) += face % 2 == 0 ? -1 : 1;
  return sheets_of(cell_configuration(window_, beyond)).doubled_face == (face ^ 1);
}

std::size_t LatticeCells::find(std::int32_t x, std::int32_t y, std::int32_t layer) const {
  const std::size_t n = static_cast<std::size_t>(y - first_y_) * static_cast<std::size_t>(side_) +
                        static_cast<std::size_t>(x - first_x_);
  const auto first = layer_.begin() + std::ptrdiff_t(start_[n]);
  const auto last = layer_.begin() + std::ptrdiff_t(start_[n + 1]);
  const auto found = std::lower_bound(first, last, layer);
  assert(found != last && *found == layer);
  return static_cast<std::size_t>(found - layer_.begin());
}

}  // namespace kerf
