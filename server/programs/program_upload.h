// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/api_call.h"

namespace kerf::net {

/// Carves the program in the body of a request.
ApiResponse start_program(const ApiCall& call);
/// Derives a scene from the program in the body.
ApiResponse describe_program(const ApiCall& call);

}  // namespace kerf::net
