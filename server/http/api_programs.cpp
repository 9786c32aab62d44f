// SPDX-License-Identifier: Apache-2.0
// The routes that carve uploaded programs.
#include <cmath>
#include <nlohmann/json.hpp>

#include "server/formats/derived_json.h"
#include "server/formats/program_facts.h"
#include "server/formats/program_survey.h"
#include "server/http/api.h"
#include "server/http/number.h"
#include "server/rights/rights.h"
#include "server/session/program_json.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

constexpr double kRateMinHz = 1, kRateMaxHz = 2000;

Json status_json(const Session& session, const ProgramStatus& status, const Caller& caller) {
  Json json = Json::parse(program_json(status));
  json["may_control"] = may_change(caller, status.author, Action::kRunPrograms);
  json["url"] = "/v1/sessions/" + session.id() + "/programs/" + std::to_string(status.id);
  return json;
}

std::string text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string value_or(const std::string* value, const char* otherwise) {
  return value != nullptr ? *value : otherwise;
}

std::optional<double> parse_rate(const std::string& text) {
  const auto rate_hz = parse_number<double>(text);
  return rate_hz && *rate_hz >= kRateMinHz && *rate_hz <= kRateMaxHz ? rate_hz : std::nullopt;
}

/// Returns an error unless the caller may control the program: its own, or any as an owner.
std::optional<ApiResponse> control_failure(const ApiCall& call, const ProgramStatus& status) {
  if (may_change(call.caller, status.author, Action::kRunPrograms)) return std::nullopt;
  return error_response(403, wire::to_string(wire::ErrorCode::kNotAllowed),
                        "program " + call.captured +
                            " was started by somebody else: an owner may control those of others");
}

ApiResponse has_ended(const ApiCall& call) {
  return error_response(409, "not_running", "program " + call.captured + " is not running");
}

std::expected<ProgramPace, ApiResponse> parse_pace(const std::string& text) {
  if (text == "feed") return ProgramPace::kFeed;
  if (text == "fast") return ProgramPace::kFast;
  return std::unexpected(error_response(400, "bad_pace", "pace must be \"feed\" or \"fast\""));
}

std::expected<double, ApiResponse> parse_speed(const std::string& text) {
  const auto speed = parse_number<double>(text);
  if (speed && *speed >= kProgramSpeedMin && *speed <= kProgramSpeedMax) return *speed;
  return std::unexpected(
      error_response(400, "bad_speed", "speed must be a number from 0.1 to 20, times feed rate"));
}

std::expected<ProgramOrder, ApiResponse> parse_order(const std::string& text) {
  if (text == "pause") return ProgramOrder::kPause;
  if (text == "resume") return ProgramOrder::kResume;
  if (text == "step") return ProgramOrder::kStep;
  return std::unexpected(error_response(
      400, "bad_order", "do must be \"pause\", \"resume\" or \"step\", which carves one block"));
}

/// Parses `dialect`, the controller of a G-code program.
std::expected<GcodeEnvironment, ApiResponse> parse_environment(const ApiRequest& request) {
  GcodeEnvironment environment;
  const std::string* given = request.query_value("dialect");
  if (given == nullptr) return environment;
  const auto dialect = dialect_of(*given);
  if (!dialect)
    return std::unexpected(
        error_response(400, "bad_dialect", "dialect must be one of " + dialect_names()));
  environment.dialect = *dialect;
  return environment;
}

/// Parses `after` or `queue`: the program that must end first.
std::expected<ProgramId, ApiResponse> parse_after(const ApiRequest& request) {
  const std::string* queue = request.query_value("queue");
  const std::string* after = request.query_value("after");
  if (after == nullptr) return queue != nullptr && *queue == "1" ? kAfterNewest : ProgramId{0};
  const auto id = parse_number<ProgramId>(*after);
  if (id && *id != 0 && *id != kAfterNewest) return *id;
  return std::unexpected(error_response(400, "bad_value", "after must be the number of a program"));
}

