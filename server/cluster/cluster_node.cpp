// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/cluster_node.h"

#include <algorithm>
#include <utility>

#include "server/cluster/cluster_node_impl.h"
#include "server/cluster/nats_address.h"
#include "server/cluster/takeover.h"
#include "server/log/log.h"
#include "server/platform/clock.h"
#include "server/platform/random.h"

namespace kerf {
namespace {

/// Sessions taken at the same time.
constexpr int kTakers = 2;

}  // namespace

ClusterNode::ClusterNode(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

ClusterNode::~ClusterNode() = default;

std::expected<std::unique_ptr<ClusterNode>, std::string> ClusterNode::connect(
    const std::string& url, int replicas, std::string node) {
  auto nats = NatsConnection::open(url, "kerf-server " + node);
  if (!nats) return std::unexpected(without_credentials(url) + ": " + nats.error().reason);
  auto impl = std::make_unique<Impl>(*std::move(nats), replicas, std::move(node),
                                     std::to_string(random_number()));
  return std::unique_ptr<ClusterNode>(new ClusterNode(std::move(impl)));
}

void ClusterNode::start(SessionRegistry& registry, std::string address,
                        const ClusterOptions& options,
                        std::function<void(const LoadReport&)> report) {
  impl_->registry = &registry;
  impl_->address = std::move(address);
  impl_->report = std::move(report);
  impl_->only_follows = options.follow == Follow::kOnly;
  const auto thread = [impl = impl_.get()](void (Impl::*run)(const std::stop_token&)) {
    return std::jthread([impl, run](const std::stop_token& stop) { (impl->*run)(stop); });
  };
  impl_->find_local();
  impl_->lease_time = {options.lease_ms * 1'000'000};
  if (options.follow != Follow::kNone) {
    impl_->followers =
        std::make_unique<Followers>(impl_->nats, registry, impl_->node, options.follow);
  }
  impl_->live = std::make_unique<LiveStates>(impl_->nats, registry, impl_->node);
  impl_->renewer = thread(&Impl::renew_all);
  impl_->watcher = thread(&Impl::watch_all);
  for (int n = 0; n < kTakers; ++n) impl_->takers.push_back(thread(&Impl::take_all));
}

std::string ClusterNode::hold() {
  std::string name, address;
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->holds = true;
    if (const auto least = impl_->table.least_loaded(Clock::boot_ns())) {
      name = least->name;
      address = least->address;
    }
  }
  impl_->takers.clear();
  if (impl_->followers) impl_->followers->stop();
  impl_->live.reset();
  impl_->own.name_successor(name);
  if (name.empty()) return {};
  for (const std::string& id : impl_->own.sessions()) (void)impl_->own.renew(id, impl_->shown(id));
  return address;
}

void ClusterNode::release(const std::vector<std::string>& unfinished) {
  impl_->watcher = {};
  impl_->renewer = {};
  for (const std::string& id : impl_->own.sessions()) {
    if (std::ranges::find(unfinished, id) != unfinished.end()) {
      log::error("session " + id + ": its last records are not copied");
    } else {
      const auto lease = impl_->own.find(id);
      impl_->own.give_back(id, LeaseState::kReleased, lease ? lease->to : "");
    }
  }
}

std::expected<void, std::string> ClusterNode::claim(const std::string& id, bool is_known) {
  Impl& impl = *impl_;
  if (impl.only_follows) {
    return std::unexpected("this server only follows sessions (--follow only): ask another one");
  }
  if (const auto made = impl.nats.make_stream(kClusterStream, kClusterSubjects, impl.replicas,
                                              Keep::kLastOfSubject);
      !made) {
    return std::unexpected(made.error().reason);
  }
  const auto last = impl.nats.last_message(kClusterStream, lease_subject(id));
  if (!last) return std::unexpected(last.error().reason);
  const auto known = *last ? decode_lease((*last)->bytes) : std::nullopt;
  if (known && known->state != LeaseState::kClosed) {
    return std::unexpected("session " + id + " already exists, at server " + known->node);
  }
  const auto epoch = epoch_of_copy(impl.nats, id);
  if (!epoch) return std::unexpected(epoch.error());
  if (*epoch > 0 && !is_known) {
    return std::unexpected("NATS has the copy of an earlier session " + id +
                           ": choose another id, or delete it with kerf-server forget " + id);
  }
  const Lease lease{.state = LeaseState::kHeld,
                    .node = impl.node,
                    .run = impl.run,
                    .address = impl.address,
                    .epoch = std::max(known ? known->epoch : 0, *epoch) + 1,
                    .time = impl.lease_time,
                    .to = {},
                    .shown = {}};
  const auto taken = impl.own.take(id, lease, *last ? (*last)->sequence : 0);
  if (!taken) return std::unexpected(taken.error().reason);
  return {};
}

bool ClusterNode::is_taken(const std::string& id) const {
  if (impl_->own.find(id)) return true;
  const std::lock_guard lock(impl_->mutex);
  const SeenLease* seen = impl_->table.find(id);
  return seen != nullptr && seen->lease.state != LeaseState::kClosed;
}

std::shared_ptr<const WriteFence> ClusterNode::fence(const std::string& id) const {
  return impl_->own.fence(id);
}

std::uint32_t ClusterNode::epoch(const std::string& id) const {
  const auto lease = impl_->own.find(id);
  return lease ? lease->epoch : 1;
}

std::expected<void, std::string> ClusterNode::close(const std::string& id) {
  if (const auto closed = impl_->own.close(id); !closed) {
    return std::unexpected(closed.error().reason);
  }
  return {};
}

void ClusterNode::give_up(const std::string& id) {
  impl_->own.give_back(id, LeaseState::kClosed, {});
}

const std::string& ClusterNode::node() const { return impl_->node; }

std::vector<PlacedSession> ClusterNode::elsewhere() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->table.elsewhere();
}

std::optional<std::string> ClusterNode::address_of(const std::string& id) const {
  if (impl_->own.find(id)) return std::nullopt;
  const std::lock_guard lock(impl_->mutex);
  return impl_->table.address_of(id, Clock::boot_ns());
}

bool ClusterNode::is_moving(const std::string& id) const {
  if (impl_->own.find(id)) return false;
  const std::lock_guard lock(impl_->mutex);
  // Before the first message, any session may exist.
  if (impl_->heard_ns == 0 && impl_->table.find(id) == nullptr) return true;
  return impl_->table.is_moving(id, Clock::boot_ns());
}

std::optional<std::string> ClusterNode::needed_server(const std::string& id) const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->table.needed_server(id);
}

std::vector<std::string> ClusterNode::other_servers() const {
  const std::lock_guard lock(impl_->mutex);
  std::vector<std::string> addresses;
  for (const OtherServer& server : impl_->table.others(Clock::boot_ns())) {
    addresses.push_back(server.address);
  }
  return addresses;
}

std::vector<std::string> ClusterNode::page_servers() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->table.page_servers(Clock::boot_ns());
}

bool ClusterNode::wants_to_follow(const std::string& id) {
  if (!impl_->followers || !address_of(id)) return false;
  return impl_->followers->want(id);
}

std::optional<std::string> ClusterNode::place_for_new() {
  if (!impl_->nats.is_connected()) return std::nullopt;
  const std::size_t own = impl_->own.sessions().size();
  const std::lock_guard lock(impl_->mutex);
  const auto least = impl_->table.least_loaded(Clock::boot_ns());
  if (!least || (least->sessions >= own && !impl_->only_follows)) return std::nullopt;
  impl_->table.expect_session(least->name);
  return least->address;
}

}  // namespace kerf
