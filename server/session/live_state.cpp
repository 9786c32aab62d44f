// SPDX-License-Identifier: Apache-2.0
#include "server/session/live_state.h"

#include <cstring>
#include <nlohmann/json.hpp>
#include <variant>

#include "server/session/program_json.h"
#include "server/wire/codec.h"

namespace kerf {
namespace {

using Json = nlohmann::json;

Json participant_json(const Participant& participant) {
  return {{"id", participant.id},
          {"is_program", participant.kind == ParticipantKind::kProgram},
          {"name", participant.name},
          {"color", participant.color},
          {"tool", participant.tool},
          {"role", std::string(to_string(participant.role))},
          {"is_muted", participant.is_muted}};
}

Participant read_participant(const Json& json) {
  Participant participant;
  json.at("id").get_to(participant.id);
  participant.kind =
      json.at("is_program").get<bool>() ? ParticipantKind::kProgram : ParticipantKind::kAgent;
  json.at("name").get_to(participant.name);
  json.at("color").get_to(participant.color);
  json.at("tool").get_to(participant.tool);
  participant.role = parse_role(json.at("role").get<std::string>()).value_or(Role::kWatcher);
  json.at("is_muted").get_to(participant.is_muted);
  return participant;
}

LiveState read_lists(const Json& json) {
  LiveState state;
  for (const Json& one : json.at("carvers")) state.carvers.push_back(read_participant(one));
  for (const Json& one : json.at("programs")) {
    if (auto program = parse_program_glance(one.dump())) {
      state.programs.push_back(*std::move(program));
    }
  }
  json.at("paused").get_to(state.paused);
  json.at("viewers").get_to(state.viewers);
  return state;
}

}  // namespace

std::vector<std::byte> encode_live(const LiveState& state) {
  Json json = {{"paused", state.paused},
               {"viewers", state.viewers},
               {"carvers", Json::array()},
               {"programs", Json::array()}};
  for (const Participant& carver : state.carvers) {
    json["carvers"].push_back(participant_json(carver));
  }
  for (const ProgramGlance& program : state.programs) {
    json["programs"].push_back(Json::parse(program_json(program)));
  }
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  const auto size = static_cast<std::uint32_t>(text.size());
  std::vector<std::byte> bytes(sizeof size + size + wire::encoded_bytes(state.tools));
  std::memcpy(bytes.data(), &size, sizeof size);
  std::memcpy(bytes.data() + sizeof size, text.data(), size);
  wire::encode({}, state.tools, std::span(bytes).subspan(sizeof size + size));
  return bytes;
}

std::optional<LiveState> decode_live(std::span<const std::byte> bytes) {
  std::uint32_t size = 0;
  if (bytes.size() < sizeof size) return std::nullopt;
  std::memcpy(&size, bytes.data(), sizeof size);
  bytes = bytes.subspan(sizeof size);
  if (size > bytes.size()) return std::nullopt;
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  const auto message = wire::decode(bytes.subspan(size));
  const auto* tools = message ? std::get_if<wire::ToolStates>(&message->body) : nullptr;
  if (tools == nullptr) return std::nullopt;
  try {
    LiveState state = read_lists(Json::parse(text, text + size));
    state.tools = *tools;
    return state;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace kerf
