// SPDX-License-Identifier: Apache-2.0
#include "server/server.h"

#include <algorithm>
#include <boost/asio/detached.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>

#include "server/certificate.h"
#include "server/http/api.h"
#include "server/http/http_connection.h"
#include "server/log/log.h"
#include "server/matters.h"
#include "server/metrics/metrics.h"
#include "server/session/journal_watch.h"
#include "server/session_log.h"
#include "server/socket/viewer_hub.h"
#include "server/store/folder_lock.h"
#include "server/store/private_file.h"
#include "server/threads/fair_threads.h"
#include "server/threads/run_and_wait.h"
#include "server/threads/run_on.h"
#include "server/threads/thread_pool.h"
#include "server/udp/udp_port.h"

namespace kerf::net {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

/// Niceness of threads with visible results, and of those with background work. Next to programs
/// that keep all cores busy a thread gets about 0.6 and 0.3 of their share. The threads of agents,
/// with niceness 0, get a full share, and first.
constexpr int kShown = 2, kBehind = 5;
/// Time for peers to receive their bye when the server stops.
constexpr std::chrono::seconds kDrainTime{2};
/// Time for the connections of agents to end after they have been cut off.
constexpr std::chrono::seconds kCutTime{10};
/// Time until journals that could not be read because of the disk are retried; doubled after each
/// attempt without a change.
constexpr std::chrono::seconds kReloadTime{1}, kReloadTimeMax{60};
/// Sessions loaded at the same time: each needs a core, and memory in addition to its block.
constexpr unsigned kLoadersMax = 4;
/// Most threads that carve one session.
constexpr int kCarversMax = 8;
/// Polling interval of the sizes of the files.
constexpr std::chrono::seconds kDiskTime{1};
/// Pause after an accept error, e.g. because the process is out of file descriptors.
constexpr std::chrono::milliseconds kAcceptPause{100};

constexpr std::string_view kNeedsRights =
    " can be reached from other machines, and everybody there could carve and delete. Start with "
    "--admin-token-file FILE (made if it does not exist) and invite people, with --open for a "
    "demonstration, or listen on 127.0.0.1";

constexpr std::string_view kProxyNeedsRights =
    " makes everybody behind the proxy an administrator of a server without rights. Start with "
    "--admin-token-file FILE or --open";

}  // namespace

struct Server::Impl {
  Impl(ServerOptions server_options, FolderLock folder_lock, std::unique_ptr<Access> rights,
       std::unique_ptr<TlsCertificate> tls, std::unique_ptr<ClusterNode> cluster)
      : options(std::move(server_options)),
        lock(std::move(folder_lock)),
        access(std::move(rights)),
        certificate(std::move(tls)),
        node(std::move(cluster)),
        spawner("spawner", 1, 0),
        viewers("viewers", 1, kShown),
        meshing("meshing", 1, kShown),
        past("past", 1, kBehind),
        snapshots("snapshots", 1, kBehind),
        registry(
            {options.http.data_folder, options.sessions_max, options.session, log_pause,
             SnapshotOptions{&snapshots, options.snapshots, log_snapshot_failure}, options.disk,
             carvers.count() > 1 ? &carvers : nullptr, node.get(), options.needs_copy, log_damage,
             net::matters()},
            [this](const std::string& id) { return spawner.create_nested("s:" + id, 1, 0); },
            meshing),
        api(options.http, registry, metrics, *access, http_matters),
        immediate("immediate", 1, kShown),
        acceptor(viewers.context()) {}

  asio::awaitable<void> accept();
  /// The server that continues the sessions: requested by an administrator, else set at the start.
  std::string redirect() const {
    const std::string asked = api.drain_target();
    return asked.empty() ? options.drain_to : asked;
  }
  std::expected<void, std::string> listen_udp();
  /// Loads the sessions of the folder in parallel, then retries those whose disk failed, as soon as
  /// it works again.
  void load(const std::stop_token& stop);
  void reload(const std::stop_token& stop);
  /// Enforces the disk limits.
  void watch_disk(const std::stop_token& stop);

  ServerOptions options;
  FolderLock lock;  ///< of the data folder; released when all journals are closed
  std::unique_ptr<Access> access;
  std::unique_ptr<TlsCertificate> certificate;  ///< null: without TLS
  std::unique_ptr<ClusterNode> node;            ///< null: not in a cluster
  Metrics metrics;
  UdpPort udp{metrics};
  OpenConnections open;  ///< viewers' thread only; outlives the connections
  IoThreads spawner;     ///< creates the sessions' threads, which inherit its niceness of 0
  IoThreads viewers, meshing, past, snapshots;
  /// Helpers of the sessions' threads. They sleep at once, because agents pause longer than a
  /// thread could spin.
  ThreadPool carvers{std::min(usable_threads(), kCarversMax), ThreadPool::Idle::kSleeps};
  SessionRegistry registry;
  JournalWatch watch{registry, snapshots};
  const std::vector<HttpMatter> http_matters = net::http_matters();
  Api api;
  IoThreads immediate;  ///< after `api`, which requests in progress use
  FairThreads control{"control", kShown}, history{"history", kShown}, workers{"workers", kBehind},
      readers{"readers", kBehind}, exports{"exports", kBehind};
  HubDirectory hubs;
  PeerContext peers{options.session,       metrics, hubs,    udp,
                    options.viewer_budget, viewers, meshing, past};
  HttpContext context{options.http,  registry,      metrics,          api,           immediate,
                      control.queue, history.queue, workers.queue,    readers.queue, exports.queue,
                      peers,         open,          certificate.get()};
  tcp::acceptor acceptor;
  std::uint16_t port = 0;
  bool stopped = false;
  std::unique_ptr<Replication> copies;  ///< null: journals are not copied
  std::jthread loader, disk_watch;
};

