// SPDX-License-Identifier: Apache-2.0
#include "server/programs/program_upload.h"

#include <expected>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "server/formats/derived_json.h"
#include "server/formats/program_facts.h"
#include "server/formats/program_survey.h"
#include "server/http/api_services.h"
#include "server/http/number.h"
#include "server/http/responses.h"
#include "server/programs/program_query.h"
#include "server/programs/program_texts.h"
#include "server/session/session.h"
#include "server/targets/target_parts.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

constexpr double kRateMinHz = 1, kRateMaxHz = 2000;

/// Parses `dialect`, the controller of a G-code program.
std::expected<GcodeEnvironment, Error> parse_environment(const ApiRequest& request) {
  GcodeEnvironment environment;
  const std::string* given = request.query_value("dialect");
  if (given == nullptr) return environment;
  const auto dialect = dialect_of(*given);
  if (!dialect)
    return std::unexpected(
        Error{ErrorKind::kInvalid, "bad_dialect", "dialect must be one of " + dialect_names()});
  environment.dialect = *dialect;
  return environment;
}

/// Parses `after` or `queue`: the program that must end first.
std::expected<ProgramId, Error> parse_after(const ApiRequest& request) {
  const std::string* queue = request.query_value("queue");
  const std::string* after = request.query_value("after");
  if (after == nullptr) return queue != nullptr && *queue == "1" ? kAfterNewest : ProgramId{0};
  const auto id = parse_number<ProgramId>(*after);
  if (id && *id != 0 && *id != kAfterNewest) return *id;
  return std::unexpected(
      Error{ErrorKind::kInvalid, "bad_value", "after must be the number of a program"});
}

std::expected<std::optional<double>, Error> parse_limit(const std::string* text) {
  if (text == nullptr) return std::nullopt;
  const auto limit_n = parse_number<double>(*text);
  if (limit_n && *limit_n > 0) return limit_n;
  return std::unexpected(
      Error{ErrorKind::kInvalid, "bad_value", "force_limit_n must be a number above 0"});
}

std::expected<double, Error> parse_tolerance(const std::string* text, double otherwise_mm) {
  if (text == nullptr) return otherwise_mm;
  const auto tolerance_mm = parse_number<double>(*text);
  if (tolerance_mm && *tolerance_mm > 0) return *tolerance_mm;
  return std::unexpected(
      Error{ErrorKind::kInvalid, "bad_value", "target_tolerance_mm must be a number above 0"});
}

std::expected<std::optional<double>, Error> parse_rate(const std::string* text) {
  if (text == nullptr) return std::nullopt;
  const auto rate_hz = parse_number<double>(*text);
  if (rate_hz && *rate_hz >= kRateMinHz && *rate_hz <= kRateMaxHz) return rate_hz;
  return std::unexpected(
      Error{ErrorKind::kInvalid, "bad_rate", "sample_hz must be a number from 1 to 2000"});
}

/// Returns the part `target` on the rays of the session's block; null without that parameter.
std::expected<std::shared_ptr<const GougeReference>, Error> parse_target_part(const ApiCall& call) {
  const ApiRequest& request = call.request;
  const Session& session = *call.session;
  const auto tolerance_mm = parse_tolerance(request.query_value("target_tolerance_mm"),
                                            session.scene()->settings.tolerance_mm);
  if (!tolerance_mm) return std::unexpected(tolerance_mm.error());
  const std::string* name = request.query_value("target");
  if (name == nullptr) return nullptr;
  auto& parts = call.services.stores.get<TargetParts>();
  auto part = parts.model(session.id(), *name, session.grid());
  if (!part) return std::unexpected(unknown_target(*name));
  return std::make_shared<const GougeReference>(*name, std::move(part), *tolerance_mm);
}

}  // namespace

ApiResponse start_program(const ApiCall& call) {
  const ApiRequest& request = call.request;
  Session& session = *call.session;
  const std::string* speed_text = request.query_value("speed");
  const char* usual = speed_text != nullptr ? "feed" : "fast";
  const auto pace = parse_pace(value_or(request.query_value("pace"), usual));
  if (!pace) return error_response(pace.error());
  const auto speed = parse_speed(value_or(speed_text, "1"));
  if (!speed) return error_response(speed.error());
  const auto after = parse_after(request);
  if (!after) return error_response(after.error());
  const auto limit_n = parse_limit(request.query_value("force_limit_n"));
  if (!limit_n) return error_response(limit_n.error());
  const auto asked_hz = parse_rate(request.query_value("sample_hz"));
  if (!asked_hz) return error_response(asked_hz.error());
  const std::optional<double> rate_hz = *asked_hz;
  const auto target = parse_target_part(call);
  if (!target) return error_response(target.error());
  const std::string name = value_or(request.query_value("name"), "program.ngc");
  if (const auto fault = program_name_fault(name)) return error_response(*fault);
  const auto environment = parse_environment(request);
  if (!environment) return error_response(environment.error());
  auto memory = take_memory(call.services, reading_memory_bytes(request.body));
  auto text_memory =
      take_memory(call.services, request.body.size() + kPathPointsMax * sizeof(PathPoint));
  if (!memory || !text_memory) return out_of_memory();
  const auto kept =
      std::make_shared<ProgramText>(request.body, ProgramPath{}, *std::move(text_memory));
  ProgramSurvey survey(kPathPointsMax, rate_hz, dynamics_of(session.scene()->machine),
                       request.stop);
  auto read = read_program(name, kept->text, *session.scene(), *environment, survey);
  if (!read) return program_failure(read.error());
  if (rate_hz && survey.duration_s() * *rate_hz >= kSamplesMax) {
    return error_response(413, "too_large", "the program has too many motions at this sample_hz");
  }
  kept->path = survey.path();
  kept->memory.reduce(kept->text.size() + kept->path.points.size() * sizeof(PathPoint));
  ProgramJob job(*std::move(read), survey, rate_hz);
  ProgramOptions order{.pace = *pace, .speed = *speed, .after = *after};
  order.force_limit_n = *limit_n;
  order.target = *target;
  order.text = kept;
  order.memory = *std::move(memory);
  auto started = run_and_wait(session.executor(), [&] {
    session.reserve(call.services.access.regions(session.id()));
    return session.programs().start(std::move(job), std::move(order), call.caller);
  });
  if (!started) return rejection_response(started.error(), 400);
  auto response = json_response(202, status_text(session.id(), *started, call.caller));
  response.headers.emplace_back(
      "Location", "/v1/sessions/" + session.id() + "/programs/" + std::to_string(started->id));
  return response;
}

ApiResponse describe_program(const ApiCall& call) {
  const std::string name = value_or(call.request.query_value("name"), "program.ngc");
  if (const auto fault = program_name_fault(name)) return error_response(*fault);
  const auto environment = parse_environment(call.request);
  if (!environment) return error_response(environment.error());
  const std::string& text = call.request.body;
  const auto derived = derive_scene(name, text, *environment, {}, call.request.stop);
  if (derived) return json_response(200, derived_json(*derived));
  const auto facts = program_facts(name, text, *environment, call.request.stop);
  return facts ? error_response(400, "bad_program", derived.error())
               : program_failure(facts.error());
}

}  // namespace kerf::net
