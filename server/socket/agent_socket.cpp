// SPDX-License-Identifier: Apache-2.0
// One agent's WebSocket. Lives on the lane of its session: what it reads is cut and answered by the
// same thread.
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>

#include "server/conversation/agent_outbox.h"
#include "server/conversation/control_json.h"
#include "server/conversation/sample_gate.h"
#include "server/metrics/metrics.h"
#include "server/session/rate_limit.h"
#include "server/socket/websocket.h"
#include "server/threads/io_threads.h"
#include "server/udp/udp_port.h"
#include "server/wire/codec.h"

namespace kerf::net {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

/// An agent's copy of the block hears of what others cut this often, if there is anything to hear.
constexpr std::chrono::milliseconds kStockInterval{20};

class AgentSocket : public std::enable_shared_from_this<AgentSocket> {
 public:
  AgentSocket(asio::ip::tcp::socket socket, std::shared_ptr<Session> session, PeerContext& context)
      : session_(std::move(session)),
        context_(context),
        socket_(std::move(socket)),
        hello_timer_(socket_.get_executor()) {
    ++context_.metrics.agents;
  }
  ~AgentSocket() {
    close_udp();
    --context_.metrics.agents;
  }

  void start(UpgradeRequest request) {
    auto run = [self = shared_from_this(), request = std::move(request)]() mutable {
      return self->run(std::move(request));
    };
    asio::co_spawn(socket_.get_executor(), std::move(run), asio::detached);
  }

 private:
  asio::awaitable<void> run(UpgradeRequest request);
  void limit_hello();
  void on_event(const SessionEvent& event);
  void on_frame(std::span<const std::byte> frame, bool text, Clock::time_point arrived);
  void on_control(std::string_view text);
  void on_hello(const HelloMessage& hello);
  void on_binary(std::span<const std::byte> frame, Clock::time_point arrived);
  void on_motion(const wire::MotionBatch& batch, Clock::time_point arrived);
  MotionAnswer apply(const wire::MotionBatch& batch, Clock::time_point arrived);
  void open_udp();
  void close_udp();
  void on_datagram(std::span<const std::byte> frame, Clock::time_point arrived);
  void on_datagram_motion(const wire::MotionBatch& batch, Clock::time_point arrived);
  template <typename Body>
  void send_datagram(std::uint64_t sequence, const Body& body);
  void reject(const Rejection& rejection, bool fatal = false);
  void say(std::string_view text);
  void say_pong(const wire::Ping& ping);
  void say_stock();
  void finish();
  void pump();
  void written(error_code error);
  wire::FrameStamp stamp(std::uint64_t sequence) const {
    return {session_->epoch(), sequence, clock_us()};
  }

  std::shared_ptr<Session> session_;
  PeerContext& context_;
  WebSocket socket_;
  asio::steady_timer hello_timer_;
  beast::flat_buffer in_;
  std::optional<Participant> self_;
  int listener_ = 0;
  RateLimit errors_{kErrorsPerS, kErrorsBurst};

  AgentOutbox out_;
  AgentOutbox::Frame leaving_;
  Clock::time_point stock_due_;
  std::uint64_t felts_ = 0, results_ = 0, pongs_ = 0;
  bool writing_ = false, finishing_ = false, broken_ = false;

