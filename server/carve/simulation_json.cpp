// SPDX-License-Identifier: Apache-2.0
#include "server/carve/simulation_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "server/formats/machine_kinematics.h"
#include "server/verify/cut_depth.h"

namespace kerf {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kListMax = 100;

Json point(Vec3 p) { return {p.x, p.y, p.z}; }

double share(double part, double whole) { return whole > 0 ? part / whole : 0; }

Json extreme_json(const Program& program, const char* unit, const Extreme& extreme) {
  if (extreme.value <= 0) return nullptr;
  return {{unit, extreme.value},
          {"place", place_of(program, extreme.file, extreme.line)},
          {"tool", extreme.tool},
          {"tip_mm", point(extreme.tip_mm)}};
}

const Extreme& greater(const Extreme& a, const Extreme& b) { return b.value > a.value ? b : a; }

Json tools_json(const Simulation& simulation) {
  const Program& program = simulation.program();
  Json tools = Json::array();
  for (const auto& [id, use] : simulation.tools())
    tools.push_back(
        {{"tool", id},
         {"removed_mm3", use.removed_mm3},
         {"imprint_mm3", use.imprint_mm3},
         {"feed_seconds", use.feed.seconds},
         {"feed_length_mm", use.feed.length_mm},
         {"air_seconds", use.air.seconds},
         {"air_length_mm", use.air.length_mm},
         {"max_engaged_area", extreme_json(program, "mm2", use.engaged_area_mm2)},
         {"max_removal_rate", extreme_json(program, "mm3_per_s", use.removal_rate_mm3_per_s)},
         {"max_force", extreme_json(program, "n", use.force_n)}});
  return tools;
}

Json tool_changes_json(const Program& program, double tool_change_s) {
  Json at = Json::array();
  for (std::size_t i = 0; i < std::min(program.tool_changes.size(), kListMax); ++i) {
    const ToolChange& change = program.tool_changes[i];
    at.push_back({{"tool", change.tool}, {"place", place_of(program, change.file, change.line)}});
  }
  const auto count = program.tool_changes.size();
  return {{"count", count},
          {"seconds_each", tool_change_s},
          {"seconds", tool_change_s * static_cast<double>(count)},
          {"first", at}};
}

void add_contacts(Json& list, const Program& program, const ContactRuns& contacts, const char* with,
                  const char* unit) {
  for (std::size_t i = 0; i < std::min(contacts.runs().size(), kListMax); ++i) {
    const ContactRun& run = contacts.runs()[i];
    list.push_back({{"with", with},
                    {"tool", run.tool},
                    {"from", place_of(program, run.from_file, run.from_line)},
                    {"to", place_of(program, run.to_file, run.to_line)},
                    {"in_rapid", run.rapid},
                    {unit, run.worst},
                    {"tip_mm", point(run.tip_mm)}});
  }
}

// Lists lines with their place and tool; `add` adds the other fields.
Json lines_json(const Program& program, const std::vector<LineVolume>& lines,
                void (*add)(const LineVolume& line, Json& entry)) {
  Json list = Json::array();
  for (const LineVolume& line : lines) {
    if (list.size() >= kListMax) break;
    Json entry{{"place", place_of(program, line.file, line.line)}, {"tool", line.tool}};
    add(line, entry);
    list.push_back(std::move(entry));
  }
  return list;
}

void add_imprint(const LineVolume& line, Json& entry) { entry["imprint_mm3"] = line.mm3; }

void add_rapid(const LineVolume& line, Json& entry) {
  entry["depth_mm"] = line.depth_mm;
  entry["removed_mm3"] = line.mm3;
}

Json misfits_json(const Program& program, const std::optional<Misfits>& misfits) {
  if (!misfits) return nullptr;
  Json list = Json::array();
  for (const Misfit& misfit : misfits->worst) {
    Json place = nullptr;
    Json tool = nullptr;
    if (misfit.motion) {
      const ProgramMotion& motion = program.motions[*misfit.motion];
      place = place_of(program, motion.file, motion.line);
      tool = motion.tool;
    }
    list.push_back({{"depth_mm", misfit.depth_mm},
                    {"place", place},
                    {"tool", tool},
                    {"deepest_mm", point(misfit.deepest_mm)},
                    {"area_mm2", misfit.area_mm2},
                    {"volume_mm3", misfit.volume_mm3}});
  }
  return {{"tolerance_mm", misfits->tolerance_mm}, {"count", misfits->count}, {"worst", list}};
}

// Whether a rapid has cut as deep as the tool's own thickness: more than a film that it takes when
// leaving a surface.
bool plunges(const Simulation& simulation, const LineVolume& line) {
  const double radius = simulation.scene().tools.at(line.tool).tool.radius_mm;
  return line.mm3 > 2 * std::numbers::pi * radius * radius * radius;
}

void warn_of_rapids(const Simulation& simulation, std::vector<std::string>& warnings) {
  const Scene& scene = simulation.scene();
  const double limit_mm = rapid_limit_mm(scene.settings.tolerance_mm);
  const char* stock = scene.stock_assumed ? "the assumed stock" : "material";
  std::size_t count = 0;
  for (const LineVolume& line : simulation.rapid_cuts()) {
    if (line.depth_mm <= limit_mm) continue;
    if (++count > kWarningsMax) return;
    warnings.push_back(place_of(simulation.program(), line.file, line.line) +
                       ": rapid motion through " + stock + ": " + std::to_string(line.depth_mm) +
                       " mm deep, " + std::to_string(line.mm3) + " mm3 removed");
  }
}

void warn_of_imprints(const Simulation& simulation, std::vector<std::string>& warnings) {
  const std::vector<LineVolume>& lines = simulation.imprints();
  for (std::size_t i = 0; i < std::min(lines.size(), kWarningsMax); ++i)
    warnings.push_back(place_of(simulation.program(), lines[i].file, lines[i].line) +
                       ": the tool starts inside the stock: " + std::to_string(lines[i].mm3) +
                       " mm3 removed there without force");
}

// A tool that leans in the wrong direction approaches from inside the stock.
void warn_of_rotary_direction(const Simulation& simulation, std::vector<std::string>& warnings) {
  if (!has_rotary_table(simulation.scene().machine.kinematics)) return;
  const bool through = std::ranges::any_of(
      simulation.rapid_cuts(), [&](const LineVolume& line) { return plunges(simulation, line); });
  if (!through && simulation.imprints().empty() && simulation.stock_contacts().runs().empty())
    return;
  const bool table = simulation.scene().machine.rotary_direction == RotaryDirection::kTable;
  warnings.push_back(simulation.program().name +
                     ": the tool comes from inside the stock: on this machine a positive angle may "
                     "turn the " +
                     (table ? "tool and not the table" : "table and not the tool") +
                     " (machine.rotary_direction of the scene, --rotary)");
}

}  // namespace

