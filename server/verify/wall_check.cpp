// SPDX-License-Identifier: Apache-2.0
#include "server/verify/wall_check.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "server/formats/accuracy_choice.h"
#include "server/formats/number_text.h"

namespace kerf {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kWallsListedMax = 100;
// Motions evaluated per candidate on average, and at least.
constexpr std::size_t kEffortPerCandidate = 24, kEffortMin = 20000;
constexpr std::size_t kMotionsPerSample = 4, kWallSamplesMin = 1000, kWallSamplesMax = 10000,
                      kMeshSamplesMin = 4000, kTargetFactor = 8;
constexpr int kDigits = 3, kPlaceDigits = 6;
// Reach of computed distances from cuts, in the largest pitch of the search.
constexpr double kReachPitches = 4;

std::string mm(double value) { return significant_text(value, kDigits) + " mm"; }

Json target_json(const WallReport& report) {
  if (!report.target) return nullptr;
  const auto& [target_mm, pitch_mm, complete] = *report.target;
  return {{"target_mm", target_mm},
          {"kept", pitch_mm && *pitch_mm >= report.pitch_mm},
          {"needs_pitch_mm", pitch_mm ? Json(*pitch_mm) : Json(nullptr)},
          {"complete", complete}};
}

// The stock, wider and deeper if it is assumed, because walls at its border do not belong to the
// part.
StockShape searched_stock(const Scene& scene) {
  const auto* box = std::get_if<BoxStock>(&scene.settings.stock);
  if (!scene.stock_assumed || box == nullptr) return scene.settings.stock;
  const Vec3 size = box->max_mm - box->min_mm;
  const double more = std::max({size.x, size.y, size.z});
  return BoxStock{box->min_mm - Vec3{more, more, more}, box->max_mm + Vec3{more, more, 0}};
}

}  // namespace

std::size_t wall_samples(const Scene& scene, const Program& program) {
  const std::size_t samples =
      std::clamp(program.motions.size() / kMotionsPerSample,
                 scene.settings.stock_mesh ? kMeshSamplesMin : kWallSamplesMin, kWallSamplesMax);
  return scene.accuracy ? kTargetFactor * samples : samples;
}

WallCheck::WallCheck(const Scene& scene, const Program& program, std::size_t candidates,
                     const std::stop_token& stop)
    : scene_(scene),
      program_(program),
      effort_(kEffortMin + kEffortPerCandidate * candidates),
      solid_(searched_stock(scene), scene.tools, program.motions,
             kReachPitches * scene.settings.pitch_mm, scene.settings.stock_mesh.get()),
      surface_(sample(candidates, stop)) {}

CutSurface WallCheck::sample(std::size_t candidates, const std::stop_token& stop) const {
  QueryEffort effort{effort_};
  return sample_cut_surface(solid_, candidates, stop, &effort);
}

WallReport WallCheck::find(const std::stop_token& stop) const {
  const SculptureSettings& settings = scene_.settings;
  std::vector<std::uint64_t> lines;
  lines.reserve(program_.motions.size());
  for (const ProgramMotion& motion : program_.motions)
    lines.push_back(std::uint64_t{motion.file} << 32U | motion.line);
  QueryEffort effort{effort_};
  WallReport report{.pitch_mm = settings.pitch_mm, .spacing_mm = surface_.spacing_mm, .walls = {}};
  report.walls = distinct_walls(
      find_thin_walls(solid_, surface_, {settings.pitch_mm, settings.tolerance_mm}, stop, &effort),
      lines, settings.pitch_mm);
  report.complete = !effort.spent();
  return report;
}

std::expected<void, std::string> WallCheck::refine(Scene& scene,
                                                   const std::stop_token& stop) const {
  const SculptureSettings& settings = scene.settings;
  const AccuracyRequest request = scene.accuracy->request;
  const std::string missed = "the target of " + mm(request.target_mm) +
                             " is not met at thin walls, grooves and sharp edges: ";
  const auto [target_mm, pitch, complete] = target_at_walls(stop);
  if (!pitch)
    return std::unexpected(missed + "no pitch above " + mm(settings.pitch_mm * kFinestWallShare) +
                           " keeps them");
  if (*pitch < settings.pitch_mm) {
    if (const auto settled = resolve_accuracy(scene, request, pitch); !settled)
      return std::unexpected(missed + "accuracy." + settled.error().field + " " +
                             settled.error().reason);
  }
  if (settings.pitch_mm > *pitch)
    return std::unexpected(missed + "accuracy.pitch_mm would have to be " + mm(*pitch));
  if (!complete)
    return std::unexpected("the target of " + mm(target_mm) +
                           " may not be met at thin walls, grooves and sharp edges: the search for "
                           "them reached its limit of effort; set accuracy.pitch_mm");
  return {};
}

