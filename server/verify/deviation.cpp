// SPDX-License-Identifier: Apache-2.0
#include "server/verify/deviation.h"

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

/// Queries a reference for consecutive points. Each result is the hint of the next query.
class DistanceProbe {
 public:
  explicit DistanceProbe(const MeshDistance& reference) : reference_(reference) {}
  double operator()(Vec3 point_mm) { return reference_.signed_distance_mm(point_mm, near_); }

 private:
  const MeshDistance& reference_;
  std::uint32_t near_ = 0;
};

/// Samples triangles and shows each sample to a visitor.
class TriangleSampler {
 public:
  TriangleSampler(DistanceProbe& probe, double spacing_mm, DeviationVisitor& visitor)
      : probe_(probe), area_max_mm2_(spacing_mm * spacing_mm), visitor_(visitor) {}

  void sample(const std::array<Vec3, 3>& corners) {
    normal_ = normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
    divide(corners, 0);
  }

 private:
  /// Bisects a triangle across its longest side until no part is larger than a square of the
  /// spacing, and samples each part at its centroid. The number of samples is proportional to the
  /// area, also for slivers.
  void divide(const std::array<Vec3, 3>& corners, int halvings) {
    const auto [a, b, c] = corners;
    const double area = 0.5 * length(cross(b - a, c - a));
    if (area <= area_max_mm2_ || halvings == kHalvingsMax) {
      const Vec3 middle = (a + b + c) * (1.0 / 3);
      visitor_.sample(middle, normal_, {probe_(middle), area});
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
    divide({from, middle, apex}, halvings + 1);
    divide({middle, to, apex}, halvings + 1);
  }

  DistanceProbe& probe_;
  double area_max_mm2_;
  DeviationVisitor& visitor_;
  Vec3 normal_;
};

Vec3 vector_of(const std::array<float, 3>& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

/// Collects the result of measure_deviation().
class DeviationCollector final : public DeviationVisitor {
 public:
  void vertex(Vec3, Vec3, double mm) override { of_vertex_mm.push_back(static_cast<float>(mm)); }
  void sample(Vec3, Vec3, DistanceSample distance) override { samples.push_back(distance); }

  std::vector<float> of_vertex_mm;
  std::vector<DistanceSample> samples;
};

}  // namespace

void visit_deviation(MeshSource& surface, const MeshDistance& reference, double spacing_mm,
                     DeviationVisitor& visitor, const std::function<void(double)>& progress,
                     const std::stop_token& stop) {
  DistanceProbe probe(reference);
  TriangleSampler sampler(probe, spacing_mm, visitor);
  std::vector<Vec3> points;
  for (MeshPiece piece; !stop.stop_requested() && surface.next(piece);) {
    points.clear();
    for (std::size_t n = 0; n < piece.positions_mm.size(); ++n) {
      points.push_back(surface.origin_mm() + vector_of(piece.positions_mm[n]));
      visitor.vertex(points.back(), vector_of(piece.normals[n]), probe(points.back()));
    }
    for (std::size_t t = 0; t + 2 < piece.indices.size(); t += 3) {
      sampler.sample(
          {points[piece.indices[t]], points[piece.indices[t + 1]], points[piece.indices[t + 2]]});
    }
    if (progress) progress(surface.share());
  }
}

Deviation measure_deviation(MeshSource& surface, const MeshDistance& reference, double spacing_mm,
                            const std::function<void(double)>& progress,
                            const std::stop_token& stop) {
  DeviationCollector collector;
  visit_deviation(surface, reference, spacing_mm, collector, progress, stop);
  return {std::move(collector.of_vertex_mm), distance_figures(std::move(collector.samples))};
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
