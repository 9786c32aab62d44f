// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/trip_log.h"

#include <chrono>
#include <fstream>
#include <iostream>
#include <sstream>

namespace kerf::agent {
namespace {

std::ostream& operator<<(std::ostream& out, const Vec3& v) {
  return out << v.x << ',' << v.y << ',' << v.z;
}

}  // namespace

std::string_view trip_reason(TripCode code) {
  switch (code) {
    case TripCode::kNone:
      return "no fault";
    case TripCode::kDeviceLost:
      return "the device was lost or is not ready; check its cable and power";
    case TripCode::kNotFinite:
      return "the device sent a pose that is no number; its driver is at fault";
    case TripCode::kWorkspace:
      return "the device left its workspace";
    case TripCode::kJump:
      return "the tip jumped by more than 5 mm in a tick; the device lost its calibration, or its "
             "driver sends wrong poses";
    case TripCode::kSpeed:
      return "the tip moved faster than 1 m/s";
    case TripCode::kTurnSpeed:
      return "the tool turned faster than 15 rad/s";
    case TripCode::kLostTicksInARow:
      return "5 ticks of the 1 kHz loop were lost in a row; kerf-agent doctor tells why";
    case TripCode::kLostTicks:
      return "2 % of the 1 kHz loop's ticks were lost in a second; kerf-agent doctor tells why";
    case TripCode::kThermalForce:
      return "the motors gave more force than they may for long; push less";
    case TripCode::kThermalTorque:
      return "the motors gave more torque than they may for long; push less";
    case TripCode::kOverdrawn:
      return "the device returned more energy than the agent allows; it may be slower or lighter "
             "than its driver declares (kerf-agent --latency)";
    case TripCode::kRejectedWrench:
      return "the session's force is no number; the server or the scene is at fault";
  }
  return "unknown fault";
}

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

TripWriter::TripWriter(FlightRecorder& recorder, std::string file)
    : recorder_(recorder), file_(std::move(file)), thread_([this](const std::stop_token& stop) {
        constexpr std::chrono::milliseconds kLookUp{100};
        while (!stop.stop_requested()) {
          write_one();
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
  std::cerr << "kerf-agent: force switched off (" << to_string(log->code)
            << "): " << trip_reason(log->code)
            << ". To go on, release the device for 0.3 s, or its cutting button if it does not "
               "sense that it is held\n";
  if (!file_.empty()) {
    std::ofstream out(file_, std::ios::app);
    out << trip_csv(*log);
    out.close();
    if (!out) std::cerr << "kerf-agent: cannot write " << file_ << '\n';
  }
  recorder_.done();
}

}  // namespace kerf::agent
