// SPDX-License-Identifier: Apache-2.0
// Prints how many bytes of a journal one motion takes, for hands at 1 kHz with a commit every 10 ms
// and for programs that are carved fast. The size is that of the file, including rows and index
// pages, without that of an empty journal. Also prints the share of the batches themselves (the
// remainder is SQLite's) and the part that no code can save: the entropy of the noise of the
// encoders and of the agent's clock, as if the path of the hand were known.
//
//   journal_bench
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "server/formats/pose_grid.h"
#include "server/store/journal_reader.h"
#include "server/store/journal_writer.h"
#include "server/store/sqlite.h"

namespace {

using namespace kerf;

constexpr int kMotions = 12'000;
constexpr double kArmMm = 100;  ///< between the encoders that measure the axis

struct Kind {
  const char* name;
  int hands = 1;
  double jitter_us = 0;  ///< of the agent's clock
  double lean_rad = 0;   ///< amplitude of the axis
  double noise_mm = 0;   ///< of the device's encoders
  int motions_per_commit = 10;
  /// For a G-code program, with tips in whole micrometers. 0 if the clock determines the duration
  /// of motions.
  double feed_mm_per_min = 0;
};

/// A hand that moves some 100 mm/s and trembles, at time `t`.
ToolPose hand(double t, const Kind& kind, std::mt19937_64& random) {
  std::normal_distribution<double> noise;
  const auto rough = [&] { return kind.noise_mm * noise(random); };
  const double lean = kind.lean_rad * std::sin(1.1 * t), turn = kind.lean_rad * std::sin(1.9 * t);
  const Vec3 axis =
      normalized({std::sin(lean) * std::cos(turn) + rough() / kArmMm,
                  std::sin(turn) + rough() / kArmMm, std::cos(lean) * std::cos(turn)});
  const Vec3 tip{30 * std::sin(1.7 * t) + 10 * std::sin(5.1 * t) + rough(),
                 25 * std::sin(2.3 * t) + 0.1 * std::sin(20 * std::numbers::pi * t) + rough(),
                 -3 + std::sin(3.1 * t) + rough()};
  if (kind.feed_mm_per_min > 0) {
    const auto round = [](double mm) { return std::round(1000 * mm) / 1000; };
    return admit_pose({{round(tip.x), round(tip.y), round(tip.z)}, {0, 0, 1}});
  }
  // Samples carry the axis as floats.
  return admit_pose({tip, kind.lean_rad > 0 ? Vec3(Vec3f(axis)) : Vec3{0, 0, 1}});
}

/// Returns the bits of a normally distributed number with this deviation, in steps, that is rounded
/// to steps. Exact to 0.01 from one step on.
double bits_of_noise(double steps) {
  return std::max(0.0, std::log2(steps * std::sqrt(2 * std::numbers::pi * std::numbers::e)));
}

/// Returns the bytes of a motion that noise alone takes. Samples carry the axis as floats, so noise
/// below their spacing is lost. The third component follows from the first two.
double noise_bytes(const Kind& kind) {
  if (kind.noise_mm == 0) return 0;
  Kind smooth = kind;
  smooth.noise_mm = 0;
  std::mt19937_64 unused;
  double bits = 0;
  for (int n = 0; n < kMotions; ++n) {
    const Vec3f axis(hand(1e-3 * n, smooth, unused).axis);
    for (const float component : {axis.x, axis.y}) {
      const double spacing = std::nextafter(std::abs(component), 1.0F) - std::abs(component);
      bits += bits_of_noise(kind.noise_mm / kArmMm / std::max(spacing, kAxisGrid));
    }
  }
  // Half of the normal distribution, which takes one bit less.
  const double clock = kind.jitter_us > 0 ? bits_of_noise(kind.jitter_us) - 1 : 0;
  return (bits / kMotions + 3 * bits_of_noise(kind.noise_mm / kTipGridMm) + clock) / 8;
}

/// Returns the bytes of all batches of a journal.
double batch_bytes(const std::filesystem::path& file) {
  auto database = SqlDatabase::open(file, SqlMode::kRead).value();
  return static_cast<double>(database.integer("SELECT sum(length(bytes)) FROM batches").value());
}

void measure(const Kind& kind, const std::filesystem::path& file) {
  const JournalHeader header{"bench", "{}", "", 1};
  if (!JournalWriter::create(file, header).value().finish()) std::abort();
  const auto empty_bytes = std::filesystem::file_size(file);
  remove_journal(file);
  auto writer = JournalWriter::create(file, header).value();
  std::mt19937_64 random(1);
  std::normal_distribution<double> jitter(0, kind.jitter_us);
  std::vector<ToolPose> last(static_cast<std::size_t>(kind.hands));
  std::vector<std::uint64_t> last_us(last.size());
  for (int n = 0, made = 0; made < kMotions; ++n) {
    for (std::size_t h = 0; h < last.size(); ++h) {
      const std::uint64_t us = static_cast<std::uint64_t>(1000 * (n + 1)) +
                               static_cast<std::uint64_t>(std::abs(jitter(random)));
      const ToolPose pose =
          hand(static_cast<double>(us) * 1e-6 + 10.0 * static_cast<double>(h), kind, random);
      double duration_s = static_cast<double>(us - last_us[h]) * 1e-6;
      if (kind.feed_mm_per_min > 0) {
        duration_s = 60 * length(pose.tip_mm - last[h].tip_mm) / kind.feed_mm_per_min;
      }
      if (n > 0) {
        const MoveTool move{1, last[h], pose, duration_s, true};
        if (!writer.append(static_cast<ParticipantId>(h + 1), move, {1, n == 1})) std::abort();
        if (++made % (kind.motions_per_commit * kind.hands) == 0 && !writer.flush()) std::abort();
      }
      last[h] = pose;
      last_us[h] = us;
    }
  }
  if (!writer.finish()) std::abort();
  const auto bytes = static_cast<double>(std::filesystem::file_size(file) - empty_bytes);
  const auto start = std::chrono::steady_clock::now();
  auto reader = JournalReader::open(file).value();
  int count = 0;
  while (reader.next().value()) ++count;
  const std::chrono::duration<double, std::micro> read = std::chrono::steady_clock::now() - start;
  std::printf(
      "%-46s %5.1f B a motion, of it batches %5.1f and noise alone %5.1f; %5.0f MB an hour of a "
      "hand; read in %.2f us a motion\n",
      kind.name, bytes / count, batch_bytes(file) / count, noise_bytes(kind), bytes / count * 3.6,
      read.count() / count);
  remove_journal(file);
}

}  // namespace

int main() {
  const auto file = std::filesystem::temp_directory_path() /
                    ("kerf-journal-bench-" + std::to_string(getpid()) + kJournalExtension);
  const Kind kinds[] = {
      {"a hand, upright tool", 1, 20, 0, 0, 10},
      {"a hand, five axes", 1, 20, 0.3, 0, 10},
      {"a hand, five axes, encoder noise of 1 um", 1, 20, 0.3, 0.001, 10},
      {"a hand, five axes, encoder noise of 10 um", 1, 20, 0.3, 0.01, 10},
      {"four hands, five axes", 4, 20, 0.3, 0, 10},
      {"a fast program, 1000 motions a commit", 1, 0, 0.3, 0, 1000},
      {"a fast program, durations by travel and feed", 1, 0, 0, 0, 1000, 800},
  };
  for (const Kind& kind : kinds) measure(kind, file);
}
