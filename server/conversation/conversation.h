// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "server/conversation/control_json.h"
#include "server/conversation/out_frame.h"
#include "server/metrics/metrics.h"
#include "server/platform/clock.h"
#include "server/rights/caller.h"
#include "server/session/rate_limit.h"
#include "server/session/session.h"
#include "server/wire/codec.h"

namespace kerf::net {

/// The clock of a conversation; tests pass a simulated one.
using Now = std::function<Clock::time_point()>;

/// The server's side of one WebSocket of a session (server/wire/README.md), without socket, thread
/// or clock. It takes frames and produces frames. Its owner (PeerSocket, or a test):
///
/// 1. passes each frame that the peer sends to receive();
/// 2. sends what take() returns, one frame at a time, and calls sent() after each;
/// 3. calls refresh() after each received frame, once its answers are in transit;
/// 4. calls hello_expired() wire::kHelloTimeoutS after the start unless has_joined();
/// 5. closes the WebSocket when finishing() and take() returns nothing more; drops the connection
///    at once when broken();
/// 6. repeats step 2 when `wake` is called, which happens for frames that no received frame caused;
/// 7. calls end() when the connection is gone.
///
/// All calls come from one thread.
class Conversation {
 public:
  /// Errors beyond this rate are counted but not reported to the peer.
  static constexpr double kErrorsPerS = 20;
  static constexpr double kErrorsBurst = 50;
  /// Text frames and pings beyond this rate are dropped before they are read.
  static constexpr double kControlsPerS = 100;
  static constexpr double kControlsBurst = 200;

  Conversation(const Conversation&) = delete;
  Conversation& operator=(const Conversation&) = delete;
  virtual ~Conversation() = default;

  /// Handles one WebSocket frame, read at `arrived`. Ignored when finishing or broken.
  void receive(std::span<const std::byte> frame, bool is_text, Clock::time_point arrived);
  /// Rejects a peer that has not sent its hello in time.
  void hello_expired();
  /// The peer's grant has expired.
  void grant_expired();
  /// Queues frames that can wait until the answers to a received frame have left.
  virtual void refresh() {}
  /// Whether the owner has to act before it passes on the next frame.
  virtual bool has_action() const { return false; }

  /// Moves the next frame to send into `out`, reusing its memory. Returns false if there is none.
  virtual bool take(OutFrame& out) = 0;
  /// Whether another frame is ready to leave at once, so that the network may carry both together.
  virtual bool has_more() const { return false; }
  /// `frame`, the last one taken, has been handed to the operating system.
  virtual void sent(const OutFrame&) {}

  /// Whether the peer's hello has been accepted, so that it is a participant.
  bool has_joined() const { return self_.has_value(); }
  /// Whether the conversation is over: the remaining frames are sent, then the WebSocket is closed.
  bool finishing() const { return finishing_; }
  /// Whether the peer does not read, so that the connection should be dropped.
  bool broken() const { return broken_; }
  /// The connection is gone.
  virtual void end() = 0;

 protected:
  Conversation(std::shared_ptr<Session> session, Metrics& metrics, Now now,
               std::function<void()> wake, Caller caller);

  virtual void on_hello(const HelloMessage& hello) = 0;
  /// The join request of a peer with this name and color, and the rights of its token.
  JoinRequest join_request(ParticipantKind kind, const HelloMessage& hello) const;
  /// Rejects a hello. The peer may try again unless it has to come back later, or may not join at
  /// all.
  void reject_hello(const Rejection& rejection);
  /// Handles any other control message, after the hello.
  virtual void on_control(const ControlMessage& message) = 0;
  /// Handles a well-formed binary message other than ping, pong and unknown types.
  virtual void on_message(const wire::Message& message, Clock::time_point arrived) = 0;
  virtual bool queue_text(std::string_view text) = 0;
  virtual void queue_pong(const wire::FrameStamp& stamp, const wire::Pong& pong) = 0;
  /// Discards the frames that need not arrive before the conversation ends.
  virtual void discard_updates() = 0;

  void reject(const Rejection& rejection, bool fatal = false);
  void reject_without_hello();
  /// Rejects a frame of another epoch. It refers to the session before it was reopened, with other
  /// sequences and possibly another block.
  bool is_of_this_epoch(const wire::Message& message);
  void reject_frame_type(const wire::Message& message, std::string_view kind);
  void say(std::string_view text);
  void finish();
  void wake() const {
    if (wake_) wake_();
  }
  wire::FrameStamp stamp(std::uint64_t sequence) const {
    return {session_->epoch(), sequence, to_us(now_())};
  }
  Session& session() const { return *session_; }

  Metrics& metrics_;
  Now now_;
  std::optional<Participant> self_;
  bool hello_waits_ = false;  ///< the answer to an accepted hello is pending
  std::uint64_t pongs_ = 0;

 private:
  void receive_text(std::string_view text);
  void receive_binary(std::span<const std::byte> frame, Clock::time_point arrived);

  std::shared_ptr<Session> session_;
  std::function<void()> wake_;
  Caller caller_;
  RateLimit errors_{kErrorsPerS, kErrorsBurst};
  RateLimit texts_{kControlsPerS, kControlsBurst}, pings_{kControlsPerS, kControlsBurst};
  bool finishing_ = false, broken_ = false;
};

}  // namespace kerf::net
