// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "server/rights/caller.h"
#include "server/socket/peer_context.h"
#include "server/websocket/byte_stream.h"
#include "server/websocket/upgrade_request.h"

namespace kerf::net {

/// Serve an agent or a viewer until its WebSocket closes. Both take over an accepted connection
/// whose upgrade request has been read and checked. `caller` is identified by the request's token.
void serve_agent(ByteStream stream, UpgradeRequest request, std::shared_ptr<Session> session,
                 Caller caller, PeerContext& context);
void serve_viewer(ByteStream stream, UpgradeRequest request, std::shared_ptr<Session> session,
                  Caller caller, PeerContext& context);
/// Redirects a peer to the server `address`, which has the session, with a bye.
void serve_redirect(ByteStream stream, UpgradeRequest request, std::string_view protocol,
                    const std::string& address);

}  // namespace kerf::net
