// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/glb_group.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace kerf {
namespace {

// glTF's component types.
constexpr int kInt8 = 5120, kUint8 = 5121, kInt16 = 5122, kUint16 = 5123, kUint32 = 5125,
              kFloat32 = 5126;
constexpr double kStepsMax = 65535;
constexpr int kStepZero = 32768;
constexpr int kNormalBits = 8;

template <class T, std::size_t N>
GlbArray make_array(const char* name, int component, const char* type, bool normalized,
                    const std::vector<std::array<T, N>>& values) {
  GlbArray array{.name = name,
                 .component = component,
                 .type = type,
                 .normalized = normalized,
                 .stride = sizeof(values[0]),
                 .count = values.size(),
                 .min = {},
                 .max = {},
                 .bytes = std::vector<std::byte>(values.size() * sizeof(values[0]))};
  std::memcpy(array.bytes.data(), values.data(), array.bytes.size());
  return array;
}

template <class T, std::size_t N>
void set_bounds(GlbArray& array, const std::vector<std::array<T, N>>& values) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto less = [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; };
    const auto [low, high] = std::minmax_element(values.begin(), values.end(), less);
    array.min.push_back(static_cast<double>((*low)[axis]));
    array.max.push_back(static_cast<double>((*high)[axis]));
  }
}

// Elements are padded to a multiple of four bytes, as glTF requires.
using Steps = std::array<std::int16_t, 4>;

Steps to_steps(const std::array<float, 3>& p, const GlbLattice& lattice) {
  Steps steps{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double step =
        std::clamp(std::floor(static_cast<double>(p[c]) / lattice.step_mm + 0.5), 0.0, kStepsMax);
    steps[c] = static_cast<std::int16_t>(static_cast<int>(step) - kStepZero);
  }
  return steps;
}

/// Drops triangles whose corners quantize to fewer than three positions. The surface stays closed.
void drop_collapsed(const std::vector<Steps>& steps, std::vector<std::uint32_t>& indices) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    const auto &a = steps[indices[t]], &b = steps[indices[t + 1]], &c = steps[indices[t + 2]];
    if (a == b || b == c || c == a) continue;
    for (std::size_t k = 0; k < 3; ++k) indices[kept++] = indices[t + k];
  }
  indices.resize(kept);
}

template <class T>
void reorder(std::vector<T>& values, const std::vector<std::uint32_t>& remap, std::size_t used) {
  if (values.empty()) return;
  std::vector<T> moved(used);
  meshopt_remapVertexBuffer(moved.data(), values.data(), values.size(), sizeof(T), remap.data());
  values = std::move(moved);
}

/// Reorders triangles and vertices for compression and drawing, and drops unused vertices.
void reorder(MeshPiece& mesh) {
  const std::size_t vertices = mesh.positions_mm.size();
  meshopt_optimizeVertexCache(mesh.indices.data(), mesh.indices.data(), mesh.indices.size(),
                              vertices);
  std::vector<std::uint32_t> remap(vertices);
  const std::size_t used = meshopt_optimizeVertexFetchRemap(remap.data(), mesh.indices.data(),
                                                            mesh.indices.size(), vertices);
  meshopt_remapIndexBuffer(mesh.indices.data(), mesh.indices.data(), mesh.indices.size(),
                           remap.data());
  reorder(mesh.positions_mm, remap, used);
  reorder(mesh.normals, remap, used);
  reorder(mesh.colors, remap, used);
  reorder(mesh.deviations_mm, remap, used);
}

GlbArray quantized_normals(const std::vector<std::array<float, 3>>& normals) {
  std::vector<std::array<std::int8_t, 4>> values;
  values.reserve(normals.size());
  for (const auto& n : normals) {
    std::array<std::int8_t, 4> value{};
    for (std::size_t c = 0; c < 3; ++c) {
      value[c] = static_cast<std::int8_t>(meshopt_quantizeSnorm(n[c], kNormalBits));
    }
    values.push_back(value);
  }
  return make_array("NORMAL", kInt8, "VEC3", true, values);
}

/// Converts sRGB (IEC 61966-2-1) to the linear vertex colors of glTF.
std::uint8_t to_linear(std::uint8_t encoded) {
  const double c = encoded / 255.0;
  const double linear = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  return static_cast<std::uint8_t>(linear * 255 + 0.5);
}

