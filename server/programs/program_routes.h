// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/matter_store.h"

namespace kerf::net {

/// Returns the routes that carve, list and control programs, and the maker of their store.
HttpMatter http_programs();

}  // namespace kerf::net
