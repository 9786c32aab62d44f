// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/link/server_link.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "haptic_agent/device/units.h"
#include "haptic_agent/link/connection.h"
#include "haptic_agent/link/server_choice.h"
#include "haptic_agent/link/traffic.h"
#include "haptic_agent/realtime/clock.h"
#include "haptic_agent/realtime/follow_cpu.h"
#include "haptic_agent/realtime/realtime_thread.h"

namespace kerf::agent {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using std::chrono::milliseconds;

constexpr milliseconds kFirstBackOff{50};
constexpr milliseconds kLongestBackOff{2000};
constexpr milliseconds kCloseTimeout{500};
/// Period at which the ring is emptied and timeouts are checked if no sample wakes the link.
constexpr milliseconds kHousekeeping{10};

/// A link that is late also finds several samples, but not so often in a row.
constexpr int kBatchesInARow = 8;

/// WebSocket close code 1000: the purpose of the connection is fulfilled.
constexpr std::uint16_t kNormalClosure = 1000;

}  // namespace

class ServerLink::Impl {
 public:
  Impl(LinkSettings settings, SampleRing& samples, LatestValue<ServerWrench>& wrenches)
      : settings_(std::move(settings)),
        wake_fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
        wake_(io_, wake_fd_),
        housekeeping_(io_),
        back_off_(io_),
        traffic_(samples, wrenches, settings_.traffic) {}

  ~Impl() {
    interrupt();
    if (thread_.joinable()) thread_.join();
  }

  void start() {
    asio::co_spawn(io_, run(), asio::detached);
    asio::co_spawn(io_, housekeep(), asio::detached);
    thread_ = std::thread([this] {
      // The servo thread's warning explains a denial.
      request_fifo(kLinkPriority);
      run_io();
    });
  }

