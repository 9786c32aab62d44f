// SPDX-License-Identifier: Apache-2.0
#include "server/cluster_options.h"

#include <CLI/CLI.hpp>

#include "server/cluster/nats_address.h"
#include "server/http/browser_rules.h"
#include "server/session/session_id.h"

namespace kerf {
namespace {

void describe_copies(CLI::App& app, net::ServerOptions& server) {
  app.add_option("--nats", server.copies.url,
                 "nats://[USER:PASSWORD@]HOST:PORT of a NATS server with JetStream, to which the "
                 "journals are copied while they are written; several of a cluster are separated "
                 "by commas; default: none")
      ->check(CLI::Validator(nats_fault, ""));
  app.add_option("--nats-replicas", server.copies.replicas,
                 "servers of the NATS cluster that keep each copy, 1 to 5")
      ->check(CLI::Range(1, 5))
      ->capture_default_str();
}

}  // namespace

void describe_cluster(CLI::App& app, net::ServerOptions& server, std::string& durable) {
  describe_copies(app, server);
  const auto name = [](const std::string& text) {
    return is_session_id(text) ? std::string()
                               : "must be 1 to 64 characters from a-z, 0-9, - and _";
  };
  const auto address = [](const std::string& text) {
    return net::is_server_address(text) ? std::string()
                                        : "must be http:// or https://, a host and a port";
  };
  app.add_option(
         "--node", server.cluster.node,
         "name of this server, which shares its sessions with the other servers of the NATS "
         "server that have one: when one of them is gone or stops, the others go on")
      ->check(CLI::Validator(name, ""));
  app.add_option("--advertise", server.cluster.advertise,
                 "address of this server for agents and browsers, e.g. http://10.0.0.1:8080; "
                 "default: that of --listen")
      ->check(CLI::Validator(address, ""));
  app.add_option_function<std::string>(
         "--follow",
         [&server](const std::string& word) { server.cluster.follow = *parse_follow(word); },
         "none, viewed, all, or only: sessions of the other servers of which this one keeps the "
         "block, cut as it is cut there: viewers may watch them here, and it goes on with them "
         "faster; viewed: those for which viewers come; only: the same, and it runs no sessions "
         "itself; default: none")
      ->check(CLI::IsMember({"none", "viewed", "all", "only"}));
  app.add_option("--lease-ms", server.cluster.lease_ms,
                 "time for which this server may change a session after it has renewed its lease; "
                 "another one takes the lease of a server that is gone a quarter later: a short "
                 "time ends the wait of agents sooner, and pauses sessions when NATS is slow")
      ->check(CLI::Range(kLeaseMsMin, kLeaseMsMax))
      ->capture_default_str();
  app.add_option("--durable", durable,
                 "disk, or copied: when a sample is safe, and no agent sends it again: on this "
                 "machine's disk, or when NATS has it too; default: copied with --node, else disk")
      ->check(CLI::IsMember({"disk", "copied"}));
}

std::string cluster_fault(const net::ServerOptions& server, const std::string& durable) {
  const ClusterOptions& cluster = server.cluster;
  const bool has_nats = !server.copies.url.empty();
  if (!cluster.node.empty() && !has_nats) return "--node needs --nats";
  if (durable == "copied" && !has_nats) return "--durable copied needs --nats";
  if (cluster.follow != Follow::kNone && cluster.node.empty()) return "--follow needs --node";
  if (!cluster.advertise.empty() && cluster.node.empty()) return "--advertise needs --node";
  const bool is_any = server.address == "0.0.0.0" || server.address == "::";
  if (!cluster.node.empty() && cluster.advertise.empty() && is_any) {
    return "--node needs --advertise when the server listens on all addresses";
  }
  return {};
}

}  // namespace kerf
