// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "server/http/routes.h"

namespace kerf::net {

/// Returns the routes that list, set and remove pins.
std::span<const Route> pin_routes();

}  // namespace kerf::net
