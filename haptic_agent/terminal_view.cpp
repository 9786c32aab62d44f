// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/terminal_view.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace kerf::agent {
namespace {

constexpr int kBarColumns = 30;
constexpr const char* kEndOfLine = "\x1b[K\n";
constexpr const char* kTenLinesUp = "\x1b[10A";
/// Width of the lines of the reason, which fits a terminal of 80 columns, and their number, enough
/// for the longest sentence of ForceReasons.
constexpr std::size_t kReasonColumns = 70;
constexpr int kReasonLines = 4;

/// Returns the counts of datagrams. Empty if the server does not offer UDP.
std::string udp_rate(const UdpReport& udp) {
  if (!udp.offered) return {};
  return "datagrams " + std::to_string(udp.sent) + " out, " + std::to_string(udp.received) +
         " in, " + std::to_string(udp.lost) + " lost, ";
}

/// Returns a sentence in kReasonLines lines, broken at spaces.
std::string reason_lines(std::string_view reason) {
  std::string text;
  for (int line = 0; line < kReasonLines; ++line) {
    std::size_t end = reason.size();
    if (end > kReasonColumns) end = std::min(reason.rfind(' ', kReasonColumns), reason.size());
    text.append(line == 0 && end > 0 ? "why     " : "        ").append(reason.substr(0, end));
    text += kEndOfLine;
    reason.remove_prefix(std::min(end + 1, reason.size()));
  }
  return text;
}

}  // namespace

std::string bar(double value, double most, int columns) {
  const double share = most > 0 ? std::clamp(value / most, 0.0, 1.0) : 0;
  const auto full = static_cast<std::size_t>(std::lround(share * columns));
  return "[" + std::string(full, '#') + std::string(static_cast<std::size_t>(columns) - full, '.') +
         "]";
}

std::string view_text(const ServoStatus& servo, const LinkStatus& link, const WrenchLimits& limits,
                      double tank_mj, std::string_view reason) {
  constexpr double kMsPerUs = 1e-3;
  const auto ms = [](auto us) { return static_cast<double>(us) * kMsPerUs; };
  const double force = length(servo.output.force_n);
  const double torque = length(servo.output.torque_nmm);
  const double force_computed = length(servo.computed.force_n);
  const double torque_computed = length(servo.computed.torque_nmm);
  std::ostringstream out;
  out << std::fixed << std::setprecision(1) << "state   " << to_string(servo.phase);
  if (servo.trips > 0) out << "   trips " << servo.trips << ", last " << to_string(servo.code);
  out << kEndOfLine << "force   " << bar(force, limits.force_n, kBarColumns) << ' ' << force
      << " N of " << force_computed << " computed" << kEndOfLine << "torque  "
      << bar(torque, limits.torque_nmm, kBarColumns) << ' ' << torque << " N·mm of "
      << torque_computed << " computed" << kEndOfLine << "energy  "
      << bar(servo.energy_mj, tank_mj, kBarColumns) << ' ' << servo.energy_mj << " mJ of "
      << tank_mj << kEndOfLine << "link    round trip " << ms(link.rtt_us) << " ms, answer "
      << ms(servo.answer_age_us) << " ms old, clock " << std::showpos << ms(link.clock_offset_us)
      << std::noshowpos << " ms, connection " << link.connections
      << (link.udp.carries ? ", UDP" : ", WebSocket") << kEndOfLine << "rate    "
      << link.samples_sent << " poses sent, " << link.results << " answers received, "
      << udp_rate(link.udp) << "tip " << servo.speed_mm_per_s << " mm/s" << kEndOfLine
      << reason_lines(reason);
  return out.str();
}

TerminalView::TerminalView(LatestValue<ServoStatus>& servo, LatestValue<LinkStatus>& link,
                           const ServoSettings& settings, const ForceReasons& reasons,
                           std::ostream& out)
    : thread_([&servo, &link, &reasons, &out, limits = settings.limits,
               tank_mj = settings.passivity.tank_mj](const std::stop_token& stop) {
        constexpr std::chrono::milliseconds kEvery{100};
        ServoStatus status;
        LinkStatus linked;
        bool first = true;
        while (!stop.stop_requested()) {
          servo.read(status);
          link.read(linked);
          if (!first) out << kTenLinesUp;
          out << view_text(status, linked, limits, tank_mj,
                           reasons.of(status.no_force, status.code))
              << std::flush;
          first = false;
          std::this_thread::sleep_for(kEvery);
        }
      }) {}

TerminalView::~TerminalView() {
  thread_.request_stop();
  thread_.join();
}

}  // namespace kerf::agent
