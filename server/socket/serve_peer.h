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

/// Serves an agent or a viewer until its WebSocket closes. Both take over an accepted connection
/// whose upgrade request has been read and checked; `caller` is who the request's token says it is.
void serve_agent(ByteStream stream, UpgradeRequest request, std::shared_ptr<Session> session,
                 Caller caller, PeerContext& context);
void serve_viewer(ByteStream stream, UpgradeRequest request, std::shared_ptr<Session> session,
                  Caller caller, PeerContext& context);
/// Sends a peer to the server `address`, which has the session, with a bye.
void serve_redirect(ByteStream stream, UpgradeRequest request, std::string_view protocol,
                    const std::string& address);

}  // namespace kerf::net
