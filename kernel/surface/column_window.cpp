// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/column_window.h"

#include <cmath>

namespace kerf {
namespace {

/// Sine of the angle (0.2 degrees) below which a ray counts as parallel to the surface at its end.
constexpr double kGrazing = 0.0035;

/// Returns the height of sample 0, in steps above the block's lowest plane.
double height_of_first_sample(const SolidSnapshot& solid) {
  const DexelGrid& grid = solid.grid();
  const double where_rays_meet = 0.5;
  const double quanta = std::floor(where_rays_meet * grid.pitch_mm / grid.z_quantum_mm + 0.5);
  const bool sampled = quanta < grid.height_quanta;
  return solid.fields.size() == 3 && sampled ? where_rays_meet : 0;
}

}  // namespace

ColumnWindow::ColumnWindow(const SolidSnapshot& solid, std::int32_t first_x, std::int32_t first_y,
                           std::int32_t side)
    : grid_(solid.fields.front().grid()),
      quanta_per_step_(grid_.pitch_mm / grid_.z_quantum_mm),
      level_zero_(height_of_first_sample(solid)),
      first_x_(first_x),
      first_y_(first_y),
      side_(side) {
  const auto columns = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  start_.reserve(columns + 1);
  runs_->reserve(columns * 2);
  for (std::int32_t j = first_y; j < first_y + side; ++j) {
    for (std::int32_t i = first_x; i < first_x + side; ++i) {
      start_.push_back(static_cast<std::uint32_t>(runs_->size()));
      if (in_grid(i, j)) append_column(solid.fields.front(), i, j);
    }
  }
  start_.push_back(static_cast<std::uint32_t>(runs_->size()));
}

/// Returns the normal at an end. A ray that ends on a wall parallel to it ends where the wall does,
/// so the surface there is taken to be horizontal.
Vec3 ColumnWindow::end_normal(const DexelSnapshot& field, std::int32_t i, std::int32_t j,
                              std::int32_t depth, bool top, NormalCode code) {
  const Vec3 normal = field.normal(i, j, depth, top, code);
  return std::abs(normal.z) < kGrazing ? Vec3{0, 0, top ? 1.0 : -1.0} : normal;
}

void ColumnWindow::append_column(const DexelSnapshot& field, std::int32_t i, std::int32_t j) {
  const ColumnView view = field.view(i, j);
  const auto append = [&](const Dexel& d, const EndCodes& codes) {
    append_run({first_sample_at_or_above(d.bottom), first_sample_at_or_above(d.top), d.bottom,
                d.top, end_normal(field, i, j, d.bottom, false, codes.bottom),
                end_normal(field, i, j, d.top, true, codes.top),
                field.is_original(i, j, d.bottom, false, codes.bottom),
                field.is_original(i, j, d.top, true, codes.top)});
  };
  for (std::size_t n = 0; n < view.lower.size(); ++n) {
    append(view.lower[n], view.lower_codes.empty() ? EndCodes{} : view.lower_codes[n]);
  }
  if (view.topmost.bottom < view.topmost.top) append(view.topmost, view.topmost_codes);
}

void ColumnWindow::append_run(const SolidRun& run) {
  if (run.first == run.end) return;  // thinner than the lattice: it contains no sample
  if (runs_->size() > start_.back() && runs_->back().end == run.first) {
    runs_->back().end = run.end;  // the gap contains no sample
    runs_->back().top = run.top;
    runs_->back().top_normal = run.top_normal;
    runs_->back().top_original = run.top_original;
  } else {
    runs_->push_back(run);
  }
}

/// Searches at most a few steps from steps(height), which is exact to rounding. A step has at least
/// 2^10 quanta, since a block with a surface has at most 2^20 pitches (kSurfacePitchesMax).
std::int32_t ColumnWindow::first_sample_at_or_above(std::int32_t height) const {
  auto sample = static_cast<std::int32_t>(steps(height));
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

}  // namespace kerf
