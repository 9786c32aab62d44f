// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/api_call.h"

namespace kerf::net {

/// Handlers for a client that replays and compares the journal of a session. The responses of
/// journal_origin() and journal_records() never change, so caches can keep them.
ApiResponse replay(const ApiCall& call);
ApiResponse journal_hashes(const ApiCall& call);
ApiResponse journal_origin(const ApiCall& call);
ApiResponse journal_records(const ApiCall& call);

}  // namespace kerf::net
