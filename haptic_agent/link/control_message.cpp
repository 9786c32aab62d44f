// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/link/control_message.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "haptic_agent/device/ranges.h"
#include "haptic_agent/device/text_fields.h"
#include "server/wire/control.h"

namespace kerf::agent {
namespace {

using nlohmann::json;

Vec3 vec3(const json& numbers) {
  return {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>()};
}

// The functions here throw json::exception if a field is missing or has the wrong type.

StockBox stock_box(const json& stock) {
  if (stock.at("shape") == "cylinder") {
    const double x = stock.at("center_mm").at(0);
    const double y = stock.at("center_mm").at(1);
    const double radius = stock.at("radius_mm");
    return {.min_mm = {x - radius, y - radius, stock.at("min_z_mm")},
            .max_mm = {x + radius, y + radius, stock.at("max_z_mm")}};
  }
  return {.min_mm = vec3(stock.at("min_mm")), .max_mm = vec3(stock.at("max_mm"))};
}

/// An unknown law is rendered as kSpecificEnergy, whose force does not grow with speed.
CutLaw cut_law(const json& force) {
  const std::string law = force.value("law", "");
  for (const CutLaw known : {CutLaw::kMechanistic, CutLaw::kRemovalRate}) {
    if (law == to_string(known)) return known;
  }
  return CutLaw::kSpecificEnergy;
}

/// Returns nullopt if the offer is missing or invalid. All frames then use the WebSocket.
std::optional<datagram::Offer> read_offer(const json& message) {
  const json offer = message.value("udp", json::object());
  if (!offer.is_object()) return std::nullopt;
  const auto text = [&](const char* name) {
    const auto field = offer.find(name);
    return field != offer.end() && field->is_string() ? field->get<std::string>() : std::string();
  };
  const auto number = [&](const char* name, std::uint64_t most) -> std::uint64_t {
    const auto field = offer.find(name);
    if (field == offer.end() || !field->is_number_unsigned()) return most + 1;
    return field->get<std::uint64_t>();
  };
  const std::uint64_t port = number("port", UINT16_MAX);
  const std::uint64_t connection = number("connection", UINT32_MAX);
  const auto to_server = datagram::key_from_text(text("key_to_server"));
  const auto to_agent = datagram::key_from_text(text("key_to_agent"));
  if (text("cipher") != datagram::kCipherName || !to_server || !to_agent || port == 0 ||
      port > UINT16_MAX || connection > UINT32_MAX) {
    return std::nullopt;
  }
  return datagram::Offer{static_cast<std::uint16_t>(port), static_cast<std::uint32_t>(connection),
                         *to_server, *to_agent};
}

/// Returns nullopt if the field is missing or invalid. The agent then works without it.
std::optional<Resume> read_resume(const json& message) {
  const json resume = message.value("resume", json::object());
  if (!resume.is_object()) return std::nullopt;
  const auto token = resume.find("token");
  const auto sequence = resume.find("agent_sequence");
  const auto resumed = resume.find("resumed");
  if (token == resume.end() || !token->is_string() || sequence == resume.end() ||
      !sequence->is_number_unsigned() || resumed == resume.end() || !resumed->is_boolean()) {
    return std::nullopt;
  }
  return Resume{token->get<std::string>(), sequence->get<std::uint64_t>(), resumed->get<bool>()};
}

/// Greatest number of other servers that are tried.
constexpr std::size_t kOthersMax = 16;

std::vector<std::string> read_others(const json& message) {
  std::vector<std::string> others;
  const json list = message.value("others", json::array());
  if (!list.is_array()) return others;
  for (const json& other : list) {
    if (other.is_string() && others.size() < kOthersMax) others.push_back(other);
  }
  return others;
}

std::string without_secrets(json message) {
  message.erase("resume");
  message.erase("udp");
  return message.dump();
}

Welcome read_welcome(const json& message) {
  const json force = message.value("force", json::object());
  Welcome welcome{.session = message.at("session"),
                  .participant = message.at("participant"),
                  .epoch = message.at("epoch"),
                  .color = message.value("color", ""),
                  .pivot_mm = message.at("pivot_mm"),
                  .law = cut_law(force),
                  .specific_force_n_per_mm2 = force.value("specific_force_n_per_mm2", 0.0),
                  .drr_n_s_per_mm3 = force.value("drr_n_s_per_mm3", 0.0),
                  .stock = stock_box(message.at("stock")),
                  .tool_ids = {},
                  .udp = read_offer(message),
                  .resume = read_resume(message),
                  .takes_reach = message.contains("reach") && message["reach"] == true,
                  .others = read_others(message),
                  .text = without_secrets(message)};
  for (const json& tool : message.at("tools")) welcome.tool_ids.push_back(tool.at("id"));
  return welcome;
}

/// Returns the fault of a number of the welcome. Empty if there is none.
std::string fault_of(const Welcome& welcome) {
  constexpr double kCoefficientMax = 1e9;
  std::ostringstream reason;
  const auto check = [&reason](const char* field, double value, double least, double most) {
    // The negated comparison also rejects NaN.
    if (!reason.str().empty() || (value >= least && value <= most)) return;
    reason << field << " must be from " << least << " to " << most << ", not " << value;
  };
  check("pivot_mm", welcome.pivot_mm, 0, kPivotMaxMm);
  check("force.specific_force_n_per_mm2", welcome.specific_force_n_per_mm2, 0, kCoefficientMax);
  check("force.drr_n_s_per_mm3", welcome.drr_n_s_per_mm3, 0, kCoefficientMax);
  const Vec3 &low = welcome.stock.min_mm, &high = welcome.stock.max_mm;
  for (const auto& [from, to] :
       {std::pair{low.x, high.x}, std::pair{low.y, high.y}, std::pair{low.z, high.z}}) {
    check("the stock's lowest coordinate", from, -kPlaceMaxMm, kPlaceMaxMm);
    check("the stock's highest coordinate", to, from, kPlaceMaxMm);
  }
  return reason.str();
}

ControlMessage read_message(const json& message) {
  const std::string type = message.at("type");
  if (type == wire::kTypeWelcome) return read_welcome(message);
  if (type == wire::kTypeError) {
    return ServerError{.code = message.at("code"),
                       .reason = message.value("reason", ""),
                       .fatal = message.value("fatal", false)};
  }
  if (type == wire::kTypeBye) {
    return Bye{.reason = message.value("reason", ""), .redirect = message.value("redirect", "")};
  }
  if (type == wire::kTypeStroke) {
    const bool undone = message.at("undone");
    if (!message.contains("code")) return StrokeChanged{undone, message.at("stroke")};
    return ChangeRefused{undone, message.at("code"), message.value("reason", "")};
  }
  if (type == wire::kTypeServers) return ServersChanged{read_others(message)};
  return OtherMessage{};
}

}  // namespace

std::string hello_text(const Hello& hello) {
  json message = {
      {"type", wire::kTypeHello}, {"name", hello.name}, {"feel", true}, {"durable", true}};
  if (!hello.color.empty()) message["color"] = hello.color;
  if (hello.stock) message["stock"] = message["returned"] = message["intent"] = true;
  if (hello.feel_of != 0) message["feel_of"] = hello.feel_of;
  if (hello.tool_id != 0) message["tool"] = hello.tool_id;
  if (hello.udp) message["udp"] = true;
  if (hello.reach) message["reach"] = true;
  if (!hello.resume.empty()) message["resume"] = hello.resume;
  return message.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string tool_text(std::uint32_t tool_id) {
  return json{{"type", wire::kTypeTool}, {"tool", tool_id}}.dump();
}

std::string change_text(bool undone) {
  return json{{"type", undone ? wire::kTypeUndo : wire::kTypeRedo}}.dump();
}

std::string reach_text(const Reach& reach) {
  const auto numbers = [](Vec3 v) { return json{v.x, v.y, v.z}; };
  return json{{"type", wire::kTypeReach},
              {"center_mm", numbers(reach.center_mm)},
              {"half_mm", numbers(reach.half_mm)},
              {"turn_rad", numbers(reach.turn_rad)},
              {"scale", reach.scale}}
      .dump();
}

std::string stock_text() { return json{{"type", wire::kTypeStock}}.dump(); }

std::expected<ControlMessage, ControlError> parse_control(std::string_view text) {
  try {
    ControlMessage message = read_message(json::parse(text));
    if (const auto* welcome = std::get_if<Welcome>(&message)) {
      if (std::string reason = fault_of(*welcome); !reason.empty()) {
        return std::unexpected(ControlError{ControlFault::kOutOfRange, std::move(reason)});
      }
    }
    return message;
  } catch (const json::exception& error) {
    return std::unexpected(ControlError{ControlFault::kMalformed, error.what()});
  }
}

std::string reason_of_body(std::string_view body) {
  constexpr std::size_t kMaxBytes = 200;
  constexpr bool kThrows = false;
  if (const json message = json::parse(body, nullptr, kThrows); message.is_object()) {
    const json error = message.value("error", json());
    const json reason = error.is_object() ? error.value("reason", json()) : error;
    return reason.is_string() ? std::string(shortened(reason.get<std::string>(), kMaxBytes))
                              : std::string{};
  }
  const std::size_t begin = std::min(body.find_first_not_of(" \r\n\t"), body.size());
  body.remove_prefix(begin);
  if (body.starts_with('<') || body.starts_with('[') || body.starts_with('{')) return {};
  return std::string(shortened(body.substr(0, body.find_first_of("\r\n")), kMaxBytes));
}

}  // namespace kerf::agent
