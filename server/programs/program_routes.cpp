// SPDX-License-Identifier: Apache-2.0
#include "server/programs/program_routes.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "server/http/number.h"
#include "server/http/responses.h"
#include "server/http/routes.h"
#include "server/programs/program_price.h"
#include "server/programs/program_query.h"
#include "server/programs/program_store.h"
#include "server/programs/program_texts.h"
#include "server/programs/program_upload.h"
#include "server/rights/rights.h"
#include "server/session/session.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

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

std::expected<ProgramOrder, Error> parse_order(const std::string& text) {
  if (text == "pause") return ProgramOrder::kPause;
  if (text == "resume") return ProgramOrder::kResume;
  if (text == "step") return ProgramOrder::kStep;
  return std::unexpected(
      Error{ErrorKind::kInvalid, "bad_order",
            "do must be \"pause\", \"resume\" or \"step\", which carves one block"});
}

/// Finds the program whose number is in the path.
std::optional<ProgramStatus> find_program(const ApiCall& call) {
  const auto id = parse_number<ProgramId>(call.captured);
  if (!id) return std::nullopt;
  return run_and_wait(call.session->executor(),
                      [&] { return call.session->programs().status(*id); });
}

ApiResponse unknown_program(const ApiCall& call) {
  return error_response(404, "unknown_program", "the session has no program " + call.captured);
}

ApiResponse status_response(const ApiCall& call, const ProgramStatus& program) {
  return json_response(200, status_text(call.session->id(), program, call.caller));
}

ApiResponse list_programs(const ApiCall& call) {
  Session& session = *call.session;
  Json list = Json::array();
  for (const auto& status :
       run_and_wait(session.executor(), [&] { return session.programs().list(); })) {
    list.push_back(Json::parse(status_text(session.id(), status, call.caller)));
  }
  const Json json = {{"programs", list}};
  return json_response(200, json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

ApiResponse program_status(const ApiCall& call) {
  const auto status = find_program(call);
  if (!status) return unknown_program(call);
  return status_response(call, *status);
}

ApiResponse cancel_program(const ApiCall& call) {
  const auto status = find_program(call);
  if (!status) return unknown_program(call);
  if (auto failure = control_failure(call, *status)) return *std::move(failure);
  Session& session = *call.session;
  const bool cancelled = run_and_wait(
      session.executor(), [&, id = status->id] { return session.programs().cancel(id); });
  if (!cancelled) return has_ended(call);
  return status_response(call, *find_program(call));
}

ApiResponse change_program(const ApiCall& call) {
  const auto status = find_program(call);
  if (!status) return unknown_program(call);
  if (auto failure = control_failure(call, *status)) return *std::move(failure);
  const ApiRequest& request = call.request;
  std::optional<ProgramOrder> order;
  if (const std::string* given = request.query_value("do")) {
    const auto parsed = parse_order(*given);
    if (!parsed) return error_response(parsed.error());
    order = *parsed;
  }
  const std::string* pace_text = request.query_value("pace");
  const std::string* speed_text = request.query_value("speed");
  // A speed implies feed rate.
  const auto pace = pace_text != nullptr || speed_text == nullptr
                        ? parse_pace(value_or(pace_text, "fast"))
                        : ProgramPace::kFeed;
  if (!pace) return error_response(pace.error());
  const auto speed = parse_speed(value_or(speed_text, "1"));
  if (!speed) return error_response(speed.error());
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
    return (!has_pace || session.programs().set_pace(id, *pace, *speed)) &&
           (!order || session.programs().order(id, *order));
  });
  if (!done) return has_ended(call);
  return status_response(call, *find_program(call));
}

constexpr Route kRoutes[] = {
    {.pattern = "/v1/sessions/{id}/programs",
     .answer = &list_programs,
     .runs = Runs::kSession,
     .action = Action::kWatch,
     .at_owner = true},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/programs",
     .query = "pace, speed, name, sample_hz, dialect, after, queue=1, force_limit_n, target, "
              "target_tolerance_mm",
     .answer = &start_program,
     .body_bytes_max = kFileBytesMax,
     .runs = Runs::kRead,
     .action = Action::kRunPrograms},
    {.pattern = "/v1/sessions/{id}/programs/{n}",
     .answer = &program_status,
     .runs = Runs::kSession,
     .action = Action::kWatch,
     .at_owner = true},
    {.methods = "PATCH",
     .pattern = "/v1/sessions/{id}/programs/{n}",
     .query = "do, pace, speed",
     .answer = &change_program,
     .runs = Runs::kSession,
     .action = Action::kRunPrograms},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/programs/{n}",
     .answer = &cancel_program,
     .runs = Runs::kSession,
     .action = Action::kRunPrograms},
    {.pattern = "/v1/sessions/{id}/programs/{n}/source",
     .answer = &program_source,
     .runs = Runs::kSession,
     .action = Action::kWatch,
     .at_owner = true},
    {.pattern = "/v1/sessions/{id}/programs/{n}/path",
     .query = "points",
     .answer = &program_path,
     .runs = Runs::kSession,
     .action = Action::kWatch,
     .at_owner = true},
    {.methods = "POST",
     .pattern = "/v1/programs",
     .query = "name, dialect",
     .answer = &describe_program,
     .body_bytes_max = kFileBytesMax,
     .runs = Runs::kRead,
     .action = Action::kAdminister},
    {.methods = "POST",
     .pattern = "/v1/prices",
     .query = "name",
     .answer = &price_program,
     .body_bytes_max = kFileBytesMax,
     .runs = Runs::kRead,
     .action = Action::kAdminister},
};

}  // namespace

HttpMatter http_programs() { return {.routes = kRoutes, .make_store = &ProgramStore::make}; }

}  // namespace kerf::net
