// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <stop_token>
#include <string>

namespace kerf {

/// Returns a binary glTF file reduced to its triangles, for tinygltf, which trusts the paths of
/// pictures and would unpack them. Views of positions and indices that are compressed by
/// EXT_meshopt_compression are unpacked after the file's own bytes. Throws MeshRejection: not a
/// file of version 2, shorter than stated, an unsupported required extension, compressed data that
/// are invalid or unpack to more than 64 times the file's size, more items than a scene needs, a
/// requested stop.
std::string gltf_geometry(std::span<const std::byte> bytes, const std::stop_token& stop = {});

}  // namespace kerf
