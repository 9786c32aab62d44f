// SPDX-License-Identifier: Apache-2.0
// The routes that carve uploaded programs.
#include <cmath>
#include <nlohmann/json.hpp>

#include "server/http/api.h"
#include "server/http/number.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

/// At feed rate a program is sampled, so that viewers see the tool move. The value is the rate of
/// the paper's force loop.
constexpr double kFeedRateHz = 100;
constexpr double kRateMinHz = 1, kRateMaxHz = 2000;
/// The most motions of one program: about two days at 100 Hz.
constexpr std::size_t kMotionsMax = 20'000'000;

Json status_json(const Session& session, const ProgramStatus& status) {
  Json json = {{"id", status.id},
               {"url", "/v1/sessions/" + session.id() + "/programs/" + std::to_string(status.id)},
               {"participant", status.participant},
               {"name", status.name},
               {"pace", status.pace == ProgramPace::kFeed ? "feed" : "fast"},
               {"state", to_string(status.state)},
               {"waiting", status.waiting},
               {"motions_done", status.motions_done},
               {"motions", status.motions},
               {"progress", status.motions == 0 ? 1.0
                                                : static_cast<double>(status.motions_done) /
                                                      static_cast<double>(status.motions)},
               {"line", status.line},
               {"programmed_s", status.programmed_s},
               {"removed_volume_mm3", status.removed_mm3},
               {"warnings", status.warnings}};
  if (!status.error.empty()) json["error"] = status.error;
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

ApiResponse program_failure(const ProgramError& error) {
  Json detail = {{"code", "bad_program"},
                 {"reason", to_string(error)},
                 {"line", error.line},
                 {"word", error.word}};
  return json_response(400, text({{"error", detail}}));
}

/// The program whose number the path holds.
std::optional<ProgramStatus> find_program(const ApiCall& call) {
  const auto id = parse_number<ProgramId>(call.captured);
  if (!id) return std::nullopt;
  return run_and_wait(call.session->executor(), [&] { return call.session->program(*id); });
}

ApiResponse unknown_program(const ApiCall& call) {
  return error_response(404, "unknown_program", "the session has no program " + call.captured);
}

}  // namespace

ApiResponse Api::list_programs(const ApiCall& call) {
  Session& session = *call.session;
  Json list = Json::array();
  for (const auto& status : run_and_wait(session.executor(), [&] { return session.programs(); })) {
    list.push_back(status_json(session, status));
  }
  return json_response(200, text({{"programs", list}}));
}

ApiResponse Api::program_status(const ApiCall& call) {
  const auto status = find_program(call);
  if (!status) return unknown_program(call);
  return json_response(200, text(status_json(*call.session, *status)));
}

ApiResponse Api::cancel_program(const ApiCall& call) {
  const auto status = find_program(call);
  if (!status) return unknown_program(call);
  Session& session = *call.session;
  const bool cancelled =
      run_and_wait(session.executor(), [&, id = status->id] { return session.cancel_program(id); });
  if (!cancelled) {
    return error_response(409, "not_running", "program " + call.captured + " is not running");
  }
  return json_response(200, text(status_json(session, *find_program(call))));
}

ApiResponse Api::start_program(const ApiCall& call) {
  const ApiRequest& request = call.request;
  Session& session = *call.session;
  const std::string pace_text = value_or(request.query_value("pace"), "feed");
  if (pace_text != "feed" && pace_text != "fast") {
    return error_response(400, "bad_pace", "pace must be \"feed\" or \"fast\"");
  }
  const ProgramPace pace = pace_text == "feed" ? ProgramPace::kFeed : ProgramPace::kFast;
  std::optional<double> rate_hz;
  if (const std::string* given = request.query_value("rate")) {
    rate_hz = parse_rate(*given);
    if (!rate_hz) return error_response(400, "bad_rate", "rate must be a number from 1 to 2000");
  } else if (pace == ProgramPace::kFeed) {
    rate_hz = kFeedRateHz;
  }
  const std::string name = value_or(request.query_value("name"), "program.ngc");
  if (name.size() > wire::kMaxNameBytes || name.find_first_of("/\\\n\r") != std::string::npos) {
    return error_response(400, "bad_name",
                          "name must have at most 64 bytes, without slashes and line breaks");
  }
  auto program = parse_program(name, request.body, session.scene());
  if (!program) return program_failure(program.error());
  if (rate_hz) {
    double duration_s = 0;
    for (const ProgramMotion& motion : program->motions) duration_s += motion.duration_s;
    if (!(duration_s * *rate_hz < static_cast<double>(kMotionsMax))) {
      return error_response(413, "too_large", "the program has too many motions at this rate");
    }
    auto sampled =
        programs_.take(static_cast<std::size_t>(duration_s * *rate_hz) * sizeof(ProgramMotion));
    if (!sampled) return out_of_memory();
    program = sample_program(*program, *rate_hz);
  }
  program->motions.shrink_to_fit();
  auto memory = programs_.take(program->motions.size() * sizeof(ProgramMotion));
  if (!memory) return out_of_memory();
  auto started = run_and_wait(session.executor(), [&] {
    session.reserve(access_.regions(session.id()));
    return session.start_program(*std::move(program), pace, *std::move(memory), call.caller);
  });
  if (!started) {
    const unsigned status = started.error().code == wire::ErrorCode::kBusy ? 503 : 400;
    return error_response(status, wire::to_string(started.error().code), started.error().reason);
  }
  auto response = json_response(202, text(status_json(session, *started)));
  response.headers.emplace_back(
      "Location", "/v1/sessions/" + session.id() + "/programs/" + std::to_string(started->id));
  return response;
}

}  // namespace kerf::net
