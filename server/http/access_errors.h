// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/api.h"

namespace kerf::net {

/// Returns the response to a request that the access rules reject.
ApiResponse access_failure(const AccessError& error);

}  // namespace kerf::net
