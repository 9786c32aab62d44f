// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/matter_store.h"

namespace kerf::net {

/// Returns the route of pictures of blocks, and the maker of their store.
HttpMatter http_pictures();

}  // namespace kerf::net
