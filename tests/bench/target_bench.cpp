// SPDX-License-Identifier: Apache-2.0
// Checks that the accuracy chosen for "target_mm" meets the target, and compares its cost with the
// cheapest settings that do. Each generated program is carved with the chosen settings and with
// coarser ones, and measured against the true solid (server/verify/true_solid.h) in both
// directions: from the mesh to the solid and from points of the solid's surface to the mesh. `laws`
// prints the data to which the laws of server/formats/accuracy_choice.cpp are fitted, `costs` those
// of the cost law alone.
// The search runs over programs that were not used to fit the laws, and ends with the distribution
// of the ratios. Usage: target_bench [samples=30000]; target_bench laws [samples];
// target_bench costs

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "server/carve/surface_error.h"
#include "server/carve/tradeoff_run.h"
#include "server/verify/wall_check.h"
#include "server/verify/wall_probe.h"
#include "tests/support/standard_job.h"

namespace {

using namespace kerf;

// Chord tolerance of the arcs in the true solid, mm.
constexpr double kTrueChordMm = 1e-4;
// The position of the rays changes the greatest error by up to a third. A configuration meets a
// target if it does so for each of these offsets (fractions of a pitch).
constexpr std::array kPlacements{Vec3{0, 0, 0}, Vec3{0.31, 0.57, 0.43}, Vec3{0.72, 0.19, 0.81}};

constexpr double kSearchStep = 1.15;
// Bounds of the law's classes of sharpness, in pitches; the last class is not bounded by the law.
constexpr std::array kSharpness{0.0, 0.27, 0.5, 1.0};

struct Job {
  std::string name, tool, kinematics, program;
};

std::string line(const char* word, Vec3 p, Vec3 axis, bool turns) {
  char text[200];
  std::snprintf(text, sizeof text, "%s X%.4f Y%.4f Z%.4f", word, p.x, p.y, p.z);
  std::string result = text;
  if (turns) {
    std::snprintf(text, sizeof text, " I%.6f J%.6f K%.6f", axis.x, axis.y, axis.z);
    result += text;
  }
  return result + "\n";
}

// Slots in all directions, up to 12 mm deep, with plunge and retract. With `turns` the axis leans
// by up to 35 degrees and turns along the slot.
std::string slots(bool turns, unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * (double(random()) / 4294967296.0);
  };
  const auto lean = [&] {
    const double angle = uniform(0, 0.6), around = uniform(0, 2 * std::numbers::pi);
    return Vec3{std::sin(angle) * std::cos(around), std::sin(angle) * std::sin(around),
                std::cos(angle)};
  };
  std::string text = "T1 M6\nF1000\n";
  for (int k = 0; k < 40; ++k) {
    const double length_mm = uniform(5, 25), around = uniform(0, 2 * std::numbers::pi);
    const Vec3 above{uniform(20, 80), uniform(20, 80), 60};
    const Vec3 from{above.x, above.y, uniform(38, 48)};
    const Vec3 to =
        from + Vec3{length_mm * std::cos(around), length_mm * std::sin(around), uniform(-2, 2)};
    const Vec3 first = turns ? lean() : Vec3{0, 0, 1}, last = turns ? lean() : Vec3{0, 0, 1};
    text += line("G0", above, first, turns) + line("G1", from, first, turns);
    text += line("G1", to, last, turns) + line("G1", {to.x, to.y, 60}, last, turns);
  }
  return text + "M2\n";
}

// Round pockets and bosses: arcs in the plane.
std::string rings() {
  std::string text = "T1 M6\nF1000\n";
  for (int k = 0; k < 12; ++k) {
    char block[200];
    const double x = 17.03 + 22 * (k % 4), y = 18.07 + 30 * (k / 4), r = 4.3 + 0.37 * k;
    std::snprintf(block, sizeof block, "G0 Z60\nX%.3f Y%.3f\nG1 Z%.3f\nG2 I%.3f J0\n", x - r, y,
                  47.0 - 0.4 * k, r);
    text += block;
  }
  return text + "G0 Z60\nM2\n";
}

std::string raster(bool five_axis) {
  std::string text = "T1 M6\nF1000\n";
  for (const ToolPose& pose : test::standard_path(five_axis))
    text += line("G1", pose.tip_mm, pose.axis, true);
  return text + "M2\n";
}

