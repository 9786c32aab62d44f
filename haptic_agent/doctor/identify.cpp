// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/doctor/identify.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/device/units.h"
#include "haptic_agent/z_width.h"

namespace kerf::agent {
namespace {

constexpr double kShakeTickS = 1e-3;
constexpr std::uint64_t kTickUs = 1000;
constexpr std::uint64_t kTicksPerLost = 100;  ///< ticks per permitted lost tick
constexpr auto kShakeTicks = static_cast<std::uint64_t>(kShakeS / kShakeTickS);
constexpr std::uint64_t kRestTicks = 300;    ///< ticks without force before each part
constexpr std::uint64_t kAbsentTicks = 100;  ///< ticks without a pose
/// Share of the device's greatest force that is used, and of the limit at which the steps begin.
constexpr double kShareOfDevice = 0.2, kFirstShare = 0.05;
/// Motion at which the steps are strong enough, and too strong, as shares of the limit of motion.
constexpr double kMoved = 0.15, kMuch = 0.35;
constexpr std::uint64_t kJudgeTicks = 400;
constexpr double kStronger = 1.5, kWeaker = 0.6;
/// Steps last 10 to 50 ms.
constexpr int kShortest = 10, kLongest = 50;
/// The spring that brings the device back, as a share of the limit of effort at the limit of
/// motion, and the time constant of its damper, s.
constexpr double kCentering = 0.8, kCenteringS = 0.02, kSpeedPart = 0.1;

std::string short_number(double value) {
  std::ostringstream out;
  out << std::setprecision(3) << value;
  return out.str();
}

}  // namespace

Identification::Identification(HapticDevice& device, double pivot_mm)
    : device_(device), pivot_mm_(pivot_mm), declared_(device.capabilities()) {
  for (Shake* shake : {&force_, &torque_}) {
    shake->motion.reserve(kShakeTicks);
    shake->tip.reserve(kShakeTicks);
  }
}

void Identification::next(Part part) noexcept {
  part_ = part;
  ticks_ = 0;
  before_ = speed_ = reached_ = 0;
}

void Identification::stop(const char* reason) noexcept {
  trouble_ = reason;
  part_ = Part::kEnd;
}

/// Returns the effort of this tick: a step plus a restoring effort towards the start. The strength
/// adapts to the device's motion in the previous steps.
double Identification::effort(double position, double least, double most, double range) noexcept {
  Shake& shake = part_ == Part::kForce ? force_ : torque_;
  speed_ += ((position - before_) / kShakeTickS - speed_) * kSpeedPart;
  before_ = position;
  reached_ = std::max(reached_, std::abs(position));
  shake.strength = std::max(shake.strength, least);
  if (ticks_ % kJudgeTicks == 0) {
    if (reached_ < kMoved * range) shake.strength = std::min(most, shake.strength * kStronger);
    if (reached_ > kMuch * range) shake.strength *= kWeaker;
    reached_ = 0;
  }
  --hold_;
  if (std::abs(position) > kMuch * range) {
    sign_ = position > 0 ? -1 : 1;
  } else if (hold_ <= 0) {
    sign_ = random_() % 2 == 0 ? 1 : -1;
    hold_ = kShortest + static_cast<int>(random_() % (kLongest - kShortest));
  }
  const double back = kCentering * most / range * (position + speed_ * kCenteringS);
  return std::clamp(sign_ * shake.strength - back, -most, most);
}

bool Identification::tick(std::uint64_t now_us) noexcept {
  const DeviceState state = device_.read(now_us);
  if (last_us_ != 0)
    lost_ += std::max<std::uint64_t>(1, (now_us - last_us_ + kTickUs / 2) / kTickUs) - 1;
  last_us_ = now_us;
  if (part_ != Part::kEnd && !state.valid && ++absent_ > kAbsentTicks)
    stop("the device has no pose any more");
  if (part_ == Part::kEnd) {
    device_.show_force(false);
    device_.write({});
    return false;
  }
  if (!state.valid) {
    device_.write({});
    return true;
  }
  absent_ = 0;
  const Grip grip{state.tip_mm + state.axis * pivot_mm_, state.axis};
  if (++ticks_ <= kRestTicks) {
    from_ = grip;
    device_.write({});
    return true;
  }
  device_.show_force(true);
  const Twist moved = between(from_, grip);
  const bool turns = part_ == Part::kTorque;
  const double position = turns ? moved.angular.y : moved.linear.x;
  if (!(length(moved.linear) <= kShakeMm && length(moved.angular) <= kShakeRad)) {
    stop(turns ? "the device turned too far: let it go, or hold its arm still"
               : "the device moved too far: it must stay where it is let go, without a hand");
    device_.write({});
    return true;
  }
  const double most = turns ? std::min(kShakeNmm, kShareOfDevice * declared_.max_torque_nmm)
                            : std::min(kShakeN, kShareOfDevice * declared_.max_force_n);
  const double value = effort(position, kFirstShare * most, most, turns ? kShakeRad : kShakeMm);
  Shake& shake = turns ? torque_ : force_;
  shake.motion.push_back({position, value});
  shake.tip.push_back({turns ? state.axis.x : state.tip_mm.x, value});
  device_.write(turns ? Wrench{.force_n = {}, .torque_nmm = {0, value, 0}}
                      : Wrench{.force_n = {value, 0, 0}, .torque_nmm = {}});
  if (shake.motion.size() < kShakeTicks) return true;
  next(!turns && declared_.max_torque_nmm > 0 ? Part::kTorque : Part::kEnd);
  device_.write({});
  return true;
}

std::expected<DeviceProfile, std::string> Identification::profile() const {
  if (trouble_ != nullptr) return std::unexpected(trouble_);
  if (part_ != Part::kEnd) return std::unexpected("it was interrupted");
  const std::uint64_t ticks = force_.motion.size() + torque_.motion.size();
  if (lost_ * kTicksPerLost > ticks) {
    return std::unexpected(join({"the loop lost ", std::to_string(lost_), " of ",
                                 std::to_string(ticks), " ticks, and at most one in ",
                                 std::to_string(kTicksPerLost), " may be: end other programs"}));
  }
  const auto push = fit_motion(force_.motion);
  if (!push) return std::unexpected("force: " + push.error());
  moved_ = *push;
  DeviceProfile profile{.device = declared_.name};
  constexpr double kGPerKg = 1000, kUs = 1e6;
  profile.moving_mass_kg = push->mass * kGPerKg;  // 1 N s²/mm = 1000 kg
  profile.friction_n = push->friction;
  profile.viscous_n_s_per_mm = push->viscous;
  profile.resolution_mm = quantum_of(force_.tip);
  double latency_s = push->latency_s;
  if (declared_.max_torque_nmm > 0) {
    const auto turn = fit_motion(torque_.motion);
    if (!turn) return std::unexpected("torque: " + turn.error());
    profile.moving_inertia_kg_m2 = turn->mass / kNmmPerNm;
    profile.resolution_rad = quantum_of(torque_.tip);
    latency_s = std::max(latency_s, turn->latency_s);
  }
  profile.latency_us = static_cast<std::uint64_t>(std::lround(latency_s * kUs));
  const DeviceCapabilities known = with_profile(declared_, profile);
  const ZWidth width = z_width(settings_for(known, {.pivot_mm = pivot_mm_}));
  profile.wall_along_n_per_mm = width.along.stiffness;
  profile.wall_across_n_per_mm = width.across.stiffness;
  return profile;
}

std::string identification_warning(const DeviceCapabilities& device) {
  const double newtons = std::min(kShakeN, kShareOfDevice * device.max_force_n);
  const bool turns = device.max_torque_nmm > 0;
  const double nmm = std::min(kShakeNmm, kShareOfDevice * device.max_torque_nmm);
  return join({"keep your hands off the ", device.name, ": for ",
               short_number(turns ? 2 * kShakeS : kShakeS), " s it is pushed with up to ",
               short_number(newtons),
               turns ? join({" N and turned with up to ", short_number(nmm), " N·mm"}) : " N",
               ", and moves by up to ", short_number(kShakeMm), " mm"});
}

std::vector<Finding> judge_profile(const DeviceCapabilities& declared,
                                   const DeviceProfile& profile) {
  constexpr double kUsPerMs = 1000, kGPerKg = 1000;
  const auto beside = [](double value, const char* unit) {
    return value > 0 ? join({" (declared: ", short_number(value), unit, ")"})
                     : std::string(" (not declared)");
  };
  std::vector<Finding> findings;
  const auto say = [&findings](Health health, std::string what) {
    findings.push_back({.health = health, .what = std::move(what)});
  };
  const auto declared_us = static_cast<double>(declared.latency_us);
  const auto us = static_cast<double>(profile.latency_us.value_or(0));
  say(us > declared_us + kUsPerMs / 2 ? Health::kWarning : Health::kFine,
      join(
          {"latency ", short_number(us / kUsPerMs), " ms", beside(declared_us / kUsPerMs, " ms")}));
  // A device heavier than declared is safe. A lighter one is not.
  constexpr double kLighter = 0.8;
  const double mass = profile.moving_mass_kg.value_or(0);
  say(mass < kLighter * declared.moving_mass_kg ? Health::kWarning : Health::kFine,
      join({"moving mass ", short_number(mass * kGPerKg), " g",
            beside(declared.moving_mass_kg * kGPerKg, " g"), ", friction ",
            short_number(profile.friction_n), " N and ",
            short_number(profile.viscous_n_s_per_mm * kGPerKg), " N s/m"}));
  if (const auto inertia = profile.moving_inertia_kg_m2) {
    say(*inertia < kLighter * declared.moving_inertia_kg_m2 ? Health::kWarning : Health::kFine,
        join({"moving inertia ", short_number(*inertia), " kg m²",
              beside(declared.moving_inertia_kg_m2, " kg m²")}));
  }
  const auto step = [](double value, const char* unit) {
    return value > 0 ? join({short_number(value), unit}) : std::string("too fine to be seen");
  };
  std::string steps = join({"step of the encoder: ", step(profile.resolution_mm.value_or(0), " mm"),
                            beside(declared.resolution_mm, " mm")});
  if (profile.resolution_rad) {
    steps += join({", of the axis: ", step(*profile.resolution_rad, " rad"),
                   beside(declared.resolution_rad, " rad")});
  }
  say(Health::kFine, std::move(steps));
  const DeviceCapabilities known = with_profile(declared, profile);
  say(Health::kFine, z_width_notice(known, settings_for(known, {})));
  return findings;
}

}  // namespace kerf::agent
