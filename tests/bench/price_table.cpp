// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/price_table.h"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <numbers>
#include <random>

#include "kernel/sculpture.h"
#include "server/formats/program.h"
#include "server/formats/scene.h"
#include "server/platform/clock.h"
#include "server/verify/price.h"

namespace kerf::bench {
namespace {

struct Job {
  std::string name;
  Scene scene;
  std::vector<ProgramMotion> motions;
};

/// A block of 120 x 80 x 30 mm whose top is Z 0.
Scene scene_with(const std::string& tool, const std::string& accuracy,
                 const std::string& kinematics = "xyz",
                 const std::string& corner = "[120, 80, 0]") {
  const std::string text = R"({"stock": {"shape": "box", "min_mm": [0, 0, -30], "max_mm": )" +
                           corner + R"(}, "accuracy": {)" + accuracy +
                           R"(}, "tools": [{"id": 1, )" + tool +
                           R"(}], "machine": {"kinematics": ")" + kinematics + R"("}})";
  return parse_scene(text, {}).value();
}

const std::string kBall10 = R"("shape": "ball", "diameter_mm": 10, "length_mm": 40)";
const std::string kBall3 = R"("shape": "ball", "diameter_mm": 3, "length_mm": 30)";
const std::string kFlat6 = R"("shape": "flat", "diameter_mm": 6, "length_mm": 40)";
const std::string kFlat40 = R"("shape": "flat", "diameter_mm": 40, "length_mm": 30)";
const std::string kDexel =
    R"("rays": "dexel", "pitch_mm": 0.2, "tolerance_mm": 0.01, "motion": "tight")";
const std::string kFine =
    R"("rays": "dexel", "pitch_mm": 0.05, "tolerance_mm": 0.005, "motion": "tight")";
const std::string kThree =
    R"("rays": "tri-dexel", "pitch_mm": 0.2, "tolerance_mm": 0.01, "motion": "tight")";

class Path {
 public:
  void go(Vec3 tip, Vec3 axis = {0, 0, 1}) {
    const ToolPose to{tip, normalized(axis)};
    if (last_set_) {
      motions.push_back({.tool = 1,
                         .from = last_,
                         .to = to,
                         .duration_s = std::max(0.001, length(tip - last_.tip_mm) / 20)});
    }
    last_ = to;
    last_set_ = true;
  }
  std::vector<ProgramMotion> motions;

