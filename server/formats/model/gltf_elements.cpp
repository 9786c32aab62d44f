// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/gltf_elements.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace kerf {
namespace {

template <class T>
double read_number(const unsigned char* from, bool normalized) {
  T number;
  std::memcpy(&number, from, sizeof number);
  const auto plain = static_cast<double>(number);
  if (std::is_floating_point_v<T> || !normalized) return plain;
  return std::max(plain / static_cast<double>(std::numeric_limits<T>::max()), -1.0);
}

}  // namespace

GltfElements::GltfElements(const tinygltf::Model& model, int accessor_number)
    : name_("accessor " + std::to_string(accessor_number)) {
  const tinygltf::Accessor& accessor = gltf_item(model.accessors, accessor_number, "accessor");
  type_ = accessor.componentType;
  normalized_ = accessor.normalized;
  count_ = accessor.count;
  components_ = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  if (accessor.sparse.isSparse) {
    // Elements that are neither in a view nor replaced are zero, and may be any number.
    if (accessor.bufferView < 0 && (accessor.sparse.count <= 0 || components_ != 3))
      reject_mesh(MeshFileErrorCode::kSyntax, name_ + " has no elements");
    read_sparse(model, accessor);
    if (accessor.bufferView < 0) return;
  }
  const tinygltf::BufferView& view =
      gltf_item(model.bufferViews, accessor.bufferView, "bufferView");
  const int stride = accessor.ByteStride(view);
  point_to(model, accessor.bufferView, accessor.byteOffset,
           static_cast<std::size_t>(std::max(stride, 0)));
}

void GltfElements::point_to(const tinygltf::Model& model, int view_number, std::size_t offset,
                            std::size_t stride) {
  const tinygltf::BufferView& view = gltf_item(model.bufferViews, view_number, "bufferView");
  const tinygltf::Buffer& buffer = gltf_item(model.buffers, view.buffer, "buffer");
  const int component = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type_));
  const auto size = static_cast<std::size_t>(std::max(component * components_, 0));
  if (component <= 0 || components_ <= 0 || stride < size)
    reject_mesh(MeshFileErrorCode::kSyntax, name_ + " has an unknown type or stride");
  const std::size_t in_view = view.byteOffset <= buffer.data.size()
                                  ? std::min(view.byteLength, buffer.data.size() - view.byteOffset)
                                  : 0;
  const bool inside = count_ > 0 && offset <= in_view && in_view - offset >= size &&
                      (count_ - 1) <= (in_view - offset - size) / stride;
  if (!inside) reject_mesh(MeshFileErrorCode::kTruncated, name_ + " ends outside its buffer");
  stride_ = stride;
  data_ = buffer.data.data() + view.byteOffset + offset;
}

void GltfElements::read_sparse(const tinygltf::Model& model, const tinygltf::Accessor& accessor) {
  if (accessor.sparse.count <= 0) return;
  if (components_ != 3)
    reject_mesh(MeshFileErrorCode::kUnsupported, name_ + ": sparse indices are not read");
  GltfElements places, values;
  places.name_ = values.name_ = name_;
  places.count_ = values.count_ = static_cast<std::size_t>(accessor.sparse.count);
  places.type_ = accessor.sparse.indices.componentType;
  places.components_ = 1;
  values.type_ = type_;
  values.components_ = components_;
  values.normalized_ = normalized_;
  const auto size_of = [](int type) {
    return static_cast<std::size_t>(
        std::max(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type)), 0));
  };
  const auto at = [](auto offset) { return static_cast<std::size_t>(std::max(offset, 0)); };
  places.point_to(model, accessor.sparse.indices.bufferView, at(accessor.sparse.indices.byteOffset),
                  size_of(places.type_));
  values.point_to(model, accessor.sparse.values.bufferView, at(accessor.sparse.values.byteOffset),
                  3 * size_of(type_));
  if (!places.is_index())
    reject_mesh(MeshFileErrorCode::kSyntax, name_ + ": sparse places must be unsigned integers");
  for (std::size_t n = 0; n < places.size(); ++n)
    replaced_.insert_or_assign(places.index(n), values.position(n));
}

bool GltfElements::is_index() const {
  return components_ == 1 && (type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                              type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                              type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
}

Vec3 GltfElements::position(std::size_t n) const {
  if (!replaced_.empty()) {
    const auto found = replaced_.find(static_cast<std::uint32_t>(n));
    if (found != replaced_.end()) return found->second;
  }
  return {value(n, 0), value(n, 1), value(n, 2)};
}

double GltfElements::value(std::size_t n, std::size_t component) const {
  if (data_ == nullptr) return 0;
  const unsigned char* from = data_ + n * stride_;
  switch (type_) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return read_number<std::int8_t>(from + component, normalized_);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return read_number<std::uint8_t>(from + component, normalized_);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return read_number<std::int16_t>(from + 2 * component, normalized_);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return read_number<std::uint16_t>(from + 2 * component, normalized_);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return read_number<std::uint32_t>(from + 4 * component, normalized_);
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return read_number<float>(from + 4 * component, normalized_);
    default:
      reject_mesh(MeshFileErrorCode::kUnsupported, "a component type is not one of glTF 2.0");
  }
}

}  // namespace kerf