std::string simulation_json(const Simulation& simulation, double tool_change_s,
                            const PartFit& fit) {
  const Program& program = simulation.program();
  Extreme area, rate, force;
  for (const auto& [id, use] : simulation.tools()) {
    area = greater(area, use.engaged_area_mm2);
    rate = greater(rate, use.removal_rate_mm3_per_s);
    force = greater(force, use.force_n);
  }
  const Travel& feed = simulation.feed();
  const Travel& air = simulation.air();
  Json collisions = Json::array();
  add_contacts(collisions, program, simulation.stock_contacts(), "stock", "depth_mm");
  add_contacts(collisions, program, simulation.obstacle_contacts(), "obstacle", "push_n");
  const Json json{{"cycle_seconds", simulation.cycle_s(tool_change_s)},
                  {"machine_seconds", simulation.machine_s()},
                  {"feed_seconds", feed.seconds},
                  {"rapid_seconds", simulation.rapid().seconds},
                  {"dwell_seconds", simulation.dwell_s()},
                  {"tool_changes", tool_changes_json(program, tool_change_s)},
                  {"feed_length_mm", feed.length_mm},
                  {"rapid_length_mm", simulation.rapid().length_mm},
                  {"air_cutting",
                   {{"seconds", air.seconds},
                    {"length_mm", air.length_mm},
                    {"share_of_feed_time", share(air.seconds, feed.seconds)},
                    {"share_of_feed_length", share(air.length_mm, feed.length_mm)}}},
                  {"tools", tools_json(simulation)},
                  {"max_engaged_area", extreme_json(program, "mm2", area)},
                  {"max_removal_rate", extreme_json(program, "mm3_per_s", rate)},
                  {"max_force", extreme_json(program, "n", force)},
                  {"collisions", collisions},
                  {"rapids_through_stock", lines_json(program, simulation.rapid_cuts(), add_rapid)},
                  {"starts_inside_stock", lines_json(program, simulation.imprints(), add_imprint)},
                  {"gouges", misfits_json(program, fit.gouges)},
                  {"rests", misfits_json(program, fit.rests)}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void warn_of_simulation(const Simulation& simulation, const PartFit& fit,
                        std::vector<std::string>& warnings) {
  const Program& program = simulation.program();
  warn_of_rapids(simulation, warnings);
  warn_of_imprints(simulation, warnings);
  warn_of_rotary_direction(simulation, warnings);
  warn_of_stock_contacts(simulation.stock_contacts(), program, warnings);
  warn_of_obstacle_contacts(simulation.obstacle_contacts(), program, warnings);
  const auto warn_of_misfits = [&](const std::optional<Misfits>& misfits, const char* event,
                                   const char* then) {
    if (!misfits) return;
    for (std::size_t i = 0; i < std::min(misfits->worst.size(), kWarningsMax); ++i) {
      const Misfit& misfit = misfits->worst[i];
      const ProgramMotion* motion = misfit.motion ? &program.motions[*misfit.motion] : nullptr;
      warnings.push_back(
          (motion != nullptr ? place_of(program, motion->file, motion->line) : program.name) +
          ": " + event + std::to_string(misfit.depth_mm) + then);
    }
  };
  warn_of_misfits(fit.gouges, "gouge into the reference, ", " mm deep");
  warn_of_misfits(fit.rests, "material is left, ",
                  " mm outside the reference; this cut is nearest");
}

}  // namespace kerf
