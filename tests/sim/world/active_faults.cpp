// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/active_faults.h"

#include <algorithm>
#include <ranges>

#include "tests/sim/nats/nats_model.h"

namespace kerf::sim {
namespace {

constexpr Time kDays = 3 * 86'400 * kSecond;
constexpr Time kSync = kMillisecond / 2, kSlowSync = kSecond;

DiskState disk_state_of(Fault fault) {
  if (fault == Fault::kDiskFull) return DiskState::kFull;
  return fault == Fault::kDiskFails ? DiskState::kFails : DiskState::kNoSync;
}

bool stops_nats(Fault fault) { return fault == Fault::kNatsGone || fault == Fault::kNatsEarlier; }

}  // namespace

const PlannedFault* ActiveFaults::newest(std::size_t server,
                                         std::initializer_list<Fault> kinds) const {
  for (const PlannedFault* fault : std::views::reverse(active_)) {
    if (fault->server == server && std::ranges::find(kinds, fault->fault) != kinds.end()) {
      return fault;
    }
  }
  return nullptr;
}

void ActiveFaults::begin(const PlannedFault& fault) {
  ServerMachine& server = *servers_[fault.server];
  if (fault.for_good) gone_.insert(fault.server);
  active_.push_back(&fault);
  if (fault.fault == Fault::kKill || fault.fault == Fault::kPowerLoss) {
    server.kill(fault.fault == Fault::kPowerLoss);
  }
  if (fault.fault == Fault::kRestart) server.stop();
  if (fault.fault == Fault::kStandStill && server.runs()) server.stand_still(fault.length);
  if (fault.fault == Fault::kCut) server.cut_connections();
  if (fault.fault == Fault::kDiskFull) server.disk().free_bytes = draw(100'000);
  if (fault.fault == Fault::kClockForward) server.set_clock(kDays);
  if (fault.fault == Fault::kClockBack) server.set_clock(-kDays);
  if (stops_nats(fault.fault)) NatsModel::instance().stop();
  apply(fault.server);
}

void ActiveFaults::end(const PlannedFault& fault) {
  std::erase(active_, &fault);
  const auto is_stop = [](const PlannedFault* one) { return stops_nats(one->fault); };
  if (std::ranges::none_of(active_, is_stop)) NatsModel::instance().start();
  apply(fault.server);
}

void ActiveFaults::end_all() {
  active_.clear();
  NatsModel::instance().start();
  for (std::size_t n = 0; n < servers_.size(); ++n) apply(n);
}

void ActiveFaults::apply(std::size_t number) {
  ServerMachine& server = *servers_[number];
  const bool is_down =
      newest(number, {Fault::kKill, Fault::kPowerLoss, Fault::kRestart}) != nullptr;
  if (!is_down && !gone_.contains(number)) server.start();
  const auto* disk = newest(number, {Fault::kDiskFull, Fault::kDiskFails, Fault::kNoSync});
  server.disk().state = disk == nullptr ? DiskState::kFine : disk_state_of(disk->fault);
  server.disk().sync_ns = newest(number, {Fault::kDiskSlow}) == nullptr ? kSync : kSlowSync;
  server.machine().is_busy = newest(number, {Fault::kBusy}) != nullptr;
  server.machine().lacks_memory = newest(number, {Fault::kNoMemory}) != nullptr;
  if (newest(number, {Fault::kNatsCutOff}) != nullptr) {
    NatsModel::instance().cut_off(&server.machine());
  } else {
    NatsModel::instance().let_in(&server.machine());
  }
}

}  // namespace kerf::sim
