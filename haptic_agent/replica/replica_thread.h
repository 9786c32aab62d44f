// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "haptic_agent/link/stock_listener.h"
#include "haptic_agent/replica/replica.h"
#include "haptic_agent/servo/histogram.h"
#include "haptic_agent/servo/latest_value.h"
#include "haptic_agent/servo/near_answers.h"

namespace kerf::agent {

/// What the copy has done; read it when the thread has ended.
struct ReplicaReport {
  std::uint64_t samples = 0;   ///< taken from the servo
  std::uint64_t answered = 0;  ///< of these
  Histogram answer_us;         ///< from the pose's measurement to its answer
  std::uint64_t patches = 0, tiles = 0, bytes = 0;
  std::uint64_t bad_patches = 0;
  std::uint64_t resyncs = 0;
  std::uint64_t compared = 0;  ///< with answers of the server
  double error = 0;            ///< rms difference of their forces, over the rms of the server's
};

/// Runs a Replica on a thread of its own, below the servo and above the link: samples come from the
/// servo, patches and results from the link, answers go to the servo. Nobody waits for anybody.
class ReplicaThread final : public StockListener {
 public:
  /// `servo` must outlive it. What comes before start waits for it.
  explicit ReplicaThread(NearAnswers& servo) : servo_(servo) {}
  ~ReplicaThread() override;
  ReplicaThread(const ReplicaThread&) = delete;
  ReplicaThread& operator=(const ReplicaThread&) = delete;

  /// Begins to answer. Call once, or never.
  void start(BlockSource source);
  /// Ends the thread, if there is one; what comes afterwards is dropped. Call it once the servo has
  /// ended.
  void stop();
  const ReplicaReport& report() const { return report_; }

  void take_stock(std::span<const std::byte> frame) override;
  void take_result(const wire::Result& result) override;
  bool wants_reset() override { return wants_reset_.exchange(false); }

 private:
  void run();
  void take_patches();
  void take_samples();

  std::unique_ptr<Replica> replica_;
  NearAnswers& servo_;
  LatestValue<wire::Result> results_;
  std::mutex mutex_;  ///< between link and replica
  std::deque<std::vector<std::byte>> patches_;
  std::atomic<bool> wants_reset_{false}, stopping_{false};
  ReplicaReport report_;
  std::thread thread_;
};

}  // namespace kerf::agent