 private:
  ToolPose last_;
  bool last_set_ = false;
};

/// Rows along X at heights of `z(x, y)`.
std::vector<ProgramMotion> raster(double step_mm, double row_mm,
                                  const std::function<double(double, double)>& z,
                                  double lean_rad = 0) {
  Path path;
  const int steps = int(120 / step_mm), rows = int(80 / row_mm);
  for (int row = 0; row <= rows; ++row) {
    for (int n = 0; n <= steps; ++n) {
      const double x = (row % 2 == 0 ? n : steps - n) * step_mm, y = row * row_mm;
      const double lean = lean_rad * std::sin(0.1 * x + y);
      path.go({x, y, z(x, y)}, {std::sin(lean), 0, std::cos(lean)});
    }
  }
  return path.motions;
}

std::vector<ProgramMotion> pocket(double wide_mm, double depth_mm, int layers) {
  Path path;
  for (int layer = 1; layer <= layers; ++layer) {
    for (double r = 1; r < 35; r += wide_mm) {
      for (int n = 0; n <= 72; ++n) {
        const double turn = 2 * std::numbers::pi * n / 72;
        path.go({60 + 1.5 * r * std::cos(turn), 40 + r * std::sin(turn), -depth_mm * layer});
      }
    }
  }
  return path.motions;
}

std::vector<ProgramMotion> holes() {
  Path path;
  for (int row = 0; row < 12; ++row) {
    for (int n = 0; n < 20; ++n) {
      const Vec3 at{5 + 5.5 * n, 5 + 6.0 * row, 2};
      path.go(at);
      for (int peck = 1; peck <= 5; ++peck) {
        path.go({at.x, at.y, -4.0 * peck});
        path.go({at.x, at.y, 1});
      }
    }
  }
  return path.motions;
}

std::vector<ProgramMotion> strokes(double z_mm, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> in(0, 1);
  Path path;
  for (int stroke = 0; stroke < 120; ++stroke) {
    Vec3 at{120 * in(random), 80 * in(random), z_mm};
    path.go({at.x, at.y, 3});
    const double turn = 2 * std::numbers::pi * in(random);
    for (int n = 0; n < 60; ++n) {
      path.go(at, {0.1 * std::sin(0.2 * n), 0.1, 1});
      at = at + 0.3 * Vec3{std::cos(turn + 0.02 * n), std::sin(turn + 0.02 * n), 0};
    }
    path.go({at.x, at.y, 3});
  }
  return path.motions;
}

std::vector<Job> twelve_jobs() {
  const auto waves = [](double x, double y) {
    return -4 + 3 * std::sin(0.1 * x) * std::cos(0.13 * y);
  };
  const auto level = [](double z) { return [z](double, double) { return z; }; };
  return {
      {"raster of waves, ball 10", scene_with(kBall10, kDexel), raster(1, 1, waves)},
      {"the same in steps of 0.2 mm", scene_with(kBall10, kDexel), raster(0.2, 3, waves)},
      {"the same in rows only", scene_with(kBall10, kDexel), raster(120, 1, level(-2))},
      {"waves, ball 3, pitch 0.05", scene_with(kBall3, kFine), raster(0.5, 0.8, waves)},
      {"waves, three fields", scene_with(kBall10, kThree), raster(1, 1, waves)},
      {"waves, leaning, 5 axes", scene_with(kBall10, kDexel, "tool-vector"),
       raster(1, 1, waves, 0.4)},
      {"pocket in 8 layers, flat 6", scene_with(kFlat6, kDexel), pocket(2, 2, 8)},
      {"pocket, three fields", scene_with(kFlat6, kThree), pocket(2, 4, 4)},
      {"face, flat 40", scene_with(kFlat40, kDexel), raster(2, 15, level(-1))},
      {"240 holes with pecks", scene_with(kFlat6, kDexel), holes()},
      {"strokes of a hand, ball 10", scene_with(kBall10, kDexel, "tool-vector"), strokes(-2, 1)},
      {"strokes in a block of 1 m", scene_with(kBall10, kDexel, "tool-vector", "[1000, 1000, 0]"),
       strokes(-2, 2)}};
}

/// Returns the resident memory of the process.
double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double all = 0, resident = 0;
  file >> all >> resident;
  return resident * double(sysconf(_SC_PAGESIZE));
}

struct Measured {
  double us = 0, bytes = 0;
};

Measured carve(const Job& job) {
  malloc_trim(0);
  const double before = resident_bytes();
  auto block = Sculpture::create(job.scene.settings).value();
  for (const auto& [id, tool] : job.scene.tools) block.apply(DefineTool{id, tool.tool}).value();
  const double start = Clock::thread_cpu_s();
  for (const ProgramMotion& m : job.motions)
    (void)block.apply(MoveTool{m.tool, m.from, m.to, m.duration_s, true});
  const double us = 1e6 * (Clock::thread_cpu_s() - start) / double(job.motions.size());
  malloc_trim(0);
  return {us, resident_bytes() - before};
}

double worst(double a, double ratio) { return std::max(a, std::max(ratio, 1 / ratio)); }

bool read_files(const std::vector<std::string>& files, std::vector<Job>& jobs) {
  for (std::size_t n = 0; n + 1 < files.size(); n += 2) {
    auto scene = load_scene(files[n]);
    std::ifstream file(files[n + 1]);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (!scene) return std::fprintf(stderr, "%s\n", to_string(scene.error()).c_str()), false;
    auto program = parse_program(files[n + 1], text, *scene);
    if (!program) return std::fprintf(stderr, "%s\n", to_string(program.error()).c_str()), false;
    const std::string name = files[n + 1].substr(files[n + 1].rfind('/') + 1);
    jobs.push_back({name, *std::move(scene), std::move(program->motions)});
  }
  return true;
}

}  // namespace

bool print_price_table(const std::vector<std::string>& files) {
  std::vector<Job> jobs = twelve_jobs();
  if (!read_files(files, jobs)) return false;
  std::printf("%-30s %8s %7s | %8s %8s %5s | %7s %7s %5s\n", "program", "motions", "carved",
              "us said", "measured", "ratio", "MB said", "grown", "ratio");
  double us_worst = 1, mb_worst = 1;
  for (const Job& job : jobs) {
    const Price said = price_of_program(job.scene, job.motions);
    const Measured found = carve(job);
    const double us = said.us_per_motion / found.us, mb = said.bytes / found.bytes;
    us_worst = worst(us_worst, us);
    mb_worst = worst(mb_worst, mb);
    std::printf("%-30s %8zu %7zu | %8.1f %8.1f %5.2f | %7.1f %7.1f %5.2f\n", job.name.c_str(),
                job.motions.size(), said.motions, said.us_per_motion, found.us, us,
                said.bytes / 1e6, found.bytes / 1e6, mb);
    std::fflush(stdout);
  }
  std::printf("farthest from 1 (greater of ratio and inverse): %.2f for time, %.2f for memory\n",
              us_worst, mb_worst);
  return true;
}

}  // namespace kerf::bench
