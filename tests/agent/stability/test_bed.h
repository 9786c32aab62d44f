// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "haptic_agent/guides/guide_model.h"
#include "haptic_agent/link/traffic.h"
#include "haptic_agent/replica/replica.h"
#include "haptic_agent/servo/servo_cycle.h"
#include "server/conversation/agent_conversation.h"
#include "server/platform/clock.h"
#include "server/session/session_registry.h"
#include "server/wire/codec.h"
#include "tests/agent/stability/virtual_line.h"
#include "tests/server/shared_executor.h"
#include "tests/support/temporary_folder.h"

namespace kerf::agent {

/// The real session, traffic, codec and servo with a simulated line between them, in virtual time:
/// one call of `tick` is one millisecond.
class TestBed {
 public:
  /// `scene`: a scene in JSON. `device` must outlive the object. `copy`: the agent has a replica,
  /// which with `intent` looks ahead of other participants' tools.
  TestBed(const std::string& scene, HapticDevice& device, ServoSettings settings,
          const LineQuality& quality, bool copy, std::uint32_t seed = 1, bool intent = true);

  /// `runs`: whether the servo's tick runs or is lost.
  void tick(bool runs = true);
  /// Makes a second agent, on a line of the same quality, cut to `tip_mm` with the first tool.
  void another_cuts_to(Vec3 tip_mm);

  const ServoCycle& servo() const { return *servo_; }
  /// The server's newest result, before transmission.
  const wire::Result& newest() const { return newest_; }
  Session& session() { return *session_; }
  /// The agent's replica. May be null.
  const Replica* replica() const { return copy_.replica ? &*copy_.replica : nullptr; }
  /// The scene's guides. May be null.
  const GuideModel* guidance() const { return guidance_ ? &*guidance_ : nullptr; }
  LinkReport link() const { return traffic_->report(); }
  std::uint64_t now_us() const { return now_us_; }

 private:
  struct Listener final : SampleListener {
    bool is_woken = false;
    void sample_ready() noexcept override { is_woken = true; }
  };
  /// The agent's replica. It answers within the tick in which it is woken.
  struct Copy final : StockListener {
    std::optional<Replica> replica;
    void take_stock(std::span<const std::byte> frame) override;
    void take_result(const wire::Result& result) override {
      replica->compare(result.agent_time_us, Vec3(result.force_n));
    }
    bool wants_reset() override { return replica->take_divergence(); }
    void answer(ReplicaExchange& servo, std::uint64_t now_us);
  };

  void join(const SessionLimits& limits, bool copy, bool intent);
  void another_arrives(std::span<const std::byte> bytes);
  void send();
  void serve(std::span<const std::byte> frame);
  void send_answers();
  void run_session();
  kerf::Clock::time_point time() const {
    return kerf::Clock::time_point(std::chrono::microseconds(now_us_));
  }

  test::TemporaryFolder folder_;
  std::shared_ptr<test::SharedExecutor> executor_ = std::make_shared<test::SharedExecutor>();
  test::SharedExecutor workers_;
  std::optional<SessionRegistry> registry_;
  std::shared_ptr<Session> session_;
  net::Metrics metrics_;
  ParticipantId another_ = 0;
  std::uint64_t another_sequence_ = 0;
  SampleRing samples_;
  LatestValue<ServerWrench> wrenches_;
  Listener listener_;
  ReplicaExchange exchange_;
  Copy copy_;
  std::unique_ptr<Traffic> traffic_;
  VirtualLine up_, down_, another_up_;
  std::string welcome_;
  std::optional<GuideModel> guidance_;
  std::unique_ptr<ServoCycle> servo_;
  wire::Result newest_;
  std::unique_ptr<net::AgentConversation> conversation_;
  std::uint64_t now_us_ = 2'000'000;
};

}  // namespace kerf::agent
