// SPDX-License-Identifier: Apache-2.0
#include "server/formats/text_file.h"

#include <array>
#include <cstdio>
#include <memory>

namespace kerf {
namespace {

struct Closer {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

}  // namespace

std::optional<std::string> read_file(const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, Closer> file(std::fopen(path.c_str(), "rb"));
  if (!file) return std::nullopt;
  std::string bytes;
  std::array<char, 1 << 16> chunk;
  while (const std::size_t count = std::fread(chunk.data(), 1, chunk.size(), file.get()))
    bytes.append(chunk.data(), count);
  if (std::ferror(file.get()) != 0) return std::nullopt;  // such as a folder
  return bytes;
}

}  // namespace kerf