std::expected<std::optional<double>, ApiResponse> parse_limit(const std::string* text) {
  if (text == nullptr) return std::nullopt;
  const auto limit_n = parse_number<double>(*text);
  if (limit_n && *limit_n > 0) return limit_n;
  return std::unexpected(
      error_response(400, "bad_value", "force_limit_n must be a number above 0"));
}

std::expected<double, ApiResponse> parse_tolerance(const std::string* text, double otherwise_mm) {
  if (text == nullptr) return otherwise_mm;
  const auto tolerance_mm = parse_number<double>(*text);
  if (tolerance_mm && *tolerance_mm > 0) return *tolerance_mm;
  return std::unexpected(
      error_response(400, "bad_value", "target_tolerance_mm must be a number above 0"));
}

/// Finds the program whose number is in the path.
std::optional<ProgramStatus> find_program(const ApiCall& call) {
  const auto id = parse_number<ProgramId>(call.captured);
  if (!id) return std::nullopt;
  return run_and_wait(call.session->executor(), [&] { return call.session->program(*id); });
}

ApiResponse unknown_program(const ApiCall& call) {
  return error_response(404, "unknown_program", "the session has no program " + call.captured);
}

}  // namespace

ApiResponse program_failure(const ProgramError& error) {
  Json detail = {{"code", "bad_program"},
                 {"reason", to_string(error)},
                 {"line", error.line},
                 {"word", error.word}};
  return json_response(400, text({{"error", detail}}));
}

std::optional<ApiResponse> program_name_failure(const std::string& name) {
  if (name.size() <= wire::kMaxNameBytes && name.find_first_of("/\\\n\r") == std::string::npos) {
    return std::nullopt;
  }
  return error_response(400, "bad_name",
                        "name must have at most 64 bytes, without slashes and line breaks");
}

ApiResponse Api::list_programs(const ApiCall& call) {
  Session& session = *call.session;
  Json list = Json::array();
  for (const auto& status : run_and_wait(session.executor(), [&] { return session.programs(); })) {
    list.push_back(status_json(session, status, call.caller));
  }
  return json_response(200, text({{"programs", list}}));
}

ApiResponse Api::program_status(const ApiCall& call) {
  const auto status = find_program(call);
  if (!status) return unknown_program(call);
  return json_response(200, text(status_json(*call.session, *status, call.caller)));
}

ApiResponse Api::cancel_program(const ApiCall& call) {
  const auto status = find_program(call);
  if (!status) return unknown_program(call);
  if (auto failure = control_failure(call, *status)) return *std::move(failure);
  Session& session = *call.session;
  const bool cancelled =
      run_and_wait(session.executor(), [&, id = status->id] { return session.cancel_program(id); });
  if (!cancelled) return has_ended(call);
  return json_response(200, text(status_json(session, *find_program(call), call.caller)));
}

ApiResponse Api::change_program(const ApiCall& call) {
  const auto status = find_program(call);
  if (!status) return unknown_program(call);
  if (auto failure = control_failure(call, *status)) return *std::move(failure);
  const ApiRequest& request = call.request;
  std::optional<ProgramOrder> order;
  if (const std::string* given = request.query_value("do")) {
    const auto parsed = parse_order(*given);
    if (!parsed) return parsed.error();
    order = *parsed;
  }
  const std::string* pace_text = request.query_value("pace");
  const std::string* speed_text = request.query_value("speed");
  // A speed implies feed rate.
  const auto pace = pace_text != nullptr || speed_text == nullptr
                        ? parse_pace(value_or(pace_text, "fast"))
                        : ProgramPace::kFeed;
  if (!pace) return pace.error();
  const auto speed = parse_speed(value_or(speed_text, "1"));
  if (!speed) return speed.error();
  const bool has_pace = pace_text != nullptr || speed_text != nullptr;
  if (!order && !has_pace) {
    return error_response(400, "bad_value", "nothing to change: give do, pace or speed");
  }
  // A muted person's program may be paused and cancelled but not continued.
  if (call.caller.is_muted && order != ProgramOrder::kPause) {
    return rejection_response(muted_rejection(), 400);
  }
  Session& session = *call.session;
  const bool done = run_and_wait(session.executor(), [&, id = status->id] {
    return (!has_pace || session.set_program_pace(id, *pace, *speed)) &&
           (!order || session.order_program(id, *order));
  });
  if (!done) return has_ended(call);
  return json_response(200, text(status_json(session, *find_program(call), call.caller)));
}

