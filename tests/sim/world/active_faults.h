// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <set>
#include <vector>

#include "tests/sim/world/plan.h"
#include "tests/sim/world/server_machine.h"

namespace kerf::sim {

/// The faults that act on the servers and on NATS now. The state of each follows from all of them:
/// where two faults overlap, the end of one leaves the other in force.
class ActiveFaults {
 public:
  /// `servers` outlives this object; the faults of begin() outlive their end().
  explicit ActiveFaults(std::vector<std::unique_ptr<ServerMachine>>& servers) : servers_(servers) {}
  void begin(const PlannedFault& fault);
  void end(const PlannedFault& fault);
  /// Ends all faults. Servers that were ended for good stay so.
  void end_all();

 private:
  const PlannedFault* newest(std::size_t server, std::initializer_list<Fault> kinds) const;
  void apply(std::size_t number);

  std::vector<std::unique_ptr<ServerMachine>>& servers_;
  std::vector<const PlannedFault*> active_;
  std::set<std::size_t> gone_;  ///< servers that do not come back
};

}  // namespace kerf::sim
