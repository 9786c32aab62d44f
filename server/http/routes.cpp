// SPDX-License-Identifier: Apache-2.0
#include "server/http/routes.h"

#include <algorithm>
#include <optional>

namespace kerf::net {
namespace {

constexpr std::size_t kSceneBytesMax = std::size_t{1} << 20;
constexpr std::size_t kFileBytesMax = std::size_t{64} << 20;  ///< programs and meshes
/// A body of a request that no route accepts, read before the error is sent: many clients do not
/// read a response while they send.
constexpr std::size_t kRejectedBytesMax = std::size_t{1} << 20;

/// The next segment of a pattern, which is removed from it.
std::string_view take_segment(std::string_view& pattern) {
  pattern.remove_prefix(1);  // "/"
  const auto segment = pattern.substr(0, pattern.find('/'));
  pattern.remove_prefix(segment.size());
  return segment;
}

/// The text that the segment's "{name}" captures, empty if it has none; nothing if `text` differs.
std::optional<std::string_view> match_segment(std::string_view segment, std::string_view text) {
  const auto brace = segment.find('{');
  if (brace == segment.npos) {
    return segment == text ? std::optional<std::string_view>("") : std::nullopt;
  }
  if (!text.starts_with(segment.substr(0, brace))) return std::nullopt;
  return text.substr(brace);
}

std::optional<std::string> match_pattern(std::string_view pattern,
                                         const std::vector<std::string>& path) {
  std::string captured;
  for (const std::string& text : path) {
    if (pattern.empty()) return std::nullopt;
    const auto segment = take_segment(pattern);
    if (segment.ends_with("...}")) {
      return path.front() == "v1" ? std::nullopt : std::optional(captured);
    }
    const auto capture = match_segment(segment, text);
    if (!capture) return std::nullopt;
    if (!capture->empty()) captured = *capture;
  }
  if (!pattern.empty() && !pattern.ends_with("...}")) return std::nullopt;
  return captured;
}

bool lists(std::string_view methods, std::string_view method) {
  while (!methods.empty()) {
    const auto one = methods.substr(0, methods.find(','));
    if (one == method) return true;
    methods.remove_prefix(std::min(one.size() + 2, methods.size()));
  }
  return false;
}

constexpr Route kRoutes[] = {
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions",
     .handler = &Api::list_sessions,
     .action = Action::kList,
     .summary = "200, the open sessions"},
    {.methods = "POST",
     .pattern = "/v1/sessions",
     .query = "id, from, dry_run",
     .handler = &Api::create_session,
     .body_bytes_max = kSceneBytesMax,
     .runs = Runs::kWork,
     .action = Action::kAdminister,
     .summary = "creates a session from a scene, or from a point of another; 201 `{id, url, "
                "accuracy, parent}`"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/templates",
     .handler = &Api::list_templates,
     .action = Action::kList,
     .summary = "200, scenes to begin with: id, title, description, scene"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}",
     .handler = &Api::session_info,
     .runs = Runs::kSession,
     .action = Action::kWatch,
     .summary = "200, state hash, motions, volumes, participants, tools, stock"},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}",
     .query = "purge",
     .handler = &Api::close_session,
     .runs = Runs::kWork,
     .action = Action::kCloseSession,
     .summary = "closes the session; `purge=1` deletes its journal"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/closed",
     .handler = &Api::list_closed,
     .runs = Runs::kWork,
     .action = Action::kAdminister,
     .summary = "200, the closed sessions: name, id, bytes, time"},
    {.methods = "POST",
     .pattern = "/v1/closed/{name}",
     .handler = &Api::reopen_session,
     .runs = Runs::kWork,
     .action = Action::kAdminister,
     .summary = "opens a closed session again; 201 `{id, url, recarved}`"},
    {.methods = "DELETE",
     .pattern = "/v1/closed/{name}",
     .handler = &Api::delete_closed,
     .runs = Runs::kWork,
     .action = Action::kAdminister,
     .summary = "deletes a closed session"},
    {.methods = "GET",
     .pattern = "/v1/sessions/{id}/agent",
     .action = Action::kCarve,
     .upgrade = Upgrade::kAgent,
     .summary = "WebSocket of an agent, `kerf.agent.v1`"},
    {.methods = "GET",
     .pattern = "/v1/sessions/{id}/view",
     .action = Action::kWatch,
     .upgrade = Upgrade::kViewer,
     .summary = "WebSocket of a viewer, `kerf.view.v1`"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/programs",
     .handler = &Api::list_programs,
     .runs = Runs::kSession,
     .action = Action::kWatch,
     .summary = "200, status of all programs"},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/programs",
     .query = "pace, speed, name, rate, after, queue, force_limit_n",
     .handler = &Api::start_program,
     .body_bytes_max = kFileBytesMax,
     .runs = Runs::kWork,
     .action = Action::kRunPrograms,
     .summary = "carves an NC program; 202 with its status"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/programs/{n}",
     .handler = &Api::program_status,
     .runs = Runs::kSession,
     .action = Action::kWatch,
     .summary = "200, progress, state, error"},
    {.methods = "PATCH",
     .pattern = "/v1/sessions/{id}/programs/{n}",
     .query = "do, pace, speed",
     .handler = &Api::change_program,
     .runs = Runs::kSession,
     .action = Action::kRunPrograms,
     .summary = "pauses, resumes or steps the program, or sets its speed; 200 with its status"},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/programs/{n}",
     .handler = &Api::cancel_program,
     .runs = Runs::kSession,
     .action = Action::kRunPrograms,
     .summary = "cancels the program; 200 with its status"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/programs/{n}/source",
     .handler = &Api::program_source,
     .runs = Runs::kSession,
     .action = Action::kWatch,
     .summary = "the text of the program, as it was uploaded"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/programs/{n}/path",
     .query = "points",
     .handler = &Api::program_path,
     .runs = Runs::kSession,
     .action = Action::kWatch,
     .summary = "200, the path of the tip, at most 20,000 points: line, kind, tool"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/model.{format}",
     .query = "encoding, triangles, error_mm, at",
     .handler = &Api::download,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "the surface as `stl`, `glb`, `3mf`, `ply`, `obj`"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/program.ngc",
     .query = "participant, from, to, tolerance_mm",
     .handler = &Api::download,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "the motions as G-code"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/program.apt",
     .query = "participant, from, to, tolerance_mm",
     .handler = &Api::download,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "the motions as APT"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/forces.csv",
     .query = "participant, device_limits",
     .handler = &Api::download,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "force and torque of every motion"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/forces",
     .query = "participant, from, to, points",
     .handler = &Api::download,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "200, least, mean and greatest force and torque of spans of motions, for plots"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/thin_walls.json",
     .handler = &Api::download,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "walls and grooves below the pitch; whether the target holds"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/journal",
     .handler = &Api::download,
     .runs = Runs::kExport,
     .action = Action::kDownload,
     .summary = "the journal, an SQLite database"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/strokes",
     .query = "since",
     .handler = &Api::list_strokes,
     .runs = Runs::kExport,
     .action = Action::kWatch,
     .summary = "200, the strokes: participant, tool, records, times, whether it is undone"},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/undo",
     .query = "strokes, participant",
     .handler = &Api::undo,
     .runs = Runs::kExport,
     .action = Action::kUndo,
     .summary =
         "undoes strokes, or the newest one of a participant; 200 when the block has changed"},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/redo",
     .query = "strokes, participant",
     .handler = &Api::redo,
     .runs = Runs::kExport,
     .action = Action::kUndo,
     .summary = "redoes strokes, or the one of a participant that was undone last; 200"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/versions",
     .handler = &Api::list_versions,
     .runs = Runs::kSession,
     .action = Action::kWatch,
     .summary = "200, the named versions: name, record, times, author"},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/versions",
     .query = "name, at",
     .handler = &Api::name_version,
     .runs = Runs::kWork,
     .action = Action::kNameVersions,
     .summary = "names the block as it is, or was at a point; 201 with the version"},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/versions/{name}",
     .handler = &Api::remove_version,
     .runs = Runs::kWork,
     .action = Action::kNameVersions,
     .summary = "deletes a version"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/exports",
     .handler = &Api::list_exports,
     .action = Action::kWatch,
     .summary = "200, downloads in preparation: name, share, seconds"},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/join",
     .query = "name",
     .handler = &Api::redeem,
     .runs = Runs::kSession,
     .action = Action::kReach,
     .summary = "exchanges an invitation for a pass, in a cookie; 201 `{role, name, color}`"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/invitations",
     .handler = &Api::list_invitations,
     .runs = Runs::kSession,
     .action = Action::kInvite,
     .summary = "200, invitations and passes, without their tokens"},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/invitations",
     .query = "role, hours, uses, name, color",
     .handler = &Api::invite,
     .runs = Runs::kSession,
     .action = Action::kInvite,
     .summary = "201 `{id, role, expires_s, token, link}`"},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/invitations/{grant}",
     .handler = &Api::revoke,
     .runs = Runs::kSession,
     .action = Action::kInvite,
     .summary = "revokes it and its passes, and removes their holders"},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/participants/{n}",
     .query = "muted, role, transfer",
     .handler = &Api::change_participant,
     .runs = Runs::kSession,
     .action = Action::kModerate,
     .summary = "mutes, changes the role, hands ownership over"},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/participants/{n}",
     .query = "reason",
     .handler = &Api::remove_participant,
     .runs = Runs::kSession,
     .action = Action::kModerate,
     .summary = "removes a participant, who gets the reason"},
    {.methods = "GET, HEAD",
     .pattern = "/v1/sessions/{id}/regions",
     .handler = &Api::list_regions,
     .action = Action::kWatch,
     .summary = "200, the reserved regions"},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/regions",
     .query = "min_mm, max_mm, participant",
     .handler = &Api::reserve,
     .runs = Runs::kSession,
     .action = Action::kModerate,
     .summary = "reserves a box for a participant, or for the owners; 201 `{region}`"},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/regions/{n}",
     .handler = &Api::release,
     .runs = Runs::kSession,
     .action = Action::kModerate,
     .summary = "releases a region"},
    {.methods = "POST",
     .pattern = "/v1/drain",
     .query = "to",
     .handler = &Api::drain,
     .runs = Runs::kAtOnce,
     .action = Action::kAdminister,
     .summary = "stops the server; sends peers to the server `to`; 202"},
    {.methods = "POST",
     .pattern = "/v1/files",
     .query = "name",
     .handler = &Api::upload_file,
     .body_bytes_max = kFileBytesMax,
     .runs = Runs::kWork,
     .action = Action::kAdminister,
     .summary = "stores a closed mesh; 201 `{file, vertices, triangles, min_mm, max_mm}`"},
    {.methods = "GET, HEAD",
     .pattern = "/healthz",
     .handler = &Api::health,
     .action = Action::kReach,
     .summary = "200 while the server runs"},
    {.methods = "GET, HEAD",
     .pattern = "/readyz",
     .handler = &Api::ready,
     .action = Action::kReach,
     .summary = "200; 503 while sessions are loading or the disk has paused one; `{status, "
                "loading, paused, unreadable}`"},
    {.methods = "GET, HEAD",
     .pattern = "/metrics",
     .handler = &Api::metrics,
     .action = Action::kAdminister,
     .summary = "Prometheus text"},
    {.methods = "GET, HEAD",
     .pattern = "/{file...}",
     .handler = &Api::viewer_file,
     .action = Action::kReach,
     .summary = "the built viewer"},
};

}  // namespace

