// SPDX-License-Identifier: Apache-2.0
// The part of the HTTP interface that carves uploaded programs.
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "server/http/api.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

/// At feed rate a program is sampled so that viewers see it move; the value is what the paper's
/// force loop ran at.
constexpr double kFeedRateHz = 100;
constexpr double kRateMinHz = 1, kRateMaxHz = 2000;
/// Motions that one program may have: about two days of 100 Hz.
constexpr std::size_t kMotionsMax = 20'000'000;

Json status_json(const Session& session, const ProgramStatus& status) {
  Json json = {{"id", status.id},
               {"url", "/v1/sessions/" + session.id() + "/programs/" + std::to_string(status.id)},
               {"participant", status.participant},
               {"name", status.name},
               {"pace", status.pace == ProgramPace::kFeed ? "feed" : "fast"},
               {"state", to_string(status.state)},
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

ApiResponse json_response(unsigned status, const Json& json) {
  ApiResponse response;
  response.status = status;
  response.body = json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  return response;
}

std::optional<std::string> query(const ApiRequest& request, const std::string& name) {
  const auto found = request.query.find(name);
  if (found == request.query.end()) return std::nullopt;
  return found->second;
}

std::optional<double> parse_rate(const std::string& text) {
  double rate_hz = 0;
  const auto end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, rate_hz);
  if (parsed.ec != std::errc() || parsed.ptr != end) return std::nullopt;
  if (!(rate_hz >= kRateMinHz && rate_hz <= kRateMaxHz)) return std::nullopt;
  return rate_hz;
}

ApiResponse program_failure(const ProgramError& error) {
  Json detail = {{"code", "bad_program"},
                 {"reason", to_string(error)},
                 {"line", error.line},
                 {"word", error.word}};
  return json_response(400, {{"error", detail}});
}

}  // namespace

ApiResponse Api::programs(const ApiRequest& request, const SessionPtr& session) {
  if (request.path.size() == 4) {
    if (request.method == "POST") return start_program(request, session);
    Json list = Json::array();
    for (const auto& status :
         run_and_wait(session->executor(), [&] { return session->programs(); })) {
      list.push_back(status_json(*session, status));
    }
    return json_response(200, {{"programs", list}});
  }
  ProgramId id = 0;
  const std::string& text = request.path[4];
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), id);
  const auto status = parsed.ec == std::errc() && parsed.ptr == text.data() + text.size()
                          ? run_and_wait(session->executor(), [&] { return session->program(id); })
                          : std::nullopt;
  if (!status || request.path.size() > 5) {
    return error_response(404, "unknown_program", "the session has no program " + text);
  }
  if (request.method == "DELETE") {
    const bool cancelled =
        run_and_wait(session->executor(), [&] { return session->cancel_program(id); });
    if (!cancelled) {
      return error_response(409, "not_running", "program " + text + " is not running any more");
    }
    return json_response(200, status_json(*session, *run_and_wait(session->executor(), [&] {
                           return session->program(id);
                         })));
  }
  if (request.method != "GET" && request.method != "HEAD") {
    auto response = error_response(405, "bad_method", request.method + " is not possible here");
    response.headers.emplace_back("Allow", "GET, HEAD, DELETE");
    return response;
  }
  return json_response(200, status_json(*session, *status));
}

ApiResponse Api::start_program(const ApiRequest& request, const SessionPtr& session) {
  const std::string pace_text = query(request, "pace").value_or("feed");
  if (pace_text != "feed" && pace_text != "fast") {
    return error_response(400, "bad_pace", "pace is neither \"feed\" nor \"fast\"");
  }
  const ProgramPace pace = pace_text == "feed" ? ProgramPace::kFeed : ProgramPace::kFast;
  std::optional<double> rate_hz;
  if (const auto text = query(request, "rate")) {
    rate_hz = parse_rate(*text);
    if (!rate_hz) return error_response(400, "bad_rate", "rate is not a number from 1 to 2000");
  } else if (pace == ProgramPace::kFeed) {
    rate_hz = kFeedRateHz;
  }
  const std::string name = query(request, "name").value_or("program.ngc");
  if (name.size() > wire::kMaxNameBytes || name.find_first_of("/\\\n\r") != std::string::npos) {
    return error_response(400, "bad_name", "name is too long or holds a slash or line break");
  }
  auto program = parse_program(name, request.body, session->scene());
  if (!program) return program_failure(program.error());
  if (rate_hz) {
    double duration_s = 0;
    for (const ProgramMotion& motion : program->motions) duration_s += motion.duration_s;
    if (!(duration_s * *rate_hz < static_cast<double>(kMotionsMax))) {
      return error_response(413, "too_large", "the program has too many motions at this rate");
    }
    program = sample_program(*program, *rate_hz);
  }
  auto started = run_and_wait(session->executor(),
                              [&] { return session->start_program(*std::move(program), pace); });
  if (!started) {
    const unsigned status = started.error().code == wire::ErrorCode::kBusy ? 503 : 400;
    return error_response(status, wire::to_string(started.error().code), started.error().reason);
  }
  auto response = json_response(202, status_json(*session, *started));
  response.headers.emplace_back(
      "Location", "/v1/sessions/" + session->id() + "/programs/" + std::to_string(started->id));
  return response;
}

}  // namespace kerf::net
