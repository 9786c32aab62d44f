// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/matter_store.h"

namespace kerf::net {

/// Returns the routes that list the tools of a session and make new ones.
HttpMatter http_tools();

}  // namespace kerf::net
