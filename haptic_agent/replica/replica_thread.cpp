// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/replica/replica_thread.h"

#include <utility>

#include "haptic_agent/realtime/clock.h"
#include "haptic_agent/realtime/realtime_thread.h"
#include "server/wire/codec.h"

namespace kerf::agent {

ReplicaThread::~ReplicaThread() { stop(); }

void ReplicaThread::start(BlockSource source) {
  replica_ = std::make_unique<Replica>(std::move(source));
  thread_ = std::thread([this] {
    // The servo thread's warning explains a denial.
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

void ReplicaThread::take_result(const wire::Result& result) {
  forces_.push({result.agent_time_us, Vec3(result.force_n)});
}

void ReplicaThread::run() {
  FollowCpu place(lead_);
  while (!stopping_.load()) {
    servo_.wait();
    place.begin(monotonic_ns());
    take_patches(place);
    take_samples();
    for (ServersForce server; forces_.pop(server);) {
      replica_->compare(server.agent_time_us, server.force_n);
    }
    if (replica_->take_divergence()) wants_reset_.store(true);
    place.end(monotonic_ns());
  }
  report_.compared = replica_->agreement().compared();
  report_.error = replica_->agreement().error();
}

void ReplicaThread::take_patches(FollowCpu& place) {
  std::vector<std::vector<std::byte>> patches;
  {
    const std::scoped_lock lock(mutex_);
    patches.swap(patches_);
  }
  for (const std::vector<std::byte>& frame : patches) {
    const auto message = wire::decode(frame);
    if (const auto* intents = message ? std::get_if<wire::Intents>(&message->body) : nullptr) {
      replica_->take(*intents);
      ++report_.intents;
      continue;
    }
    const auto* patch = message ? std::get_if<wire::StockPatch>(&message->body) : nullptr;
    // The block is rebuilt, or the motions of several seconds are cut again.
    if (patch != nullptr && (patch->reset || patch->returned)) place.leave(monotonic_ns());
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
  const std::uint64_t now = monotonic_us();
  servo_.write(answer_of(*newest, now));
  if (now >= newest->agent_time_us) report_.answer_us.add(now - newest->agent_time_us);
}

}  // namespace kerf::agent
