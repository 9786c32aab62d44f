// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/matter_store.h"

namespace kerf::net {

/// Returns the routes that list, undo and redo strokes.
HttpMatter http_strokes();

}  // namespace kerf::net