Scene scene_of(const Job& job, const std::string& accuracy) {
  return parse_scene(
             R"({"stock": {"shape": "box", "min_mm": [0,0,0], "max_mm": [100,100,50]}, "accuracy": )" +
                 accuracy + R"(, "tools": [{"id": 1, )" + job.tool +
                 R"(}], "machine": {"kinematics": ")" + job.kinematics + "\"}}",
             {})
      .value();
}

struct Measured {
  double us = 0;
  double error_mm = 0;  // greatest distance of the mesh and the true surface, in both directions
  double from_mesh_mm = 0;  // from the mesh to the true surface
};

class Bench {
 public:
  Bench(const Job& job, std::size_t samples)
      : job_(job), samples_(samples), scene_(scene_of(job, "{}")) {
    scene_.settings.tolerance_mm = kTrueChordMm;
    const Program program = parse_program("p.ngc", job.program, scene_).value();
    truth_.emplace(scene_.settings.stock, scene_.tools, program.motions, 6);
    surface_ = sample_cut_surface(*truth_, samples);
  }

  // Points where the surface is sharp or thin to a degree between two bounds: greatest distance of
  // its points from a ball of a pitch's diameter inside or outside the solid, in pitches. Otherwise
  // no points.
  struct Sharpness {
    double above, up_to;
  };
  double missing_mm(const SolidSnapshot& carved, double pitch_mm, Sharpness sharpness) const {
    const auto fits = [&](const CutPoint& point, double pitches) {
      const WallProbe probe(*truth_, {pitch_mm, kTrueChordMm}, pitches * pitch_mm, nullptr);
      return !probe.thin_at(point, SurfaceSide::kSolid) &&
             !probe.thin_at(point, SurfaceSide::kVoid);
    };
    CutSurface part;
    for (const CutPoint& point : surface_.points)
      if (fits(point, sharpness.up_to) && !(sharpness.above > 0 && fits(point, sharpness.above)))
        part.points.push_back(point);
    return part.points.empty() ? 0 : measure_missing(carved, part).max_mm;
  }

  SolidSnapshot carve(const Accuracy& a) {
    set(a);
    const Program program = parse_program("p.ngc", job_.program, scene_).value();
    return carve_once(scene_.settings, scene_, program).value().snapshot;
  }

  // Carves like a user, with arcs at the same tolerance. The time is that of the whole program,
  // because looser arcs have fewer motions. The error is the greatest over all offsets.
  Measured measure(const Accuracy& a, double enough_mm = 1e300) {
    set(a);
    const Program program = parse_program("p.ngc", job_.program, scene_).value();
    Measured worst{.us = 1e300};
    for (const Vec3 part : kPlacements) {
      SculptureSettings settings = scene_.settings;
      // The block grows by less than a pitch on three sides, far from the cuts, which moves the
      // rays.
      auto& box = std::get<BoxStock>(settings.stock);
      box.min_mm = box.min_mm - part * a.pitch_mm;
      const auto carved = carve_once(settings, scene_, program).value();
      worst.us = std::min(worst.us, 1e6 * carved.cpu_s);
      worst.from_mesh_mm =
          std::max(worst.from_mesh_mm, measure_surface(carved.snapshot, *truth_, samples_).max_mm);
      worst.error_mm = std::max(
          {worst.error_mm, worst.from_mesh_mm, measure_missing(carved.snapshot, surface_).max_mm});
      if (worst.error_mm > enough_mm) break;
    }
    return worst;
  }

 private:
  void set(const Accuracy& a) {
    scene_.settings.rays = a.rays;
    scene_.settings.pitch_mm = a.pitch_mm;
    scene_.settings.tolerance_mm = a.tolerance_mm;
    scene_.settings.motion = a.motion;
  }

  const Job& job_;
  std::size_t samples_;
  Scene scene_;
  std::optional<TrueSolid> truth_;
  CutSurface surface_;
};

