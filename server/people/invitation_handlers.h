// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/api_call.h"

namespace kerf::net {

/// Handlers of people_routes.cpp for invitations and passes.
ApiResponse list_invitations(const ApiCall& call);
ApiResponse invite(const ApiCall& call);
ApiResponse revoke(const ApiCall& call);
/// Exchanges an invitation for a pass.
ApiResponse redeem(const ApiCall& call);

}  // namespace kerf::net