std::optional<MemoryBudget::Share> Api::program_memory(std::size_t bytes) {
  if (auto share = programs_.take(bytes)) return share;
  for (const auto& session : registry_.list()) {
    run_and_wait(session->executor(), [&] { return session->drop_ended_texts(), 0; });
  }
  return programs_.take(bytes);
}

/// Returns the part `target` on the rays of the session's block; null without that parameter.
std::expected<std::shared_ptr<const GougeReference>, ApiResponse> Api::parse_target_part(
    const ApiCall& call) {
  const ApiRequest& request = call.request;
  const Session& session = *call.session;
  const auto tolerance_mm = parse_tolerance(request.query_value("target_tolerance_mm"),
                                            session.scene().settings.tolerance_mm);
  if (!tolerance_mm) return std::unexpected(tolerance_mm.error());
  const std::string* name = request.query_value("target");
  if (name == nullptr) return nullptr;
  auto part = targets_.model(session.id(), *name, session.grid());
  if (!part) return std::unexpected(unknown_target(*name));
  return std::make_shared<const GougeReference>(*name, std::move(part), *tolerance_mm);
}

ApiResponse Api::start_program(const ApiCall& call) {
  const ApiRequest& request = call.request;
  Session& session = *call.session;
  const std::string* speed_text = request.query_value("speed");
  const char* usual = speed_text != nullptr ? "feed" : "fast";
  const auto pace = parse_pace(value_or(request.query_value("pace"), usual));
  if (!pace) return pace.error();
  const auto speed = parse_speed(value_or(speed_text, "1"));
  if (!speed) return speed.error();
  const auto after = parse_after(request);
  if (!after) return after.error();
  const auto limit_n = parse_limit(request.query_value("force_limit_n"));
  if (!limit_n) return limit_n.error();
  std::optional<double> rate_hz;
  if (const std::string* given = request.query_value("sample_hz")) {
    rate_hz = parse_rate(*given);
    if (!rate_hz)
      return error_response(400, "bad_rate", "sample_hz must be a number from 1 to 2000");
  }
  const auto target = parse_target_part(call);
  if (!target) return target.error();
  const std::string name = value_or(request.query_value("name"), "program.ngc");
  if (auto failure = program_name_failure(name)) return *std::move(failure);
  const auto environment = parse_environment(request);
  if (!environment) return environment.error();
  auto memory = program_memory(reading_memory_bytes(request.body));
  auto text_memory = program_memory(request.body.size() + kPathPointsMax * sizeof(PathPoint));
  if (!memory || !text_memory) return out_of_memory();
  const auto kept =
      std::make_shared<ProgramText>(request.body, ProgramPath{}, *std::move(text_memory));
  ProgramSurvey survey(kPathPointsMax, rate_hz, dynamics_of(session.scene().machine), request.stop);
  auto read = read_program(name, kept->text, session.scene(), *environment, survey);
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
    session.reserve(access_.regions(session.id()));
    return session.start_program(std::move(job), std::move(order), call.caller);
  });
  if (!started) return rejection_response(started.error(), 400);
  auto response = json_response(202, text(status_json(session, *started, call.caller)));
  response.headers.emplace_back(
      "Location", "/v1/sessions/" + session.id() + "/programs/" + std::to_string(started->id));
  return response;
}

ApiResponse Api::describe_program(const ApiCall& call) {
  const std::string name = value_or(call.request.query_value("name"), "program.ngc");
  if (auto failure = program_name_failure(name)) return *std::move(failure);
  const auto environment = parse_environment(call.request);
  if (!environment) return environment.error();
  const std::string& text = call.request.body;
  const auto derived = derive_scene(name, text, *environment, {}, call.request.stop);
  if (derived) return json_response(200, derived_json(*derived));
  const auto facts = program_facts(name, text, *environment, call.request.stop);
  return facts ? error_response(400, "bad_program", derived.error())
               : program_failure(facts.error());
}

}  // namespace kerf::net
