// SPDX-License-Identifier: Apache-2.0
#include "server/conversation/control_json.h"

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "kernel/dexel/tile_index.h"
#include "server/formats/guide_json.h"
#include "server/rights/rights.h"
#include "server/session/hash_text.h"
#include "server/session/pin_json.h"
#include "server/session/program_json.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

constexpr double kEyeMaxMm = 1e6;
constexpr const char* kMustBeBool = "must be true or false";

Rejection bad_field(const char* field, const std::string& rule) {
  return {wire::ErrorCode::kBadMessage, std::string("field \"") + field + "\" " + rule};
}

std::expected<std::string, Rejection> text_field(const Json& object, const char* field) {
  const auto found = object.find(field);
  if (found == object.end()) return std::string();
  if (!found->is_string()) return std::unexpected(bad_field(field, "must be a string"));
  return found->get<std::string>();
}

std::expected<ToolId, Rejection> tool_field(const Json& object, bool required) {
  const auto found = object.find("tool");
  if (found == object.end()) {
    if (required) return std::unexpected(bad_field("tool", "is missing"));
    return 0;
  }
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() > 0xFFFFFFFFU) {
    return std::unexpected(bad_field("tool", "must be a tool number"));
  }
  return found->get<ToolId>();
}

std::expected<double, Rejection> number_of(const Json& value, const char* field, double low,
                                           double high) {
  if (!value.is_number()) return std::unexpected(bad_field(field, "must be a number"));
  const double number = value.get<double>();
  if (!(number >= low && number <= high)) {
    return std::unexpected(bad_field(field, "is out of range"));
  }
  return number;
}

std::expected<Vec3, Rejection> place_field(const Json& object, const char* field) {
  const auto found = object.find(field);
  if (found == object.end() || !found->is_array() || found->size() != 3) {
    return std::unexpected(bad_field(field, "must be three numbers"));
  }
  std::array<double, 3> at{};
  for (std::size_t n = 0; n < at.size(); ++n) {
    const auto number = number_of((*found)[n], field, -kEyeMaxMm, kEyeMaxMm);
    if (!number) return std::unexpected(number.error());
    at[n] = *number;
  }
  return Vec3{at[0], at[1], at[2]};
}

std::expected<ViewerLook, Rejection> look_of(const Json& object) {
  ViewerLook look;
  const auto eye = place_field(object, "eye_mm");
  if (!eye) return std::unexpected(eye.error());
  look.eye_mm = *eye;
  const auto error = object.find("error_rad");
  if (error == object.end()) return std::unexpected(bad_field("error_rad", "is missing"));
  const auto angle = number_of(*error, "error_rad", 0, 1);
  if (!angle) return std::unexpected(angle.error());
  look.error_rad = *angle;
  return look;
}

/// Reads the look of a viewer's hello: an object, or true if a look message follows.
std::expected<void, Rejection> read_look(const Json& object, HelloMessage& hello) {
  const auto found = object.find("look");
  if (found == object.end()) return {};
  if (found->is_boolean()) {
    hello.look_follows = found->get<bool>();
    return {};
  }
  if (!found->is_object()) {
    return std::unexpected(bad_field("look", "must be true, false or an object"));
  }
  const auto look = look_of(*found);
  if (!look) return std::unexpected(look.error());
  hello.look = *look;
  return {};
}

/// Reads the budget of a viewer; nothing if it is not stated.
std::expected<std::optional<std::uint32_t>, Rejection> budget_of(const Json& object) {
  const auto found = object.find("budget");
  if (found == object.end()) return std::nullopt;
  const auto budget = found->is_number_unsigned() ? found->get<std::uint64_t>() : 1;
  if (budget != 0 && (budget < kBudgetMin || budget > kBudgetMax)) {
    return std::unexpected(bad_field(
        "budget", "must be 0 (none) or a whole number from " + std::to_string(kBudgetMin) + " to " +
                      std::to_string(kBudgetMax) + " bytes per second"));
  }
  return static_cast<std::uint32_t>(budget);
}

std::expected<ControlMessage, Rejection> parse_look(const Json& object) {
  const auto look = look_of(object);
  if (!look) return std::unexpected(look.error());
  const auto budget = budget_of(object);
  if (!budget) return std::unexpected(budget.error());
  return LookMessage{*look, *budget};
}

std::expected<ControlMessage, Rejection> parse_hello(const Json& object) {
  HelloMessage hello;
  auto name = text_field(object, "name");
  if (!name) return std::unexpected(name.error());
  hello.name = *std::move(name);
  auto color = text_field(object, "color");
  if (!color) return std::unexpected(color.error());
  hello.color = *std::move(color);
  const auto tool = tool_field(object, false);
  if (!tool) return std::unexpected(tool.error());
  hello.tool = *tool;
  for (const auto& [key, field] :
       {std::pair{"feel", &HelloMessage::feel}, std::pair{"stock", &HelloMessage::stock},
        std::pair{"changes", &HelloMessage::changes}, std::pair{"durable", &HelloMessage::durable},
        std::pair{"udp", &HelloMessage::udp}, std::pair{"repeat", &HelloMessage::repeat},
        std::pair{"intent", &HelloMessage::intent}, std::pair{"whole", &HelloMessage::whole},
        std::pair{"returned", &HelloMessage::returned}}) {
    const auto found = object.find(key);
    if (found == object.end()) continue;
    if (!found->is_boolean()) return std::unexpected(bad_field(key, kMustBeBool));
    hello.*field = found->get<bool>();
  }
  if (const auto look = read_look(object, hello); !look) return std::unexpected(look.error());
  const auto budget = budget_of(object);
  if (!budget) return std::unexpected(budget.error());
  hello.budget = budget->value_or(0);
  auto resume = text_field(object, "resume");
  if (!resume) return std::unexpected(resume.error());
  hello.resume = *std::move(resume);
  if (const auto other = object.find("feel_of"); other != object.end()) {
    if (!other->is_number_unsigned() || other->get<std::uint64_t>() > UINT32_MAX) {
      return std::unexpected(bad_field("feel_of", "must be a participant number"));
    }
    hello.feel_of = other->get<ParticipantId>();
  }
  return hello;
}