void Server::Impl::load(const std::stop_token& stop) {
  const std::stop_callback end(stop, [this] { registry.stop_loading(); });
  {
    std::vector<std::jthread> threads;
    const unsigned count = std::clamp(std::thread::hardware_concurrency(), 1U, kLoadersMax);
    threads.reserve(count);
    for (unsigned n = 0; n < count; ++n) {
      threads.emplace_back([this] {
        LoadReport report;
        while (registry.load_next(report)) log_report(std::exchange(report, {}));
      });
    }
  }
  reload(stop);
}

void Server::Impl::reload(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock guard(mutex);
  const auto failed_disk = [](const UnreadableSession& session) {
    return session.error.code == JournalErrorCode::kIo;
  };
  auto time = kReloadTime;
  while (std::ranges::any_of(registry.unreadable(), failed_disk)) {
    wake.wait_for(guard, stop, time, [] { return false; });
    if (stop.stop_requested()) return;
    const auto started = registry.retry_disk_failures();
    for (const std::string& id : started) log::info("session " + id + ": its disk works again");
    time = started.empty() ? std::min(2 * time, kReloadTimeMax) : kReloadTime;
  }
}

void Server::Impl::watch_disk(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock guard(mutex);
  while (!stop.stop_requested()) {
    registry.keep_disk_limits();
    api.keep_space(registry.disk_use(), options.disk);
    wake.wait_for(guard, stop, kDiskTime, [] { return false; });
  }
}

std::expected<void, std::string> Server::Impl::listen_udp() {
  const UdpOptions& udp_options = options.udp;
  if (!udp_options.on) return {};
  auto listening = udp.listen(udp_options.address.empty() ? options.address : udp_options.address,
                              udp_options.port.value_or(port));
  if (listening || udp_options.required) return listening;
  log::warn(listening.error() + "; agents will use their WebSockets");
  return {};
}

asio::awaitable<void> Server::Impl::accept() {
  for (;;) {
    error_code error;
    tcp::socket socket =
        co_await acceptor.async_accept(asio::redirect_error(asio::use_awaitable, error));
    if (error == asio::error::operation_aborted || !acceptor.is_open()) co_return;
    if (error) {
      log::warn("accept: " + error.message());
      asio::steady_timer pause(viewers.context(), kAcceptPause);
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
      continue;
    }
    const std::int64_t count = metrics.connections + metrics.viewers + metrics.agents;
    if (static_cast<std::size_t>(count) >= options.connections_max) {
      metrics.rejected("connections");
      if (!open.close_one()) continue;  // closed at once
    }
    asio::co_spawn(viewers.context(), serve_http(std::move(socket), context), asio::detached);
  }
}

