// SPDX-License-Identifier: Apache-2.0
#include "server/carve/deviation.h"

#include <algorithm>
#include <cmath>

namespace kerf {
namespace {

/// Limit of 2^20 samples per triangle.
constexpr int kHalvingsMax = 20;

using Rgb = std::array<std::uint8_t, 3>;
constexpr Rgb kBelow{33, 102, 172}, kZero{247, 247, 247}, kAbove{178, 24, 43};

std::uint8_t mixed(std::uint8_t from, std::uint8_t to, double share) {
  return static_cast<std::uint8_t>(from + (to - from) * share + 0.5);
}

Rgb color_of(double mm, double range_mm) {
  const double share = std::clamp(std::abs(mm) / range_mm, 0.0, 1.0);
  const Rgb& end = mm < 0 ? kBelow : kAbove;
  return {mixed(kZero[0], end[0], share), mixed(kZero[1], end[1], share),
          mixed(kZero[2], end[2], share)};
}

/// Queries a reference for consecutive points; each result is the hint of the next query.
class Probe {
 public:
  explicit Probe(const MeshDistance& reference) : reference_(reference) {}
  double operator()(Vec3 point_mm) { return reference_.signed_distance_mm(point_mm, near_); }

 private:
  const MeshDistance& reference_;
  std::uint32_t near_ = 0;
};

/// Bisects a triangle across its longest side until no part is larger than a square of the spacing,
/// and samples each part at its centroid. The number of samples is proportional to the area, also
/// for slivers.
void sample_triangle(const std::array<Vec3, 3>& corners, double spacing_mm, int halvings,
                     Probe& probe, std::vector<DistanceSample>& samples) {
  const auto [a, b, c] = corners;
  const double area = 0.5 * length(cross(b - a, c - a));
  if (area <= spacing_mm * spacing_mm || halvings == kHalvingsMax) {
    samples.push_back({probe((a + b + c) * (1.0 / 3)), area});
    return;
  }
  std::size_t longest = 0;
  double longest_mm = 0;
  for (std::size_t n = 0; n < 3; ++n) {
    const double mm = length(corners[(n + 1) % 3] - corners[n]);
    if (mm > longest_mm) longest = n, longest_mm = mm;
  }
  const Vec3 from = corners[longest], to = corners[(longest + 1) % 3];
  const Vec3 apex = corners[(longest + 2) % 3], middle = (from + to) * 0.5;
  sample_triangle({from, middle, apex}, spacing_mm, halvings + 1, probe, samples);
  sample_triangle({middle, to, apex}, spacing_mm, halvings + 1, probe, samples);
}

}  // namespace

Deviation measure_deviation(MeshSource& surface, const MeshDistance& reference, double spacing_mm,
                            const std::function<void(double)>& progress,
                            const std::stop_token& stop) {
  Deviation deviation;
  std::vector<DistanceSample> samples;
  Probe probe(reference);
  std::vector<Vec3> points;
  for (MeshPiece piece; !stop.stop_requested() && surface.next(piece);) {
    points.clear();
    for (const auto& p : piece.positions_mm) {
      points.push_back(surface.origin_mm() + Vec3{double(p[0]), double(p[1]), double(p[2])});
      deviation.of_vertex_mm.push_back(static_cast<float>(probe(points.back())));
    }
    for (std::size_t t = 0; t + 2 < piece.indices.size(); t += 3) {
      sample_triangle(
          {points[piece.indices[t]], points[piece.indices[t + 1]], points[piece.indices[t + 2]]},
          spacing_mm, 0, probe, samples);
    }
    if (progress) progress(surface.share());
  }
  deviation.figures = distance_figures(std::move(samples));
  return deviation;
}

bool DeviationMesh::next(MeshPiece& piece) {
  if (!surface_->next(piece)) return false;
  for (std::size_t n = 0; n < piece.positions_mm.size(); ++n) {
    const float mm = deviation_.of_vertex_mm.at(next_vertex_++);
    piece.deviations_mm.push_back(mm);
    piece.colors.push_back(color_of(static_cast<double>(mm), range_mm_));
  }
  return true;
}

}  // namespace kerf
