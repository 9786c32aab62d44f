// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/server.h"

namespace CLI {
class App;
}

namespace kerf {

/// Adds the options that limit the cost of viewers. They are stored in `server`.
void describe_viewers(CLI::App& app, net::ServerOptions& server);

}  // namespace kerf
