// SPDX-License-Identifier: Apache-2.0
#include "server/session/program_json.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "server/formats/number_text.h"
#include "server/verify/cut_depth.h"

namespace kerf {
namespace {

using Json = nlohmann::json;

const char* unit_of(AlarmKind kind) {
  switch (kind) {
    case AlarmKind::kRapid:
    case AlarmKind::kShank:
    case AlarmKind::kGouge:
      return "mm";
    default:
      return "N";
  }
}

/// Explains the limit of an alarm.
std::string reason_of(AlarmKind kind) {
  switch (kind) {
    case AlarmKind::kRapid:
      return "a rapid cut deeper into the stock than " + exact_text(kRapidDepthMm) +
             " mm and the scene's tolerance";
    case AlarmKind::kShank:
      return "shank or holder entered the stock by more than the scene's tolerance";
    case AlarmKind::kObstacle:
      return "an obstacle pushed the tool";
    case AlarmKind::kForce:
      return "the mean cutting force of a motion was above force_limit_n";
    case AlarmKind::kGouge:
      return "a motion cut deeper below the target part than target_tolerance_mm";
  }
  return "";
}

Json glance_json(const ProgramGlance& program) {
  const bool is_at_feed = program.pace == ProgramPace::kFeed;
  Json json = {{"id", program.id},
               {"participant", program.participant},
               {"name", program.name},
               {"pace", is_at_feed ? "feed" : "fast"},
               {"state", to_string(program.state)},
               {"waiting", program.waiting},
               {"motions_done", program.motions_done},
               {"motions", program.motions},
               {"progress", program.motions == 0 ? 1.0
                                                 : static_cast<double>(program.motions_done) /
                                                       static_cast<double>(program.motions)},
               {"line", program.line},
               {"tool", program.tool},
               {"feed_mm_per_min", program.feed_mm_per_min},
               {"programmed_s", program.programmed_s},
               {"elapsed_s", program.elapsed_s},
               {"remaining_s", std::max(0.0, program.programmed_s - program.elapsed_s)},
               {"removed_volume_mm3", program.removed_mm3},
               {"alarm_count", program.alarm_count}};
  if (is_at_feed) json["speed"] = program.speed;
  if (program.state == ProgramState::kQueued) json["after"] = program.after;
  if (!program.error.empty()) json["error"] = program.error;
  return json;
}

std::string text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string program_json(const ProgramGlance& program) { return text(glance_json(program)); }

std::optional<ProgramGlance> parse_program_glance(std::string_view text) {
  constexpr std::array kStates = {ProgramState::kQueued,    ProgramState::kRunning,
                                  ProgramState::kPaused,    ProgramState::kFinished,
                                  ProgramState::kCancelled, ProgramState::kFailed};
  try {
    const Json json = Json::parse(text);
    ProgramGlance program;
    json.at("id").get_to(program.id);
    json.at("participant").get_to(program.participant);
    json.at("name").get_to(program.name);
    program.pace = json.at("pace") == "feed" ? ProgramPace::kFeed : ProgramPace::kFast;
    program.speed = json.value("speed", 1.0);
    const auto state = std::ranges::find_if(
        kStates, [&](ProgramState one) { return json.at("state") == to_string(one); });
    if (state == kStates.end()) return std::nullopt;
    program.state = *state;
    program.after = json.value("after", ProgramId{0});
    json.at("waiting").get_to(program.waiting);
    json.at("motions_done").get_to(program.motions_done);
    json.at("motions").get_to(program.motions);
    json.at("line").get_to(program.line);
    json.at("tool").get_to(program.tool);
    json.at("feed_mm_per_min").get_to(program.feed_mm_per_min);
    json.at("programmed_s").get_to(program.programmed_s);
    json.at("elapsed_s").get_to(program.elapsed_s);
    json.at("removed_volume_mm3").get_to(program.removed_mm3);
    json.at("alarm_count").get_to(program.alarm_count);
    program.error = json.value("error", "");
    return program;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

std::string program_json(const ProgramStatus& program) {
  Json json = glance_json(program);
  json["tools"] = program.tools;
  json["read_as"] = program.read_as;
  if (program.machine_s > 0) json["machine_s"] = program.machine_s;
  json["warnings"] = program.warnings;
  if (!program.target.empty()) {
    json["target"] = program.target;
    json["target_tolerance_mm"] = program.target_tolerance_mm;
  }
  json["alarms"] = Json::array();
  for (const ProgramAlarm& alarm : program.alarms) {
    const Vec3 tip = alarm.tip_mm;
    json["alarms"].push_back({{"kind", to_string(alarm.kind)},
                              {"from_line", alarm.from_line},
                              {"to_line", alarm.to_line},
                              {"tool", alarm.tool},
                              {"amount", alarm.amount},
                              {"limit", alarm.limit},
                              {"removed_mm3", alarm.removed_mm3},
                              {"unit", unit_of(alarm.kind)},
                              {"reason", reason_of(alarm.kind)},
                              {"tip_mm", {tip.x, tip.y, tip.z}}});
    if (alarm.kind != AlarmKind::kGouge) continue;
    const Vec3 at = alarm.at_mm;
    json["alarms"].back()["at_mm"] = {at.x, at.y, at.z};
  }
  return text(json);
}

}  // namespace kerf
