// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/trip_log.h"

#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iostream>
#include <sstream>

#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/realtime/clock.h"

namespace kerf::agent {
namespace {

std::ostream& operator<<(std::ostream& out, const Vec3& v) {
  return out << v.x << ',' << v.y << ',' << v.z;
}

}  // namespace

std::string trip_csv(const FlightLog& log) {
  std::ostringstream out;
  out << "# trip: " << to_string(log.code) << '\n'
      << "t_us,x_mm,y_mm,z_mm,vx,vy,vz,wanted_fx_n,wanted_fy_n,wanted_fz_n,fx_n,fy_n,fz_n,tx_nmm,"
         "ty_nmm,tz_nmm,energy_mj,answer_age_us,lost,phase\n";
  for (std::size_t i = 0; i < log.count; ++i) {
    const FlightTick& t = log.ticks[i];
    out << t.time_us << ',' << t.tip_mm << ',' << t.velocity_mm_per_s << ',' << t.requested.force_n
        << ',' << t.output.force_n << ',' << t.output.torque_nmm << ',' << t.energy_mj << ','
        << t.answer_age_us << ',' << t.lost_now << ',' << to_string(t.phase) << '\n';
  }
  return out.str();
}

TripWriter::TripWriter(ServoCycle& cycle, const ForceReasons& reasons, std::string file)
    : cycle_(cycle),
      recorder_(cycle.recorder()),
      reasons_(reasons),
      watch_(reasons),
      file_(std::move(file)),
      thread_([this](const std::stop_token& stop) {
        constexpr std::chrono::milliseconds kLookUp{100};
        while (!stop.stop_requested()) {
          write_one();
          tell(monotonic_us());
          std::this_thread::sleep_for(kLookUp);
        }
      }) {}

TripWriter::~TripWriter() {
  thread_.request_stop();
  thread_.join();
  write_one();
}

void TripWriter::write_one() {
  const FlightLog* log = recorder_.log();
  if (log == nullptr) return;
  std::cerr << join({"kerf-agent: force switched off (", to_string(log->code),
                     "): ", reasons_.of(NoForce::kTripped, log->code), "; or kill -USR1 ",
                     std::to_string(::getpid()), "\n"});
  if (!file_.empty()) {
    std::ofstream out(file_, std::ios::app);
    out << trip_csv(*log);
    out.close();
    if (!out) std::cerr << "kerf-agent: cannot write " << file_ << '\n';
  }
  recorder_.done();
}

void TripWriter::tell(std::uint64_t now_us) {
  const std::string line = watch_.look(cycle_.no_force(), now_us);
  if (!line.empty()) std::cerr << join({"kerf-agent: ", line, "\n"}) << std::flush;
}

}  // namespace kerf::agent