Server::Server(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Server::~Server() {
  stop();
  // An agent's connection belongs to the thread of its session and uses members destroyed here.
  // Peers that do not close are cut off, including those that have not said hello.
  const auto deadline = Clock::now() + kCutTime;
  while (impl_->metrics.agents > 0 && Clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  // The viewers' thread uses the other threads until its last turn, so they are destroyed before
  // it.
  run_and_wait(impl_->viewers, [this] {
    impl_->hubs.finish_reading();
    impl_->viewers.context().stop();
    return true;
  });
}

std::expected<std::unique_ptr<Server>, std::string> Server::create(ServerOptions options) {
  const std::error_code error = create_private_folder(options.http.data_folder);
  if (!std::filesystem::is_directory(options.http.data_folder)) {
    return std::unexpected(options.http.data_folder.string() + ": " + error.message());
  }
  auto lock = FolderLock::take(options.http.data_folder);
  if (!lock) return std::unexpected(lock.error());
  auto access = Access::open({.folder = options.http.data_folder,
                              .admin_token = std::exchange(options.admin_token, {}),
                              .open = options.open});
  if (!access) return std::unexpected(access.error());
  auto certificate = load_certificate(options.tls_certificate, options.tls_key);
  if (!certificate) return std::unexpected(certificate.error());
  std::unique_ptr<ClusterNode> node;
  if (!options.cluster.node.empty()) {
    auto made =
        ClusterNode::connect(options.copies.url, options.copies.replicas, options.cluster.node);
    if (!made) return std::unexpected(made.error());
    node = *std::move(made);
  }
  if (node) {
    options.http.other_servers = [at = node.get()] { return at->other_servers(); };
    options.http.page_servers = [at = node.get()] { return at->page_servers(); };
  }
  auto impl = std::make_unique<Impl>(std::move(options), *std::move(lock), *std::move(access),
                                     *std::move(certificate), std::move(node));
  show_expiry(impl->certificate.get(), impl->metrics);
  if (impl->node) {
    impl->registry.open_one_by_one();  // those whose lease this server gets
  } else if (const auto found = impl->registry.find_journals(); !found) {
    log::error(describe(found.error()));
  }
  impl->loader =
      std::jthread([server = impl.get()](const std::stop_token& stop) { server->load(stop); });
  impl->watch.start();
  impl->disk_watch = std::jthread(
      [server = impl.get()](const std::stop_token& stop) { server->watch_disk(stop); });
  if (!impl->options.copies.url.empty()) {
    auto copies = Replication::start(impl->options.copies, impl->registry);
    if (!copies) return std::unexpected(copies.error());
    impl->copies = *std::move(copies);
  }
  return std::unique_ptr<Server>(new Server(std::move(impl)));
}

SessionRegistry& Server::sessions() { return impl_->registry; }
std::uint16_t Server::port() const { return impl_->port; }
std::uint16_t Server::udp_port() const { return impl_->udp.port(); }

std::string Server::url() const {
  error_code error;
  const bool all = asio::ip::make_address(impl_->options.address, error).is_unspecified();
  const std::string address = all && !error ? "localhost" : impl_->options.address;
  const bool v6 = address.find(':') != std::string::npos;
  const std::string scheme = impl_->certificate ? "https://" : "http://";
  return scheme + (v6 ? "[" + address + "]" : address) + ":" + std::to_string(impl_->port);
}

std::expected<void, std::string> Server::reload_certificate() {
  if (!impl_->certificate) return std::unexpected("the server has no certificate");
  auto reloaded = impl_->certificate->reload();
  show_expiry(impl_->certificate.get(), impl_->metrics);
  return reloaded;
}

std::expected<void, std::string> Server::listen() {
  error_code error;
  const auto address = asio::ip::make_address(impl_->options.address, error);
  if (error) return std::unexpected(impl_->options.address + " is not an IP address");
  if (!address.is_loopback() && impl_->access->regime() == Regime::kLocal) {
    return std::unexpected(impl_->options.address + std::string(kNeedsRights));
  }
  if (!impl_->options.http.proxies.empty() && impl_->access->regime() == Regime::kLocal) {
    return std::unexpected("--trust-proxy" + std::string(kProxyNeedsRights));
  }
  const tcp::endpoint endpoint(address, impl_->options.port);
  tcp::acceptor& acceptor = impl_->acceptor;
  const auto fail = [&] {
    return std::unexpected("cannot listen on " + impl_->options.address + ":" +
                           std::to_string(impl_->options.port) + ": " + error.message());
  };
  if (acceptor.open(endpoint.protocol(), error)) return fail();
  if (acceptor.set_option(tcp::acceptor::reuse_address(true), error)) return fail();
  if (acceptor.bind(endpoint, error)) return fail();
  if (acceptor.listen(asio::socket_base::max_listen_connections, error)) return fail();
  impl_->port = acceptor.local_endpoint(error).port();
  if (auto ok = impl_->listen_udp(); !ok) return ok;
  if (impl_->node) {
    const std::string& advertised = impl_->options.cluster.advertise;
    impl_->node->start(impl_->registry, advertised.empty() ? url() : advertised,
                       impl_->options.cluster, log_report);
  }
  // Requests query the node, so it is started before the first one.
  asio::co_spawn(impl_->viewers.context(), impl_->accept(), asio::detached);
  return {};
}

void Server::stop() {
  if (std::exchange(impl_->stopped, true)) return;
  impl_->loader = {};  // stops it
  impl_->disk_watch = {};
  impl_->watch.stop();
  // The acceptor belongs to the viewers' thread, so it is closed there and destroyed here.
  run_and_wait(impl_->viewers, [this] {
    error_code ignored;
    impl_->acceptor.close(ignored);
    return true;
  });
  impl_->api.stop();
  std::string redirect = impl_->redirect();
  if (impl_->node) {
    impl_->registry.stop_loading();
    const std::string successor = impl_->node->hold();
    if (redirect.empty()) redirect = successor;
  }
  const std::string reason =
      redirect.empty() ? "the server is shutting down" : "the session continues at " + redirect;
  if (impl_->copies) impl_->copies->hold();
  for (const JournalError& lost : impl_->registry.close_all(reason, redirect)) {
    log::error("the last records could not be written and are lost: " + describe(lost));
  }
  const auto deadline = Clock::now() + kDrainTime;
  std::vector<std::string> uncopied;
  if (impl_->copies) uncopied = impl_->copies->finish(deadline);
  if (impl_->node) impl_->node->release(uncopied);
  const Metrics& metrics = impl_->metrics;
  while (metrics.agents + metrics.viewers + metrics.waiting_to_load > 0 &&
         Clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

}  // namespace kerf::net
