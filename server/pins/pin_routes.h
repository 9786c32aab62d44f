// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/matter_store.h"

namespace kerf::net {

/// Returns the routes that list, set and remove pins.
HttpMatter http_pins();

}  // namespace kerf::net
