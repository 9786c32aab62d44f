// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/sheet_table.h"

#include <algorithm>

namespace kerf {
namespace {

/// The least share of the distance of a point from a plane that remains when it is moved towards
/// it.
constexpr double kShareKept = 1.0 / 1024;

constexpr bool solid(unsigned configuration, unsigned corner) {
  return ((configuration >> corner) & 1U) != 0;
}

constexpr bool is_ambiguous(unsigned configuration, const CellFace& face) {
  const bool first = solid(configuration, face.corners[0]);
  return first == solid(configuration, face.corners[2]) &&
         first != solid(configuration, face.corners[1]) &&
         first != solid(configuration, face.corners[3]);
}

/// Disjoint sets over the twelve edges, usable at compile time.
struct EdgeSets {
  std::array<std::uint8_t, 12> parent{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  constexpr std::uint8_t find(std::uint8_t edge) const {
    while (parent[edge] != edge) edge = parent[edge];
    return edge;
  }
  constexpr void join(std::uint8_t a, std::uint8_t b) { parent[find(b)] = find(a); }
};

constexpr void join_across(EdgeSets& sets, unsigned configuration, const CellFace& face,
                           bool join_solids) {
  if (is_ambiguous(configuration, face)) {
    for (unsigned n = 0; n < 4; ++n) {
      if (solid(configuration, face.corners[n]) != join_solids) {
        sets.join(face.edges[(n + 3) % 4], face.edges[n]);
      }
    }
    return;
  }
  int first = -1;
  for (unsigned n = 0; n < 4; ++n) {
    if (solid(configuration, face.corners[n]) == solid(configuration, face.corners[(n + 1) % 4])) {
      continue;
    }
    if (first >= 0) sets.join(static_cast<std::uint8_t>(first), face.edges[n]);
    first = face.edges[n];
  }
}

constexpr CellSheets trace(unsigned configuration, int flipped_face) {
  EdgeSets sets;
  std::array<bool, 12> crossed{};
  for (int f = 0; f < 6; ++f) {
    const CellFace& face = kCellFaces[static_cast<unsigned>(f)];
    join_across(sets, configuration, face, f == flipped_face);
    for (unsigned n = 0; n < 4; ++n) {
      crossed[face.edges[n]] =
          solid(configuration, face.corners[n]) != solid(configuration, face.corners[(n + 1) % 4]);
    }
  }
  CellSheets result;
  result.of_edge.fill(kNoSheet);
  std::array<std::uint8_t, 12> sheet_of_root{};
  sheet_of_root.fill(kNoSheet);
  for (std::uint8_t edge = 0; edge < 12; ++edge) {
    if (!crossed[edge]) continue;
    std::uint8_t& sheet = sheet_of_root[sets.find(edge)];
    if (sheet == kNoSheet) sheet = result.count++;
    result.of_edge[edge] = sheet;
    result.edges[sheet] = static_cast<std::uint16_t>(result.edges[sheet] | (1U << edge));
  }
  for (int f = 0; f < 6; ++f) {
    const CellFace& face = kCellFaces[static_cast<unsigned>(f)];
    if (is_ambiguous(configuration, face) &&
        result.of_edge[face.edges[0]] == result.of_edge[face.edges[1]] &&
        result.of_edge[face.edges[0]] == result.of_edge[face.edges[2]]) {
      result.doubled_face = f;
    }
  }
  return result;
}

constexpr std::array<CellSheets, 256> all_sheets(bool flipped) {
  std::array<CellSheets, 256> table{};
  for (unsigned configuration = 0; configuration < 256; ++configuration) {
    table[configuration] = trace(configuration, -1);
    const int face = table[configuration].doubled_face;
    if (flipped && face >= 0) {
      table[configuration] = trace(configuration, face);
      table[configuration].doubled_face = face;
    }
  }
  return table;
}

constexpr auto kSheets = all_sheets(false);
constexpr auto kFlippedSheets = all_sheets(true);

/// Returns whether flipping is sound for every configuration. A doubled face must be the only
/// ambiguous face of its cell, so that no other face's decision changes, and flipping must give it
/// two sheets.
constexpr bool flipping_is_sound() {
  for (unsigned configuration = 0; configuration < 256; ++configuration) {
    const int doubled = kSheets[configuration].doubled_face;
    if (doubled < 0) continue;
    int ambiguous = 0;
    for (const CellFace& face : kCellFaces) ambiguous += is_ambiguous(configuration, face) ? 1 : 0;
    const CellFace& face = kCellFaces[static_cast<unsigned>(doubled)];
    const CellSheets& flipped = kFlippedSheets[configuration];
    bool one_sheet = true;
    for (unsigned n = 1; n < 4; ++n) {
      one_sheet &= flipped.of_edge[face.edges[0]] == flipped.of_edge[face.edges[n]];
    }
    if (ambiguous != 1 || one_sheet) return false;
  }
  return true;
}
static_assert(flipping_is_sound());

/// Corners of the cell that edges of a sheet end in, as bits.
constexpr std::array<std::uint8_t, 12> kEdgeEnds{0x03, 0x0c, 0x30, 0xc0, 0x05, 0x0a,
                                                 0x50, 0xa0, 0x11, 0x22, 0x44, 0x88};
constexpr unsigned ends_of(std::uint16_t edges) {
  unsigned corners = 0;
  for (unsigned e = 0; e < 12; ++e) {
    if ((edges >> e & 1U) != 0) corners |= kEdgeEnds[e];
  }
  return corners;
}

/// A plane: x normal.x + y normal.y + z normal.z = offset / 4 in pitches from the cell's center.
struct CellPlane {
  int x = 0, y = 0, z = 0, offset = 0;
};

/// Returns the greatest value of a plane's sum over corners, doubled.
constexpr int greatest(const CellPlane& n, unsigned corners) {
  int most = -9;
  for (unsigned c = 0; c < 8; ++c) {
    if ((corners >> c & 1U) == 0) continue;
    const int sum = n.x * ((c & 1U) != 0 ? 1 : -1) + n.y * ((c & 2U) != 0 ? 1 : -1) +
                    n.z * ((c & 4U) != 0 ? 1 : -1);
    most = most > sum ? most : sum;
  }
  return most;
}

/// Returns a plane with the edges of one sheet on its lower side and those of another on its upper
/// side, midway between them and as far from both as possible. Its normal is zero if there is none.
constexpr CellPlane separating_plane(std::uint16_t lower, std::uint16_t upper) {
  const unsigned below = ends_of(lower), above = ends_of(upper);
  CellPlane best;
  int widest = -1;  // the square of the gap, times 6
  for (int n = 0; n < 27; ++n) {
    CellPlane plane{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1, 0};
    if (n == 13) continue;  // the zero vector
    const int low = greatest(plane, below);
    const int high = -greatest({-plane.x, -plane.y, -plane.z, 0}, above);
    const int length2 = plane.x * plane.x + plane.y * plane.y + plane.z * plane.z;
    if (low > high || (high - low) * (high - low) * 6 / length2 <= widest) continue;
    widest = (high - low) * (high - low) * 6 / length2;
    plane.offset = low + high;
    best = plane;
  }
  return best;
}

/// Returns whether there is such a plane for any two sheets of any cell.
constexpr bool sheets_are_separable(const std::array<CellSheets, 256>& table) {
  for (const CellSheets& cell : table) {
    for (unsigned s = 0; s < cell.count; ++s) {
      for (unsigned t = s + 1; t < cell.count; ++t) {
        const CellPlane plane = separating_plane(cell.edges[s], cell.edges[t]);
        if (plane.x == 0 && plane.y == 0 && plane.z == 0) return false;
      }
    }
  }
  return true;
}
static_assert(sheets_are_separable(kSheets));
static_assert(sheets_are_separable(kFlippedSheets));

}  // namespace

Vec3 on_own_side(const CellSheets& sheets, std::uint8_t sheet, Vec3 inside, Vec3 place) {
  double share = 1;
  for (std::uint8_t other = 0; other < sheets.count; ++other) {
    if (other == sheet) continue;
    const bool below = sheet < other;
    const CellPlane plane =
        separating_plane(sheets.edges[below ? sheet : other], sheets.edges[below ? other : sheet]);
    const auto beyond = [&](Vec3 p) {
      const double off = plane.x * p.x + plane.y * p.y + plane.z * p.z - 0.25 * plane.offset;
      return below ? off : -off;
    };
    const double from = beyond(inside), to = beyond(place);
    if (to > from * kShareKept) share = std::min(share, (1 - kShareKept) * from / (from - to));
  }
  return share < 1 ? inside + (place - inside) * share : place;
}

const CellSheets& sheets_of(std::uint8_t configuration) { return kSheets[configuration]; }
const CellSheets& flipped_sheets_of(std::uint8_t configuration) {
  return kFlippedSheets[configuration];
}

}  // namespace kerf
