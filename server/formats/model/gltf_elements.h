// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "kernel/math/vec3.h"
#include "server/formats/model/mesh_rejection.h"

namespace tinygltf {
class Model;
struct Accessor;
}  // namespace tinygltf

namespace kerf {

/// Returns an item of a list of a glTF file. Throws MeshRejection if it does not exist.
template <class Item>
const Item& gltf_item(const std::vector<Item>& list, int number, const char* what) {
  if (number < 0 || static_cast<std::size_t>(number) >= list.size())
    reject_mesh(MeshFileErrorCode::kBadIndex,
                std::string(what) + ' ' + std::to_string(number) + " does not exist");
  return list[static_cast<std::size_t>(number)];
}

/// The elements of an accessor, whose model must outlive them. Throws MeshRejection if any byte is
/// outside the buffer.
class GltfElements {
 public:
  GltfElements(const tinygltf::Model& model, int accessor);

  std::size_t size() const { return count_; }
  bool is_vec3() const { return components_ == 3; }
  bool is_index() const;
  /// Requires is_index() and n < size().
  std::uint32_t index(std::size_t n) const { return static_cast<std::uint32_t>(value(n, 0)); }
  /// Requires is_vec3() and n < size().
  Vec3 position(std::size_t n) const;

 private:
  GltfElements() = default;
  /// Points to `count_` elements that begin `offset` bytes after the start of a view.
  void point_to(const tinygltf::Model& model, int view, std::size_t offset, std::size_t stride);
  void read_sparse(const tinygltf::Model& model, const tinygltf::Accessor& accessor);
  double value(std::size_t n, std::size_t component) const;

  std::string name_;
  const unsigned char* data_ = nullptr;  ///< null: all zero
  std::size_t count_ = 0, stride_ = 0;
  int type_ = 0, components_ = 0;
  bool normalized_ = false;
  std::unordered_map<std::uint32_t, Vec3> replaced_;  ///< by a sparse accessor
};

}  // namespace kerf
