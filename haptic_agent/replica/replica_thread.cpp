// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/replica/replica_thread.h"

#include <utility>

#include "haptic_agent/servo/realtime.h"
#include "haptic_agent/servo/servo_clock.h"
#include "server/wire/codec.h"

namespace kerf::agent {
namespace {

std::uint64_t now_us() noexcept {
  constexpr std::uint64_t kNsPerUs = 1000;
  return MonotonicClock{}.now_ns() / kNsPerUs;
}

}  // namespace

ReplicaThread::~ReplicaThread() { stop(); }

void ReplicaThread::start(BlockSource source) {
  replica_ = std::make_unique<Replica>(std::move(source));
  thread_ = std::thread([this] {
    // The servo thread reports what a rejection means.
    request_fifo(kReplicaPriority);
    run();
  });
}

void ReplicaThread::stop() {
  stopping_.store(true);
  servo_.wake();
  if (thread_.joinable()) thread_.join();
}

void ReplicaThread::take_stock(std::span<const std::byte> frame) {
  if (stopping_.load()) return;
  const std::scoped_lock lock(mutex_);
  patches_.emplace_back(frame.begin(), frame.end());
}

void ReplicaThread::take_result(const wire::Result& result) { results_.write(result); }

void ReplicaThread::run() {
  while (!stopping_.load()) {
    servo_.wait();
    take_patches();
    take_samples();
    if (wire::Result theirs; results_.read(theirs)) replica_->compare(theirs);
    if (replica_->take_doubt()) wants_reset_.store(true);
  }
  report_.compared = replica_->agreement().compared();
  report_.error = replica_->agreement().error();
}

void ReplicaThread::take_patches() {
  std::deque<std::vector<std::byte>> patches;
  {
    const std::scoped_lock lock(mutex_);
    patches.swap(patches_);
  }
  for (const std::vector<std::byte>& frame : patches) {
    const auto message = wire::decode(frame);
    const auto* patch = message ? std::get_if<wire::StockPatch>(&message->body) : nullptr;
    if (patch == nullptr || !replica_->take(*patch)) {
      ++report_.bad_patches;
      wants_reset_.store(true);
      continue;
    }
    ++report_.patches;
    report_.tiles += patch->tiles.size();
    report_.bytes += frame.size();
    report_.resyncs += patch->reset ? 1 : 0;
  }
}

void ReplicaThread::take_samples() {
  std::optional<wire::Result> newest;
  wire::MotionSample sample;
  while (servo_.pop(sample)) {
    ++report_.samples;
    newest = replica_->move(sample);
    report_.answered += newest ? 1 : 0;
  }
  if (!newest) return;
  const std::uint64_t now = now_us();
  servo_.write(answer_of(*newest, now));
  if (now >= newest->agent_time_us) report_.answer_us.add(now - newest->agent_time_us);
}

}  // namespace kerf::agent
