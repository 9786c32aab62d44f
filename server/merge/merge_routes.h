// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/matter_store.h"

namespace kerf::net {

/// The route that merges a .kerf file with a session into a new session.
HttpMatter http_merge();

}  // namespace kerf::net
