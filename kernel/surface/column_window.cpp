#include "kernel/surface/column_window.h"

#include <cstdlib>

namespace kerf {

ColumnWindow::ColumnWindow(const DexelSnapshot& snapshot, std::int32_t first_x,
                           std::int32_t first_y, std::int32_t side)
    : grid_(snapshot.grid()),
      quanta_per_step_(grid_.pitch_mm / grid_.z_quantum_mm),
      first_x_(first_x),
      first_y_(first_y),
      side_(side) {
  const auto columns = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  start_.reserve(columns + 1);
  runs_.reserve(columns * 2);
  std::vector<Dexel> scratch;
  for (std::int32_t j = first_y; j < first_y + side; ++j) {
    for (std::int32_t i = first_x; i < first_x + side; ++i) {
      start_.push_back(static_cast<std::uint32_t>(runs_.size()));
      if (in_grid(i, j)) append_column(snapshot.column(i, j, scratch));
    }
  }
  start_.push_back(static_cast<std::uint32_t>(runs_.size()));
}

void ColumnWindow::append_column(std::span<const Dexel> dexels) {
  for (const Dexel& dexel : dexels) {
    const SolidRun run{first_sample_at_or_above(dexel.bottom), first_sample_at_or_above(dexel.top),
                       dexel.bottom, dexel.top};
    if (run.first == run.end) continue;  // thinner than the lattice: no sample sees it
    if (runs_.size() > start_.back() && runs_.back().end == run.first) {
      runs_.back().end = run.end;  // no sample sees the gap
      runs_.back().top = run.top;
    } else {
      runs_.push_back(run);
    }
  }
}

std::int32_t ColumnWindow::first_sample_at_or_above(std::int32_t height) const {
  auto sample = static_cast<std::int32_t>(height / quanta_per_step_);
  while (level(sample) < height) ++sample;
  while (level(sample - 1) >= height) --sample;
  return sample;
}

bool ColumnWindow::solid(std::int32_t i, std::int32_t j, std::int32_t sample) const {
  for (const SolidRun& run : runs(i, j)) {
    if (sample < run.end) return sample >= run.first;
  }
  return false;
}

std::optional<std::int32_t> ColumnWindow::nearest_end(std::int32_t i, std::int32_t j, DexelEnd kind,
                                                      std::int32_t height) const {
  std::optional<std::int32_t> nearest;
  for (const SolidRun& run : runs(i, j)) {
    const std::int32_t end = kind == DexelEnd::kTop ? run.top : run.bottom;
    if (!nearest || std::abs(end - height) < std::abs(*nearest - height)) nearest = end;
  }
  return nearest;
}

}  // namespace kerf
