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

/// Where quantised positions lie: step n of an axis stands for (n + 32768) step_mm from the origin
/// of the surface.
struct GlbLattice {
  double step_mm = 1;  ///< a power of two; the whole surface fits 65536 steps
};
GlbLattice glb_lattice(Vec3 size_mm);

/// One array of a group, as it stands in the file and as its accessor describes it.
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

/// Pieces that share one primitive: few enough vertices for 16-bit indices, unless one piece alone
/// has more.
class GlbGroup {
 public:
  static constexpr std::size_t kVerticesMax = 65535;
  bool empty() const { return mesh_.indices.empty(); }
  /// Whether the piece must wait for the next group.
  bool is_full_for(const MeshPiece& piece) const {
    return !empty() && mesh_.positions_mm.size() + piece.positions_mm.size() > kVerticesMax;
  }
  void add(const MeshPiece& piece);
  /// The arrays of the group, the indices last; none where quantising leaves no triangle. The group
  /// is empty afterwards.
  std::vector<GlbArray> take(ModelEncoding encoding, const GlbLattice& lattice);

 private:
  MeshPiece mesh_;
};

}  // namespace kerf
