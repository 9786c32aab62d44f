// SPDX-License-Identifier: Apache-2.0
#include "server/strokes/stroke_routes.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <ranges>
#include <string>
#include <vector>

#include "server/http/api_services.h"
#include "server/http/number.h"
#include "server/http/responses.h"
#include "server/http/routes.h"
#include "server/session/session.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

Json stroke_json(const ListedStroke& listed) {
  const Stroke& stroke = listed.stroke;
  return {{"id", stroke.id},           {"participant", stroke.participant},
          {"tool", stroke.tool},       {"last", stroke.last},
          {"motions", stroke.motions}, {"begin_ms", stroke.begin_ms},
          {"end_ms", stroke.end_ms},   {"undone", listed.is_undone}};
}

/// Parses `strokes`, numbers separated by commas. Nullopt if one is malformed or there are too
/// many.
std::optional<std::vector<StrokeId>> parse_strokes(const std::string& text) {
  std::vector<StrokeId> ids;
  if (text.empty()) return std::nullopt;
  for (const auto part : std::views::split(text, ',')) {
    const auto id = parse_number<StrokeId>(std::string_view(part.begin(), part.end()));
    if (!id || *id == 0 || ids.size() == kStrokesMax) return std::nullopt;
    ids.push_back(*id);
  }
  return ids;
}

ApiResponse stroke_failure(const Rejection& rejection) {
  if (rejection.code == wire::ErrorCode::kBadMessage) {
    return error_response(409, "bad_stroke", rejection.reason);
  }
  return rejection_response(rejection, 409);
}

ApiResponse list_strokes(const ApiCall& call) {
  std::uint64_t since = 0;
  if (const std::string* text = call.request.query_value("since")) {
    const auto number = parse_number<std::uint64_t>(*text);
    if (!number) return error_response(400, "bad_since", "since must be the number of a record");
    since = *number;
  }
  const auto strokes = call.session->past().strokes(since, call.request.stop);
  if (!strokes) return history_failure(*call.session, strokes.error(), call.request.stop);
  Json list = Json::array();
  for (const ListedStroke& stroke : *strokes) list.push_back(stroke_json(stroke));
  return json_response(200, Json{{"strokes", std::move(list)}}.dump());
}

ApiResponse change_strokes(const ApiCall& call, bool undone) {
  StrokeRequest request{.undone = undone, .caller = call.caller};
  const std::string* strokes = call.request.query_value("strokes");
  const std::string* participant = call.request.query_value("participant");
  if ((strokes == nullptr) == (participant == nullptr)) {
    return error_response(400, "bad_request", "name either strokes or a participant");
  }
  if (strokes != nullptr) {
    const auto ids = parse_strokes(*strokes);
    if (!ids) {
      return error_response(400, "bad_strokes",
                            "strokes must be 1 to " + std::to_string(kStrokesMax) +
                                " numbers of first records, separated by commas");
    }
    request.strokes = *ids;
  } else {
    const auto id = parse_number<ParticipantId>(*participant);
    if (!id) return error_response(400, "bad_participant", "participant must be a number");
    request.participant = *id;
  }
  const auto changed = call.session->stroke_changes().change(request, call.services.carvers.get(),
                                                             call.request.stop);
  if (!changed) return stroke_failure(changed.error());
  Json answer = {{"strokes", changed->strokes},
                 {"sequence", changed->sequence},
                 {"tiles", changed->tiles},
                 {"returned_mm3", changed->returned_mm3}};
  std::optional<std::string> pending = changed->pending;
  if (const auto durable = call.session->flush_and_copy(); !durable && !pending)
    pending = describe(durable.error());
  if (pending) answer["pending"] = *pending;
  return json_response(pending ? 202 : 200, answer.dump());
}

ApiResponse undo(const ApiCall& call) { return change_strokes(call, true); }

ApiResponse redo(const ApiCall& call) { return change_strokes(call, false); }

constexpr Route kRoutes[] = {
    {.pattern = "/v1/sessions/{id}/strokes",
     .query = "since",
     .answer = &list_strokes,
     .runs = Runs::kHistory,
     .action = Action::kWatch},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/undo",
     .query = "strokes, participant",
     .answer = &undo,
     .runs = Runs::kHistory,
     .action = Action::kUndo},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/redo",
     .query = "strokes, participant",
     .answer = &redo,
     .runs = Runs::kHistory,
     .action = Action::kUndo},
};

}  // namespace

HttpMatter http_strokes() { return {.routes = kRoutes}; }

}  // namespace kerf::net
