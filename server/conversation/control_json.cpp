// SPDX-License-Identifier: Apache-2.0
#include "server/conversation/control_json.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "kernel/dexel/tile_index.h"
#include "server/formats/guide_json.h"
#include "server/rights/rights.h"
#include "server/session/hash_text.h"
#include "server/session/program_json.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

Json place_json(Vec3 place) { return {place.x, place.y, place.z}; }

Json reach_json(const DeviceReach& reach) {
  return {{"center_mm", place_json(reach.center_mm)},
          {"half_mm", place_json(reach.half_mm)},
          {"turn_rad", place_json(reach.turn_rad)},
          {"scale", reach.scale}};
}

Json participants_json(const std::vector<Participant>& participants) {
  Json list = Json::array();
  for (const Participant& participant : participants) {
    Json entry = {{"participant", participant.id},
                  {"name", participant.name},
                  {"color", participant.color},
                  {"kind", to_string(participant.kind)}};
    if (participant.tool != 0) entry["tool"] = participant.tool;
    if (participant.role != Role::kAdministrator) entry["role"] = to_string(participant.role);
    if (participant.is_muted) entry["muted"] = true;
    if (const auto& reach = participant.reach) entry["reach"] = reach_json(*reach);
    list.push_back(std::move(entry));
  }
  return list;
}

Json welcome(const Session& session, const Participant& self) {
  const std::shared_ptr<const Scene> shared = session.scene();
  const Scene& scene = *shared;
  Json json = {{"type", wire::kTypeWelcome},
               {"session", session.id()},
               {"participant", self.id},
               {"epoch", session.epoch()},
               {"color", self.color},
               {"pitch_mm", scene.settings.pitch_mm},
               {"pivot_mm", scene.settings.force.pivot_mm},
               {"force", Json::parse(force_json(scene))},
               {"stock", Json::parse(stock_json(scene))},
               {"tools", Json::parse(tools_json(scene))}};
  if (const auto others = session.other_servers(); !others.empty()) json["others"] = others;
  if (self.role == Role::kAdministrator) return json;
  json["role"] = to_string(self.role);
  json["may"] = allowed_actions(self.role);
  return json;
}

Json udp_json(const datagram::Offer& offer) {
  return {{"port", offer.port},
          {"connection", offer.connection},
          {"cipher", datagram::kCipherName},
          {"key_to_server", datagram::to_text(offer.to_server)},
          {"key_to_agent", datagram::to_text(offer.to_agent)}};
}

std::string text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string agent_welcome(const Session& session, const Admission& admission,
                          const SessionLimits& limits, const datagram::Offer* udp, bool reach) {
  Json json = welcome(session, admission.participant);
  if (!admission.token.empty()) {
    json["resume"] = {{"token", admission.token},
                      {"resumed", admission.resumed},
                      {"agent_sequence", admission.agent_sequence}};
  }
  const std::shared_ptr<const Scene> scene = session.scene();
  json["accuracy"] = Json::parse(accuracy_json(*scene));
  if (!scene->guides.empty())
    json["guides"] = Json::parse(guides_json(scene->guides, GuideFiles::kExpanded));
  json["rate_hz"] = wire::kMotionRateHz;
  json["limits"] = {
      {"samples_per_message", wire::kMaxSamplesPerMotion},
      {"speed_mm_per_s", admission.participant.role == Role::kGuest ? limits.guest_speed_mm_per_s
                                                                    : limits.speed_mm_per_s},
      {"samples_per_s", limits.samples_per_s},
      {"frame_bytes", wire::kMaxClientFrameBytes}};
  if (udp != nullptr) json["udp"] = udp_json(*udp);
  if (reach) json["reach"] = true;
  return text(json);
}

