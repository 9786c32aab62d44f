// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/matter_store.h"

namespace kerf::net {

/// Returns the routes of files made from a session: models, programs, forces, the journal.
HttpMatter http_downloads();

}  // namespace kerf::net
