// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/summary.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

namespace kerf::agent {
namespace {

using nlohmann::json;

constexpr double kMedian = 0.5;
constexpr double kP99 = 0.99;
constexpr double kP999 = 0.999;
constexpr double kP9999 = 0.9999;

json quantiles(const Histogram& histogram) {
  return {{"count", histogram.total()},
          {"p50", histogram.quantile_us(kMedian)},
          {"p99", histogram.quantile_us(kP99)},
          {"p999", histogram.quantile_us(kP999)},
          {"p9999", histogram.quantile_us(kP9999)},
          {"max", histogram.max_us()}};
}

json servo_json(const Summary& s) {
  const CycleStats& c = s.cycles;
  return {{"ticks", c.ticks},
          {"due", c.ticks + c.lost},
          {"late", c.late},
          {"lost", c.lost},
          {"most_lost_at_once", c.most_lost_at_once},
          {"longest_gap_us", c.longest_gap_us},
          {"longest_tick_us", c.longest_tick_us},
          {"wake_us", quantiles(c.wake_us)},
          {"fifo", s.realtime.fifo},
          {"memory_locked", s.realtime.memory_locked},
          {"pinned", s.realtime.pinned},
          {"samples", s.servo.samples},
          {"ring_overflows", s.servo.ring_overflows},
          {"invalid_poses", s.servo.invalid_poses}};
}

json udp_json(const UdpReport& udp) {
  return {{"asked", udp.asked},
          {"offered", udp.offered},
          {"carries", udp.carries},
          {"taken_over", udp.taken_over},
          {"fell_back", udp.fell_back},
          {"datagrams_sent", udp.sent},
          {"datagrams_received", udp.received},
          {"datagrams_lost", udp.lost},
          {"datagrams_dropped", udp.dropped},
          {"samples", udp.samples},
          {"repeated", udp.repeated},
          {"gaps", udp.gaps}};
}

json link_json(const Summary& s) {
  const LinkReport& l = s.link;
  json errors = json::object();
  for (const auto& [code, complaint] : l.complaints) {
    errors[code] = {{"count", complaint.count}, {"first_reason", complaint.first_reason}};
  }
  return {{"connections", l.connections},
          {"samples_sent", l.samples_sent},
          {"messages_sent", l.messages_sent},
          {"resent", l.resent},
          {"merged_air", l.merged_air},
          {"merged_cuts", l.merged_cuts},
          {"thinned_cuts", l.thinned_cuts},
          {"forgotten", l.forgotten},
          {"held_back", l.held_back},
          {"unanswered", l.unanswered},
          {"resumed", l.resumed},
          {"not_durable", l.not_durable},
          {"given_up", l.given_up},
          {"results", l.results},
          {"rejected_results", l.rejected_results},
          {"old_results", l.old_results},
          {"bad_frames", l.bad_frames},
          {"udp", udp_json(l.udp)},
          {"ping_us", quantiles(l.clock.rtt_us())},
          {"answer_us", quantiles(l.answer_us)},
          {"turnaround_us", quantiles(l.turnaround_us)},
          {"clock_offset_us", l.clock.offset_us()},
          {"errors", errors}};
}

json sums_json(const FeltSums& sums) {
  return {{"felt_mean", sums.felt_mean()},
          {"felt_max", sums.felt_peak()},
          {"computed_mean", sums.computed_mean()},
          {"computed_max", sums.computed_peak()},
          {"rms_error", sums.error()}};
}

json felt_json(const FeltReport& felt) {
  return {{"ticks", felt.ticks},
          {"reduced_ticks", felt.reduced_ticks},
          {"force_n", sums_json(felt.force)},
          {"torque_nmm", sums_json(felt.torque)}};
}

json force_json(const Summary& s) {
  return {{"felt", felt_json(s.servo.felt)},
          {"max_n", s.servo.max_force_n},
          {"max_torque_nmm", s.servo.max_torque_nmm},
          {"server_max_n", s.link.max_server_force_n},
          {"saturated_ticks", s.saturated_ticks},
          {"slewed_ticks", s.slewed_ticks},
          {"decayed_ticks", s.servo.decayed_ticks},
          {"not_finite", s.not_finite_wrenches},
          {"projected", s.projected_wrenches},
          {"given_mj", s.given_mj},
          {"most_returned_mj", s.most_returned_mj},
          {"soft_ticks", s.servo.soft_ticks},
          {"softest_mm_per_n", s.servo.softest_mm_per_n}};
}

json mapping_json(const WorkspaceMapping& m) {
  return {{"scale", m.scale},
          {"force_gain", m.gain},
          {"stiffness_scale", m.stiffness_scale()},
          {"turn_rad", {m.turn_rad.x, m.turn_rad.y, m.turn_rad.z}}};
}

json copy_json(const Summary& s) {
  return {{"samples", s.copy.samples},
          {"answered", s.copy.answered},
          {"felt_ticks", s.servo.replica_answers},
          {"overflows", s.servo.replica_overflows},
          {"patches", s.copy.patches},
          {"bad_patches", s.copy.bad_patches},
          {"tiles", s.copy.tiles},
          {"bytes", s.copy.bytes},
          {"resyncs", s.copy.resyncs},
          {"answer_us", quantiles(s.copy.answer_us)},
          {"compared", s.copy.compared},
          {"error", s.copy.error}};
}

json guides_json(const Summary& s) {
  json guides = json::array();
  for (const GuideUse& use : s.guides) {
    guides.push_back({{"kind", use.kind}, {"ticks", use.ticks}, {"max_n", use.max_force_n}});
  }
  return guides;
}

/// Returns the reasons that occurred, with their ticks.
json no_force_json(const Summary& s) {
  json ticks = json::object();
  for (std::size_t i = 1; i < kNoForceNames.size(); ++i) {
    if (s.servo.no_force_ticks[i] > 0)
      ticks[std::string(kNoForceNames[i])] = s.servo.no_force_ticks[i];
  }
  return {{"reason", to_string(s.no_force)}, {"text", s.no_force_text}, {"ticks", ticks}};
}

json safety_json(const Summary& s) {
  return {{"trips", s.trips},
          {"last_trip", to_string(s.last_trip)},
          {"degraded_ticks", s.degraded_ticks},
          {"no_force", no_force_json(s)},
          {"watchdog_stops", s.watchdog_stops}};
}

json record_json(const RecordReport& record) {
  if (record.file.empty()) return nullptr;
  return {{"file", record.file},
          {"ticks", record.ticks},
          {"lost", record.lost},
          {"bytes", record.bytes},
          {"error", record.error}};
}

json study_json(const StudyReport& study) {
  if (study.file.empty()) return nullptr;
  return {{"file", study.file},
          {"answered", study.answered},
          {"correct", study.correct},
          {"error", study.error}};
}

struct Quantiles {
  const Histogram& of;
};

std::ostream& operator<<(std::ostream& out, const Quantiles& q) {
  constexpr double kMsPerUs = 1e-3;
  const auto ms = [&](std::uint64_t us) { return static_cast<double>(us) * kMsPerUs; };
  return out << std::fixed << std::setprecision(2) << "p50 " << ms(q.of.quantile_us(kMedian))
             << "  p99 " << ms(q.of.quantile_us(kP99)) << "  p99.9 " << ms(q.of.quantile_us(kP999))
             << "  p99.99 " << ms(q.of.quantile_us(kP9999)) << "  max " << ms(q.of.max_us())
             << " ms";
}

/// Returns the UDP line. Empty if UDP was not requested.
std::string udp_line(const UdpReport& udp, std::uint64_t samples_sent) {
  if (!udp.asked) return {};
  if (!udp.offered) return "udp      the server has no UDP transport\n";
  std::ostringstream out;
  out << "udp      " << udp.samples << " of " << samples_sent
      << " samples first sent over UDP, switched to UDP " << udp.taken_over << " times and back "
      << udp.fell_back << " times, at the end " << (udp.carries ? "in use" : "not in use")
      << "; datagrams: " << udp.sent << " out, " << udp.received << " in, " << udp.lost << " lost, "
      << udp.dropped << " dropped; " << udp.repeated << " samples repeated, " << udp.gaps
      << " gaps\n";
  return out.str();
}

/// Returns the lines that compare felt and computed wrenches. Empty if no force was computed.
std::string felt_lines(const FeltReport& felt) {
  if (felt.ticks == 0) return {};
  constexpr double kPercent = 100;
  std::ostringstream out;
  out << std::fixed << std::setprecision(2);
  const auto line = [&](const char* name, const FeltSums& sums, const char* unit) {
    out << name << sums.felt_mean() << " of " << sums.computed_mean() << unit << " in the mean, "
        << sums.felt_peak() << " of " << sums.computed_peak() << unit << " at most, differs by "
        << sums.error() * kPercent << " % rms";
  };
  line("felt     force ", felt.force, " N");
  out << "\n         ";
  line("torque ", felt.torque, " N·mm");
  out << "\n         reduced in " << felt.reduced_ticks << " of " << felt.ticks
      << " ticks with a computed force\n";
  return out.str();
}

/// Returns the line about cuts that shook the tool. Empty if none did.
std::string soft_line(const ServoReport& servo) {
  if (servo.soft_ticks == 0) return {};
  std::ostringstream out;
  out << std::fixed << std::setprecision(1) << "         in " << servo.soft_ticks
      << " ticks the cut shook the tool, and its force was made softer: it followed turns over up "
         "to "
      << servo.softest_mm_per_n << " mm per N. A firmer grip avoids that\n";
  return out.str();
}

/// Returns the line about ticks without the computed force. Empty if there are none.
std::string no_force_line(const ServoReport& servo) {
  std::ostringstream out;
  const char* separator = "unfelt   ";
  for (std::size_t i = 1; i < kNoForceNames.size(); ++i) {
    if (servo.no_force_ticks[i] == 0) continue;
    out << separator << kNoForceNames[i] << " in " << servo.no_force_ticks[i] << " ticks";
    separator = ", ";
  }
  std::string line = out.str();
  return line.empty() ? line : line + "\n";
}

/// Returns the line about samples that a loss of the server could affect. Empty if there are none.
std::string durable_line(const LinkReport& link) {
  if (link.resumed + link.not_durable + link.given_up == 0) return {};
  std::ostringstream out;
  out << "durable  continued as the same participant " << link.resumed << " times; "
      << link.not_durable << " answered samples not durable at the end, " << link.given_up
      << " given up before\n";
  return out.str();
}

/// Returns the line about the guides. Empty if there are none.
std::string guides_line(const std::vector<GuideUse>& guides) {
  if (guides.empty()) return {};
  std::ostringstream out;
  out << std::fixed << std::setprecision(2) << "guides   ";
  const char* separator = "";
  for (const GuideUse& use : guides) {
    out << separator << use.kind << " in " << use.ticks << " ticks, up to " << use.max_force_n
        << " N";
    separator = "; ";
  }
  out << '\n';
  return out.str();
}

struct Copy {
  const ReplicaReport& of;
};

/// Prints nothing if there was no replica.
std::ostream& operator<<(std::ostream& out, const Copy& copy) {
  constexpr double kPercent = 100, kKilo = 1000;
  const ReplicaReport& c = copy.of;
  if (c.samples == 0) return out;
  return out << "replica  answered " << c.answered << " of " << c.samples << " samples, "
             << Quantiles{c.answer_us} << "; forces differ from the server's by "
             << c.error * kPercent << " % rms; " << c.tiles << " tiles, "
             << static_cast<double>(c.bytes) / kKilo << " kB\n";
}

}  // namespace

bool succeeded(const Summary& s) {
  return s.link.failure.empty() && s.record.error.empty() && s.study.error.empty();
}

void print_summary(std::ostream& out, const Summary& s) {
  const CycleStats& c = s.cycles;
  const LinkReport& l = s.link;
  out << "servo    " << c.ticks << " ticks at 1 kHz, " << c.late << " late, " << c.lost
      << " lost, longest gap " << c.longest_gap_us << " us"
      << (s.realtime.fifo ? ", SCHED_FIFO" : ", no real-time priority") << '\n'
      << "wake-up  " << Quantiles{c.wake_us} << '\n'
      << "answer   " << Quantiles{l.answer_us} << "  (from pose to received wrench)\n"
      << "ping     " << Quantiles{l.clock.rtt_us()} << '\n'
      << "link     " << l.samples_sent << " samples in " << l.messages_sent << " messages, "
      << l.results << " results, " << l.connections << " connection"
      << (l.connections == 1 ? "" : "s") << ", " << l.resent << " resent, " << l.unanswered
      << " unanswered, " << l.merged_air + l.merged_cuts + l.thinned_cuts << " merged\n"
      << udp_line(l.udp, l.samples_sent - l.resent) << durable_line(l) << "force    up to "
      << std::setprecision(2) << s.servo.max_force_n << " N and " << s.servo.max_torque_nmm
      << " N·mm (server: " << l.max_server_force_n << " N), saturated in " << s.saturated_ticks
      << " ticks, faded in " << s.servo.decayed_ticks << '\n'
      << felt_lines(s.servo.felt) << no_force_line(s.servo) << soft_line(s.servo)
      << guides_line(s.guides) << Copy{s.copy} << "energy   " << -s.given_mj
      << " mJ dissipated, at most " << s.most_returned_mj << " mJ returned over any interval; "
      << s.projected_wrenches << " wrenches reduced\n"
      << "safety   " << s.trips << " trips" << (s.trips > 0 ? ", last: " : "")
      << (s.trips > 0 ? to_string(s.last_trip) : "") << "; degraded in " << s.degraded_ticks
      << " ticks; stopped by the watchdog " << s.watchdog_stops << " times\n"
      << "carved   " << l.removed_mm3 << " mm³";
  if (l.imprint_results > 0) {
    out << "; began inside stock " << l.imprint_results << " times, there without force";
  }
  if (s.max_deviation_mm > 0) {
    out << "; maximum deviation of the simulated hand from its path " << s.max_deviation_mm
        << " mm";
  }
  out << '\n';
  if (!s.record.file.empty()) out << record_text(s.record) << '\n';
  if (!s.study.file.empty()) out << study_text(s.study) << '\n';
  for (const auto& [code, complaint] : l.complaints) {
    out << "error    " << complaint.count << " x " << code << ": " << complaint.first_reason
        << '\n';
  }
}

std::string summary_json(const Summary& s) {
  const LinkReport& l = s.link;
  const json summary = {{"session", s.welcome.session},
                        {"participant", s.welcome.participant},
                        {"device", s.device},
                        {"failure", l.failure},
                        {"mapping", mapping_json(s.mapping)},
                        {"servo", servo_json(s)},
                        {"link", link_json(s)},
                        {"force", force_json(s)},
                        {"guides", guides_json(s)},
                        {"copy", copy_json(s)},
                        {"safety", safety_json(s)},
                        {"record", record_json(s.record)},
                        {"study", study_json(s.study)},
                        {"removed_mm3", l.removed_mm3},
                        {"imprint_results", l.imprint_results},
                        {"motions_in_session", l.motions_in_session},
                        {"max_deviation_mm", s.max_deviation_mm}};
  return summary.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace kerf::agent
