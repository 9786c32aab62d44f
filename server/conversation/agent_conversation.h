// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "server/conversation/agent_outbox.h"
#include "server/conversation/conversation.h"
#include "server/conversation/sample_gate.h"
#include "server/datagram/key.h"
#include "server/datagram/layout.h"
#include "server/platform/clock.h"

namespace kerf::net {

/// A frame to send to the agent over UDP, before it is sealed.
struct OutDatagram {
  std::array<std::byte, datagram::kMaxFrameBytes> bytes;
  std::size_t size = 0;
  std::optional<Clock::time_point> arrived;  ///< of the motion that it answers, if it is an answer

  std::span<const std::byte> frame() const { return std::span(bytes).first(size); }
};

/// The server's side of one agent's protocol, over its WebSocket and, on request, over UDP. Belongs
/// to the session's executor: motions are cut and answered inside receive() and receive_datagram().
class AgentConversation final : public Conversation {
 public:
  /// Minimum interval between updates of an agent's replica.
  static constexpr std::chrono::milliseconds kStockInterval{20};

  /// Minimum interval between intent frames.
  static constexpr std::chrono::milliseconds kIntentInterval{10};

  /// Interval at which the list of other servers is compared with the one that the agent has.
  static constexpr std::chrono::seconds kServersInterval{1};

  /// Limits changes of the tool and, separately, of the reach, because every participant is
  /// notified: rate per second and burst.
  static constexpr double kChangesPerS = 10;
  static constexpr double kChangesBurst = 30;

  struct Setup {
    std::shared_ptr<Session> session;
    const SessionLimits& limits;  ///< for the welcome
    Metrics& metrics;
    Now now = Clock::now;
    /// Called when frames are queued that are not caused by a received frame.
    std::function<void()> wake;
    /// Opens a UDP connection for this agent, or nullopt if none is available.
    std::function<std::optional<datagram::Offer>()> open_udp;
    Caller caller = Caller::local();
  };

  explicit AgentConversation(Setup setup);
  ~AgentConversation() override;

  /// Handles one frame received over the UDP connection. Call refresh() afterwards.
  void receive_datagram(std::span<const std::byte> frame, Clock::time_point arrived);
  /// The next datagram to send, valid until the next call of a receive function or of work(), or
  /// null without one.
  const OutDatagram* take_datagram();

  void refresh() override;
  /// A batch is longer than one turn of the executor: no frame may be passed on before work() has
  /// completed it.
  bool has_action() const override { return batch_.has_value(); }
  /// Works on the batch for one turn. On completion queues the answer as a frame, or as datagrams
  /// if the batch came over UDP.
  void work();
  /// Whether another agent of the session is moving.
  bool has_rival() const { return self_ && session().has_other_agent(self_->id); }
  bool take(OutFrame& out) override { return out_.take(out); }
  void sent(const OutFrame& frame) override;
  void end() override;

 private:
  /// A batch that continues in later turns.
  struct InProgress {
    Clock::time_point arrived;
    bool over_udp;
  };

  void on_hello(const HelloMessage& hello) override;
  void on_control(const ControlMessage& message) override;
  void on_message(const wire::Message& message, Clock::time_point arrived) override;
  bool queue_text(std::string_view text) override { return out_.put_text(text); }
  void queue_pong(const wire::FrameStamp& stamp, const wire::Pong& pong) override {
    out_.put_pong(stamp, {pong.ping_time_us, pong.time_us, durable_sequence()});
  }
  void discard_updates() override { out_.close(); }

  void change_stroke(bool undone);
  void send_intents(Clock::time_point now);
  void send_servers(Clock::time_point now);
  void on_event(const SessionEvent& event);
  /// The durable sequence for results and pongs, or 0 unless the agent has requested it.
  std::uint64_t durable_sequence() const;
  /// Returns the answer, unless the batch continues in later turns.
  std::optional<MotionAnswer> apply(const wire::MotionBatch& batch, const InProgress& from);
  void complete(MotionAnswer& answer, Clock::time_point arrived);
  void queue_answer(const MotionAnswer& answer, Clock::time_point arrived);
  void queue_answer_datagrams(const MotionAnswer& answer, Clock::time_point arrived);
  void on_datagram_motion(const wire::MotionBatch& batch, Clock::time_point arrived);
  template <typename Body>
  void queue_datagram(std::uint64_t sequence, const Body& body,
                      std::optional<Clock::time_point> arrived = std::nullopt);

  SessionLimits limits_;
  std::function<std::optional<datagram::Offer>()> open_udp_;
  int listener_ = 0;
  AgentOutbox out_;
  std::uint64_t felts_ = 0, results_ = 0, intents_ = 0;
  bool states_durable_ = false;
  /// The participant was removed, or belongs to a newer connection of the agent.
  bool left_ = false;

  RateLimit tools_{kChangesPerS, kChangesBurst};
  RateLimit reaches_{kChangesPerS, kChangesBurst};
  /// Whether a stroke is being undone or redone; expires with the conversation.
  std::shared_ptr<bool> changes_ = std::make_shared<bool>(false);

  bool stock_due_ = false;  ///< the replica may be incomplete
  bool has_whole_ = false;  ///< the replica is of the whole block
  Clock::time_point next_stock_;
  bool intents_due_ = false;  ///< samples have been applied since the last ones
  bool has_near_ = false;     ///< the last intent frame listed a tool
  Clock::time_point next_intents_;
  std::vector<std::string> servers_;  ///< other ones, as the agent knows them
  Clock::time_point next_servers_;

  std::optional<InProgress> batch_;

  bool has_udp_ = false;
  SampleGate gate_;
  wire::Result last_answer_;
  std::array<OutDatagram, 2> datagrams_;  ///< an answer: another's force, and the result
  std::size_t datagrams_queued_ = 0, datagrams_taken_ = 0;
};

}  // namespace kerf::net
