// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace kerf::net {

/// Control messages that wait for a peer that does not read; more end the connection.
inline constexpr std::size_t kControlQueueMax = 64;

}  // namespace kerf::net
