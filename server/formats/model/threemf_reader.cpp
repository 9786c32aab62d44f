// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <string>

#include "server/formats/model/mesh_reader.h"
#include "server/formats/model/mesh_rejection.h"
#include "server/formats/model/threemf_part.h"
#include "server/formats/model/zip_reader.h"

// Reads the 3D Manufacturing Format: core specification 1.3 and, of the production extension, the
// paths to other parts. Reads the build items with their components. Skips supports, open surfaces,
// colors and materials.

namespace kerf {
namespace {

/// Limits for hostile packages.
constexpr int kComponentDepthMax = 32;
constexpr std::size_t kPartsMax = 1000;

class ThreemfReader {
 public:
  ThreemfReader(std::span<const std::byte> bytes, std::uint64_t triangles_max,
                const std::stop_token& stop)
      : package_(bytes),
        triangles_max_(triangles_max),
        stop_(stop),
        count_{.triangles_max = triangles_max} {}

  TriangleMesh read() {
    std::string relationships;
    package_.read("_rels/.rels", [&](std::string_view text) { relationships += text; });
    std::string name = threemf_model_part(relationships);
    if (name.empty()) name = "3D/3dmodel.model";
    const ThreemfPart& root = part(name);
    for (const ThreemfPlaced& item : root.items) place(item, name, item.transform, 0);
    if (mesh_.triangles.empty())
      reject_mesh(MeshFileErrorCode::kEmpty, "the package builds no object with triangles");
    return std::move(mesh_);
  }

 private:
  const ThreemfPart& part(const std::string& name) {
    if (const auto known = parts_.find(name); known != parts_.end()) return known->second;
    if (parts_.size() == kPartsMax)
      reject_mesh(MeshFileErrorCode::kTooLarge,
                  "the package has more than 1000 model parts, the limit");
    return parts_
        .emplace(name, read_threemf_part(name, count_,
                                         [&](const auto& take) {
                                           const auto piece = [&](std::string_view text) {
                                             go_on();
                                             take(text);
                                           };
                                           if (!package_.read(name, piece))
                                             reject_mesh(MeshFileErrorCode::kSyntax,
                                                         "the package has no part " + name);
                                         }))
        .first->second;
  }

  void place(const ThreemfPlaced& placed, const std::string& from,
             const ThreemfTransform& transform, int depth) {
    if (depth > kComponentDepthMax)
      reject_mesh(MeshFileErrorCode::kUnsupported, "components are nested more than 32 deep");
    const std::string& name = placed.part.empty() ? from : placed.part;
    const ThreemfPart& source = part(name);
    const auto object = source.objects.find(placed.id);
    if (object == source.objects.end())
      reject_mesh(MeshFileErrorCode::kBadIndex, name + " has no object " + placed.id);
    if (!object->second.is_solid) return;
    go_on();
    add(object->second.mesh, transform, source.unit_mm);
    for (const ThreemfPlaced& component : object->second.components) {
      if (++placed_ > triangles_max_)
        reject_mesh(MeshFileErrorCode::kTooLarge, "the package places too many components");
      place(component, name, component.transform.then(transform), depth + 1);
    }
  }

  void go_on() const {
    if (stop_.stop_requested()) reject_mesh(MeshFileErrorCode::kStopped, "stopped");
  }

  void add(const TriangleMesh& mesh, const ThreemfTransform& transform, double unit_mm) {
    if (mesh_.triangles.size() + mesh.triangles.size() > triangles_max_ ||
        mesh_.vertices_mm.size() + mesh.vertices_mm.size() > triangles_max_)
      reject_mesh(MeshFileErrorCode::kTooLarge, "the package builds more than " +
                                                    std::to_string(triangles_max_) +
                                                    " triangles or vertices, the limit");
    const auto first = static_cast<std::uint32_t>(mesh_.vertices_mm.size());
    for (const Vec3& v : mesh.vertices_mm)
      mesh_.vertices_mm.push_back(unit_mm * transform.apply(v));
    const bool mirrored = transform.mirrors();
    for (const auto& t : mesh.triangles) {
      const std::size_t second = mirrored ? 2 : 1, third = mirrored ? 1 : 2;
      mesh_.triangles.push_back({first + t[0], first + t[second], first + t[third]});
    }
  }

  ZipReader package_;
  std::uint64_t triangles_max_, placed_ = 0;
  const std::stop_token& stop_;
  ThreemfCount count_;  ///< of all parts
  std::map<std::string, ThreemfPart> parts_;
  TriangleMesh mesh_;
};

}  // namespace

MeshFileResult read_threemf(std::span<const std::byte> bytes, std::uint64_t triangles_max,
                            const std::stop_token& stop) {
  try {
    return ThreemfReader(bytes, triangles_max, stop).read();
  } catch (const MeshRejection& rejection) {
    return std::unexpected(rejection.error);
  }
}

}  // namespace kerf
