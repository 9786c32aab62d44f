// SPDX-License-Identifier: Apache-2.0
#pragma once

// The parts of ClusterNode. Its threads are in cluster_threads.cpp.

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/cluster/cluster_node.h"
#include "server/cluster/followers.h"
#include "server/cluster/lease_table.h"
#include "server/cluster/live_states.h"
#include "server/cluster/nats_connection.h"
#include "server/cluster/own_leases.h"
#include "server/platform/random.h"

namespace kerf {

struct ClusterNode::Impl {
  Impl(NatsConnection connection, int count, std::string name, std::string run_name)
      : nats(std::move(connection)),
        replicas(count),
        node(std::move(name)),
        run(std::move(run_name)),
        own(nats, run),
        table(node, run) {}

  void renew_all(const std::stop_token& stop);
  void renew(const std::string& id);
  std::optional<ShownSession> shown(const std::string& id) const;
  void state_itself();
  void watch_all(const std::stop_token& stop);
  void watch(const std::stop_token& stop);
  void take_note(const StreamMessage& message);
  void take_all(const std::stop_token& stop);
  std::optional<std::string> next_to_take();
  void take(const std::string& id);
  std::optional<std::uint32_t> take_lease(const std::string& id, const SeenLease& seen,
                                          std::uint32_t epoch_of_copy);
  void leave(const std::string& id, const SeenLease& seen);
  void end_former(const std::string& id);
  void note_not_taken(const std::string& id, const SeenLease& seen, const LeaseError& error);
  bool open(const std::string& id);
  void find_local();
  void hand_over_lost();
  void follow_others();

  NatsConnection nats;
  int replicas;
  std::string node, run, address;
  bool only_follows = false;
  LeaseTime lease_time;
  SessionRegistry* registry = nullptr;
  std::function<void(const LoadReport&)> report;
  OwnLeases own;
  std::map<std::string, std::string> faults;  ///< renewer only: faults of sessions, as logged
  std::int64_t noted_ns = 0;                  ///< renewer's thread only

  mutable std::mutex mutex;  ///< guards the members below; while it is held only the mutex of
                             ///< OwnLeases may be locked
  LeaseTable table;
  std::int64_t heard_ns = 0;  ///< time of the watch's last message; 0: the watch is down
  /// When to try a free lease, and when to retry a session that could not be opened.
  std::map<std::string, std::int64_t> due_ns, again_ns;
  std::set<std::string> taking;
  std::set<std::string> local;  ///< journals of the data folder at the start
  bool holds = false;
  std::map<std::string, std::int64_t> lost;  ///< sessions to end, and since when
  std::set<std::string> ending;              ///< sessions that a thread is ending
  std::mt19937_64 chance{random_number()};
  /// Both exist between start() and hold(), the first one on request.
  std::unique_ptr<Followers> followers;
  std::unique_ptr<LiveStates> live;
  std::jthread renewer, watcher;
  std::vector<std::jthread> takers;
};

}  // namespace kerf