std::string viewer_welcome(const Session& session, const Participant& self, const Roster& roster,
                           std::uint32_t budget, std::optional<std::uint64_t> meshes) {
  Json json = welcome(session, self);
  const DexelGrid& grid = session.grid();
  const std::shared_ptr<const Scene> scene = session.scene();
  if (!scene->name.empty()) json["name"] = scene->name;
  json["participants"] = participants_json(roster.listed);
  json["viewers"] = roster.viewers;
  json["grid"] = {{"origin_mm", {grid.origin_mm.x, grid.origin_mm.y, grid.origin_mm.z}},
                  {"columns", {grid.columns_x, grid.columns_y}},
                  {"tile", kTileSide}};
  if (budget > 0) json["budget"] = budget;
  if (meshes) json["meshes"] = *meshes;
  return text(json);
}

std::string participants_message(const Roster& roster) {
  return text({{"type", wire::kTypeParticipants},
               {"participants", participants_json(roster.listed)},
               {"viewers", roster.viewers}});
}

std::string carvers_message(const std::vector<Participant>& carvers) {
  return text({{"type", wire::kTypeParticipants}, {"participants", participants_json(carvers)}});
}

std::string servers_message(const std::vector<std::string>& others) {
  return text({{"type", wire::kTypeServers}, {"others", others}});
}

std::string change_message(const RosterChange& change) {
  Json json = {{"type", wire::kTypeParticipantsChanged}, {"viewers", change.viewers}};
  if (!change.changed.empty()) json["changed"] = participants_json(change.changed);
  if (!change.left.empty()) json["left"] = change.left;
  return text(json);
}

std::string state_message(std::uint64_t motions, double removed_mm3, std::uint64_t hash,
                          bool settled, std::string_view paused,
                          const std::optional<PastPlace>& past) {
  Json json = {{"type", wire::kTypeState},
               {"motions", motions},
               {"removed_volume_mm3", removed_mm3},
               {"state_hash", hash_text(hash)},
               {"settled", settled}};
  if (!paused.empty()) json["paused"] = paused;
  if (past) {
    json["at"] = {{"record", past->record}, {"time_ms", past->time_ms}, {"rate", past->rate}};
  }
  return text(json);
}

std::string programs_message(const std::vector<ProgramGlance>& programs) {
  Json list = Json::array();
  for (const ProgramGlance& program : programs) list.push_back(Json::parse(program_json(program)));
  return text({{"type", wire::kTypePrograms}, {"programs", list}});
}

std::string cameras_message(const std::vector<ShownCamera>& cameras) {
  Json list = Json::array();
  for (const auto& [participant, name, color, camera] : cameras) {
    list.push_back({{"participant", participant},
                    {"name", name},
                    {"color", color},
                    {"eye_mm", place_json(camera.eye_mm)},
                    {"target_mm", place_json(camera.target_mm)},
                    {"parallel", camera.is_parallel}});
  }
  return text({{"type", wire::kTypeCameras}, {"cameras", std::move(list)}});
}

std::string error_message(const Rejection& rejection, bool fatal) {
  return text({{"type", wire::kTypeError},
               {"code", wire::to_string(rejection.code)},
               {"reason", rejection.reason},
               {"fatal", fatal}});
}

std::string stroke_message(bool undone, const std::expected<StrokesChanged, Rejection>& changed) {
  Json message = {{"type", wire::kTypeStroke}, {"undone", undone}};
  if (!changed) {
    message["code"] = wire::to_string(changed.error().code);
    message["reason"] = changed.error().reason;
    return text(message);
  }
  message["stroke"] = changed->strokes.front();
  message["sequence"] = changed->sequence;
  message["returned_mm3"] = changed->returned_mm3;
  if (changed->pending) message["pending"] = *changed->pending;
  return text(message);
}

std::string bye_message(std::string_view reason, std::string_view redirect) {
  Json message = {{"type", wire::kTypeBye}, {"reason", reason}};
  if (!redirect.empty()) message["redirect"] = redirect;
  return text(message);
}

}  // namespace kerf::net
