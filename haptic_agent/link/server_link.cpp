#include "haptic_agent/link/server_link.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/as_tuple.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>

#include "haptic_agent/link/pace.h"
#include "haptic_agent/link/sample_queue.h"
#include "haptic_agent/servo/servo_clock.h"
#include "server/wire/codec.h"
#include "server/wire/control.h"

namespace kerf::agent {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// Errors come as values, never as exceptions.
constexpr auto kAwait = asio::as_tuple(asio::use_awaitable);

constexpr milliseconds kFirstBackOff{50};
constexpr milliseconds kLongestBackOff{2000};
constexpr seconds kConnectTimeout{3};
constexpr seconds kWelcomeTimeout{5};
/// A server that says nothing at all for this long, not even to a ping of the WebSocket, is gone.
constexpr seconds kIdleTimeout{6};
constexpr milliseconds kCloseTimeout{500};
/// How often the ring is emptied where no sample wakes the link, and pauses are looked at.
constexpr milliseconds kHousekeeping{10};
constexpr std::uint64_t kPingEveryUs = 100'000;
/// An HTTP refusal is quoted up to here.
constexpr std::size_t kMaxQuotedBytes = 200;
constexpr unsigned kHttpClientError = 400;
constexpr unsigned kHttpServerError = 500;
constexpr unsigned kHttpTooMany = 429;
constexpr double kUsPerS = 1e6;

std::uint64_t now_us() noexcept {
  constexpr std::uint64_t kNsPerUs = 1000;
  return MonotonicClock{}.now_ns() / kNsPerUs;
}

/// Why a connection ended. A final one is not tried again.
struct Loss {
  std::string reason;
  bool final = false;
};

std::span<const std::byte> bytes_of(const beast::flat_buffer& buffer) noexcept {
  return {static_cast<const std::byte*>(buffer.data().data()), buffer.size()};
}

Vec3 to_vec3(const wire::Vec3f& v) noexcept {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

/// One connection, shared by the coroutine that reads and the one that writes.
struct Connection {
  explicit Connection(asio::io_context& io) : socket(io), reader_ended(io) {
    reader_ended.expires_at(asio::steady_timer::time_point::max());
  }

  websocket::stream<beast::tcp_stream> socket;
  /// Cancelled when the reader has ended: the way to wait for it.
  asio::steady_timer reader_ended;
  bool reading = false;
  std::optional<Loss> loss;
  std::optional<std::uint64_t> pong_due;
  std::uint64_t next_ping_us = 0;
  std::uint64_t motion_sequence = 0;
  std::uint64_t ping_sequence = 0;
  std::uint64_t pong_sequence = 0;
  std::uint32_t tool_id = 0;
};

}  // namespace

class ServerLink::Impl {
 public:
  Impl(LinkSettings settings, SampleRing& samples, LatestValue<ServerWrench>& wrenches)
      : settings_(std::move(settings)),
        ring_(samples),
        wrenches_(wrenches),
        wake_fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
        wake_(io_, wake_fd_),
        housekeeping_(io_),
        back_off_(io_) {}

  ~Impl() {
    interrupt();
    if (thread_.joinable()) thread_.join();
  }

  void start() {
    asio::co_spawn(io_, run(), asio::detached);
    asio::co_spawn(io_, keep_house(), asio::detached);
    thread_ = std::thread([this] { io_.run(); });
  }

