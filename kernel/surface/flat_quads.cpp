// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/flat_quads.h"

#include <algorithm>
#include <limits>
#include <span>

namespace kerf {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
/// Rectangles that save fewer triangles than this are not merged.
constexpr std::int64_t kSavingMin = 6;
/// Greatest number of rectangles tried per plane. The remainder is ragged and saves little.
constexpr int kRectanglesMax = 48;

struct Rectangle {
  std::int32_t u = 0, v = 0, width = 0, height = 0;
  /// Returns the number of triangles saved: a quadrangle has two, a merged rectangle a fan with one
  /// per edge of its rim.
  std::int64_t saving() const {
    if (width < 2 || height < 2) return 0;
    return 2 * std::int64_t{width} * height - 2 * (std::int64_t{width} + height);
  }
};

void append_triangle(std::vector<std::uint32_t>& indices, bool reversed, std::uint32_t a,
                     std::uint32_t b, std::uint32_t c) {
  if (reversed) std::swap(b, c);
  indices.insert(indices.end(), {a, b, c});
}

}  // namespace

/// The quadrangles of one plane, indexed by position.
class FlatQuads::Grid {
 public:
  Grid(std::span<const Quad> quads, const FlatPlane& plane,
       std::span<const std::array<float, 3>> positions)
      : quads_(quads), plane_(plane), positions_(positions), merged_(quads.size(), false) {
    first_u_ = last_u_ = quads[0].u;
    first_v_ = last_v_ = quads[0].v;
    for (const Quad& quad : quads) {
      first_u_ = std::min(first_u_, quad.u);
      last_u_ = std::max(last_u_, quad.u);
      first_v_ = std::min(first_v_, quad.v);
      last_v_ = std::max(last_v_, quad.v);
    }
    width_ = last_u_ - first_u_ + 1;
    height_ = last_v_ - first_v_ + 1;
    at_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), kNone);
    for (std::size_t n = 0; n < quads.size(); ++n) {
      std::uint32_t& place = at_[index(quads[n].u - first_u_, quads[n].v - first_v_)];
      regular_ &= place == kNone;  // two sheets may touch in one plane; then nothing is merged
      place = static_cast<std::uint32_t>(n);
    }
    for (std::int32_t v = 0; v < height_ && regular_; ++v) {
      for (std::int32_t u = 0; u < width_ && regular_; ++u) regular_ = neighbors_agree(u, v);
    }
  }

  /// Appends merged rectangles, best first, then the remaining quadrangles.
  bool append_triangles(std::vector<std::uint32_t>& indices) {
    bool joined = false;
    for (int n = 0; n < kRectanglesMax && regular_; ++n) {
      const Rectangle best = best_rectangle();
      if (best.saving() < kSavingMin) break;
      if (leave_out_folds(best)) continue;
      append_fan(best, indices);
      joined = true;
      for (std::int32_t v = best.v; v < best.v + best.height; ++v) {
        for (std::int32_t u = best.u; u < best.u + best.width; ++u) {
          merged_[at_[index(u, v)]] = true;
          at_[index(u, v)] = kNone;
        }
      }
    }
    for (std::size_t n = 0; n < quads_.size(); ++n) {
      if (merged_[n]) continue;
      auto c = quads_[n].corners;
      if (quads_[n].split == QuadSplit::kSecond) c = {c[1], c[2], c[3], c[0]};
      append_triangle(indices, plane_.reversed, c[0], c[1], c[2]);
      append_triangle(indices, plane_.reversed, c[0], c[2], c[3]);
    }
    return joined;
  }

 private:
  std::size_t index(std::int32_t u, std::int32_t v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(u);
  }
  const Quad* quad(std::int32_t u, std::int32_t v) const {
    if (u >= width_ || v >= height_ || at_[index(u, v)] == kNone) return nullptr;
    return &quads_[at_[index(u, v)]];
  }

  bool neighbors_agree(std::int32_t u, std::int32_t v) const {
    const Quad* here = quad(u, v);
    if (here == nullptr) return true;
    const auto& c = here->corners;
    const Quad* right = quad(u + 1, v);
    const Quad* above = quad(u, v + 1);
    return (right == nullptr || (c[1] == right->corners[0] && c[2] == right->corners[3])) &&
           (above == nullptr || (c[3] == above->corners[0] && c[2] == above->corners[1]));
  }

  /// Finds the rectangle that saves most triangles: per row, the largest rectangle under the
  /// histogram of free positions.
  Rectangle best_rectangle() const {
    Rectangle best;
    std::vector<std::int32_t> skyline(static_cast<std::size_t>(width_) + 1, 0);
    std::vector<std::int32_t> starts;
    for (std::int32_t v = 0; v < height_; ++v) {
      for (std::int32_t u = 0; u < width_; ++u) {
        std::int32_t& h = skyline[static_cast<std::size_t>(u)];
        h = at_[index(u, v)] == kNone ? 0 : h + 1;
      }
      starts.clear();
      for (std::int32_t u = 0; u <= width_; ++u) {
        const auto height_of = [&skyline](std::int32_t at) {
          return skyline[static_cast<std::size_t>(at)];
        };
        while (!starts.empty() && height_of(starts.back()) >= height_of(u)) {
          const std::int32_t height = height_of(starts.back());
          starts.pop_back();
          const std::int32_t first = starts.empty() ? 0 : starts.back() + 1;
          const Rectangle candidate{first, v - height + 1, u - first, height};
          if (candidate.saving() > best.saving()) best = candidate;
        }
        starts.push_back(u);
      }
    }
    return best;
  }

  /// An edge of a rectangle's rim: its first vertex, and the quadrangle that it belongs to.
  struct RimEdge {
    std::uint32_t from;
    std::size_t place;
  };
  std::vector<RimEdge> rim_of(const Rectangle& r) const {
    std::vector<RimEdge> rim;
    const auto add = [&](std::int32_t u, std::int32_t v, std::size_t n) {
      rim.push_back({quads_[at_[index(u, v)]].corners[n], index(u, v)});
    };
    const std::int32_t end_u = r.u + r.width;
    const std::int32_t end_v = r.v + r.height;
    for (std::int32_t u = r.u; u < end_u; ++u) add(u, r.v, 0);
    for (std::int32_t v = r.v; v < end_v; ++v) add(end_u - 1, v, 1);
    for (std::int32_t u = end_u; u > r.u; --u) add(u - 1, end_v - 1, 2);
    for (std::int32_t v = end_v; v > r.v; --v) add(r.u, v - 1, 3);
    return rim;
  }
  std::uint32_t center_of(const Rectangle& r) const {
    return quads_[at_[index(r.u + r.width / 2, r.v + r.height / 2)]].corners[0];
  }

  /// Excludes the quadrangles at which the fan of a rectangle would fold or have no area from the
  /// search. Returns whether there are any.
  bool leave_out_folds(const Rectangle& r) {
    const std::vector<RimEdge> rim = rim_of(r);
    const std::uint32_t center = center_of(r);
    bool any = false;
    for (std::size_t n = 0; n < rim.size(); ++n) {
      if (turns_left(center, rim[n].from, rim[(n + 1) % rim.size()].from)) continue;
      at_[rim[n].place] = kNone;
      any = true;
    }
    return any;
  }

  /// Returns whether three vertices are counter-clockwise about the axis. Differences of floats of
  /// similar size are exact in doubles, and equal products round alike, so a triangle without area
  /// is not.
  bool turns_left(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const std::size_t u = (plane_.axis + 1U) % 3, v = (plane_.axis + 2U) % 3;
    const auto &p = positions_[a], &q = positions_[b], &r = positions_[c];
    return (double(q[u]) - double(p[u])) * (double(r[v]) - double(p[v])) >
           (double(q[v]) - double(p[v])) * (double(r[u]) - double(p[u]));
  }

  void append_fan(const Rectangle& r, std::vector<std::uint32_t>& indices) const {
    const std::vector<RimEdge> rim = rim_of(r);
    const std::uint32_t center = center_of(r);
    for (std::size_t n = 0; n < rim.size(); ++n) {
      append_triangle(indices, plane_.reversed, center, rim[n].from,
                      rim[(n + 1) % rim.size()].from);
    }
  }

  std::span<const Quad> quads_;
  FlatPlane plane_;
  std::span<const std::array<float, 3>> positions_;
  std::vector<bool> merged_;
  std::int32_t first_u_ = 0, last_u_ = 0, first_v_ = 0, last_v_ = 0, width_ = 0, height_ = 0;
  std::vector<std::uint32_t> at_;  ///< number of the mergeable quadrangle at each position
  bool regular_ = true;
};

