// SPDX-License-Identifier: Apache-2.0
#include "server/programs/program_query.h"

#include <nlohmann/json.hpp>

#include "server/http/number.h"
#include "server/http/responses.h"
#include "server/rights/rights.h"
#include "server/session/program_json.h"
#include "server/wire/limits.h"

namespace kerf::net {

using Json = nlohmann::json;

std::string value_or(const std::string* value, const char* otherwise) {
  return value != nullptr ? *value : otherwise;
}

std::expected<ProgramPace, Error> parse_pace(const std::string& text) {
  if (text == "feed") return ProgramPace::kFeed;
  if (text == "fast") return ProgramPace::kFast;
  return std::unexpected(
      Error{ErrorKind::kInvalid, "bad_pace", "pace must be \"feed\" or \"fast\""});
}

std::expected<double, Error> parse_speed(const std::string& text) {
  const auto speed = parse_number<double>(text);
  if (speed && *speed >= kProgramSpeedMin && *speed <= kProgramSpeedMax) return *speed;
  return std::unexpected(Error{ErrorKind::kInvalid, "bad_speed",
                               "speed must be a number from 0.1 to 20, times feed rate"});
}

ApiResponse program_failure(const ProgramError& error) {
  const Json detail = {{"code", "bad_program"},
                       {"reason", to_string(error)},
                       {"line", error.line},
                       {"word", error.word}};
  const Json json = {{"error", detail}};
  return json_response(400, json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::optional<Error> program_name_fault(const std::string& name) {
  if (name.size() <= wire::kMaxNameBytes && name.find_first_of("/\\\n\r") == std::string::npos) {
    return std::nullopt;
  }
  return Error{ErrorKind::kInvalid, "bad_name",
               "name must have at most 64 bytes, without slashes and line breaks"};
}

std::string status_text(const std::string& session, const ProgramStatus& program,
                        const Caller& caller) {
  Json json = Json::parse(program_json(program));
  json["may_control"] = may_change(caller, program.author, Action::kRunPrograms);
  json["url"] = "/v1/sessions/" + session + "/programs/" + std::to_string(program.id);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace kerf::net