GlbArray linear_colors(const std::vector<std::array<std::uint8_t, 3>>& colors) {
  std::vector<std::array<std::uint8_t, 4>> values;
  values.reserve(colors.size());
  for (const auto& c : colors) {
    values.push_back({to_linear(c[0]), to_linear(c[1]), to_linear(c[2]), 255});
  }
  return make_array("COLOR_0", kUint8, "VEC4", true, values);
}

GlbArray index_array(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
  if (vertices > GlbGroup::kVerticesMax) {
    std::vector<std::array<std::uint32_t, 1>> wide;
    wide.reserve(indices.size());
    for (const std::uint32_t n : indices) wide.push_back({n});
    return make_array("", kUint32, "SCALAR", false, wide);
  }
  std::vector<std::array<std::uint16_t, 1>> narrow;
  narrow.reserve(indices.size());
  for (const std::uint32_t n : indices) narrow.push_back({static_cast<std::uint16_t>(n)});
  return make_array("", kUint16, "SCALAR", false, narrow);
}

void compress(GlbArray& array, const std::vector<std::uint32_t>& indices) {
  // The codec versions that EXT_meshopt_compression specifies.
  meshopt_encodeVertexVersion(0);
  meshopt_encodeIndexVersion(1);
  const bool is_index = array.name.empty();
  std::vector<unsigned char> out(is_index
                                     ? meshopt_encodeIndexBufferBound(indices.size(), UINT32_MAX)
                                     : meshopt_encodeVertexBufferBound(array.count, array.stride));
  const std::size_t bytes =
      is_index ? meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), indices.size())
               : meshopt_encodeVertexBuffer(out.data(), out.size(), array.bytes.data(), array.count,
                                            array.stride);
  array.bytes.resize(bytes);
  std::memcpy(array.bytes.data(), out.data(), bytes);
  array.compressed = true;
}

}  // namespace

GlbLattice glb_lattice(Vec3 size_mm) {
  const double largest = std::max({size_mm.x, size_mm.y, size_mm.z});
  int exponent = 0;
  std::frexp(largest / kStepsMax, &exponent);  // largest / 65535 < 2^exponent
  return {.step_mm = std::ldexp(1.0, exponent)};
}

void GlbGroup::add(const MeshPiece& piece) {
  const auto first = static_cast<std::uint32_t>(mesh_.positions_mm.size());
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(mesh_.positions_mm, piece.positions_mm);
  append(mesh_.normals, piece.normals);
  append(mesh_.colors, piece.colors);
  append(mesh_.deviations_mm, piece.deviations_mm);
  for (const std::uint32_t n : piece.indices) mesh_.indices.push_back(first + n);
}

std::vector<GlbArray> GlbGroup::take(ModelEncoding encoding, const GlbLattice& lattice) {
  MeshPiece mesh = std::exchange(mesh_, {});
  const bool quantized = encoding != ModelEncoding::kFloat;
  const bool meshopt = encoding == ModelEncoding::kMeshopt;
  std::vector<Steps> steps;
  if (quantized) {
    for (const auto& p : mesh.positions_mm) steps.push_back(to_steps(p, lattice));
    drop_collapsed(steps, mesh.indices);
  }
  if (mesh.indices.empty()) return {};
  if (meshopt) {
    reorder(mesh);
    steps.clear();
    for (const auto& p : mesh.positions_mm) steps.push_back(to_steps(p, lattice));
  }
  std::vector<GlbArray> arrays;
  if (quantized) {
    arrays.push_back(make_array("POSITION", kInt16, "VEC3", false, steps));
    set_bounds(arrays.back(), steps);
    arrays.push_back(quantized_normals(mesh.normals));
  } else {
    arrays.push_back(make_array("POSITION", kFloat32, "VEC3", false, mesh.positions_mm));
    set_bounds(arrays.back(), mesh.positions_mm);
    arrays.push_back(make_array("NORMAL", kFloat32, "VEC3", false, mesh.normals));
  }
  if (!mesh.colors.empty()) arrays.push_back(linear_colors(mesh.colors));
  if (!mesh.deviations_mm.empty()) {
    std::vector<std::array<float, 1>> values;
    values.reserve(mesh.deviations_mm.size());
    for (const float d : mesh.deviations_mm) values.push_back({d});
    arrays.push_back(make_array("_DEVIATION_MM", kFloat32, "SCALAR", false, values));
  }
  arrays.push_back(index_array(mesh.indices, mesh.positions_mm.size()));
  if (meshopt) {
    for (GlbArray& array : arrays) compress(array, mesh.indices);
  }
  return arrays;
}

}  // namespace kerf
