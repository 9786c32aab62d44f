// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/model_parts.h"
#include "server/formats/model/vertex_welder.h"

namespace kerf {

// Positions are shared, so that the indices form a closed surface. Normals have separate indices,
// so that creases stay sharp. Colors follow the coordinates, the form that most readers accept.
ModelResult write_obj(const ModelOutput& output) {
  const std::string name = one_line(output.request.title);
  output.sink.write("# " + name + "\n# written by Kerf; mm, Z up\no " + name + "\n");
  VertexWelder welder;
  ModelSummary summary;
  MeshPiece piece;
  std::string text;
  std::uint64_t normals = 0;
  while (output.next(piece)) {
    text.clear();
    const auto& welded = welder.weld(piece);
    for (const std::uint32_t n : welded.fresh) {
      put_vector(text, "v", output.in_scene(piece.positions_mm[n]));
      if (!piece.colors.empty()) {
        const auto& rgb = piece.colors[n];
        put_vector(text, "", {float(rgb[0]) / 255, float(rgb[1]) / 255, float(rgb[2]) / 255});
      }
      text += '\n';
    }
    for (const auto& normal : piece.normals) {
      put_vector(text, "vn", normal);
      text += '\n';
    }
    for (std::size_t first = 0; first + 2 < piece.indices.size(); first += 3) {
      text += 'f';
      for (std::size_t c = 0; c < 3; ++c) {
        text += ' ';
        put_number(text, std::uint64_t{welded.indices[first + c]} + 1);
        text += "//";
        put_number(text, normals + piece.indices[first + c] + 1);
      }
      text += '\n';
    }
    normals += piece.normals.size();
    summary.triangles += piece.indices.size() / 3;
    output.sink.write(text);
  }
  if (welder.overflowed()) return model_error("the surface has more than 2^32 vertices");
  summary.vertices = welder.vertices();
  return summary;
}

}  // namespace kerf