  /// Null without a UDP lane.
  std::shared_ptr<UdpPeer> udp_;
  SampleGate gate_;
  wire::Result last_answer_;
};

asio::awaitable<void> AgentSocket::run(UpgradeRequest request) {
  error_code error;
  prepare(socket_, wire::kAgentProtocol);
  co_await socket_.async_accept(request, asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return;
  listener_ = session_->listen([this](const SessionEvent& event) { on_event(event); });
  limit_hello();
  while (!error && !broken_) {
    in_.consume(in_.size());
    co_await socket_.async_read(in_, asio::redirect_error(asio::use_awaitable, error));
    if (error || finishing_) continue;
    const auto data = in_.cdata();
    on_frame({static_cast<const std::byte*>(data.data()), data.size()}, socket_.got_text(),
             Clock::now());
  }
  hello_timer_.cancel();
  close_udp();
  session_->unlisten(listener_);
  if (self_) session_->leave(self_->id);
}

void AgentSocket::limit_hello() {
  hello_timer_.expires_after(std::chrono::microseconds(std::int64_t(wire::kHelloTimeoutS * 1e6)));
  hello_timer_.async_wait([self = shared_from_this()](error_code error) {
    if (error || self->self_) return;
    self->reject({wire::ErrorCode::kNoHello, "no hello within 5 s"}, true);
    self->finish();
  });
}

void AgentSocket::on_event(const SessionEvent& event) {
  if (event.closing.empty()) {
    if (self_) say(participants_message(session_->participants()));
    return;
  }
  say(bye_message(event.closing));
  finish();
}

void AgentSocket::on_frame(std::span<const std::byte> frame, bool text, Clock::time_point arrived) {
  if (frame.size() > wire::kMaxClientFrameBytes) {
    reject({wire::ErrorCode::kTooLarge, "a frame of " + std::to_string(frame.size()) +
                                            " bytes; at most " +
                                            std::to_string(wire::kMaxClientFrameBytes)});
  } else if (text) {
    on_control({reinterpret_cast<const char*>(frame.data()), frame.size()});
  } else {
    on_binary(frame, arrived);
  }
}

void AgentSocket::on_control(std::string_view text) {
  const auto message = parse_control(text);
  if (!message) return reject(message.error());
  if (const auto* hello = std::get_if<HelloMessage>(&*message)) return on_hello(*hello);
  if (!self_) return reject({wire::ErrorCode::kNoHello, "the first message must be a hello"});
  if (std::holds_alternative<StockMessage>(*message)) {
    return session_->reset_stock(self_->id);
  }
  const auto* tool = std::get_if<ToolMessage>(&*message);
  if (tool == nullptr) return reject({wire::ErrorCode::kBadMessage, "only a viewer looks"});
  const auto chosen = session_->choose_tool(self_->id, tool->tool);
  if (!chosen) reject(chosen.error());
}

void AgentSocket::on_hello(const HelloMessage& hello) {
  if (self_) return reject({wire::ErrorCode::kBadMessage, "hello was said before"});
  const JoinRequest request{
      ParticipantKind::kAgent, hello.name, hello.color, hello.tool, hello.feel,
      hello.feel_of,           hello.stock};
  const auto joined = session_->join(request);
  if (!joined) {
    const bool fatal = joined.error().code == wire::ErrorCode::kBusy;
    reject(joined.error(), fatal);
    if (fatal) finish();
    return;
  }
  self_ = *joined;
  hello_timer_.cancel();
  if (hello.udp) open_udp();
  say(agent_welcome(*session_, *self_, context_.limits, udp_ ? &udp_->offer() : nullptr));
  say(participants_message(session_->participants()));
}

void AgentSocket::on_binary(std::span<const std::byte> frame, Clock::time_point arrived) {
  const auto message = wire::decode(frame, wire::kMaxClientFrameBytes);
  if (!message) {
    return reject({wire::protocol_error(message.error().code),
                   std::string(message.error().reason) + " (byte " +
                       std::to_string(message.error().offset) + " of the frame)"});
  }
  if (const auto* ping = std::get_if<wire::Ping>(&message->body)) return say_pong(*ping);
  if (const auto* batch = std::get_if<wire::MotionBatch>(&message->body)) {
    return on_motion(*batch, arrived);
  }
  if (std::holds_alternative<wire::Ack>(message->body)) {
    if (!self_) return reject({wire::ErrorCode::kNoHello, "the first message must be a hello"});
    const auto taken = session_->ack_stock(self_->id, message->header.stamp.sequence);
    if (!taken) reject(taken.error());
    return;
  }
  const bool skipped = std::holds_alternative<wire::UnknownBody>(message->body) ||
                       std::holds_alternative<wire::Pong>(message->body);
  if (!skipped) reject({wire::ErrorCode::kBadMessage, "an agent does not send such frames"});
}

void AgentSocket::on_motion(const wire::MotionBatch& batch, Clock::time_point arrived) {
  if (!self_) return reject({wire::ErrorCode::kNoHello, "the first message must be a hello"});
  const MotionAnswer answer = apply(batch, arrived);
  out_.put_result(stamp(++results_), answer.result, arrived);
  if (answer.felt) out_.put_felt(stamp(++felts_), *answer.felt);
  say_stock();
  pump();
}

MotionAnswer AgentSocket::apply(const wire::MotionBatch& batch, Clock::time_point arrived) {
  auto answer = session_->move(self_->id, batch.view());
  for (const Rejection& rejection : answer.rejections) reject(rejection);
  answer.result.turnaround_us = static_cast<std::uint32_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - arrived).count());
  gate_.applied(answer.result.agent_sequence);
  last_answer_ = answer.result;
  return answer;
}

void AgentSocket::open_udp() {
  auto take = [weak = weak_from_this()](std::span<const std::byte> frame,
                                        Clock::time_point arrived) {
    if (const auto self = weak.lock()) self->on_datagram(frame, arrived);
  };
  udp_ = context_.udp.open(session_->executor(), std::move(take));
}

void AgentSocket::close_udp() {
  if (udp_) context_.udp.close(*udp_);
  udp_.reset();
}

