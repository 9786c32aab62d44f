// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/matter_store.h"

namespace kerf::net {

/// Returns the routes that list, store and delete target parts and compare the block with them, and
/// the maker of their store.
HttpMatter http_targets();

}  // namespace kerf::net
