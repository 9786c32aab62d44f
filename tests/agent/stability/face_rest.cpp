// SPDX-License-Identifier: Apache-2.0
#include "tests/agent/stability/face_rest.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "tests/agent/stability/test_bed.h"

namespace kerf::agent {
namespace {

constexpr double kArmS = 0.9;    ///< at rest above the face, in which the device arms
constexpr double kPressS = 0.6;  ///< duration of the approach
constexpr double kAboveMm = 12;  ///< the rim of a tilted tool is below its tip
constexpr int kBuzzTicks = 500;

std::string scene_of(const FaceRest& rest) {
  const std::string block = R"("shape":"box","min_mm":[-30,-30,-30],"max_mm":[30,30,0])";
  const std::string below = R"("shape":"box","min_mm":[-30,-30,-40],"max_mm":[30,30,-39])";
  return R"({"name":"face","stock":{)" + (rest.obstacle ? below : block) +
         R"(},"accuracy":{"rays":"dexel","pitch_mm":0.5,"tolerance_mm":0.01,"motion":"tight"},
         "tools":[{"id":1,)" +
         kFaceTools[rest.tool].json + "}]," +
         (rest.obstacle ? R"("obstacles":[{)" + block + "}]," : std::string()) +
         R"("force":{"law":"specific_energy","specific_force_n_per_mm2":0.2,"pivot_mm":60}})";
}

/// The tip's target: down along z with a smooth start and end.
Vec3 target(const FaceRest& rest, double time_s) {
  const double t = std::clamp((time_s - kArmS) / kPressS, 0.0, 1.0);
  const double share = (1 - std::cos(std::numbers::pi * t)) / 2;
  return {0, 0, kAboveMm - (kAboveMm + rest.depth_mm) * share};
}

double settling_s(const PlantMechanics& m) {
  constexpr double kConstants = 7, kMostS = 12;
  const double moves = m.damping_ratio * std::sqrt(m.hand_n_per_mm * 1000 / m.mass_kg);
  const double turns = m.damping_ratio * std::sqrt(m.hand_nmm_per_rad / (m.inertia_kg_m2 * 1000));
  return std::min(kMostS, 1 + kConstants / std::min(moves, turns));
}

}  // namespace

FaceRestOutcome rest_on_face(const FaceRest& rest) {
  PlantMechanics mechanics = rest.mechanics;
  mechanics.axis = {std::sin(rest.tilt_rad), 0, std::cos(rest.tilt_rad)};
  Plant plant([&](double time_s) { return target(rest, time_s); }, mechanics, false);
  TestBed bed(scene_of(rest), plant, {}, rest.line, true);
  const int ticks =
      static_cast<int>((kArmS + kPressS + settling_s(rest.mechanics)) * 1000) + kBuzzTicks;
  for (int i = 0; i < ticks; ++i) {
    if (i == ticks - kBuzzTicks) plant.begin_rest();
    bed.tick();
  }
  return {.returned_mj = plant.most_returned_mj(),
          .buzz_mm_per_s = plant.rms_mm_per_s(),
          .moved_at_rest_mm = plant.moved_at_rest_mm(),
          .given_at_rest_mj = plant.given_at_rest_mj(),
          .force_n = length(plant.acting().force_n),
          .trips = bed.servo().supervisor().trips()};
}

FaceRest random_face_rest(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto log_uniform = [&](double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  };
  const auto one_of = [&](std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
  };
  constexpr std::uint64_t kLatencyUs[] = {0, 1000, 3000};
  FaceRest rest;
  rest.mechanics = {.mass_kg = log_uniform(0.05, 2),
                    .inertia_kg_m2 = log_uniform(1e-5, 1e-3),
                    .hand_n_per_mm = log_uniform(0.02, 2),
                    .hand_nmm_per_rad = log_uniform(20, 1340),
                    .damping_ratio = log_uniform(0.1, 1),
                    .latency_us = kLatencyUs[one_of(3)]};
  rest.tilt_rad = one_of(4) == 0 ? 0 : uniform(0, 0.5);
  rest.tool = one_of(kFaceTools.size());
  rest.obstacle = one_of(3) == 0;
  rest.depth_mm = log_uniform(0.5, 6);
  rest.line = {.rtt_ms = one_of(2) == 0 ? 0 : uniform(0, 50)};
  return rest;
}

}  // namespace kerf::agent
