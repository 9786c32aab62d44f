// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/force_reason.h"

namespace kerf::agent {
namespace {

/// The sentence of a reason. Empty for kNone, and for kTripped, whose sentence names the trip.
std::string_view sentence(NoForce reason) {
  switch (reason) {
    case NoForce::kNone:
    case NoForce::kTripped:
      return {};
    case NoForce::kNoMotors:
      return "the device has no motors that give forces; it carves without. To feel the cut, use "
             "one "
             "that has";
    case NoForce::kAbsent:
      return "the device is not connected or sends no poses; check cable, power and driver";
    case NoForce::kHoming:
      return "the device does not know its pose yet; calibrate it, or move it to its home position";
    case NoForce::kFault:
      return "the device reports a fault, or a pose that is not a number; look into its own "
             "program, or switch it off and on";
    case NoForce::kNotHeld:
      return "the device is not held; hold its grip or its deadman button";
    case NoForce::kNoAnswer:
      return "the server does not answer; check the network, and that the session still runs";
    case NoForce::kOutOfReach:
      return "the tip is outside of the device's workspace; move it back";
    case NoForce::kTouching:
      return "the tool touches something already; lift it off, and the force comes on";
    case NoForce::kMoving:
      return "the tip is faster than 50 mm/s; slow down, and the force comes on";
    case NoForce::kArming:
      return "the force comes on within half a second; hold the device until then";
    case NoForce::kClutched:
      return "the clutch is held, so that the tool stays; release it to feel the cut again";
    case NoForce::kServerLate:
      return "the server's answers are late; check the network (kerf-agent doctor --server)";
    case NoForce::kTicksLost:
      return "the 1 kHz loop loses ticks; end other programs, or give it real-time priority "
             "(kerf-agent doctor)";
    case NoForce::kTankEmpty:
      return "the device has returned as much energy as it may; hold it more firmly";
    case NoForce::kLimited:
      return "the cut is harder than the limits of the device or of the options; cut less at a "
             "time";
  }
  return {};
}

}  // namespace

std::string_view trip_reason(TripCode code) {
  switch (code) {
    case TripCode::kNone:
      return "no fault";
    case TripCode::kDeviceLost:
      return "the device was lost or is not ready; check its cable and power";
    case TripCode::kNotFinite:
      return "the device sent a pose that is not a number; look for a newer driver";
    case TripCode::kWorkspace:
      return "the device left its workspace; move it back";
    case TripCode::kJump:
      return "the tip jumped by more than 5 mm in a tick; calibrate the device, or look for a "
             "newer "
             "driver";
    case TripCode::kSpeed:
      return "the tip moved faster than 1 m/s; move more slowly";
    case TripCode::kTurnSpeed:
      return "the tool turned faster than 15 rad/s; turn it more slowly";
    case TripCode::kLostTicksInARow:
      return "5 ticks of the 1 kHz loop were lost in a row; kerf-agent doctor finds the cause";
    case TripCode::kLostTicks:
      return "50 % of the 1 kHz loop's ticks were lost in a second; kerf-agent doctor finds the "
             "cause";
    case TripCode::kThermalForce:
      return "the motors gave more force than they may for long; push less";
    case TripCode::kThermalTorque:
      return "the motors gave more torque than they may for long; push less";
    case TripCode::kOverdrawn:
      return "the device returned more energy than the agent allows; it may be slower or lighter "
             "than its driver declares (kerf-agent --latency)";
    case TripCode::kRejectedWrench:
      return "the session's force is not a number; tell who runs the server, or choose another "
             "scene";
  }
  return "unknown fault";
}

std::string_view rearm_remedy(const DeviceCapabilities& device) {
  if (device.has_deadman) return "release the device for 0.3 s and hold it again";
  if (device.always_cut) {
    return "hold the tip still for a second, then move it 1 cm away and back";
  }
  return "hold the tip still for a second, then move it 1 cm away and back, or press and release "
         "the cutting button";
}

ForceReasons::ForceReasons(const DeviceCapabilities& device) {
  for (std::size_t i = 0; i < other_.size(); ++i) other_[i] = sentence(static_cast<NoForce>(i));
  for (std::size_t i = 0; i < tripped_.size(); ++i) {
    tripped_[i] = trip_reason(static_cast<TripCode>(i));
    tripped_[i].append(". To go on, ").append(rearm_remedy(device));
  }
}

}  // namespace kerf::agent
