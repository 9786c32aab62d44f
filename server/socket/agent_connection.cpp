// SPDX-License-Identifier: Apache-2.0
// One agent: its WebSocket and, on request, its UDP connection. Belongs to the thread of its
// session, so that the thread that reads a motion also cuts and answers it.
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>
#include <utility>

#include "server/conversation/agent_conversation.h"
#include "server/metrics/metrics.h"
#include "server/socket/peer_socket.h"
#include "server/udp/udp_port.h"
#include "server/wire/control.h"

namespace kerf::net {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

class AgentConnection final : public PeerSocket {
 public:
  AgentConnection(ByteStream stream, const std::shared_ptr<Session>& session, Caller caller,
                  PeerContext& context)
      : PeerSocket(std::move(stream), wire::kAgentProtocol, caller.remaining_s),
        context_(context),
        executor_(session->executor()),
        worked_(static_cast<IoThreads&>(executor_).context(), Clock::time_point::max()),
        conversation_({.session = session,
                       .limits = context.limits,
                       .metrics = context.metrics,
                       .now = Clock::now,
                       .wake = [this] { pump(); },
                       .open_udp = [this] { return open_udp(); },
                       .caller = std::move(caller)}) {
    ++context_.metrics.agents;
  }
  ~AgentConnection() override {
    close_udp();
    --context_.metrics.agents;
  }

 private:
  Conversation& conversation() override { return conversation_; }
  asio::awaitable<void> act() override;
  void closed() override {
    close_udp();
    conversation_.end();
  }

  std::optional<datagram::Offer> open_udp();
  void close_udp();
  void receive_datagram(std::span<const std::byte> frame, Clock::time_point arrived);
  void send_datagrams();

  PeerContext& context_;
  Executor& executor_;
  std::shared_ptr<UdpPeer> udp_;  ///< null without a UDP connection
  bool works_ = false;            ///< a coroutine works on the batch
  asio::steady_timer worked_;     ///< cancelled when the work is done; never expires
  AgentConversation conversation_;
};

std::optional<datagram::Offer> AgentConnection::open_udp() {
  auto take = [weak = weak_from_this()](std::span<const std::byte> frame,
                                        Clock::time_point arrived) {
    const auto self = std::static_pointer_cast<AgentConnection>(weak.lock());
    if (self) self->receive_datagram(frame, arrived);
  };
  udp_ = context_.udp.open(executor_, std::move(take));
  if (!udp_) return std::nullopt;
  return udp_->offer();
}

/// Works on a long batch, turn by turn. In between the thread serves the other agents, for at least
/// as long as this one. Before the first turn it reads the frames that they have already sent,
/// because these may be carved together. Only one coroutine works, and another waits for it, so
/// that this also holds while both transports have frames.
asio::awaitable<void> AgentConnection::act() {
  error_code ignored;
  while (works_) co_await worked_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
  works_ = true;
  asio::io_context& thread = static_cast<IoThreads&>(executor_).context();
  co_await asio::post(thread, asio::use_awaitable);
  asio::steady_timer pause(thread);
  while (conversation_.has_action() && !has_failed()) {
    const auto start = Clock::now();
    conversation_.work();
    send_datagrams();
    pump();
    if (!conversation_.has_action()) break;
    pause.expires_after(conversation_.has_rival() ? Clock::now() - start : Clock::duration{});
    co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
  }
  works_ = false;
  worked_.cancel();
  conversation_.refresh();
  pump();
}

void AgentConnection::close_udp() {
  if (udp_) context_.udp.close(*udp_);
  udp_.reset();
}

void AgentConnection::send_datagrams() {
  if (!udp_) return;
  while (const OutDatagram* datagram = conversation_.take_datagram()) {
    udp_->send(datagram->frame());
    if (!datagram->arrived) continue;
    const std::chrono::duration<double> turnaround = Clock::now() - *datagram->arrived;
    context_.metrics.motion_answered(turnaround.count());
  }
}

void AgentConnection::receive_datagram(std::span<const std::byte> frame,
                                       Clock::time_point arrived) {
  if (!udp_ || has_failed()) return;
  conversation_.receive_datagram(frame, arrived);
  send_datagrams();
  conversation_.refresh();
  pump();
  if (!conversation_.has_action() || works_) return;
  auto work = [self = std::static_pointer_cast<AgentConnection>(
                   shared_from_this())]() -> asio::awaitable<void> { co_await self->act(); };
  asio::co_spawn(static_cast<IoThreads&>(executor_).context(), std::move(work), asio::detached);
}

}  // namespace

void serve_agent(ByteStream stream, UpgradeRequest request, std::shared_ptr<Session> session,
                 Caller caller, PeerContext& context) {
  error_code error;
  stream.socket().set_option(asio::ip::tcp::no_delay(true), error);
  const auto protocol = stream.socket().local_endpoint(error).protocol();
  auto tls = stream.release_tls();
  const auto native = stream.socket().release(error);
  if (error) return;
  IoThreads& thread = threads_of(*session);
  thread.post([native, protocol, &thread, tls = std::move(tls), request = std::move(request),
               session = std::move(session), caller = std::move(caller), &context]() mutable {
    ByteStream moved(asio::ip::tcp::socket(thread.context(), protocol, native), std::move(tls));
    std::make_shared<AgentConnection>(std::move(moved), session, std::move(caller), context)
        ->start(std::move(request));
  });
}

}  // namespace kerf::net