void AgentSocket::on_datagram(std::span<const std::byte> frame, Clock::time_point arrived) {
  if (!udp_ || finishing_ || broken_) return;
  const auto message = wire::decode(frame, wire::kMaxClientFrameBytes);
  if (!message) {
    return reject(
        {wire::protocol_error(message.error().code), std::string(message.error().reason)});
  }
  if (const auto* ping = std::get_if<wire::Ping>(&message->body)) {
    send_datagram(++pongs_, wire::Pong{ping->time_us, clock_us()});
  } else if (const auto* batch = std::get_if<wire::MotionBatch>(&message->body)) {
    on_datagram_motion(*batch, arrived);
  }
}

/// What was lost on the way is never guessed: behind a gap nothing is applied, and the answer
/// before goes out again, so that the agent knows from where on to repeat.
void AgentSocket::on_datagram_motion(const wire::MotionBatch& batch, Clock::time_point arrived) {
  const Arrival arrival = gate_.judge(batch);
  if (arrival == Arrival::kNew) {
    const MotionAnswer answer = apply(batch, arrived);
    if (answer.felt) send_datagram(++felts_, wire::ToolStates{{*answer.felt}});
    send_datagram(++results_, answer.result);
    context_.metrics.motion_answered(std::chrono::duration<double>(Clock::now() - arrived).count());
    say_stock();
    pump();
    return;
  }
  wire::Result again = last_answer_;
  if (arrival == Arrival::kGap) {
    context_.metrics.motion_gap();
    again.status |= wire::kStatusGap;
  }
  send_datagram(++results_, again);
}

template <typename Body>
void AgentSocket::send_datagram(std::uint64_t sequence, const Body& body) {
  std::array<std::byte, datagram::kMaxFrameBytes> frame;
  const std::size_t bytes = wire::encode(stamp(sequence), body, frame);
  udp_->send(std::span(frame).first(bytes));
}

/// Asks for what the agent's copy of the block lacks, while nothing of it waits to leave.
void AgentSocket::say_stock() {
  const auto now = Clock::now();
  if (out_.has_stock() || now < stock_due_) return;
  stock_due_ = now + kStockInterval;
  if (const auto news = session_->stock_update(self_->id)) {
    out_.put_stock(stamp(news->sequence), news->patch());
  }
}

void AgentSocket::reject(const Rejection& rejection, bool fatal) {
  context_.metrics.rejected(wire::to_string(rejection.code));
  if (fatal || errors_.allow(Clock::now())) say(error_message(rejection, fatal));
}

void AgentSocket::say(std::string_view text) {
  if (broken_) return;
  if (!out_.put_text(text)) {
    broken_ = true;  // it does not read: nothing that we say would arrive
    beast::get_lowest_layer(socket_).close();
    return;
  }
  pump();
}

void AgentSocket::say_pong(const wire::Ping& ping) {
  out_.put_pong(stamp(++pongs_), {ping.time_us, clock_us()});
  pump();
}

void AgentSocket::finish() {
  finishing_ = true;
  out_.close();
  pump();
}

void AgentSocket::pump() {
  if (writing_ || broken_) return;
  const bool leaves = out_.take(leaving_);
  if (!leaves && !finishing_) return;
  writing_ = true;
  if (!leaves) {
    socket_.async_close(beast::websocket::close_code::going_away,
                        [self = shared_from_this()](error_code) {});
    return;
  }
  socket_.text(leaving_.kind == AgentOutbox::Kind::kText);
  socket_.async_write(
      asio::buffer(leaving_.bytes),
      [self = shared_from_this()](error_code error, std::size_t) { self->written(error); });
}

void AgentSocket::written(error_code error) {
  writing_ = false;
  if (error) {
    broken_ = true;
    return;
  }
  if (leaving_.kind == AgentOutbox::Kind::kResult) {
    context_.metrics.motion_answered(
        std::chrono::duration<double>(Clock::now() - leaving_.arrived).count());
  }
  pump();
}

}  // namespace

void serve_agent(asio::ip::tcp::socket socket, UpgradeRequest request,
                 std::shared_ptr<Session> session, PeerContext& context) {
  error_code error;
  socket.set_option(asio::ip::tcp::no_delay(true), error);
  const auto protocol = socket.local_endpoint(error).protocol();
  const auto native = socket.release(error);
  if (error) return;
  IoThreads& thread = threads_of(*session);
  thread.post([native, protocol, &thread, request = std::move(request),
               session = std::move(session), &context]() mutable {
    asio::ip::tcp::socket moved(thread.context(), protocol, native);
    std::make_shared<AgentSocket>(std::move(moved), std::move(session), context)
        ->start(std::move(request));
  });
}

}  // namespace kerf::net
