#include "server/formats/glb.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <system_error>
#include <utility>

#include "kernel/surface/tile_mesh.h"

namespace kerf {
namespace {

/// A GLB counts its bytes in 32 bits; what is not vertex data stays far below this reserve.
constexpr std::size_t kBytesMax = std::numeric_limits<std::uint32_t>::max() - (64U << 20U);
constexpr double kMetresPerMm = 0.001;
/// Quaternion x, y, z, w that turns Z-up into glTF's Y-up: -90 degrees about x.
constexpr double kHalfSqrt = 0.70710678118654752;

template <typename T>
int add_view(tinygltf::Model& model, const std::vector<T>& data, int target) {
  auto& bytes = model.buffers[0].data;
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = bytes.size();
  view.byteLength = data.size() * sizeof(T);
  view.target = target;
  bytes.resize(bytes.size() + view.byteLength);
  std::memcpy(bytes.data() + view.byteOffset, data.data(), view.byteLength);
  model.bufferViews.push_back(std::move(view));
  return static_cast<int>(model.bufferViews.size() - 1);
}

int add_accessor(tinygltf::Model& model, int view, int component, int type, std::size_t count) {
  tinygltf::Accessor accessor;
  accessor.bufferView = view;
  accessor.componentType = component;
  accessor.type = type;
  accessor.count = count;
  model.accessors.push_back(std::move(accessor));
  return static_cast<int>(model.accessors.size() - 1);
}

void set_bounds(tinygltf::Accessor& accessor, const std::vector<std::array<float, 3>>& points) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto less = [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; };
    const auto [low, high] = std::minmax_element(points.begin(), points.end(), less);
    accessor.minValues.push_back(static_cast<double>((*low)[axis]));
    accessor.maxValues.push_back(static_cast<double>((*high)[axis]));
  }
}

/// Adds a node with the tile's mesh and returns its number.
int add_tile(tinygltf::Model& model, const TileMesh& mesh) {
  const int positions =
      add_accessor(model, add_view(model, mesh.positions_mm, TINYGLTF_TARGET_ARRAY_BUFFER),
                   TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, mesh.positions_mm.size());
  set_bounds(model.accessors.back(), mesh.positions_mm);
  const int normals =
      add_accessor(model, add_view(model, mesh.normals, TINYGLTF_TARGET_ARRAY_BUFFER),
                   TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, mesh.normals.size());
  const int indices =
      add_accessor(model, add_view(model, mesh.indices, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER),
                   TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, mesh.indices.size());

  tinygltf::Primitive primitive;
  primitive.attributes = {{"POSITION", positions}, {"NORMAL", normals}};
  primitive.indices = indices;
  primitive.material = 0;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  tinygltf::Mesh gltf_mesh;
  gltf_mesh.primitives.push_back(std::move(primitive));
  model.meshes.push_back(std::move(gltf_mesh));

  tinygltf::Node node;
  node.name = "t_" + std::to_string(mesh.tile.x) + "_" + std::to_string(mesh.tile.y);
  node.mesh = static_cast<int>(model.meshes.size() - 1);
  model.nodes.push_back(std::move(node));
  return static_cast<int>(model.nodes.size() - 1);
}

tinygltf::Model make_model(const DexelGrid& grid, std::string_view scene_name) {
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "Kerf";
  tinygltf::Value::Object extras;
  extras["scene"] = tinygltf::Value(std::string(scene_name));
  extras["units_below_root"] = tinygltf::Value(std::string("mm, Z up"));
  extras["pitch_mm"] = tinygltf::Value(grid.pitch_mm);
  model.asset.extras = tinygltf::Value(extras);
  model.buffers.emplace_back();

  tinygltf::Material material;
  material.name = "stock";
  material.pbrMetallicRoughness.baseColorFactor = {0.72, 0.62, 0.48, 1.0};
  material.pbrMetallicRoughness.metallicFactor = 0.0;
  material.pbrMetallicRoughness.roughnessFactor = 0.6;
  model.materials.push_back(std::move(material));

  tinygltf::Node root;
  root.name = "kerf";
  root.rotation = {-kHalfSqrt, 0, 0, kHalfSqrt};
  root.scale = {kMetresPerMm, kMetresPerMm, kMetresPerMm};
  const Vec3& o = grid.origin_mm;
  // The mesh counts from the block's corner, so that floats keep their precision far from the
  // scene's zero.
  root.translation = {o.x * kMetresPerMm, o.z * kMetresPerMm, -o.y * kMetresPerMm};
  model.nodes.push_back(std::move(root));
  tinygltf::Scene scene;
  scene.name = scene_name;
  scene.nodes = {0};
  model.scenes.push_back(std::move(scene));
  model.defaultScene = 0;
  return model;
}

}  // namespace

std::expected<std::vector<std::byte>, GlbError> make_model_glb(const DexelSnapshot& snapshot,
                                                               std::string_view scene_name,
                                                               const MeshProgress& progress) {
  const DexelGrid& grid = snapshot.grid();
  tinygltf::Model model = make_model(grid, scene_name);
  const double tiles = static_cast<double>(grid.tiles_x()) * grid.tiles_y();
  double done = 0;
  for (std::int32_t y = 0; y < grid.tiles_y(); ++y) {
    for (std::int32_t x = 0; x < grid.tiles_x(); ++x) {
      const TileMesh mesh = mesh_tile(snapshot, {x, y});
      if (!mesh.indices.empty()) {
        const int node = add_tile(model, mesh);
        model.nodes[0].children.push_back(node);
      }
      if (model.buffers[0].data.size() > kBytesMax) {
        return std::unexpected(
            GlbError{"the surface is larger than the 4 GiB that a GLB can hold"});
      }
      if (progress) progress(++done / tiles);
    }
  }
  if (model.buffers[0].data.empty()) {  // nothing left of the block: a GLB without meshes
    model.buffers.clear();
    model.materials.clear();
  }
  std::ostringstream out(std::ios::binary);
  tinygltf::TinyGLTF writer;
  if (!writer.WriteGltfSceneToStream(&model, out, false, true)) {
    return std::unexpected(GlbError{"the GLB could not be composed"});
  }
  const std::string_view text = out.view();
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return std::vector<std::byte>(first, first + text.size());
}

std::expected<void, GlbError> write_model_glb_file(const std::filesystem::path& path,
                                                   const DexelSnapshot& snapshot,
                                                   std::string_view scene_name,
                                                   const MeshProgress& progress) {
  const auto glb = make_model_glb(snapshot, scene_name, progress);
  if (!glb) return std::unexpected(glb.error());
  std::filesystem::path part = path;
  part += ".part";
  std::ofstream file(part, std::ios::binary);
  file.write(reinterpret_cast<const char*>(glb->data()), static_cast<std::streamsize>(glb->size()));
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(part, path, error);
  if (!file || error) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    return std::unexpected(GlbError{path.string() + ": cannot be written"});
  }
  return {};
}

}  // namespace kerf
