// SPDX-License-Identifier: Apache-2.0
// A page has no meshes as obstacles: its scenes may name no files. These stand for the tree of
// their triangles, which is not linked then.
#include "kernel/force/triangle_tree.h"

namespace kerf {

std::shared_ptr<const TriangleTree> make_triangle_tree(const std::vector<TriangleTree::Triangle>&) {
  return nullptr;
}
TriangleTree::Found TriangleTree::find(Vec3) const { return {}; }

}  // namespace kerf
