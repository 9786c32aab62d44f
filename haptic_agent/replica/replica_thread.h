// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "haptic_agent/link/stock_listener.h"
#include "haptic_agent/realtime/follow_cpu.h"
#include "haptic_agent/realtime/histogram.h"
#include "haptic_agent/realtime/spsc_ring.h"
#include "haptic_agent/replica/replica.h"
#include "haptic_agent/servo/replica_exchange.h"

namespace kerf::agent {

/// Counters of the replica. Read after the thread has ended.
struct ReplicaReport {
  std::uint64_t samples = 0;   ///< received from the servo
  std::uint64_t answered = 0;  ///< number of answered samples
  Histogram answer_us;         ///< from the measurement of a pose to its answer
  std::uint64_t patches = 0, tiles = 0, bytes = 0;
  std::uint64_t bad_patches = 0;
  std::uint64_t intents = 0;  ///< frames with poses of other tools nearby
  std::uint64_t resyncs = 0;
  std::uint64_t compared = 0;  ///< answers that were compared with the server's
  double error = 0;            ///< rms difference of the forces over the rms of the server's
};

/// Runs a Replica on its own thread, with a priority below the servo and above the link. Samples
/// come from the servo, patches and results from the link. Answers go to the servo. Only this
/// thread waits.
class ReplicaThread final : public StockListener {
 public:
  /// `servo` and `lead`, the processor of its loop, must outlive the object; `lead` may be null.
  /// Input that arrives before start is queued.
  explicit ReplicaThread(ReplicaExchange& servo, const LeadCpu* lead = nullptr)
      : servo_(servo), lead_(lead) {}
  ~ReplicaThread() override;
  ReplicaThread(const ReplicaThread&) = delete;
  ReplicaThread& operator=(const ReplicaThread&) = delete;

  /// Starts to answer. Call at most once.
  void start(BlockSource source);
  /// Ends the thread, if running. Later input is dropped. Call after the servo has ended.
  void stop();
  const ReplicaReport& report() const { return report_; }

  void take_stock(std::span<const std::byte> frame) override;
  void take_result(const wire::Result& result) override;
  bool wants_reset() override { return wants_reset_.exchange(false); }

 private:
  struct ServersForce {
    std::uint64_t agent_time_us = 0;
    Vec3 force_n{};
  };

  void run();
  void take_patches(FollowCpu& place);
  void take_samples();

  std::unique_ptr<Replica> replica_;
  ReplicaExchange& servo_;
  const LeadCpu* lead_;
  SpscRing<ServersForce, 1024> forces_;
  std::mutex mutex_;  ///< guards patches_
  std::vector<std::vector<std::byte>> patches_;
  std::atomic<bool> wants_reset_{false}, stopping_{false};
  ReplicaReport report_;
  std::thread thread_;
};

}  // namespace kerf::agent
