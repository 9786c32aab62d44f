// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/formats/model/mesh_source.h"
#include "server/formats/model/model_writer.h"

namespace kerf {

/// Lattice of quantized positions: step n of an axis is (n + 32768) step_mm from the origin of the
/// surface.
struct GlbLattice {
  double step_mm = 1;  ///< a power of two; the whole surface fits 65536 steps
};
GlbLattice glb_lattice(Vec3 size_mm);

/// One array of a group: its bytes in the file and the data of its accessor.
struct GlbArray {
  std::string name;   ///< "POSITION", "NORMAL", "COLOR_0", "_DEVIATION_MM"; empty: the indices
  int component = 0;  ///< glTF's componentType
  const char* type = "SCALAR";  ///< glTF's type
  bool normalized = false;
  std::size_t stride = 0;        ///< bytes of one element before compression
  std::size_t count = 0;         ///< elements
  bool compressed = false;       ///< by EXT_meshopt_compression
  std::vector<double> min, max;  ///< of positions; empty otherwise
  std::vector<std::byte> bytes;  ///< unpadded
};

/// Collects pieces into one primitive with 16-bit indices, or 32-bit indices if a single piece has
/// too many vertices.
class GlbGroup {
 public:
  static constexpr std::size_t kVerticesMax = 65535;
  bool empty() const { return mesh_.indices.empty(); }
  /// Returns true if the piece does not fit and belongs in the next group.
  bool is_full_for(const MeshPiece& piece) const {
    return !empty() && mesh_.positions_mm.size() + piece.positions_mm.size() > kVerticesMax;
  }
  void add(const MeshPiece& piece);
  /// Returns the arrays of the group, indices last, and clears the group. Empty if quantization
  /// leaves no triangle.
  std::vector<GlbArray> take(ModelEncoding encoding, const GlbLattice& lattice);

 private:
  MeshPiece mesh_;
};

}  // namespace kerf
