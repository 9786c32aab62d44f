// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/api_call.h"

namespace kerf::net {

/// Returns a file made from a session.
ApiResponse download(const ApiCall& call);
/// Lists the files in preparation.
ApiResponse list_exports(const ApiCall& call);

}  // namespace kerf::net
