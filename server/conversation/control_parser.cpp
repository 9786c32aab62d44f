// SPDX-License-Identifier: Apache-2.0
// Reads the messages of peers; control_json.cpp writes those of the server.
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "server/conversation/control_json.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

/// Limit of the coordinates of eyes, targets and reaches, and of half the edge of a reach.
constexpr double kCoordinateMaxMm = 1e6;
/// Limit of a rotation vector: more than a turn.
constexpr double kTurnMaxRad = 7;
constexpr double kScaleMax = 1e6;
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

std::expected<Vec3, Rejection> vector_field(const Json& object, const char* field, double low,
                                            double high) {
  const auto found = object.find(field);
  if (found == object.end() || !found->is_array() || found->size() != 3) {
    return std::unexpected(bad_field(field, "must be three numbers"));
  }
  std::array<double, 3> at{};
  for (std::size_t n = 0; n < at.size(); ++n) {
    const auto number = number_of((*found)[n], field, low, high);
    if (!number) return std::unexpected(number.error());
    at[n] = *number;
  }
  return Vec3{at[0], at[1], at[2]};
}

std::expected<Vec3, Rejection> place_field(const Json& object, const char* field) {
  return vector_field(object, field, -kCoordinateMaxMm, kCoordinateMaxMm);
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

/// Reads the budget of a viewer, or nullopt if it is not stated.
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
        std::pair{"returned", &HelloMessage::returned}, std::pair{"reach", &HelloMessage::reach},
        std::pair{"verify", &HelloMessage::verify}}) {
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

std::expected<ControlMessage, Rejection> parse_reach(const Json& object) {
  if (!object.contains("center_mm") && !object.contains("half_mm")) return ReachMessage{};
  const auto center = place_field(object, "center_mm");
  if (!center) return std::unexpected(center.error());
  const auto half = vector_field(object, "half_mm", 0, kCoordinateMaxMm);
  if (!half) return std::unexpected(half.error());
  if (!(half->x > 0 && half->y > 0 && half->z > 0)) {
    return std::unexpected(bad_field("half_mm", "must be greater than zero"));
  }
  DeviceReach reach{.center_mm = *center, .half_mm = *half, .turn_rad = {}};
  if (object.contains("turn_rad")) {
    const auto turn = vector_field(object, "turn_rad", -kTurnMaxRad, kTurnMaxRad);
    if (!turn) return std::unexpected(turn.error());
    reach.turn_rad = *turn;
  }
  if (const auto found = object.find("scale"); found != object.end()) {
    const auto scale = number_of(*found, "scale", 1 / kScaleMax, kScaleMax);
    if (!scale) return std::unexpected(scale.error());
    reach.scale = *scale;
  }
  return ReachMessage{reach};
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
  if (*type == wire::kTypeReach) return parse_reach(object);
  if (*type == wire::kTypeUndo) return ChangeMessage{.undone = true};
  if (*type == wire::kTypeRedo) return ChangeMessage{.undone = false};
  return std::unexpected(
      Rejection{wire::ErrorCode::kBadMessage,
                "field \"type\" must be \"hello\", \"tool\", \"look\", \"seek\", \"camera\", "
                "\"stock\", \"reach\", \"undo\" or \"redo\""});
}

}  // namespace kerf::net
