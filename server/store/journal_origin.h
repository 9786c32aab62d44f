// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace kerf {

/// What a journal begins with, besides its records: all that a replay needs of it.
struct JournalOrigin {
  std::string session;                       ///< id
  std::string scene_json;                    ///< canonical
  std::map<std::string, std::string> files;  ///< that the scene names, with their contents
};

/// Encodes an origin: little-endian u32 number of texts, then each as a u32 number of bytes and the
/// bytes: id, scene, and of each file its name and its contents.
std::vector<std::byte> encode_origin(const JournalOrigin& origin);
/// The error is one sentence.
std::expected<JournalOrigin, std::string> read_origin(std::span<const std::byte> bytes);

}  // namespace kerf
