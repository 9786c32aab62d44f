// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "server/formats/model/model_parts.h"

namespace kerf {
namespace {

constexpr std::size_t kTitleBytes = 80;
/// Twelve floats and two zero bytes.
constexpr std::size_t kBytesPerFacet = 50;

std::vector<std::byte> make_header(std::string_view title) {
  // The text does not begin with the scene's name: a file that begins with "solid" is read as
  // ASCII.
  std::string text = "Kerf STL, mm: " + one_line(title);
  text.resize(kTitleBytes, ' ');
  std::vector<std::byte> header(kTitleBytes);
  std::memcpy(header.data(), text.data(), kTitleBytes);
  put_u32(header, 0);
  return header;
}

std::array<std::array<float, 3>, 3> corners_of(const ModelOutput& output, const MeshPiece& piece,
                                               std::size_t first) {
  std::array<std::array<float, 3>, 3> corners;
  for (std::size_t c = 0; c < 3; ++c) {
    corners[c] = output.in_scene(piece.positions_mm[piece.indices[first + c]]);
  }
  return corners;
}

/// Returns the geometric normal of the triangle, as the format requires, not a shading normal.
std::array<float, 3> normal_of(const MeshPiece& piece, std::size_t first) {
  const auto& p = piece.positions_mm;
  const auto& i = piece.indices;
  return facet_normal({p[i[first]], p[i[first + 1]], p[i[first + 2]]});
}

/// Writes three floats, little-endian, and returns the position after them.
std::byte* put_floats(std::byte* to, const std::array<float, 3>& values) {
  for (const float value : values) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (unsigned n = 0; n < 4; ++n) *to++ = static_cast<std::byte>(bits >> (8 * n));
  }
  return to;
}

}  // namespace

ModelResult write_stl(const ModelOutput& output) {
  output.sink.write(make_header(output.request.title));
  ModelSummary summary;
  MeshPiece piece;
  std::vector<std::byte> bytes;
  while (output.next(piece)) {
    bytes.assign(piece.indices.size() / 3 * kBytesPerFacet, std::byte{});
    std::byte* facet = bytes.data();
    for (std::size_t first = 0; first + 2 < piece.indices.size(); first += 3) {
      std::byte* to = put_floats(facet, normal_of(piece, first));
      for (const auto& corner : corners_of(output, piece, first)) to = put_floats(to, corner);
      facet += kBytesPerFacet;
    }
    output.sink.write(bytes);
    summary.triangles += piece.indices.size() / 3;
  }
  if (summary.triangles > UINT32_MAX) {
    return model_error("the surface has more facets than an STL file can count (2^32)");
  }
  std::vector<std::byte> count;
  put_u32(count, static_cast<std::uint32_t>(summary.triangles));
  output.sink.patch(kTitleBytes, count);
  summary.vertices = 3 * summary.triangles;
  return summary;
}

ModelResult write_stl_ascii(const ModelOutput& output) {
  const std::string name = one_line(output.request.title);
  output.sink.write("solid " + name + "\n");
  ModelSummary summary;
  MeshPiece piece;
  std::string text;
  while (output.next(piece)) {
    text.clear();
    for (std::size_t first = 0; first + 2 < piece.indices.size(); first += 3) {
      put_vector(text, "facet normal", normal_of(piece, first));
      text += "\nouter loop\n";
      for (const auto& corner : corners_of(output, piece, first)) {
        put_vector(text, "vertex", corner);
        text += '\n';
      }
      text += "endloop\nendfacet\n";
    }
    output.sink.write(text);
    summary.triangles += piece.indices.size() / 3;
  }
  output.sink.write("endsolid " + name + "\n");
  summary.vertices = 3 * summary.triangles;
  return summary;
}

}  // namespace kerf
