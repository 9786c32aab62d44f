// SPDX-License-Identifier: Apache-2.0
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <string>

#include "server/formats/model/gltf_elements.h"
#include "server/formats/model/gltf_file.h"
#include "server/formats/model/mesh_reader.h"
#include "server/formats/stop_poll.h"

// Reads binary glTF 2.0: the triangles of the nodes of its scene. Lengths are meters and +Y is up
// (glTF 2.0, 3.4). They become mm with +Z up. Materials, textures, skins and animations are
// ignored, so the pose is that of the nodes.

namespace kerf {
namespace {

constexpr int kNodeDepthMax = 64;
constexpr double kMmPerMeter = 1000;

/// A 4 x 4 matrix by columns, as glTF writes it.
struct NodeMatrix {
  std::array<double, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

  Vec3 apply(Vec3 v) const {
    return {m[0] * v.x + m[4] * v.y + m[8] * v.z + m[12],
            m[1] * v.x + m[5] * v.y + m[9] * v.z + m[13],
            m[2] * v.x + m[6] * v.y + m[10] * v.z + m[14]};
  }
  Vec3 column(std::size_t n) const { return {m[4 * n], m[4 * n + 1], m[4 * n + 2]}; }
  bool mirrors() const { return dot(cross(column(0), column(1)), column(2)) < 0; }
  /// Applies the other first, then this.
  NodeMatrix after(const NodeMatrix& other) const {
    NodeMatrix product;
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t r = 0; r < 4; ++r) {
        double sum = 0;
        for (std::size_t n = 0; n < 4; ++n) sum += m[4 * n + r] * other.m[4 * c + n];
        product.m[4 * c + r] = sum;
      }
    }
    return product;
  }
};

NodeMatrix matrix_of(const tinygltf::Node& node) {
  NodeMatrix matrix;
  if (node.matrix.size() == 16) {
    std::ranges::copy(node.matrix, matrix.m.begin());
    return matrix;
  }
  if (node.rotation.size() == 4) {
    const double x = node.rotation[0], y = node.rotation[1], z = node.rotation[2],
                 w = node.rotation[3];
    matrix.m = {1 - 2 * (y * y + z * z),
                2 * (x * y + z * w),
                2 * (x * z - y * w),
                0,
                2 * (x * y - z * w),
                1 - 2 * (x * x + z * z),
                2 * (y * z + x * w),
                0,
                2 * (x * z + y * w),
                2 * (y * z - x * w),
                1 - 2 * (x * x + y * y),
                0,
                0,
                0,
                0,
                1};
  }
  if (node.scale.size() == 3) {
    for (std::size_t n = 0; n < 12; ++n) matrix.m[n] *= node.scale[n / 4];
  }
  if (node.translation.size() == 3) std::ranges::copy(node.translation, matrix.m.begin() + 12);
  return matrix;
}

/// Rejects references to other files.
tinygltf::FsCallbacks no_files() {
  return {[](const std::string&, void*) { return false; },
          [](const std::string& name, void*) { return name; },
          [](std::vector<unsigned char>*, std::string* error, const std::string& name, void*) {
            *error += "it names the file " + name + "; put all of it into one .glb";
            return false;
          },
          [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
            return false;
          },
          nullptr};
}

class GltfReader {
 public:
  GltfReader(std::span<const std::byte> bytes, std::uint64_t triangles_max,
             const std::stop_token& stop)
      : triangles_max_(triangles_max), stop_(stop), poll_(stop) {
    const std::string file = gltf_geometry(bytes, stop);
    end_if(stop.stop_requested());
    std::string error, warning;
    tinygltf::TinyGLTF loader;
    loader.SetFsCallbacks(no_files());
    if (!loader.LoadBinaryFromMemory(&model_, &error, &warning,
                                     reinterpret_cast<const unsigned char*>(file.data()),
                                     static_cast<unsigned>(file.size()))) {
      std::ranges::replace(error, '\n', ' ');
      reject_mesh(MeshFileErrorCode::kSyntax, "the file is not valid binary glTF: " + error);
    }
    end_if(stop.stop_requested());
  }

  TriangleMesh read() {
    // glTF +Y up, meters -> +Z up, mm.
    NodeMatrix root;
    root.m = {kMmPerMeter, 0, 0, 0, 0, 0, kMmPerMeter, 0, 0, -kMmPerMeter, 0, 0, 0, 0, 0, 1};
    const int number = model_.defaultScene >= 0 ? model_.defaultScene : 0;
    for (const int node : gltf_item(model_.scenes, number, "scene").nodes) place(node, root, 0);
    if (mesh_.triangles.empty())
      reject_mesh(MeshFileErrorCode::kEmpty, "the scene of the file has no triangle");
    return std::move(mesh_);
  }