// Compares the choice with the cheapest of the neighboring settings that meets the target. Returns
// the ratio of their costs, or infinity if the choice misses its target.
double search(Bench& bench, const AccuracyChoice& choice, bool turns) {
  const double target = choice.request.target_mm;
  const Accuracy& chosen = choice.accuracy;
  const Measured of_choice = bench.measure(chosen);
  Measured best = of_choice;
  Accuracy best_at = chosen;
  if (of_choice.error_mm > target) best.us = 1e300;
  int tried = 0;
  for (const double looser : {1.0, 4.0}) {
    if (!turns && looser > 1) continue;
    for (double coarser = looser > 1 ? 1.0 : kSearchStep; coarser < 20; coarser *= kSearchStep) {
      const Accuracy a{chosen.rays, chosen.pitch_mm * coarser, chosen.tolerance_mm * looser,
                       chosen.motion};
      const Measured m = bench.measure(a, target);
      ++tried;
      // Coarser settings cannot meet a target missed by this much.
      if (m.error_mm > 1.7 * target) break;
      if (m.error_mm > target || m.us >= best.us) continue;
      best = m;
      best_at = a;
    }
  }
  if (of_choice.error_mm > target) best.us = of_choice.us;
  std::printf(" %6.3g | %7.4g %8.2g %7.4f %s %9.0f | %7.4g %8.2g %-5s %9.0f | %5.2f | %d\n", target,
              chosen.pitch_mm, chosen.tolerance_mm, of_choice.error_mm,
              of_choice.error_mm <= target ? "meets" : "FAILS", of_choice.us, best_at.pitch_mm,
              best_at.tolerance_mm, best_at.motion == MotionModel::kTight ? "tight" : "paper",
              best.us, of_choice.us / best.us, tried);
  std::fflush(stdout);
  return of_choice.error_mm <= target ? of_choice.us / best.us
                                      : std::numeric_limits<double>::infinity();
}

// Programs to which the laws are fitted.
std::vector<Job> fitted_jobs() {
  const std::string ball = R"("shape": "ball", "diameter_mm": 6, "length_mm": 40)";
  const std::string flat = R"("shape": "flat", "diameter_mm": 6, "length_mm": 40)";
  const std::string cone =
      R"("shape": "cone_end", "diameter_mm": 6, "tip_angle_deg": 90, "length_mm": 40)";
  const std::string thin = R"("shape": "flat", "diameter_mm": 2, "length_mm": 40)";
  const std::string standard = R"("shape": "ball", "diameter_mm": 10, "length_mm": 50)";
  return {{"slots, flat 6 mm", flat, "xyz", slots(false, 1)},
          {"slots, ball 6 mm", ball, "xyz", slots(false, 2)},
          {"slots, cone end 6 mm", cone, "xyz", slots(false, 3)},
          {"slots, flat 2 mm", thin, "xyz", slots(false, 4)},
          {"rings, flat 6 mm", flat, "xyz", rings()},
          {"turning slots, flat 6 mm", flat, "tool-vector", slots(true, 5)},
          {"turning slots, ball 6 mm", ball, "tool-vector", slots(true, 6)},
          {"raster, 3-axis, ball 10 mm", standard, "tool-vector", raster(false)},
          {"raster, 5-axis, ball 10 mm", standard, "tool-vector", raster(true)}};
}

// Programs that were not used to fit the laws.
std::vector<Job> other_jobs() {
  const auto tool = [](const std::string& shape) {
    return R"("shape": )" + shape + R"(, "length_mm": 40)";
  };
  return {{"slots, flat 8 mm", tool(R"("flat", "diameter_mm": 8)"), "xyz", slots(false, 11)},
          {"slots, ball 3 mm", tool(R"("ball", "diameter_mm": 3)"), "xyz", slots(false, 12)},
          {"slots, bull-nose 8 r2", tool(R"("bull_nose", "diameter_mm": 8, "corner_radius_mm": 2)"),
           "xyz", slots(false, 13)},
          {"slots, cone end 60 degrees",
           tool(R"("cone_end", "diameter_mm": 6, "tip_angle_deg": 60)"), "xyz", slots(false, 14)},
          {"rings, ball 4 mm", tool(R"("ball", "diameter_mm": 4)"), "xyz", rings()},
          {"turning slots, bull-nose 8 r2",
           tool(R"("bull_nose", "diameter_mm": 8, "corner_radius_mm": 2)"), "tool-vector",
           slots(true, 15)}};
}

