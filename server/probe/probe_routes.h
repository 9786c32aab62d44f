// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/matter_store.h"

namespace kerf::net {

/// Returns the routes that describe the surface at a point and name its authors.
HttpMatter http_probe();

}  // namespace kerf::net