 private:
  static void end_if(bool stops) {
    if (stops) reject_mesh(MeshFileErrorCode::kStopped, "stopped");
  }

  void place(int number, const NodeMatrix& parent, int depth) {
    if (depth > kNodeDepthMax)
      reject_mesh(MeshFileErrorCode::kUnsupported, "nodes are nested more than 64 deep");
    if (++nodes_ > triangles_max_) reject_mesh(MeshFileErrorCode::kTooLarge, "too many nodes");
    end_if(stop_.stop_requested());
    const tinygltf::Node& node = gltf_item(model_.nodes, number, "node");
    const NodeMatrix matrix = parent.after(matrix_of(node));
    if (node.mesh >= 0) {
      for (const auto& primitive : gltf_item(model_.meshes, node.mesh, "mesh").primitives)
        add(primitive, matrix);
    }
    for (const int child : node.children) place(child, matrix, depth + 1);
  }

  void add(const tinygltf::Primitive& primitive, const NodeMatrix& matrix) {
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (mode < TINYGLTF_MODE_TRIANGLES) return;  // points and lines
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) return;
    const GltfElements positions(model_, position->second);
    if (!positions.is_vec3())
      reject_mesh(MeshFileErrorCode::kSyntax, "POSITION must have three components");
    first_ = static_cast<std::uint32_t>(mesh_.vertices_mm.size());
    count_ = positions.size();
    if (mesh_.vertices_mm.size() + count_ > 3 * triangles_max_)
      reject_mesh(MeshFileErrorCode::kTooLarge, "the file has too many vertices");
    for (std::size_t n = 0; n < count_; ++n) {
      end_if(poll_.stops());
      mesh_.vertices_mm.push_back(matrix.apply(positions.position(n)));
      if (!is_finite(mesh_.vertices_mm.back()))
        reject_mesh(MeshFileErrorCode::kNotFinite, "a coordinate is not finite");
    }
    mirrored_ = matrix.mirrors();
    if (primitive.indices < 0) {
      add_triangles(mode, count_, [](std::size_t n) { return static_cast<std::uint32_t>(n); });
      return;
    }
    const GltfElements indices(model_, primitive.indices);
    if (!indices.is_index())
      reject_mesh(MeshFileErrorCode::kSyntax, "indices must be unsigned integers");
    add_triangles(mode, indices.size(), [&](std::size_t n) { return indices.index(n); });
  }

  /// glTF 2.0, 3.7.2.1: triangles, strips and fans.
  template <class Index>
  void add_triangles(int mode, std::size_t count, Index&& index) {
    if (mode == TINYGLTF_MODE_TRIANGLES) {
      for (std::size_t n = 0; n + 2 < count; n += 3)
        add_triangle(index(n), index(n + 1), index(n + 2));
      return;
    }
    for (std::size_t n = 0; n + 2 < count; ++n) {
      if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
        add_triangle(index(n + 1), index(n + 2), index(0));
      } else {
        add_triangle(index(n), index(n + 1 + n % 2), index(n + 2 - n % 2));
      }
    }
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    end_if(poll_.stops());
    if (std::max({a, b, c}) >= count_)
      reject_mesh(MeshFileErrorCode::kBadIndex, "vertex " + std::to_string(std::max({a, b, c})) +
                                                    " is out of range: the " + "primitive has " +
                                                    std::to_string(count_));
    if (mesh_.triangles.size() == triangles_max_)
      reject_mesh(
          MeshFileErrorCode::kTooLarge,
          "the file has more than " + std::to_string(triangles_max_) + " triangles, the limit");
    if (mirrored_) std::swap(b, c);
    mesh_.triangles.push_back({first_ + a, first_ + b, first_ + c});
  }

  std::uint64_t triangles_max_, nodes_ = 0;
  const std::stop_token& stop_;
  StopPoll poll_;
  tinygltf::Model model_;
  TriangleMesh mesh_;
  std::uint32_t first_ = 0;  ///< vertex of the current primitive
  std::size_t count_ = 0;
  bool mirrored_ = false;
};

}  // namespace

MeshFileResult read_gltf(std::span<const std::byte> bytes, std::uint64_t triangles_max,
                         const std::stop_token& stop) {
  try {
    return GltfReader(bytes, triangles_max, stop).read();
  } catch (const MeshRejection& rejection) {
    return std::unexpected(rejection.error);
  }
}

}  // namespace kerf
