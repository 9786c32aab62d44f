// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/face_vertex.h"

#include <cmath>

namespace kerf {
namespace {

/// Greatest distance of a vertex on a face from a crossing, in pitches.
constexpr double kFaceOffMax = 0.45;

/// The side, -1 or 1, on which a corner of a quadrangle is relative to its edge, along the two axes
/// that follow the edge's own.
struct Quadrant {
  std::int32_t a, b;
};
constexpr std::array<Quadrant, 4> kAround{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
/// The quadrangles around edges along y begin one corner earlier.
Quadrant quadrant(std::uint8_t axis, std::size_t n) {
  return kAround[(n + (axis == 1 ? 3 : 0)) % 4];
}

LatticeSample moved(LatticeSample s, std::size_t axis, std::int32_t by) {
  s[axis] += by;
  return s;
}

}  // namespace

bool FaceVertices::find(const LatticeEdge& edge, const std::array<std::size_t, 4>& cells,
                        const Corners& corners, OfQuad& between) {
  bool any = false;
  for (std::size_t n = 0; n < 4; ++n) {
    between[n] = after(edge, cells, corners, n);
    any |= between[n].has_value();
  }
  return any;
}

std::optional<SurfaceVertex> FaceVertices::after(const LatticeEdge& edge,
                                                 const std::array<std::size_t, 4>& cells,
                                                 const Corners& corners, std::size_t n) {
  const std::size_t next = (n + 1) % 4;
  if (cells_.sheets(cells[n]).count == 1 && cells_.sheets(cells[next]).count == 1) {
    return std::nullopt;
  }
  const Quadrant from = quadrant(edge.axis, n), to = quadrant(edge.axis, next);
  const bool crosses_a = from.a != to.a;
  const std::size_t across = (edge.axis + (crosses_a ? 1U : 2U)) % 3;
  const std::size_t aside = (edge.axis + (crosses_a ? 2U : 1U)) % 3;
  const bool upwards = crosses_a ? to.a > from.a : to.b > from.b;
  const std::int32_t side = crosses_a ? from.b : from.a;
  // The face has the samples low and high of the edge, and their neighbors.
  const LatticeSample low{edge.i, edge.j, edge.k}, high = moved(low, edge.axis, 1);
  const bool low_solid = solid(low);
  const bool beside_low = solid(moved(low, aside, side)),
             beside_high = solid(moved(high, aside, side));
  bool cuts_low = false;  // the sheet cuts off the low sample from the other three
  if (beside_low == beside_high) {
    cuts_low = beside_low != low_solid;
  } else if (beside_low == low_solid) {
    return std::nullopt;  // it passes between the two edges along the axis
  } else {
    const int face = static_cast<int>(2 * across) + (upwards ? 1 : 0);
    const bool joins_solids = cells_.flipped_face(cells[n]) == face;
    cuts_low = low_solid != joins_solids;
  }
  const LatticeSample cut = cuts_low ? low : high;
  if (passes_near(cut, across, corners[upwards ? n : next], corners[upwards ? next : n])) {
    return std::nullopt;
  }
  // Between the crossings of the two edges at the sample that is cut off.
  const LatticeSample start = side > 0 ? cut : moved(cut, aside, -1);
  SurfaceVertex vertex = placement_.place_on_edge(edge);
  const SurfaceVertex other =
      placement_.place_on_edge({start[0], start[1], start[2], static_cast<std::uint8_t>(aside)});
  vertex.position_mm = edge.axis < aside ? between_crossings(vertex.position_mm, other.position_mm)
                                         : between_crossings(other.position_mm, vertex.position_mm);
  return vertex;
}

FaceVertices::Position FaceVertices::between_crossings(const Position& first,
                                                       const Position& second) const {
  const std::array<double, 3> a = placement_.from_sample({}, first);
  const std::array<double, 3> b = placement_.from_sample({}, second);
  double length2 = 0;
  for (std::size_t c = 0; c < 3; ++c) length2 += (b[c] - a[c]) * (b[c] - a[c]);
  const double share =
      length2 > 4 * kFaceOffMax * kFaceOffMax ? kFaceOffMax / std::sqrt(length2) : 0.5;
  Position p{};
  for (std::size_t c = 0; c < 3; ++c) {
    p[c] = static_cast<float>(double(first[c]) + (double(second[c]) - double(first[c])) * share);
  }
  return p;
}

bool FaceVertices::passes_near(const LatticeSample& sample, std::size_t across,
                               const Position& lower, const Position& upper) const {
  const std::array<double, 3> p = placement_.from_sample(sample, lower);
  const std::array<double, 3> q = placement_.from_sample(sample, upper);
  const double share = p[across] / (p[across] - q[across]);
  std::array<double, 3> away{};
  for (std::size_t c = 0; c < 3; ++c) away[c] = std::abs(p[c] + (q[c] - p[c]) * share);
  return away[(across + 1) % 3] + away[(across + 2) % 3] <= 1;
}

}  // namespace kerf
