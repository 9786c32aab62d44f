// SPDX-License-Identifier: Apache-2.0
#include <sys/mman.h>

#include <chrono>
#include <memory>
#include <thread>

#include "haptic_agent/act_on_signal.h"
#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/doctor/checks.h"
#include "haptic_agent/doctor/identify.h"
#include "haptic_agent/realtime/clock.h"
#include "haptic_agent/servo/watchdog.h"

namespace kerf::agent {
namespace {

constexpr double kPivotMm = 60;  ///< the default pivot of scenes
constexpr auto kTimeToLetGo = std::chrono::seconds(3);

bool waits_until_ready(HapticDevice& device, double wait_s) {
  const std::uint64_t until_us = monotonic_us() + static_cast<std::uint64_t>(wait_s * kUsPerS);
  while (monotonic_us() < until_us) {
    if (device.read(monotonic_us()).phase == DevicePhase::kReady) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

}  // namespace

std::vector<Finding> identify_device(const DeviceChoice& choice, double wait_s,
                                     const std::string& path,
                                     const std::function<void(const std::string&)>& warn) {
  const auto bad = [](std::string what) {
    return std::vector<Finding>{{.health = Health::kBad, .what = std::move(what)}};
  };
  // An interruption by the user leaves no force on.
  ActOnSignal signals;
  // The simulated hand would carve meanwhile, so it stays at the start of its path.
  constexpr double kHardlyMoves = 0.0001;
  const bool simulated = choice.kind == DeviceKind::kSimulated;
  const auto made = make_device(choice, {}, {.speed = simulated ? kHardlyMoves : 1.0});
  if (!made) return bad(made.error());
  HapticDevice& device = **made;
  const DeviceCapabilities declared = device.capabilities();
  if (!(declared.max_force_n > 0))
    return bad(join({"the ", declared.name, " has no motors: there is nothing to identify"}));
  if (!waits_until_ready(device, wait_s)) {
    const std::string trouble = device.trouble();
    return bad(trouble.empty() ? join({"the ", declared.name, " did not become ready"}) : trouble);
  }
  warn(identification_warning(declared));
  if (!simulated) std::this_thread::sleep_for(kTimeToLetGo);
  Identification identification(device, kPivotMm);
  MonotonicClock clock;
  ServoLoop loop(clock);
  signals.on_leave([&loop] { loop.stop(); });
  run_watched(loop, identification, {[&device] { device.write({}); }, [&device] { device.stop(); }},
              [] { make_realtime({}); });
  signals.on_leave(nullptr);
  munlockall();
  const auto profile = identification.profile();
  if (!profile) return bad(join({"the ", declared.name, " was not identified: ", profile.error()}));
  std::vector<Finding> findings = judge_profile(declared, *profile);
  if (const auto written = write_profile(path, *profile); !written) return bad(written.error());
  findings.push_back(
      {.what = join({"written to ", path, ": start kerf-agent with --profile ", path})});
  return findings;
}

}  // namespace kerf::agent
