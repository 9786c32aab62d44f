// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/realtime/follow_cpu.h"

#include <pthread.h>

namespace kerf::agent {

void PlaceChoice::begin(std::uint64_t now_ns) noexcept {
  woken_ns_ = now_ns;
  if (!window_ns_) start_window(now_ns);
}

void PlaceChoice::start_window(std::uint64_t now_ns) noexcept {
  window_ns_ = now_ns;
  busy_ns_ = 0;
}

void PlaceChoice::end(std::uint64_t now_ns) noexcept {
  if (!window_ns_) return;
  const std::uint64_t worked_ns = now_ns - woken_ns_;
  busy_ns_ += worked_ns;
  if (worked_ns > kLongNs) return leave(now_ns);
  const std::uint64_t passed_ns = now_ns - *window_ns_;
  if (passed_ns < kWindowNs) return;
  const double load = static_cast<double>(busy_ns_) / static_cast<double>(passed_ns);
  if (load > kHeavy) place_ = Place::kApart;
  if (load <= kLight) place_ = Place::kBeside;
  start_window(now_ns);
}

void PlaceChoice::leave(std::uint64_t now_ns) noexcept {
  place_ = Place::kApart;
  start_window(now_ns);
}

FollowCpu::FollowCpu(const LeadCpu* lead) noexcept : lead_(lead) {
  if (pthread_getaffinity_np(pthread_self(), sizeof allowed_, &allowed_) != 0) lead_ = nullptr;
}

void FollowCpu::end(std::uint64_t now_ns) noexcept {
  choice_.end(now_ns);
  apply(choice_.place());
}

void FollowCpu::leave(std::uint64_t now_ns) noexcept {
  choice_.leave(now_ns);
  apply(choice_.place());
}

void FollowCpu::release() noexcept {
  choice_.reset();
  apply(Place::kAnywhere);
}

void FollowCpu::apply(Place place) noexcept {
  const int cpu = lead_ != nullptr ? lead_->cpu() : -1;
  const bool follows = cpu >= 0 && cpu < CPU_SETSIZE && CPU_COUNT(&allowed_) > 1 &&
                       CPU_ISSET(static_cast<std::size_t>(cpu), &allowed_);
  if (!follows) place = Place::kAnywhere;
  if (place == applied_ && (place == Place::kAnywhere || cpu == cpu_)) return;
  cpu_set_t set = allowed_;
  if (place == Place::kBeside) CPU_ZERO(&set);
  if (place == Place::kBeside) CPU_SET(static_cast<std::size_t>(cpu), &set);
  if (place == Place::kApart) CPU_CLR(static_cast<std::size_t>(cpu), &set);
  // Fails if the set of permitted processors has changed: the thread stays where it is.
  if (pthread_setaffinity_np(pthread_self(), sizeof set, &set) != 0) return;
  applied_ = place;
  cpu_ = cpu;
}

}  // namespace kerf::agent
