// SPDX-License-Identifier: Apache-2.0
#include "server/programs/program_texts.h"

#include <nlohmann/json.hpp>

#include "server/http/number.h"
#include "server/http/responses.h"
#include "server/session/session.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

constexpr std::size_t kPathPoints = 5000;

char letter_of(PathKind kind) {
  switch (kind) {
    case PathKind::kStart:
      return 's';
    case PathKind::kRapid:
      return 'r';
    case PathKind::kFeed:
      return 'f';
  }
  return 's';
}

/// Returns the text of the program named by the path, or the error.
std::expected<std::shared_ptr<const ProgramText>, ApiResponse> find_text(const ApiCall& call) {
  const std::string name = "program " + call.captured;
  const auto id = parse_number<ProgramId>(call.captured).value_or(0);
  Session& session = *call.session;
  auto [is_known, text] = run_and_wait(session.executor(), [&] {
    return std::pair(session.programs().status(id).has_value(), session.programs().text(id));
  });
  if (text) return std::move(text);
  return std::unexpected(
      is_known ? error_response(404, "no_source",
                                name + " has ended, and newer ones needed the memory of its text")
               : error_response(404, "unknown_program", "the session has no " + name));
}

}  // namespace

ApiResponse program_source(const ApiCall& call) {
  const auto found = find_text(call);
  if (!found) return found.error();
  ApiResponse response;
  response.content_type = "text/plain; charset=utf-8";
  response.text = {*found, &(*found)->text};
  return response;
}

ApiResponse program_path(const ApiCall& call) {
  std::size_t points_max = kPathPoints;
  if (const std::string* given = call.request.query_value("points")) {
    points_max = parse_number<std::size_t>(*given).value_or(0);
    if (points_max < 2 || points_max > kPathPointsMax) {
      return error_response(400, "bad_value",
                            "points must be 2 to " + std::to_string(kPathPointsMax));
    }
  }
  const auto found = find_text(call);
  if (!found) return found.error();
  const ProgramPath path = drawn_path((*found)->path, points_max);
  std::string kinds;
  std::vector<double> x, y, z, times;
  std::vector<std::uint32_t> lines;
  std::vector<ToolId> tools;
  for (const PathPoint& point : path.points) {
    kinds += letter_of(point.kind);
    x.push_back(point.tip_mm.x);
    y.push_back(point.tip_mm.y);
    z.push_back(point.tip_mm.z);
    times.push_back(point.time_s);
    lines.push_back(point.line);
    tools.push_back(point.tool);
  }
  return json_response(200, nlohmann::json{{"points", path.points.size()},
                                           {"error_mm", path.error_mm},
                                           {"kind", kinds},
                                           {"x_mm", x},
                                           {"y_mm", y},
                                           {"z_mm", z},
                                           {"time_s", times},
                                           {"line", lines},
                                           {"tool", tools}}
                                .dump());
}

}  // namespace kerf::net
