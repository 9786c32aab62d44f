// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string_view>

#include "server/conversation/conversation.h"
#include "server/socket/serve_peer.h"
#include "server/websocket/web_socket.h"

namespace kerf::net {

/// WebSocket close code 1001: the server is going away.
inline constexpr std::uint16_t kGoingAway = 1001;

/// One WebSocket, of an agent or a viewer. Moves frames between the network and a Conversation and
/// knows nothing of their content. Everything runs on the thread of the socket's executor.
class PeerSocket : public std::enable_shared_from_this<PeerSocket> {
 public:
  virtual ~PeerSocket() = default;
  PeerSocket(const PeerSocket&) = delete;
  PeerSocket& operator=(const PeerSocket&) = delete;

  /// Accepts the upgrade and runs until the connection is gone. The socket keeps itself alive.
  void start(UpgradeRequest request);

 protected:
  /// Time for a peer to read the last frames and to close, once its conversation is over. Shorter
  /// than the time that a stopping server waits for its peers.
  static constexpr std::chrono::milliseconds kLeaveTime{1500};

  /// `remaining_s`: time until the peer's grant expires (negative: never).
  PeerSocket(ByteStream stream, std::string_view protocol, std::int64_t remaining_s,
             std::chrono::milliseconds leave_time = kLeaveTime);

  virtual Conversation& conversation() = 0;
  /// Performs the action of Conversation::has_action. No frame is read during it.
  virtual boost::asio::awaitable<void> act();
  /// The connection is gone, or the upgrade has failed.
  virtual void closed() = 0;

  /// Sends the next frame of the conversation unless one is being sent.
  void pump();
  /// Whether writing has failed, so that nothing can be sent any more.
  bool has_failed() const { return failed_; }

 private:
  boost::asio::awaitable<void> run(UpgradeRequest request);
  void limit_hello();
  void limit_grant();
  void limit_leaving();
  void written(boost::system::error_code error);

  WebSocket socket_;
  std::string_view protocol_;
  std::int64_t remaining_s_;
  std::chrono::milliseconds leave_time_;
  boost::asio::steady_timer hello_timer_, grant_timer_, leave_timer_;
  OutFrame out_;  ///< being sent
  bool open_ = false, writing_ = false, failed_ = false, leaving_ = false;
};

}  // namespace kerf::net