  std::expected<Welcome, std::string> wait_welcome() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return welcome_.has_value() || !failure_.empty(); });
    if (!failure_.empty()) return std::unexpected(failure_);
    return *welcome_;
  }

  void interrupt() {
    interrupted_.store(true);
    wake();
  }

  void stop(double drain_s) {
    drain_until_us_.store(now_us() + static_cast<std::uint64_t>(drain_s * kUsPerS));
    wake();
    if (thread_.joinable()) thread_.join();
  }

  void wake() noexcept {
    const std::uint64_t one = 1;
    // A full counter is awake already; nothing else can go wrong here.
    [[maybe_unused]] const auto written = ::write(wake_fd_, &one, sizeof one);
  }

  const LinkReport& report() const noexcept { return report_; }

 private:
  bool interrupted() const noexcept { return interrupted_.load(); }

  void notice(const std::string& text) const {
    if (settings_.notice) settings_.notice(text);
  }

  void drain_ring() {
    wire::MotionSample sample;
    while (ring_.pop(sample)) queue_.push(sample);
  }

  /// The whole life of the link: connect, serve, connect again.
  asio::awaitable<void> run() {
    milliseconds pause = kFirstBackOff;
    std::uint64_t trying_since_us = now_us();
    while (!finished()) {
      auto connection = std::make_shared<Connection>(io_);
      greeting_ = connection;
      const std::optional<Loss> refused = co_await connect(*connection);
      greeting_.reset();
      if (!refused) {
        pause = kFirstBackOff;
        co_await serve(connection);
        trying_since_us = now_us();
      }
      const Loss loss = refused ? *refused : connection->loss.value_or(Loss{});
      if (finished()) break;
      if (loss.final ||
          static_cast<double>(now_us() - trying_since_us) / kUsPerS > settings_.patience_s) {
        fail(loss.reason);
        break;
      }
      if (!refused) notice("connection lost (" + loss.reason + "), connecting again");
      back_off_.expires_after(pause);
      co_await back_off_.async_wait(kAwait);
      pause = std::min(pause * 2, kLongestBackOff);
    }
    end();
  }

  void fail(const std::string& reason) {
    {
      const std::scoped_lock lock(mutex_);
      failure_ = reason.empty() ? "the connection is lost" : reason;
      report_.failure = failure_;
    }
    changed_.notify_all();
    if (settings_.failed) settings_.failed();
  }

  void end() {
    if (!welcome_ && failure_.empty()) fail("interrupted");
    drain_ring();
    report_.resent = queue_.resent();
    report_.merged_air = queue_.merged_air();
    report_.thinned_cuts = queue_.thinned_cuts();
    report_.forgotten = queue_.forgotten();
    report_.unanswered = queue_.unanswered();
    ended_ = true;
    housekeeping_.cancel();
  }

  /// Empties the ring while nobody else does, and wakes whoever waits for a pause to be over.
  asio::awaitable<void> keep_house() {
    while (!ended_) {
      housekeeping_.expires_after(kHousekeeping);
      co_await housekeeping_.async_wait(kAwait);
      drain_ring();
      wake();
      if (!finished()) continue;
      // Nobody waits any longer for a server that does not answer.
      back_off_.cancel();
      if (greeting_) beast::get_lowest_layer(greeting_->socket).close();
    }
  }

  asio::awaitable<std::optional<Loss>> connect(Connection& connection) {
    tcp::resolver resolver(io_);
    const auto [unresolved, addresses] =
        co_await resolver.async_resolve(settings_.server.host, settings_.server.port, kAwait);
    if (unresolved) {
      co_return Loss{"cannot find " + settings_.server.host + ": " + unresolved.message()};
    }
    beast::tcp_stream& stream = beast::get_lowest_layer(connection.socket);
    stream.expires_after(kConnectTimeout);
    const auto [unconnected, address] = co_await stream.async_connect(addresses, kAwait);
    if (unconnected) {
      co_return Loss{"cannot connect to " + settings_.server.host + ":" + settings_.server.port +
                     ": " + unconnected.message()};
    }
    stream.socket().set_option(tcp::no_delay(true));
    stream.expires_never();
    std::optional<Loss> refused = co_await upgrade(connection.socket);
    if (!refused) refused = co_await greet(connection);
    co_return refused;
  }

  asio::awaitable<std::optional<Loss>> upgrade(websocket::stream<beast::tcp_stream>& socket) {
    socket.set_option(websocket::stream_base::timeout{.handshake_timeout = kConnectTimeout,
                                                      .idle_timeout = kIdleTimeout,
                                                      .keep_alive_pings = true});
    socket.set_option(websocket::stream_base::decorator([](websocket::request_type& request) {
      request.set(http::field::sec_websocket_protocol,
                  beast::string_view(wire::kAgentProtocol.data(), wire::kAgentProtocol.size()));
    }));
    socket.read_message_max(wire::kMaxServerFrameBytes);
    websocket::response_type response;
    const std::string host = settings_.server.host + ":" + settings_.server.port;
    const std::string target = "/v1/sessions/" + settings_.session + "/agent";
    const auto [failed] = co_await socket.async_handshake(response, host, target, kAwait);
    if (failed == websocket::error::upgrade_declined) {
      const unsigned status = response.result_int();
      std::string said = response.body();
      said.resize(std::min(said.size(), kMaxQuotedBytes));
      std::erase(said, '\n');
      const bool for_good =
          status >= kHttpClientError && status < kHttpServerError && status != kHttpTooMany;
      co_return Loss{"the server refuses session '" + settings_.session + "': HTTP " +
                         std::to_string(status) + (said.empty() ? "" : ": " + said),
                     for_good};
    }
    if (failed) co_return Loss{"no WebSocket: " + failed.message()};
    if (response[http::field::sec_websocket_protocol] !=
        beast::string_view(wire::kAgentProtocol.data(), wire::kAgentProtocol.size())) {
      co_return Loss{"the server does not speak " + std::string(wire::kAgentProtocol), true};
    }
    co_return std::nullopt;
  }

  /// Says hello and waits for the welcome, or for the error that stands in its place.
  asio::awaitable<std::optional<Loss>> greet(Connection& connection) {
    asio::steady_timer deadline(io_, kWelcomeTimeout);
    deadline.async_wait([&connection](error_code stopped) {
      if (!stopped) beast::get_lowest_layer(connection.socket).close();
    });
    const std::string hello = hello_text(settings_.hello);
    connection.socket.text(true);
    const auto [unsent, sent] = co_await connection.socket.async_write(asio::buffer(hello), kAwait);
    if (unsent) co_return Loss{"the server hung up: " + unsent.message()};
    beast::flat_buffer frame;
    while (true) {
      frame.clear();
      const auto [unread, got] = co_await connection.socket.async_read(frame, kAwait);
      if (unread) co_return Loss{"no welcome from the server: " + unread.message()};
      if (!connection.socket.got_text()) continue;
      const auto message = parse_control(beast::buffers_to_string(frame.data()));
      if (!message)
        co_return Loss{"the server's welcome is not understood: " + message.error(), true};
      if (const auto* error = std::get_if<ServerError>(&*message)) {
        co_return Loss{"the server refuses: " + error->code + ": " + error->reason,
                       error->code != wire::to_string(wire::ErrorCode::kBusy)};
      }
      if (const auto* bye = std::get_if<Bye>(&*message)) {
        co_return Loss{"the server says good-bye: " + bye->reason};
      }
      if (const auto* welcome = std::get_if<Welcome>(&*message)) {
        enter(connection, *welcome);
        co_return std::nullopt;
      }
    }
  }

  void enter(Connection& connection, const Welcome& welcome) {
    connection.tool_id = settings_.hello.tool_id;
    ++report_.connections;
    epoch_ = welcome.epoch;
    queue_.rewind();
    if (report_.connections > 1) notice("connected again");
    {
      const std::scoped_lock lock(mutex_);
      if (!welcome_) welcome_ = welcome;
    }
    changed_.notify_all();
  }

  asio::awaitable<void> serve(std::shared_ptr<Connection> connection) {
    connection->reading = true;
    asio::co_spawn(io_, read_all(connection), asio::detached);
    co_await write_all(*connection);
    if (!connection->loss) {
      // The timeout of the stream's own closing handshake is long; a server that does not answer
      // must not hold the agent up.
      asio::steady_timer deadline(io_, kCloseTimeout);
      deadline.async_wait([connection](error_code stopped) {
        if (!stopped) beast::get_lowest_layer(connection->socket).close();
      });
      co_await connection->socket.async_close(websocket::close_code::normal, kAwait);
    }
    beast::get_lowest_layer(connection->socket).close();
    while (connection->reading) co_await connection->reader_ended.async_wait(kAwait);
  }

  asio::awaitable<void> read_all(std::shared_ptr<Connection> connection) {
    beast::flat_buffer frame;
    while (!connection->loss) {
      frame.clear();
      const auto [failed, got] = co_await connection->socket.async_read(frame, kAwait);
      if (failed) {
        if (!connection->loss) connection->loss = Loss{failed.message()};
        break;
      }
      if (connection->socket.got_text()) {
        take_text(*connection, beast::buffers_to_string(frame.data()));
      } else {
        take_frame(*connection, bytes_of(frame));
      }
    }
    connection->reading = false;
    connection->reader_ended.cancel();
    wake();
  }

  void take_text(Connection& connection, const std::string& text) {
    const auto message = parse_control(text);
    if (!message) {
      ++report_.bad_frames;
    } else if (const auto* error = std::get_if<ServerError>(&*message)) {
      ServerComplaint& complaint = report_.complaints[error->code];
      if (complaint.count++ == 0) {
        complaint.first_reason = error->reason;
        notice("server: " + error->code + ": " + error->reason);
      }
      if (error->fatal) connection.loss = Loss{error->code + ": " + error->reason, true};
    } else if (const auto* bye = std::get_if<Bye>(&*message)) {
      connection.loss = Loss{"the server says good-bye: " + bye->reason};
    }
  }

  void take_frame(Connection& connection, std::span<const std::byte> frame) {
    const auto message = wire::decode(frame);
    if (!message) {
      ++report_.bad_frames;
      return;
    }
    if (const auto* result = std::get_if<wire::Result>(&message->body)) {
      if (message->header.stamp.epoch != epoch_) {
        connection.loss = Loss{"the session has been rebuilt"};
        return;
      }
      take_result(*result);
    } else if (const auto* pong = std::get_if<wire::Pong>(&message->body)) {
      report_.clock.take(pong->ping_time_us, pong->time_us, now_us());
    } else if (const auto* ping = std::get_if<wire::Ping>(&message->body)) {
      connection.pong_due = ping->time_us;
      wake();
    }
  }

  void take_result(const wire::Result& result) {
    const std::uint64_t arrival_us = now_us();
    const Wrench wrench{.force_n = to_vec3(result.force_n),
                        .torque_nmm = to_vec3(result.torque_nmm)};
    wrenches_.write({.wrench = wrench, .pose_us = result.agent_time_us, .arrival_us = arrival_us});
    queue_.answered(result.agent_sequence);
    ++report_.results;
    if ((result.status & wire::kStatusRefused) != 0) ++report_.refused_results;
    report_.motions_in_session = result.motions_applied;
    report_.removed_mm3 += static_cast<double>(result.removed_mm3);
    report_.max_server_force_n = std::max(report_.max_server_force_n, length(wrench.force_n));
    if (arrival_us >= result.agent_time_us) {
      report_.answer_us.add(arrival_us - result.agent_time_us);
    }
    report_.turnaround_us.add(result.turnaround_us);
  }

  /// Writes whatever is due, one frame at a time, until the connection breaks or the link is to
  /// stop.
  asio::awaitable<void> write_all(Connection& connection) {
    std::array<std::byte, wire::kMaxClientFrameBytes> frame;
    connection.next_ping_us = now_us();
    while (!connection.loss && !finished()) {
      drain_ring();
      if (const std::uint32_t tool = next_tool(connection); tool != 0) {
        const std::string text = tool_text(tool);
        co_await write(connection, true, asio::buffer(text));
        connection.tool_id = tool;
        continue;
      }
      const std::size_t bytes = fill(connection, frame);
      if (bytes > 0) {
        co_await write(connection, false, asio::buffer(frame.data(), bytes));
      } else {
        co_await wake_.async_wait(asio::posix::stream_descriptor::wait_read, kAwait);
        std::uint64_t wakes = 0;
        [[maybe_unused]] const auto got = ::read(wake_fd_, &wakes, sizeof wakes);
      }
    }
  }

  asio::awaitable<void> write(Connection& connection, bool text, asio::const_buffer bytes) {
    connection.socket.text(text);
    const auto [failed, sent] = co_await connection.socket.async_write(bytes, kAwait);
    if (failed && !connection.loss) connection.loss = Loss{failed.message()};
  }

  bool finished() {
    if (interrupted()) return true;
    const std::uint64_t until_us = drain_until_us_.load();
    if (until_us == 0) return false;
    drain_ring();
    return queue_.settled() || now_us() >= until_us;
  }

  /// The tool that the next sample asks for, if the others at the block do not know it yet.
  std::uint32_t next_tool(const Connection& connection) const noexcept {
    const auto tool = queue_.next_tool();
    return tool && *tool != connection.tool_id ? *tool : 0;
  }

  /// Encodes the next binary frame, if one is due; its size, or 0.
  std::size_t fill(Connection& connection, std::span<std::byte> frame) {
    const std::uint64_t time_us = now_us();
    const auto stamp = [&](std::uint64_t sequence) {
      return wire::FrameStamp{.epoch = epoch_, .sequence = sequence, .time_us = time_us};
    };
    if (connection.pong_due) {
      const wire::Pong pong{.ping_time_us = *connection.pong_due, .time_us = time_us};
      connection.pong_due.reset();
      return wire::encode(stamp(++connection.pong_sequence), pong, frame);
    }
    if (time_us >= connection.next_ping_us) {
      connection.next_ping_us = time_us + kPingEveryUs;
      return wire::encode(stamp(++connection.ping_sequence), wire::Ping{time_us}, frame);
    }
    const std::size_t most = pace_.allowed(time_us);
    if (most == 0 || queue_.unsent() == 0) return 0;
    const wire::MotionBatch batch = queue_.take(most);
    pace_.sent(batch.count);
    report_.samples_sent += batch.count;
    ++report_.messages_sent;
    return wire::encode(stamp(++connection.motion_sequence), batch, frame);
  }

  LinkSettings settings_;
  SampleRing& ring_;
  LatestValue<ServerWrench>& wrenches_;
  std::atomic<bool> interrupted_{false};
  std::atomic<std::uint64_t> drain_until_us_{0};

  // Below: the link's thread only, except what the mutex guards.
  asio::io_context io_{1};
  int wake_fd_;
  asio::posix::stream_descriptor wake_;
  asio::steady_timer housekeeping_;
  asio::steady_timer back_off_;
  SampleQueue queue_;
  Pace pace_;
  std::uint32_t epoch_ = 0;
  /// The connection that is being made, if one is.
  std::shared_ptr<Connection> greeting_;
  bool ended_ = false;
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
void ServerLink::sample_ready() noexcept { impl_->wake(); }
const LinkReport& ServerLink::report() const noexcept { return impl_->report(); }

}  // namespace kerf::agent
