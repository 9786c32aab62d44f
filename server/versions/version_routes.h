// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/matter_store.h"

namespace kerf::net {

/// Returns the routes that list, create, rename and delete named versions.
HttpMatter http_versions();

}  // namespace kerf::net
