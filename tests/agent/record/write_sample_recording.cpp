// SPDX-License-Identifier: Apache-2.0
// Writes a recording of 2,345 ticks whose values follow from their number, and the same recording
// as a killed program leaves it, for tests/e2e/validate_recording.mjs.
// Usage: write_sample_recording FOLDER
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

#include "haptic_agent/record/recorder.h"
#include "tests/support/content_of.h"

namespace {

kerf::agent::TickRecord tick_at(std::uint64_t n) {
  using kerf::Vec3;
  const auto i = static_cast<double>(n);
  const auto vector = [i](double base) { return Vec3{base + i, base + 0.25 + i, base + 0.5 + i}; };
  return {.time_us = 7'000'000 + n * 1000,
          .pose_us = 6'999'700 + n * 1000,
          .answer_age_us = n,
          .tip_mm = vector(100),
          .axis = {0.6, 0, 0.8},
          .computed = {vector(200), vector(300)},
          .requested = {vector(400), vector(500)},
          .felt = {vector(600), vector(700)},
          .energy_mj = 0.125 * i,
          .felt_share = 0.75,
          .buttons = 3,
          .tool_id = static_cast<std::uint32_t>(n % 4),
          .lost = static_cast<std::uint32_t>(n % 3),
          .phase = kerf::agent::ServoPhase::kDegraded,
          .trip = kerf::agent::TripCode::kOverdrawn,
          .mode = kerf::agent::ForceMode::kPaper,
          .has_pose = n % 2 == 0};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  const std::filesystem::path file = folder / "sample.mcap";
  std::filesystem::remove(file);
  constexpr std::uint64_t kTicks = 2345;
  auto recorder = kerf::agent::Recorder::start(file.string(), {{"session", "demo"}}, R"({"a":1})");
  if (!recorder) {
    std::cerr << recorder.error() << '\n';
    return 1;
  }
  for (std::uint64_t n = 0; n < kTicks; ++n) (*recorder)->tape().push(tick_at(n));
  const auto report = (*recorder)->finish({{"trips", "4"}});
  const std::string whole = kerf::test::content_of(file);
  std::ofstream(folder / "cut_off.mcap", std::ios::binary) << whole.substr(0, whole.size() / 2);
  return report.error.empty() && report.ticks == kTicks ? 0 : 1;
}
