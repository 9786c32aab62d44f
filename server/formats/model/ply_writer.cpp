// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "server/formats/model/model_parts.h"
#include "server/formats/model/vertex_welder.h"

namespace kerf {
namespace {

// The header is rewritten once the counts are known. Its length does not depend on them.
constexpr std::size_t kCountDigits = 20;

std::string make_header(const std::string& title, const MeshPiece& like,
                        const ModelSummary& counts) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment " + one_line(title) +
                     "\ncomment written by Kerf; mm, Z up\n";
  if (!like.deviations_mm.empty()) {
    text += "comment quality is the signed distance from the reference in mm, positive outside\n";
  }
  const std::string vertices = std::to_string(counts.vertices);
  const std::string triangles = std::to_string(counts.triangles);
  text += "element vertex " + vertices + "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!like.colors.empty()) {
    text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  }
  if (!like.deviations_mm.empty()) text += "property float quality\n";
  text += "element face " + triangles + "\nproperty list uchar int vertex_indices\ncomment ";
  text.append(2 * kCountDigits - vertices.size() - triangles.size(), '-');
  return text + "\nend_header\n";
}

void put_vertex(std::vector<std::byte>& bytes, const ModelOutput& output, const MeshPiece& piece,
                std::uint32_t n) {
  for (const float c : output.in_scene(piece.positions_mm[n])) put_float(bytes, c);
  if (!piece.colors.empty()) {
    for (const std::uint8_t c : piece.colors[n]) bytes.push_back(std::byte{c});
  }
  if (!piece.deviations_mm.empty()) put_float(bytes, piece.deviations_mm[n]);
}

}  // namespace

ModelResult write_ply(const ModelOutput& output) {
  const std::string& title = output.request.title;
  VertexWelder welder;
  ModelSummary summary;
  MeshPiece piece;
  SpoolFile faces(output.path);
  bool more = output.next(piece);
  const std::string header = make_header(title, piece, summary);
  MeshPiece like;  // the piece that determines the properties
  like.colors.resize(piece.colors.empty() ? 0 : 1);
  like.deviations_mm.resize(piece.deviations_mm.empty() ? 0 : 1);
  output.sink.write(header);
  std::vector<std::byte> bytes;
  for (; more; more = output.next(piece)) {
    const auto& welded = welder.weld(piece);
    bytes.clear();
    for (const std::uint32_t n : welded.fresh) put_vertex(bytes, output, piece, n);
    output.sink.write(bytes);
    faces.write(std::as_bytes(std::span(welded.indices)));
    summary.triangles += piece.indices.size() / 3;
  }
  summary.vertices = welder.vertices();
  if (summary.vertices > INT32_MAX) {
    return model_error("the surface has more vertices than a PLY face can index (2^31)");
  }
  const bool whole = faces.read_all([&](std::span<const std::byte> chunk) {
    bytes.clear();
    for (std::size_t at = 0; at + 12 <= chunk.size(); at += 12) {
      bytes.push_back(std::byte{3});
      bytes.insert(bytes.end(), chunk.begin() + std::ptrdiff_t(at),
                   chunk.begin() + std::ptrdiff_t(at + 12));
    }
    output.sink.write(bytes);
  });
  if (!whole) return model_error("writing the temporary file failed; is the disk full?");
  const std::string counted = make_header(title, like, summary);
  output.sink.patch(0, std::as_bytes(std::span(counted)));
  return summary;
}

}  // namespace kerf
