// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace kerf {

/// The beginning of a journal: all data for a replay except the records.
struct JournalOrigin {
  std::string session;                       ///< id
  std::string scene_json;                    ///< canonical
  std::map<std::string, std::string> files;  ///< contents of the files that the scene names
};

/// Encodes an origin: little-endian u32 number of texts, then each as a u32 number of bytes and the
/// bytes: id, scene, and the name and contents of each file.
std::vector<std::byte> encode_origin(const JournalOrigin& origin);
/// Decodes an origin. The error is one sentence.
std::expected<JournalOrigin, std::string> read_origin(std::span<const std::byte> bytes);

}  // namespace kerf
