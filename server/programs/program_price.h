// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/api_call.h"

namespace kerf::net {

/// Estimates the cost of a program in a scene, both in the body: {"scene": SCENE, "program": TEXT}.
ApiResponse price_program(const ApiCall& call);

}  // namespace kerf::net
