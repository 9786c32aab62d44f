// SPDX-License-Identifier: Apache-2.0
// One viewer's WebSocket, on the viewer lane.
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <boost/asio/detached.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <deque>

#include "server/conversation/control_json.h"
#include "server/metrics/metrics.h"
#include "server/session/rate_limit.h"
#include "server/socket/viewer_hub.h"
#include "server/socket/websocket.h"
#include "server/threads/run_on.h"
#include "server/wire/codec.h"

namespace kerf::net {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

/// A look may make the server mesh a block anew; a viewer sends one when its camera has come to
/// rest.
constexpr double kLooksPerS = 5;
constexpr double kLooksBurst = 20;
/// Without this the kernel hides megabytes of stale frames in its send buffer (README.md).
constexpr int kNotSentBytes = 32 * 1024;

class ViewerSocket final : public ViewerSink, public std::enable_shared_from_this<ViewerSocket> {
 public:
  ViewerSocket(asio::ip::tcp::socket socket, std::shared_ptr<Session> session, PeerContext& context)
      : session_(std::move(session)),
        context_(context),
        socket_(std::move(socket)),
        hello_timer_(socket_.get_executor()) {
    ++context_.metrics.viewers;
  }
  ~ViewerSocket() override {
    if (hub_) hub_->remove(self_->id);  // also if an exception ended run()
    --context_.metrics.viewers;
  }

  void start(UpgradeRequest request) {
    auto run = [self = shared_from_this(), request = std::move(request)]() mutable {
      return self->run(std::move(request));
    };
    asio::co_spawn(socket_.get_executor(), std::move(run), asio::detached);
  }

  void send_tools(SharedBytes frame) override {
    tools_ = std::move(frame);
    pump();
  }
  void send_mesh(FeedFrame frame) override {
    mesh_.push_back(std::move(frame));
    pump();
  }
  void send_state(std::string text) override {
    state_ = std::move(text);
    pump();
  }
  void send_control(std::string text) override { say(std::move(text), true); }
  void bad_ack() override {
    reject({wire::ErrorCode::kBadSequence, "ack of a mesh frame that was never sent"});
  }
  void end(const std::string& reason) override {
    say(bye_message(reason), true);
    finishing_ = true;
    pump();
  }

 private:
  asio::awaitable<void> run(UpgradeRequest request);
  asio::awaitable<void> on_frame(std::span<const std::byte> frame, bool text);
  asio::awaitable<void> on_control(std::string_view text);
  void on_binary(std::span<const std::byte> frame);
  void limit_hello();
  void reject(const Rejection& rejection, bool fatal = false);
  void say(std::string bytes, bool text);
  void pump();
  template <typename Buffers>
  void write(bool text, const Buffers& buffers);

  std::shared_ptr<Session> session_;
  PeerContext& context_;
  WebSocket socket_;
  asio::steady_timer hello_timer_;
  beast::flat_buffer in_;
  std::optional<Participant> self_;
  std::shared_ptr<ViewerHub> hub_;
  RateLimit errors_{kErrorsPerS, kErrorsBurst};
  RateLimit looks_{kLooksPerS, kLooksBurst};

