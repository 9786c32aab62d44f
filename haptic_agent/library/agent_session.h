// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "haptic_agent/force_reason.h"
#include "haptic_agent/guides/guide_model.h"
#include "haptic_agent/library/kerf_agent.h"
#include "haptic_agent/link/server_link.h"
#include "haptic_agent/replica/replica_thread.h"
#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {

struct SessionOptions {
  LinkSettings link;
  DeviceCapabilities device;
  WrenchLimits limits;
  /// Maintain a copy of the block near the tool.
  bool keep_copy = true;
};

struct SessionFailure {
  kerf_agent_result result = KERF_AGENT_INTERNAL;
  /// One sentence.
  std::string reason;
};

/// The device of a servo cycle whose poses and wrenches the caller exchanges between its ticks.
class GivenDevice final : public HapticDevice {
 public:
  explicit GivenDevice(DeviceCapabilities capabilities) : capabilities_(std::move(capabilities)) {}

  void give(const DeviceState& state) noexcept { state_ = state; }
  const Wrench& taken() const noexcept { return wrench_; }

  DeviceCapabilities capabilities() const override { return capabilities_; }
  DeviceState read(std::uint64_t) noexcept override { return state_; }
  void write(const Wrench& wrench) noexcept override { wrench_ = rated(wrench, capabilities_); }
  void stop() noexcept override {}

 private:
  DeviceCapabilities capabilities_;
  DeviceState state_;
  Wrench wrench_;
};

/// A session joined with a device of the caller: the agent of kerf_agent.h. Link, replica and servo
/// cycle are those of kerf-agent.
class AgentSession {
 public:
  /// Waits for the welcome.
  static std::expected<std::unique_ptr<AgentSession>, SessionFailure> connect(
      SessionOptions options);
  ~AgentSession() { close(0); }
  AgentSession(const AgentSession&) = delete;
  AgentSession& operator=(const AgentSession&) = delete;

  const Welcome& welcome() const noexcept { return welcome_; }
  std::uint32_t tool() const noexcept { return tool_.load(); }
  /// From any thread. Returns false if the session has no such tool.
  bool choose_tool(std::uint32_t tool) noexcept;
  /// See Supervisor::rearm. From any thread.
  void rearm() noexcept { cycle_->rearm(); }
  /// See kerf_agent_set_mapping. From any thread. The error is one sentence.
  std::expected<void, std::string> set_mapping(const kerf_agent_mapping& given);
  kerf_agent_mapping mapping();
  /// From any thread.
  void ask(bool undone) noexcept { link_->ask(undone); }
  bool connected() const noexcept { return link_->connected(); }
  bool lost() const noexcept { return lost_.load(); }

  /// Reserves the servo cycle for the calling thread. Returns false if another thread has it.
  bool enter() noexcept { return !ticking_.test_and_set(std::memory_order_acquire); }
  void leave() noexcept { ticking_.clear(std::memory_order_release); }
  /// One tick, on the thread that entered. Returns the wrench until the next one. Within
  /// kShortestUs after a tick it returns the same wrench, or zero if the device is not ready. A
  /// malformed pose is a tick at any time.
  Wrench step(const kerf_agent_pose& pose, std::uint64_t now_us) noexcept;

  /// From any thread.
  kerf_agent_status status();
  /// Runs the loop on its own thread and waits until it has ended. The caller must have entered.
  void run(const kerf_agent_device& device, void* context, bool realtime);
  void stop_running() noexcept { stopping_.store(true); }
  /// Reports a warning to the user, from run.
  void notice(const std::string& line) const;

  /// Closes the connection within `drain_s`.
  void close(double drain_s);

  static constexpr std::uint64_t kShortestUs = 500;

 private:
  explicit AgentSession(SessionOptions options);
  std::optional<SessionFailure> join();

  SessionOptions options_;
  const ForceReasons reasons_;
  SampleRing samples_;
  LatestValue<ServerWrench> wrenches_;
  LatestValue<LinkStatus> link_status_;
  LatestValue<Reach> reach_;
  LeadCpu lead_;
  ReplicaExchange exchange_;
  ReplicaThread replica_{exchange_, &lead_};
  std::unique_ptr<ServerLink> link_;
  Welcome welcome_;
  GivenDevice device_;
  std::optional<GuideModel> guidance_;
  std::optional<ServoCycle> cycle_;
  double lever_mm_ = 1;
  bool closed_ = false;

  std::atomic_flag ticking_;
  std::atomic<bool> lost_{false}, stopping_{false};
  std::atomic<std::uint32_t> tool_{0};
  std::atomic<std::uint64_t> ticks_{0};
  std::uint64_t last_us_ = 0;  ///< time of the newest tick; belongs to the thread that entered

  std::mutex mapping_mutex_;  ///< guards mapping_ and the writes of it to the cycle
  MappingRequest mapping_;
  std::uint32_t mapping_flags_ = 0;

  std::mutex status_mutex_;  ///< guards both, because LatestValue has one reader
  ServoStatus servo_now_;
  LinkStatus link_now_;
};

}  // namespace kerf::agent
