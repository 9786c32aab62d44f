// SPDX-License-Identifier: Apache-2.0
// One viewer's WebSocket, on the viewers' thread.
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>
#include <utility>

#include "server/conversation/viewer_conversation.h"
#include "server/metrics/metrics.h"
#include "server/socket/peer_socket.h"
#include "server/socket/viewer_hub.h"
#include "server/threads/run_on.h"
#include "server/wire/control.h"

namespace kerf::net {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

/// Without this limit the kernel keeps megabytes of stale frames in its send buffer (README.md).
constexpr int kNotSentBytes = 32 * 1024;

class ViewerConnection final : public PeerSocket {
 public:
  ViewerConnection(ByteStream stream, std::shared_ptr<Session> session, Caller caller,
                   PeerContext& context)
      : PeerSocket(std::move(stream), wire::kViewProtocol, caller.remaining_s),
        session_(std::move(session)),
        context_(context),
        conversation_(
            session_, context.metrics, Clock::now, [this] { pump(); }, std::move(caller),
            context.viewer_budget) {
    ++context_.metrics.viewers;
  }
  ~ViewerConnection() override {
    leave_hub();  // also if an exception ended the connection
    --context_.metrics.viewers;
  }

 private:
  Conversation& conversation() override { return conversation_; }
  asio::awaitable<void> act() override;
  asio::awaitable<bool> wait_for_turn();
  asio::awaitable<void> join(JoinRequest request);
  void leave_hub();
  void closed() override;

  std::shared_ptr<Session> session_;
  PeerContext& context_;
  ViewerConversation conversation_;
  std::shared_ptr<ViewerHub> hub_;  ///< null before the viewer has joined
};

asio::awaitable<void> ViewerConnection::act() {
  while (const auto action = conversation_.take_action()) {
    if (const auto* request = std::get_if<JoinRequest>(&*action)) {
      co_await join(*request);
    } else if (const auto* look = std::get_if<ViewerLook>(&*action)) {
      hub_->look(conversation_.id(), *look);
    } else if (const auto* budget = std::get_if<ViewerBudget>(&*action)) {
      hub_->set_budget(conversation_.id(), budget->bytes_per_s);
    } else if (const auto* ack = std::get_if<MeshAck>(&*action)) {
      hub_->acknowledge(conversation_.id(), ack->sequence);
    } else if (const auto* seek = std::get_if<SeekMessage>(&*action)) {
      hub_->seek(conversation_.id(), *seek);
    } else if (const auto* camera = std::get_if<CameraMessage>(&*action)) {
      hub_->show_camera(conversation_.id(), *camera);
    }
  }
}

/// Waits until the viewer may join. Returns false if it must be rejected. A large audience is
/// admitted one by one.
asio::awaitable<bool> ViewerConnection::wait_for_turn() {
  auto ask = [session = session_] { return session->people().viewer_turn(); };
  const auto wait_s = co_await run_on(threads_of(*session_), std::move(ask));
  if (!wait_s) co_return false;
  if (*wait_s <= 0) co_return true;
  error_code ignored;
  asio::steady_timer timer(co_await asio::this_coro::executor);
  timer.expires_after(std::chrono::duration_cast<std::chrono::microseconds>(
      std::chrono::duration<double>(*wait_s)));
  co_await timer.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
  co_return true;
}

asio::awaitable<void> ViewerConnection::join(JoinRequest request) {
  using Joined = std::pair<std::expected<Participant, Rejection>, Roster>;
  request.has_turn = co_await wait_for_turn();
  auto join = [session = session_, request]() {
    auto joined = session->join(request);
    return Joined{std::move(joined), session->roster()};
  };
  const Joined joined = co_await run_on(threads_of(*session_), std::move(join));
  conversation_.joined(joined.first, joined.second);
  if (!joined.first) co_return;
  hub_ = context_.hubs.get(session_, context_);
  hub_->add(conversation_.id(), &conversation_, conversation_.first_look());
}

void ViewerConnection::leave_hub() {
  if (hub_) hub_->remove(conversation_.id());
  hub_.reset();
}

void ViewerConnection::closed() {
  leave_hub();
  if (!conversation_.has_joined()) return;
  threads_of(*session_).post([session = session_, id = conversation_.id()] { session->leave(id); });
}

}  // namespace

void serve_viewer(ByteStream stream, UpgradeRequest request, std::shared_ptr<Session> session,
                  Caller caller, PeerContext& context) {
  error_code ignored;
  stream.socket().set_option(asio::ip::tcp::no_delay(true), ignored);
  setsockopt(stream.socket().native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &kNotSentBytes,
             sizeof kNotSentBytes);
  std::make_shared<ViewerConnection>(std::move(stream), std::move(session), std::move(caller),
                                     context)
      ->start(std::move(request));
}

}  // namespace kerf::net
