// SPDX-License-Identifier: Apache-2.0
#include "server/carve/part_fit.h"

#include "server/verify/true_solid.h"

namespace kerf {
namespace {

// For a convex stock, the solid of a part is in it if its corners are.
std::optional<Shortfall> shortfall_of(const IndexedMesh& mesh, const Scene& scene,
                                      double tolerance_mm) {
  const TrueSolid uncut(scene.settings.stock, {}, {}, 0, scene.settings.stock_mesh.get());
  Shortfall worst{tolerance_mm, {}};
  for (std::uint32_t v = 0; v < mesh.positions_mm.size(); ++v) {
    const Vec3 at = mesh.origin_mm + mesh.position(v);
    const double outside = uncut.from_stock(at).mm;
    if (outside > worst.mm) worst = {outside, at};
  }
  if (worst.mm <= tolerance_mm) return std::nullopt;
  return worst;
}

}  // namespace

std::expected<PartFit, std::string> fit_part(const DexelSnapshot& before,
                                             const DexelSnapshot& after, const IndexedMesh& mesh,
                                             const Scene& scene, const Program& program,
                                             const PartFitRequest& request,
                                             const SearchControl& control) {
  const MeshDistance surface(mesh);
  const PartModel part(mesh, surface, after.grid());
  if (request.two_sided && part.material() == nullptr)
    return std::unexpected(part.fault() + "; close it, or use --reference-repair");
  const double carved_mm = scene.settings.tolerance_mm;
  PartFit fit;
  fit.gouges = find_gouges(before, after, part, request.tolerance_mm, control);
  attribute_gouges(*fit.gouges, program.motions, scene.tools, carved_mm, control.stop);
  if (!request.two_sided) return fit;
  fit.rests = find_rests(after, part, request.tolerance_mm, fit.loose_mm3, control);
  attribute_rests(*fit.rests, scene, program.motions, control.stop);
  fit.shortfall = shortfall_of(mesh, scene, request.tolerance_mm);
  return fit;
}

}  // namespace kerf
