// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "server/http/routes.h"
#include "server/session/matter.h"

namespace kerf::net {

/// The matters of this server: the one registration of each (server/session/README.md#matters).
/// Their order is that of their messages to viewers.
std::vector<MakeMatter> matters();
/// The routes of each matter.
std::vector<std::span<const Route>> matter_routes();

}  // namespace kerf::net
