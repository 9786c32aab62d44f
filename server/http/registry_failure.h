// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/api_call.h"
#include "server/session/session_registry.h"

namespace kerf::net {

/// Returns the response for a scene that is invalid, or a session that cannot be created, opened or
/// closed.
ApiResponse registry_failure(const RegistryError& error);

}  // namespace kerf::net
