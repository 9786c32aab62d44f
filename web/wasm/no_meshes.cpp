// SPDX-License-Identifier: Apache-2.0
// A page has no meshes, neither as obstacles nor as stock: its scenes may name no files, and the
// columns of a block that began as a mesh come from the server. These stand for what reads them,
// which is not linked then.
#include "kernel/dexel/mesh_stock.h"
#include "kernel/force/triangle_tree.h"

namespace kerf {

std::shared_ptr<const TriangleTree> make_triangle_tree(const std::vector<TriangleTree::Triangle>&) {
  return nullptr;
}
TriangleTree::Found TriangleTree::find(Vec3) const { return {}; }

BoxStock mesh_bounds(const TriangleMesh&) { return {}; }
std::string mesh_stock_fault(const TriangleMesh&) { return "a page takes no mesh as stock"; }
void dexelize(const TriangleMesh&, const DexelGrid&, bool,
              const std::function<void(TileIndex, std::shared_ptr<DexelTile>)>&, ColumnShares*,
              const StopAsked&) {}

}  // namespace kerf