WallTargetResult WallCheck::target_at_walls(const std::stop_token& stop) const {
  const SculptureSettings& settings = scene_.settings;
  const double target_mm = scene_.accuracy->request.target_mm;
  QueryEffort effort{effort_};
  const auto pitch = pitch_for_walls(
      solid_, surface_,
      {settings.pitch_mm, target_mm - settings.tolerance_mm, settings.tolerance_mm}, stop, &effort);
  return {target_mm, pitch, !effort.spent()};
}

std::string WallCheck::place_text(const ThinWall& wall) const {
  const std::size_t motions = program_.motions.size();
  const auto number = [](double value) { return significant_text(value, kPlaceDigits); };
  const std::string shape = std::string(wall.groove ? ": a groove of " : ": a wall of ") +
                            mm(wall.thickness_mm) + " at X" + number(wall.mm.x) + " Y" +
                            number(wall.mm.y) + " Z" + number(wall.mm.z);
  if (wall.sweep >= motions)
    return (scene_.stock_file.file.empty() ? "the stock" : scene_.stock_file.file) + shape;
  const ProgramMotion& motion = program_.motions[wall.sweep];
  std::string text = place_of(program_, motion.file, motion.line) + shape;
  if (wall.other_sweep >= motions) return text + ", at the border of the stock";
  const ProgramMotion& other = program_.motions[wall.other_sweep];
  if (other.file != motion.file)
    return text + ", cut from the other side in " + place_of(program_, other.file, other.line);
  if (other.line == motion.line) return text;
  return text + ", cut from the other side in line " + std::to_string(other.line);
}

std::vector<std::string> WallCheck::warnings(const WallReport& report) const {
  std::vector<std::string> lines;
  for (const bool grooves : {false, true})
    if (std::string line = warning(report, grooves); !line.empty())
      lines.push_back(std::move(line));
  return lines;
}

std::string WallCheck::warning(const WallReport& report, bool grooves) const {
  const ThinWall* shown = nullptr;
  std::size_t count = 0;
  for (const ThinWall& wall : report.walls) {
    if (wall.groove != grooves) continue;
    ++count;
    if (shown == nullptr || (wall.missing && !shown->missing)) shown = &wall;
  }
  if (shown == nullptr) return {};
  std::string text = place_text(*shown) + ", is " + (grooves ? "narrower" : "thinner") +
                     " than the pitch of " + mm(report.pitch_mm) +
                     (shown->missing ? " and is missing in the result" : " and may be missing") +
                     "; its pitch would have to be below " + mm(shown->thickness_mm);
  if (count > 1)
    text +=
        " (and " + std::to_string(count - 1) + " more such " + (grooves ? "grooves)" : "walls)");
  return text;
}

std::string WallCheck::json(const WallReport& report) const {
  Json walls = Json::array();
  for (const ThinWall& wall : report.walls) {
    if (walls.size() == kWallsListedMax) break;
    const auto place = [&](std::uint32_t sweep) -> Json {
      if (sweep >= program_.motions.size()) return nullptr;
      const ProgramMotion& motion = program_.motions[sweep];
      return place_of(program_, motion.file, motion.line);
    };
    walls.push_back({{"kind", wall.groove ? "groove" : "wall"},
                     {"at_mm", {wall.mm.x, wall.mm.y, wall.mm.z}},
                     {"thickness_mm", wall.thickness_mm},
                     {"place", place(wall.sweep)},
                     {"other_place", place(wall.other_sweep)},
                     {"missing", wall.missing}});
  }
  const Json json{{"pitch_mm", report.pitch_mm},
                  {"sample_spacing_mm", report.spacing_mm},
                  {"count", report.walls.size()},
                  {"missing", std::ranges::count(report.walls, true, &ThinWall::missing)},
                  {"complete", report.complete},
                  {"target", target_json(report)},
                  {"warnings", warnings(report)},
                  {"walls", walls}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace kerf