  std::expected<Welcome, std::string> wait_welcome() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return welcome_.has_value() || !failure_.empty(); });
    if (welcome_ && failure_.empty()) return *welcome_;
    return std::unexpected(failure_);
  }

  void interrupt() {
    interrupted_.store(true);
    wake();
  }

  void stop(double drain_s) {
    drain_until_us_.store(monotonic_us() + static_cast<std::uint64_t>(drain_s * kUsPerS));
    wake();
    if (thread_.joinable()) thread_.join();
  }

  void ask(bool undone) noexcept {
    if (!connected()) return;
    (undone ? undos_ : redos_).fetch_add(1);
    wake();
  }

  void wake() noexcept {
    const std::uint64_t one = 1;
    // The write fails only if the counter is full, and then the link is already awake.
    [[maybe_unused]] const auto written = ::write(wake_fd_, &one, sizeof one);
  }

  const LinkReport& report() const noexcept { return report_; }
  bool connected() const noexcept { return connected_.load(); }
  bool rejected() const noexcept { return rejected_.load(); }

 private:
  /// While the servo hands over several samples at a time, because the replica answers them,
  /// received frames are not urgent and are handled at the next wake-up by the servo. While a frame
  /// is being written to a peer that does not read, wake-ups are not consumed.
  void run_io() {
    FollowCpu place(settings_.lead);
    while (!io_.stopped()) {
      const bool drains = drain_until_us_.load() != 0 || interrupted();
      if (batches_ < kBatchesInARow || !awaits_wake_ || drains) {
        if (batches_ < kBatchesInARow || drains) place.release();
        io_.run_one();
        continue;
      }
      pollfd event{.fd = wake_fd_, .events = POLLIN, .revents = 0};
      ::poll(&event, 1, static_cast<int>(kHousekeeping.count()));
      place.begin(monotonic_ns());
      io_.poll();
      place.end(monotonic_ns());
    }
  }

  void count_batch(std::size_t samples) {
    if (samples == 0) return;
    const bool is_batch = samples > 1 && settings_.traffic.copy != nullptr;
    batches_ = is_batch ? std::min(batches_ + 1, kBatchesInARow) : 0;
  }

  bool interrupted() const noexcept { return interrupted_.load(); }

  void notice(const std::string& text) const {
    if (settings_.notice) settings_.notice(text);
  }

  /// Runs the link: connects, serves the connection, reconnects.
  asio::awaitable<void> run() {
    milliseconds pause = kFirstBackOff;
    std::uint64_t trying_since_us = monotonic_us();
    while (!finished()) {
      auto connection = std::make_shared<Connection>(io_);
      greeting_ = connection;
      const std::expected<Welcome, Loss> welcome = co_await join(*connection, settings_);
      greeting_.reset();
      if (welcome) {
        enter(*welcome);
        open_udp(connection, *welcome);
        pause = kFirstBackOff;
        connected_.store(true);
        co_await serve(connection);
        connected_.store(false);
        trying_since_us = monotonic_us();
      }
      const Loss loss = welcome ? connection->loss.value_or(Loss{}) : welcome.error();
      if (finished()) break;
      if (loss.final ||
          static_cast<double>(monotonic_us() - trying_since_us) / kUsPerS > settings_.patience_s) {
        rejected_.store(loss.final);
        fail(loss.reason);
        break;
      }
      if (welcome) notice("connection lost (" + loss.reason + "), connecting again");
      follow(loss.redirect);
      // With several servers, try each before the pause grows.
      bool is_round = welcome || !servers_.has_others();
      if (!is_round && loss.redirect.empty()) is_round = servers_.turn(settings_.server);
      back_off_.expires_after(is_round ? pause : kFirstBackOff);
      co_await back_off_.async_wait(kAwait);
      if (is_round) pause = std::min(pause * 2, kLongestBackOff);
    }
    end();
  }

  /// The server that ended the connection names the one that continues the session.
  void follow(const std::string& redirect) {
    if (redirect.empty()) return;
    const auto server = follow_redirect(settings_.server, redirect);
    if (!server) return notice("the address at which the session continues is not safe to follow");
    settings_.server = *server;
  }

  void fail(const std::string& reason) {
    {
      const std::scoped_lock lock(mutex_);
      failure_ = reason.empty() ? "the connection is lost" : reason;
    }
    changed_.notify_all();
    if (settings_.failed) settings_.failed();
  }

  void end() {
    if (!welcome_ && failure_.empty()) fail("interrupted");
    traffic_.collect();
    report_ = traffic_.report();
    report_.failure = failure_;
    ended_ = true;
    housekeeping_.cancel();
  }

  /// Empties the ring while there is no connection, and wakes the writing coroutine periodically.
  asio::awaitable<void> housekeep() {
    while (!ended_) {
      housekeeping_.expires_after(kHousekeeping);
      co_await housekeeping_.async_wait(kAwait);
      traffic_.collect();
      // If the writing coroutine has just looked, no frame has become due since.
      if (!std::exchange(looked_, false)) wake();
      if (!finished()) continue;
      // Cancels a pending reconnection.
      back_off_.cancel();
      if (greeting_) greeting_->cut();
    }
  }

  void enter(const Welcome& welcome) {
    // Requests do not survive the connection.
    undos_.store(0);
    redos_.store(0);
    servers_.welcomed(settings_.server, welcome.others);
    if (settings_.hello.udp) traffic_.ask_for_udp();
    std::optional<std::uint64_t> server_has;
    if (welcome.resume) server_has = welcome.resume->agent_sequence;
    traffic_.begin(welcome.epoch, settings_.hello.tool_id, monotonic_us(), welcome.udp.has_value(),
                   server_has);
    traffic_.offer_reach(welcome.takes_reach);
    if (welcome.resume) settings_.hello.resume = welcome.resume->token;
    if (welcome.resume && welcome.resume->resumed) traffic_.note_resumed();
    if (welcome_) notice("connected again");
    {
      const std::scoped_lock lock(mutex_);
      if (!welcome_) welcome_ = welcome;
    }
    changed_.notify_all();
  }

  /// Opens UDP, if offered, for the lifetime of the WebSocket.
  void open_udp(const std::shared_ptr<Connection>& connection, const Welcome& welcome) {
    error_code failed;
    const auto server = connection->socket->tcp().remote_endpoint(failed);
    if (settings_.hello.udp && !welcome.udp && !std::exchange(notified_no_udp_, true)) {
      notice("the server has no UDP transport, staying on the WebSocket");
    }
    if (!welcome.udp || failed) return;
    connection->udp = std::make_unique<DatagramSocket>(io_, server.address(), *welcome.udp,
                                                       traffic_.udp_counts());
    auto read = [this, connection] {
      return connection->udp->read_all([this, connection](std::span<const std::byte> frame) {
        if (connection->loss) return;
        connection->loss = traffic_.take_datagram(frame, monotonic_us());
        wake();
      });
    };
    asio::co_spawn(io_, std::move(read), asio::detached);
  }

  void send_datagrams(Connection& connection) {
    if (!connection.udp) return;
    std::array<std::byte, datagram::kMaxFrameBytes> frame;
    while (const std::size_t bytes = traffic_.fill_datagram(monotonic_us(), frame)) {
      connection.udp->send(std::span(frame).first(bytes));
    }
    if (const std::string text = traffic_.take_notice(); !text.empty()) notice(text);
  }

  asio::awaitable<void> serve(std::shared_ptr<Connection> connection) {
    connection->reading = true;
    asio::co_spawn(io_, read_all(connection), asio::detached);
    co_await write_all(*connection);
    if (!connection->loss) {
      // The stream's own timeout for the closing handshake is long. A silent server must not delay
      // the agent.
      asio::steady_timer deadline(io_, kCloseTimeout);
      deadline.async_wait([connection](error_code stopped) {
        if (!stopped) connection->cut();
      });
      co_await connection->socket->close(kNormalClosure);
    }
    connection->cut();
    if (connection->udp) connection->udp->close();
    while (connection->reading) co_await connection->reader_ended.async_wait(kAwait);
  }

  asio::awaitable<void> read_all(std::shared_ptr<Connection> connection) {
    net::WebSocket& socket = *connection->socket;
    while (!connection->loss) {
      const error_code failed = co_await socket.read();
      if (failed) {
        if (!connection->loss) connection->loss = Loss{failed.message()};
        break;
      }
      std::string text;
      const std::optional<Loss> loss = socket.is_text()
                                           ? traffic_.take_text(socket.text(), text)
                                           : traffic_.take_frame(socket.message(), monotonic_us());
      if (!text.empty()) notice(text);
      if (const auto others = traffic_.take_servers()) {
        servers_.welcomed(settings_.server, *others);
      }
      if (loss) connection->loss = loss;
    }
    connection->reading = false;
    connection->reader_ended.cancel();
    wake();
  }

  /// Writes all frames that are due until the connection is lost or the link stops.
  asio::awaitable<void> write_all(Connection& connection) {
    std::array<std::byte, wire::kMaxClientFrameBytes> frame;
    while (!connection.loss && !finished()) {
      looked_ = true;
      count_batch(traffic_.collect());
      for (int n = undos_.exchange(0); n > 0; --n) traffic_.ask(true);
      for (int n = redos_.exchange(0); n > 0; --n) traffic_.ask(false);
      send_datagrams(connection);
      if (const std::string text = traffic_.take_control(monotonic_us()); !text.empty()) {
        co_await write(connection, true, asio::buffer(text));
        continue;
      }
      const std::size_t bytes = traffic_.fill(monotonic_us(), frame);
      if (bytes > 0) {
        co_await write(connection, false, asio::buffer(frame.data(), bytes));
      } else {
        awaits_wake_ = true;
        co_await wake_.async_wait(asio::posix::stream_descriptor::wait_read, kAwait);
        awaits_wake_ = false;
        std::uint64_t wakes = 0;
        [[maybe_unused]] const auto got = ::read(wake_fd_, &wakes, sizeof wakes);
      }
    }
  }

  asio::awaitable<void> write(Connection& connection, bool text, asio::const_buffer bytes) {
    const error_code failed = co_await connection.socket->write(text, bytes);
    if (failed && !connection.loss) connection.loss = Loss{failed.message()};
  }

  bool finished() {
    if (interrupted()) return true;
    const std::uint64_t until_us = drain_until_us_.load();
    if (until_us == 0) return false;
    traffic_.collect();
    return traffic_.settle(monotonic_us()) || monotonic_us() >= until_us;
  }

  LinkSettings settings_;
  std::atomic<bool> interrupted_{false}, connected_{false}, rejected_{false};
  std::atomic<std::uint64_t> drain_until_us_{0};
  std::atomic<int> undos_{0}, redos_{0};  ///< requested, not yet handled by the link thread

  // The members below belong to the link thread, except those guarded by the mutex.
  asio::io_context io_{1};
  int wake_fd_;
  asio::posix::stream_descriptor wake_;
  bool awaits_wake_ = false;  ///< the writing coroutine has written every due frame
  bool looked_ = false;       ///< it has looked for due frames since the last housekeeping
  asio::steady_timer housekeeping_;
  asio::steady_timer back_off_;
  Traffic traffic_;
  /// The connection whose handshake is in progress; otherwise null.
  std::shared_ptr<Connection> greeting_;
  bool ended_ = false;
  ServerChoice servers_;
  int batches_ = 0;  ///< wake-ups in a row with several samples, while there is a replica
  bool notified_no_udp_ = false;
  LinkReport report_;
  std::thread thread_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Welcome> welcome_;
  std::string failure_;
};

ServerLink::ServerLink(LinkSettings settings, SampleRing& samples,
                       LatestValue<ServerWrench>& wrenches)
    : impl_(std::make_unique<Impl>(std::move(settings), samples, wrenches)) {}
ServerLink::~ServerLink() = default;

void ServerLink::start() { impl_->start(); }
std::expected<Welcome, std::string> ServerLink::wait_welcome() { return impl_->wait_welcome(); }
void ServerLink::interrupt() { impl_->interrupt(); }
void ServerLink::stop(double drain_s) { impl_->stop(drain_s); }
void ServerLink::ask(bool undone) noexcept { impl_->ask(undone); }
void ServerLink::sample_ready() noexcept { impl_->wake(); }
bool ServerLink::connected() const noexcept { return impl_->connected(); }
bool ServerLink::rejected() const noexcept { return impl_->rejected(); }
const LinkReport& ServerLink::report() const noexcept { return impl_->report(); }

}  // namespace kerf::agent