// Greatest error over all offsets, in pitches, at a negligible tolerance: from the mesh to the
// solid, and from the solid to the mesh by the sharpness of the solid.
void print_error_law(std::size_t samples) {
  std::printf("greatest surface error / pitch: mesh to solid | solid to mesh where a ball of a ");
  std::printf("pitch fits within 0.27, 0.5, 1 pitch\n%-50s 0.6 %29s 0.3 %29s 0.15\n", "pitch", "",
              "");
  for (const Job& job : fitted_jobs()) {
    Bench bench(job, samples);
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      std::printf("%-28s %-9s", job.name.c_str(), to_string(rays));
      for (const double pitch : {0.6, 0.3, 0.15}) {
        const Accuracy accuracy{rays, pitch, pitch / 50, MotionModel::kTight};
        std::printf("  %6.3f |", bench.measure(accuracy).from_mesh_mm / pitch);
        const SolidSnapshot carved = bench.carve(accuracy);
        for (std::size_t n = 1; n < kSharpness.size(); ++n)
          std::printf(" %6.3f",
                      bench.missing_mm(carved, pitch, {kSharpness[n - 1], kSharpness[n]}) / pitch);
        std::fflush(stdout);
      }
      std::printf("\n");
    }
  }
}

void print_distribution(std::vector<double> ratios) {
  std::ranges::sort(ratios);
  const auto missed = std::ranges::count(ratios, std::numeric_limits<double>::infinity());
  const auto cheap = std::ranges::count_if(ratios, [](double ratio) { return ratio <= 1.5; });
  std::printf(
      "%zu choices: %td miss their target, %td take at most 1.5 times the cheapest; ratios:",
      ratios.size(), missed, cheap);
  for (const double ratio : ratios) std::printf(" %.2f", ratio);
  std::printf("\n");
}

// CPU time, to which the cost law is fitted: the 5-axis raster, the least of three runs.
void print_cost_law() {
  const Job job = fitted_jobs().back();
  Scene scene = scene_of(job, "{}");
  const Program program = parse_program("p.ngc", job.program, scene).value();
  AccuracyUse use{.stock = scene.settings.stock, .tools = {scene.tools.at(1).tool}};
  std::printf("rays      motion  pitch tolerance us/motion predicted sub-motions/motion\n");
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (const MotionModel motion : {MotionModel::kTight, MotionModel::kPaper}) {
      for (const double tolerance : {0.1, 0.01, 0.001, 0.0001}) {
        for (const double pitch : {0.8, 0.4, 0.2, 0.1}) {
          if (motion == MotionModel::kPaper && tolerance < 0.01) continue;
          const Accuracy a{rays, pitch, tolerance, motion};
          scene.settings.rays = rays;
          scene.settings.pitch_mm = pitch;
          scene.settings.tolerance_mm = tolerance;
          scene.settings.motion = motion;
          auto carved = carve_once(scene.settings, scene, program).value();
          for (int more = 0; more < 2; ++more)
            carved.cpu_s =
                std::min(carved.cpu_s, carve_once(scene.settings, scene, program).value().cpu_s);
          const auto motions = double(program.motions.size());
          std::printf("%-9s %-6s %6.3g %9.2g %9.2f %9.2f %18.2f\n", to_string(rays),
                      motion == MotionModel::kTight ? "tight" : "paper", pitch, tolerance,
                      1e6 * carved.cpu_s / motions, predicted_us(a, use),
                      double(carved.sub_motions) / motions);
          std::fflush(stdout);
        }
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "laws") {
    print_error_law(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 10000);
    print_cost_law();
    return 0;
  }
  if (argc > 1 && std::string(argv[1]) == "costs") {
    print_cost_law();
    return 0;
  }
  const std::size_t samples = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 30000;
  std::printf(
      "target |  chosen: pitch, tolerance, greatest error, us | cheapest that meets it: "
      "pitch, tolerance, motion, us | ratio | tried\n");
  std::vector<double> ratios;
  int not_promised = 0;
  for (const Job& job : other_jobs()) {
    std::printf("%s\n", job.name.c_str());
    const bool turns = job.program.find('K') != std::string::npos;
    // Distances to turning motions take longer to compute.
    Bench bench(job, turns ? samples / 4 : samples);
    for (const char* target : {"0.4", "0.15", "0.06"}) {
      if (turns && std::string(target) == "0.06") continue;
      Scene scene = scene_of(job, std::string(R"({"target_mm": )") + target + "}");
      const Program program = parse_program("p.ngc", job.program, scene).value();
      // Chosen as by kerf-carve.
      const std::size_t wall_points = wall_samples(scene, program);
      if (const auto met = WallCheck(scene, program, wall_points).refine(scene); !met) {
        std::printf(" %6s | not promised: %s\n", target, met.error().c_str());
        ++not_promised;
        continue;
      }
      ratios.push_back(search(bench, *scene.accuracy, turns));
    }
  }
  print_distribution(std::move(ratios));
  std::printf("%d more targets were not promised\n", not_promised);
  return 0;
}
