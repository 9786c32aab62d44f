// SPDX-License-Identifier: Apache-2.0
#include "server/formats/text_file.h"

#include <array>
#include <fstream>

namespace kerf {

std::optional<std::string> read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes;
  // On a folder, read() sets the failure bit where stream iterators would throw.
  std::array<char, 1 << 16> chunk;
  while (file.read(chunk.data(), chunk.size()) || file.gcount() > 0)
    bytes.append(chunk.data(), static_cast<std::size_t>(file.gcount()));
  if (!file.eof()) return std::nullopt;
  return bytes;
}

}  // namespace kerf
