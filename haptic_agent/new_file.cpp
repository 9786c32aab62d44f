// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/new_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace kerf::agent {

std::expected<int, std::string> new_file(const std::string& path) {
  constexpr mode_t kMode = 0644;
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
  if (file >= 0) return file;
  if (errno == EEXIST) return std::unexpected(path + " exists; choose another name");
  return std::unexpected("cannot create " + path + ": " + std::strerror(errno));
}

std::expected<std::ofstream, std::string> new_text_file(const std::string& path) {
  const auto file = new_file(path);
  if (!file) return std::unexpected(file.error());
  ::close(*file);
  return std::ofstream(path);
}

}  // namespace kerf::agent
