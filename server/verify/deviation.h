// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "server/formats/model/mesh_distance.h"
#include "server/formats/model/mesh_source.h"
#include "server/verify/distance_figures.h"

namespace kerf {

/// Signed distance of each vertex of a surface from a reference: positive where material was left,
/// negative where too much was removed.
struct Deviation {
  std::vector<float> of_vertex_mm;  ///< in the order of the source
  DistanceFigures figures;          ///< of samples over the whole surface, weighted by area
};

/// Receives signed distances of a surface from a reference.
class DeviationVisitor {
 public:
  virtual ~DeviationVisitor() = default;
  /// A vertex with its unit normal, in the order of the source, and its distance.
  virtual void vertex(Vec3 at_mm, Vec3 normal, double mm) = 0;
  /// A point inside a triangle with that triangle's unit normal, its distance and the area that it
  /// represents, mm².
  virtual void sample(Vec3 at_mm, Vec3 normal, DistanceSample distance) = 0;
};

/// Measures a surface against a reference at every vertex, and at points inside its triangles at
/// most about `spacing_mm` apart, so that large triangles count as much as many small ones. Ends
/// early if a stop is requested.
void visit_deviation(MeshSource& surface, const MeshDistance& reference, double spacing_mm,
                     DeviationVisitor& visitor, const std::function<void(double)>& progress = {},
                     const std::stop_token& stop = {});

/// Measures a surface against a reference at every vertex, and for the figures like
/// visit_deviation. Ends early, with the figures of part of the surface, if a stop is requested.
Deviation measure_deviation(MeshSource& surface, const MeshDistance& reference, double spacing_mm,
                            const std::function<void(double)>& progress = {},
                            const std::stop_token& stop = {});

/// A surface colored by its deviation: from blue (-range_mm and below) through white (0) to red
/// (range_mm and above).
class DeviationMesh final : public MeshSource {
 public:
  /// `deviation` must have been measured on an equal source and must outlive this object.
  DeviationMesh(std::unique_ptr<MeshSource> surface, const Deviation& deviation, double range_mm)
      : surface_(std::move(surface)), deviation_(deviation), range_mm_(range_mm) {}
  Vec3 origin_mm() const override { return surface_->origin_mm(); }
  Vec3 size_mm() const override { return surface_->size_mm(); }
  bool next(MeshPiece& piece) override;
  double share() const override { return surface_->share(); }

 private:
  std::unique_ptr<MeshSource> surface_;
  const Deviation& deviation_;
  double range_mm_;
  std::size_t next_vertex_ = 0;
};

}  // namespace kerf
