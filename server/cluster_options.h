// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/server.h"

namespace CLI {
class App;
}

namespace kerf {

/// Adds the options of copies at NATS and of a cluster. `durable` receives the value of --durable.
void describe_cluster(CLI::App& app, net::ServerOptions& server, std::string& durable);

/// Returns a conflict between these options, or an empty text.
std::string cluster_fault(const net::ServerOptions& server, const std::string& durable);

}  // namespace kerf
