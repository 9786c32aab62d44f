// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/api_call.h"

namespace kerf::net {

/// Handlers of people_routes.cpp for the reserved regions of a block.
ApiResponse list_regions(const ApiCall& call);
ApiResponse reserve(const ApiCall& call);
ApiResponse release(const ApiCall& call);

}  // namespace kerf::net