  std::deque<std::pair<std::string, bool>> control_;
  std::string control_out_, state_;
  SharedBytes tools_, tools_out_;
  std::deque<FeedFrame> mesh_;
  FeedFrame mesh_out_;
  std::array<std::byte, wire::kHeaderBytes> mesh_header_{};
  std::uint64_t pongs_ = 0;
  bool writing_ = false, finishing_ = false, broken_ = false;
};

asio::awaitable<void> ViewerSocket::run(UpgradeRequest request) {
  error_code error;
  prepare(socket_, wire::kViewProtocol);
  co_await socket_.async_accept(request, asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return;
  limit_hello();
  while (!error && !broken_) {
    in_.consume(in_.size());
    co_await socket_.async_read(in_, asio::redirect_error(asio::use_awaitable, error));
    if (error || finishing_) continue;
    const auto data = in_.cdata();
    const std::span frame(static_cast<const std::byte*>(data.data()), data.size());
    co_await on_frame(frame, socket_.got_text());
  }
  hello_timer_.cancel();
  if (hub_) hub_->remove(self_->id);
  if (self_) {
    threads_of(*session_).post([session = session_, id = self_->id] { session->leave(id); });
  }
}

void ViewerSocket::limit_hello() {
  hello_timer_.expires_after(std::chrono::microseconds(std::int64_t(wire::kHelloTimeoutS * 1e6)));
  hello_timer_.async_wait([self = shared_from_this()](error_code error) {
    if (error || self->self_) return;
    self->reject({wire::ErrorCode::kNoHello, "no hello within 5 s"}, true);
    self->finishing_ = true;
    self->pump();
  });
}

asio::awaitable<void> ViewerSocket::on_frame(std::span<const std::byte> frame, bool text) {
  if (frame.size() > wire::kMaxClientFrameBytes) {
    reject({wire::ErrorCode::kTooLarge, "a frame of " + std::to_string(frame.size()) +
                                            " bytes; at most " +
                                            std::to_string(wire::kMaxClientFrameBytes)});
  } else if (text) {
    const std::string_view control(reinterpret_cast<const char*>(frame.data()), frame.size());
    co_await on_control(control);
  } else {
    on_binary(frame);
  }
}

asio::awaitable<void> ViewerSocket::on_control(std::string_view text) {
  using enum wire::ErrorCode;
  const auto message = parse_control(text);
  if (!message) {
    reject(message.error());
    co_return;
  }
  if (const auto* look = std::get_if<LookMessage>(&*message); look != nullptr && hub_) {
    if (looks_.allow(Clock::now())) {
      hub_->looks(self_->id, look->look);
    } else {
      reject({kTooFast, "more than 5 looks a second"});
    }
    co_return;
  }
  const auto* hello = std::get_if<HelloMessage>(&*message);
  if (hello == nullptr || self_) {
    reject({self_ ? kBadMessage : kNoHello, self_ ? "a viewer has no tool and says hello once"
                                                  : "the first message must be a hello"});
    co_return;
  }
  JoinRequest request{ParticipantKind::kViewer, hello->name, hello->color, 0, false};
  using Joined = std::pair<std::expected<Participant, Rejection>, std::vector<Participant>>;
  auto join = [session = session_, request]() {
    auto joined = session->join(request);
    return Joined{std::move(joined), session->participants()};
  };
  const Joined joined = co_await run_on(threads_of(*session_), std::move(join));
  if (!joined.first) {
    const bool fatal = joined.first.error().code == kBusy;
    reject(joined.first.error(), fatal);
    finishing_ = finishing_ || fatal;
    pump();
    co_return;
  }
  self_ = *joined.first;
  hello_timer_.cancel();
  say(viewer_welcome(*session_, *self_, joined.second), true);
  hub_ = context_.hubs.get(session_, context_);
  hub_->add(self_->id, this);
}

void ViewerSocket::on_binary(std::span<const std::byte> frame) {
  const auto message = wire::decode(frame, wire::kMaxClientFrameBytes);
  if (!message) {
    return reject({wire::protocol_error(message.error().code),
                   std::string(message.error().reason) + " (byte " +
                       std::to_string(message.error().offset) + " of the frame)"});
  }
  if (const auto* ping = std::get_if<wire::Ping>(&message->body)) {
    const wire::Pong pong{ping->time_us, clock_us()};
    std::string bytes(wire::encoded_bytes(pong), '\0');
    wire::encode({session_->epoch(), ++pongs_, clock_us()}, pong,
                 std::as_writable_bytes(std::span(bytes)));
    return say(std::move(bytes), false);
  }
  if (std::holds_alternative<wire::Ack>(message->body)) {
    if (!hub_) return reject({wire::ErrorCode::kNoHello, "the first message must be a hello"});
    return hub_->acked(self_->id, message->header.stamp.sequence);
  }
  const bool skipped = std::holds_alternative<wire::UnknownBody>(message->body) ||
                       std::holds_alternative<wire::Pong>(message->body);
  if (!skipped) reject({wire::ErrorCode::kBadMessage, "a viewer does not send such frames"});
}

void ViewerSocket::reject(const Rejection& rejection, bool fatal) {
  context_.metrics.rejected(wire::to_string(rejection.code));
  if (fatal || errors_.allow(Clock::now())) say(error_message(rejection, fatal), true);
}

void ViewerSocket::say(std::string bytes, bool text) {
  if (finishing_ || broken_) return;
  if (control_.size() >= kControlQueueMax) {
    broken_ = true;  // it does not read: nothing that we say would arrive
    beast::get_lowest_layer(socket_).close();
    return;
  }
  control_.emplace_back(std::move(bytes), text);
  pump();
}

template <typename Buffers>
void ViewerSocket::write(bool text, const Buffers& buffers) {
  writing_ = true;
  socket_.text(text);
  socket_.async_write(buffers, [self = shared_from_this()](error_code error, std::size_t) {
    self->writing_ = false;
    self->broken_ = self->broken_ || error.failed();
    self->pump();
  });
}

void ViewerSocket::pump() {
  if (writing_ || broken_) return;
  if (!control_.empty()) {
    const bool text = control_.front().second;
    control_out_ = std::move(control_.front().first);
    control_.pop_front();
    return write(text, asio::buffer(control_out_));
  }
  if (finishing_) {
    writing_ = true;
    return socket_.async_close(beast::websocket::close_code::going_away,
                               [self = shared_from_this()](error_code) {});
  }
  if (tools_) {
    tools_out_ = std::exchange(tools_, nullptr);
    return write(false, asio::buffer(*tools_out_));
  }
  if (!mesh_.empty()) {
    mesh_out_ = std::move(mesh_.front());
    mesh_.pop_front();
    mesh_header_ = wire::mesh_header({session_->epoch(), mesh_out_.sequence, clock_us()},
                                     mesh_out_.flags, mesh_out_.glb->size());
    context_.metrics.mesh_sent(mesh_out_.glb->size());
    const std::array<asio::const_buffer, 2> parts = {asio::buffer(mesh_header_),
                                                     asio::buffer(*mesh_out_.glb)};
    return write(false, parts);
  }
  if (!state_.empty()) {
    control_out_ = std::exchange(state_, {});
    return write(true, asio::buffer(control_out_));
  }
}

}  // namespace

void serve_viewer(asio::ip::tcp::socket socket, UpgradeRequest request,
                  std::shared_ptr<Session> session, PeerContext& context) {
  error_code ignored;
  socket.set_option(asio::ip::tcp::no_delay(true), ignored);
  setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &kNotSentBytes,
             sizeof kNotSentBytes);
  std::make_shared<ViewerSocket>(std::move(socket), std::move(session), context)
      ->start(std::move(request));
}

}  // namespace kerf::net
