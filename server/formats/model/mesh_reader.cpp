// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/mesh_reader.h"

#include <algorithm>
#include <tuple>
#include <vector>

#include "server/formats/model/open_vertices.h"
#include "server/formats/model/stl_reader.h"
#include "server/formats/model/text_words.h"

namespace kerf {
namespace {

// -0 and +0 are the same coordinate.
Vec3 plain(Vec3 v) { return {v.x + 0.0, v.y + 0.0, v.z + 0.0}; }

/// Returns for each vertex the first one at the same position. Sorts, because a hostile file could
/// make its vertices collide in a table.
std::vector<std::uint32_t> first_at_place(const std::vector<Vec3>& vertices) {
  struct Placed {
    Vec3 at;
    std::uint32_t vertex;
  };
  std::vector<Placed> placed;
  placed.reserve(vertices.size());
  for (const Vec3& v : vertices)
    placed.push_back({plain(v), static_cast<std::uint32_t>(placed.size())});
  std::ranges::sort(placed, [](const Placed& a, const Placed& b) {
    return std::tie(a.at.x, a.at.y, a.at.z, a.vertex) < std::tie(b.at.x, b.at.y, b.at.z, b.vertex);
  });
  std::vector<std::uint32_t> first(vertices.size());
  for (std::size_t n = 0; n < placed.size(); ++n) {
    const bool repeats = n > 0 && placed[n].at == placed[n - 1].at;
    first[placed[n].vertex] = repeats ? first[placed[n - 1].vertex] : placed[n].vertex;
  }
  return first;
}

/// Share of the mesh's diagonal below which vertices on open edges are equal. Programs that compute
/// a vertex once per triangle, or write floats, give it different last digits.
constexpr double kSameShare = 1e-6;

void drop_triangles_without_area(TriangleMesh& mesh) {
  std::erase_if(mesh.triangles,
                [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

TriangleMesh merge_vertices(const TriangleMesh& read) {
  TriangleMesh mesh;
  std::vector<std::uint32_t> merged = first_at_place(read.vertices_mm);
  for (std::uint32_t v = 0; v < merged.size(); ++v) {
    const bool is_first = merged[v] == v;  // earlier ones have their numbers already
    merged[v] = is_first ? static_cast<std::uint32_t>(mesh.vertices_mm.size()) : merged[merged[v]];
    if (is_first) mesh.vertices_mm.push_back(plain(read.vertices_mm[v]));
  }
  for (const auto& t : read.triangles)
    mesh.triangles.push_back({merged[t[0]], merged[t[1]], merged[t[2]]});
  drop_triangles_without_area(mesh);
  if (mesh.triangles.empty() || seems_closed(mesh)) return mesh;
  join_open_vertices(mesh, kSameShare);
  drop_triangles_without_area(mesh);
  return mesh;
}

MeshFileResult read_unmerged(MeshFileFormat format, std::span<const std::byte> bytes,
                             std::uint64_t triangles_max, const std::stop_token& stop) {
  switch (format) {
    case MeshFileFormat::kPly:
      return read_ply(bytes, triangles_max, stop);
    case MeshFileFormat::kObj:
      return read_obj({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, triangles_max,
                      stop);
    case MeshFileFormat::k3mf:
      return read_threemf(bytes, triangles_max, stop);
    case MeshFileFormat::kGlb:
      return read_gltf(bytes, triangles_max, stop);
    case MeshFileFormat::kStl:
      break;
  }
  const auto facets = read_stl(bytes, triangles_max, stop);
  if (!facets) return std::unexpected(facets.error());
  TriangleMesh mesh;
  for (const StlTriangle& facet : *facets) {
    const auto n = static_cast<std::uint32_t>(mesh.vertices_mm.size());
    mesh.vertices_mm.insert(mesh.vertices_mm.end(), facet.begin(), facet.end());
    mesh.triangles.push_back({n, n + 1, n + 2});
  }
  return mesh;
}

}  // namespace

const char* to_string(MeshFileErrorCode code) {
  switch (code) {
    case MeshFileErrorCode::kTruncated:
      return "truncated";
    case MeshFileErrorCode::kCountMismatch:
      return "count_mismatch";
    case MeshFileErrorCode::kNotFinite:
      return "not_finite";
    case MeshFileErrorCode::kTooLarge:
      return "too_large";
    case MeshFileErrorCode::kSyntax:
      return "syntax";
    case MeshFileErrorCode::kBadIndex:
      return "bad_index";
    case MeshFileErrorCode::kEmpty:
      return "empty";
    case MeshFileErrorCode::kUnsupported:
      return "unsupported";
    case MeshFileErrorCode::kStopped:
      return "stopped";
  }
  return "unknown";
}

std::optional<MeshFileFormat> mesh_file_format(std::string_view file_name) {
  const auto dot = file_name.rfind('.');
  if (dot == file_name.npos) return std::nullopt;
  const std::string_view extension = file_name.substr(dot + 1);
  if (equal_ignoring_case(extension, "stl")) return MeshFileFormat::kStl;
  if (equal_ignoring_case(extension, "ply")) return MeshFileFormat::kPly;
  if (equal_ignoring_case(extension, "obj")) return MeshFileFormat::kObj;
  if (equal_ignoring_case(extension, "3mf")) return MeshFileFormat::k3mf;
  if (equal_ignoring_case(extension, "glb")) return MeshFileFormat::kGlb;
  return std::nullopt;
}

MeshFileResult read_mesh(MeshFileFormat format, std::span<const std::byte> bytes,
                         std::uint64_t triangles_max, const std::stop_token& stop) {
  const auto read = read_unmerged(format, bytes, triangles_max, stop);
  if (!read) return read;
  TriangleMesh mesh = merge_vertices(*read);
  if (stop.stop_requested())
    return std::unexpected(MeshFileError{MeshFileErrorCode::kStopped, "stopped"});
  if (mesh.triangles.empty()) {
    return std::unexpected(
        MeshFileError{MeshFileErrorCode::kEmpty, "the file contains no triangle with an area > 0"});
  }
  return mesh;
}

}  // namespace kerf
