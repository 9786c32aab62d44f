// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>
#include <string_view>
#include <thread>

#include "haptic_agent/force_reason.h"
#include "haptic_agent/link/link_report.h"
#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {

/// Returns a bar of `columns` characters, filled to value / most.
std::string bar(double value, double most, int columns);

/// Returns the state of the agent in ten lines, each ended by the escape code that erases to the
/// end of the line. `reason`: why there is no force, or less than computed. It fills the last four
/// lines, which are enough for every sentence of ForceReasons.
std::string view_text(const ServoStatus& servo, const LinkStatus& link, const WrenchLimits& limits,
                      double tank_mj, std::string_view reason);

/// Prints the agent's state on a terminal ten times per second, in place, from an ordinary thread.
class TerminalView {
 public:
  /// The arguments must outlive the view. Starts at once.
  TerminalView(LatestValue<ServoStatus>& servo, LatestValue<LinkStatus>& link,
               const ServoSettings& settings, const ForceReasons& reasons, std::ostream& out);
  ~TerminalView();
  TerminalView(const TerminalView&) = delete;
  TerminalView& operator=(const TerminalView&) = delete;

 private:
  std::jthread thread_;
};

}  // namespace kerf::agent
