// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "server/http/routes.h"

namespace kerf::net {

/// Returns the routes that list, create, rename and delete named versions.
std::span<const Route> version_routes();

}  // namespace kerf::net