std::span<const Route> routes() { return kRoutes; }

RouteMatch match_route(std::string_view method, const std::vector<std::string>& path) {
  RouteMatch match;
  for (const Route& route : routes()) {
    // The viewer's files are what remains.
    if (route.pattern.ends_with("...}") && !match.allow.empty()) break;
    auto captured = match_pattern(route.pattern, path);
    if (!captured) continue;
    match.allow.append(match.allow.empty() ? "" : ", ").append(route.methods);
    match.upgrade = route.upgrade;
    if (lists(route.methods, method)) {
      match.route = &route;
      match.captured = *std::move(captured);
    }
  }
  return match;
}

std::size_t body_bytes_max(const RouteMatch& match, std::string_view method) {
  if (match.route != nullptr) return match.route->body_bytes_max;
  return method == "POST" ? kRejectedBytesMax : 0;
}

std::string routes_markdown() {
  std::string text = "| method | path | query | right | answer |\n|---|---|---|---|---|\n";
  for (const Route& route : routes()) {
    text += "| ";
    text.append(route.methods).append(" | `").append(route.pattern).append("` | ");
    text.append(route.query).append(route.query.empty() ? "| `" : " | `");
    text.append(to_string(route.action)).append("` | ");
    text.append(route.summary).append(" |\n");
  }
  return text;
}

}  // namespace kerf::net