std::expected<ControlMessage, Rejection> parse_seek(const Json& object) {
  SeekMessage seek;
  if (const auto at = object.find("at"); at != object.end()) {
    seek.is_live = *at == "live";
    if (at->is_number_unsigned()) seek.record = at->get<std::uint64_t>();
    if (!seek.is_live && !seek.record) {
      return std::unexpected(bad_field("at", "must be the number of a record or \"live\""));
    }
  }
  if (const auto found = object.find("rate"); found != object.end()) {
    const auto rate = number_of(*found, "rate", 0, kRateMax);
    if (!rate) return std::unexpected(rate.error());
    if (*rate > 0 && *rate < kRateMin) return std::unexpected(bad_field("rate", "is out of range"));
    seek.rate = *rate;
  }
  return seek;
}

std::expected<ControlMessage, Rejection> parse_camera(const Json& object) {
  if (!object.contains("eye_mm") && !object.contains("target_mm")) return CameraMessage{};
  ViewerCamera camera;
  const auto eye = place_field(object, "eye_mm");
  if (!eye) return std::unexpected(eye.error());
  const auto target = place_field(object, "target_mm");
  if (!target) return std::unexpected(target.error());
  camera.eye_mm = *eye;
  camera.target_mm = *target;
  if (const auto found = object.find("parallel"); found != object.end()) {
    if (!found->is_boolean()) return std::unexpected(bad_field("parallel", kMustBeBool));
    camera.is_parallel = found->get<bool>();
  }
  return CameraMessage{camera};
}

Json place_json(Vec3 place) { return {place.x, place.y, place.z}; }

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
    list.push_back(std::move(entry));
  }
  return list;
}

Json welcome(const Session& session, const Participant& self) {
  const Scene& scene = session.scene();
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

std::expected<ControlMessage, Rejection> parse_control(std::string_view frame) {
  const Json object = Json::parse(frame, nullptr, false);
  if (object.is_discarded() || !object.is_object()) {
    return std::unexpected(
        Rejection{wire::ErrorCode::kBadJson, "a text frame must be a JSON object"});
  }
  const auto type = text_field(object, "type");
  if (!type) return std::unexpected(type.error());
  if (*type == wire::kTypeHello) return parse_hello(object);
  if (*type == wire::kTypeTool) {
    const auto tool = tool_field(object, true);
    if (!tool) return std::unexpected(tool.error());
    return ToolMessage{*tool};
  }
  if (*type == wire::kTypeLook) return parse_look(object);
  if (*type == wire::kTypeSeek) return parse_seek(object);
  if (*type == wire::kTypeCamera) return parse_camera(object);
  if (*type == wire::kTypeStock) return StockMessage{};
  if (*type == wire::kTypeUndo) return ChangeMessage{.undone = true};
  if (*type == wire::kTypeRedo) return ChangeMessage{.undone = false};
  return std::unexpected(
      Rejection{wire::ErrorCode::kBadMessage,
                "field \"type\" must be \"hello\", \"tool\", \"look\", \"seek\", \"camera\", "
                "\"stock\", \"undo\" or \"redo\""});
}

std::string agent_welcome(const Session& session, const Admission& admission,
                          const SessionLimits& limits, const datagram::Offer* udp) {
  Json json = welcome(session, admission.participant);
  if (!admission.token.empty()) {
    json["resume"] = {{"token", admission.token},
                      {"resumed", admission.resumed},
                      {"agent_sequence", admission.agent_sequence}};
  }
  json["accuracy"] = Json::parse(accuracy_json(session.scene()));
  if (const auto& guides = session.scene().guides; !guides.empty())
    json["guides"] = Json::parse(guides_json(guides, GuideFiles::kExpanded));
  json["rate_hz"] = wire::kMotionRateHz;
  json["limits"] = {
      {"samples_per_message", wire::kMaxSamplesPerMotion},
      {"speed_mm_per_s", admission.participant.role == Role::kGuest ? limits.guest_speed_mm_per_s
                                                                    : limits.speed_mm_per_s},
      {"samples_per_s", limits.samples_per_s},
      {"frame_bytes", wire::kMaxClientFrameBytes}};
  if (udp != nullptr) json["udp"] = udp_json(*udp);
  return text(json);
}

std::string viewer_welcome(const Session& session, const Participant& self, const Roster& roster,
                           std::uint32_t budget) {
  Json json = welcome(session, self);
  const DexelGrid& grid = session.grid();
  if (!session.scene().name.empty()) json["name"] = session.scene().name;
  json["participants"] = participants_json(roster.listed);
  json["viewers"] = roster.viewers;
  json["grid"] = {{"origin_mm", {grid.origin_mm.x, grid.origin_mm.y, grid.origin_mm.z}},
                  {"columns", {grid.columns_x, grid.columns_y}},
                  {"tile", kTileSide}};
  if (budget > 0) json["budget"] = budget;
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

std::string pins_message(const std::vector<Pin>& pins) {
  Json list = Json::array();
  for (const Pin& pin : pins) list.push_back(Json::parse(pin_json(pin)));
  return text({{"type", wire::kTypePins}, {"pins", std::move(list)}});
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
