// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "server/http/matter_store.h"
#include "server/session/matter.h"

namespace kerf::net {

/// The matters of this server: the one registration of each (server/session/README.md#matters).
/// Their order is that of their messages to viewers.
std::vector<MakeMatter> matters();
/// The part of each matter in the HTTP interface.
std::vector<HttpMatter> http_matters();

}  // namespace kerf::net
