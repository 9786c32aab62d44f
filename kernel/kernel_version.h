// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf {

/// Version of the kernel's results. It is raised whenever equal settings and commands may give a
/// different state hash (Sculpture::state_hash). Hashes of different versions must not be compared;
/// a journal stores the version that computed its hashes (server/store/README.md).
inline constexpr std::int64_t kKernelVersion = 9;

}  // namespace kerf