void FlatQuads::add(const FlatPlane& plane, std::int32_t u, std::int32_t v,
                    const std::array<std::uint32_t, 4>& corners, QuadSplit split) {
  if (last_ == nullptr || plane != last_plane_) {
    const auto number = static_cast<std::uint32_t>(planes_.size());
    last_ = &planes_.emplace(plane, Plane{number}).first->second;
    last_plane_ = plane;
  }
  ++last_->quads;
  entries_->push_back({last_->number, {u, v, corners, split}});
}

bool FlatQuads::append_triangles(std::span<const std::array<float, 3>> positions,
                                 std::vector<std::uint32_t>& indices) const {
  std::vector<std::size_t> next(planes_.size());
  std::size_t begin = 0;
  for (const auto& [plane, of] : planes_) {
    next[of.number] = begin;
    begin += of.quads;
  }
  Scratch<Quad> sorted;
  sorted->resize(entries_->size());
  for (const Entry& entry : *entries_) (*sorted)[next[entry.plane]++] = entry.quad;
  bool joined = false;
  for (const auto& [plane, of] : planes_) {
    const std::span<const Quad> quads(sorted->data() + next[of.number] - of.quads, of.quads);
    joined |= Grid(quads, plane, positions).append_triangles(indices);
  }
  return joined;
}

}  // namespace kerf
