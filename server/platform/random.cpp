// SPDX-License-Identifier: Apache-2.0
#include "server/platform/random.h"

#include <sys/random.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstdlib>

namespace kerf {

bool fill_random(std::span<std::byte> bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t filled = getrandom(bytes.data(), bytes.size(), 0);
    if (filled < 0 && errno == EINTR) continue;
    if (filled <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(filled));
  }
  return true;
}

std::uint64_t random_number() noexcept {
  std::array<std::byte, sizeof(std::uint64_t)> bytes{};
  if (!fill_random(bytes)) {
    std::perror("the system gives no random numbers: getrandom");
    std::abort();
  }
  return std::bit_cast<std::uint64_t>(bytes);
}

}  // namespace kerf
