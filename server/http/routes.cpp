// SPDX-License-Identifier: Apache-2.0
#include "server/http/routes.h"

#include "server/http/api.h"

namespace kerf::net {
namespace {

constexpr std::size_t kSceneBytesMax = std::size_t{1} << 20;

constexpr Route kRoutes[] = {
    {.pattern = "/v1/sessions",
     .handler = &Api::list_sessions,
     .action = Action::kList,
     .summary = "200, the open sessions"},
    {.methods = "POST",
     .pattern = "/v1/sessions",
     .query = "id, from, dry_run=1, here=1",
     .handler = &Api::create_session,
     .body_bytes_max = kSceneBytesMax,
     .runs = Runs::kWork,
     .action = Action::kAdminister,
     .summary = "creates a session from a scene or another; 201 `{id, url, accuracy, parent}`"},
    {.pattern = "/v1/templates",
     .handler = &Api::list_templates,
     .action = Action::kList,
     .summary = "200, scenes to begin with: id, title, description, scene"},
    {.pattern = "/v1/sessions/{id}",
     .handler = &Api::session_info,
     .runs = Runs::kSession,
     .action = Action::kWatch,
     .summary = "200, state hash, motions, volumes, participants, tools, stock"},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}",
     .query = "purge=1",
     .handler = &Api::close_session,
     .runs = Runs::kWork,
     .action = Action::kCloseSession,
     .summary = "closes the session; `purge=1` deletes its journal"},
    {.pattern = "/v1/closed",
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
    {.methods = "POST",
     .pattern = "/v1/drain",
     .query = "to",
     .handler = &Api::drain,
     .action = Action::kAdminister,
     .summary = "stops the server; sends peers to the server `to`; 202"},
    {.methods = "POST",
     .pattern = "/v1/files",
     .query = "name, repair=1",
     .handler = &Api::upload_file,
     .body_bytes_max = kFileBytesMax,
     .runs = Runs::kRead,
     .action = Action::kAdminister,
     .summary = "stores a closed mesh, or with `repair=1` one that a scene's `\"repair\": true` "
                "closes; 201 `{file, vertices, triangles, min_mm, max_mm, repaired}`"},
    {.pattern = "/healthz",
     .handler = &Api::health,
     .action = Action::kReach,
     .summary = "200 while the server runs"},
    {.pattern = "/readyz",
     .handler = &Api::ready,
     .action = Action::kReach,
     .summary = "200; 503 while not ready; `{status, loading, paused, damaged, unreadable}`"},
    {.pattern = "/metrics",
     .handler = &Api::metrics,
     .action = Action::kAdminister,
     .summary = "Prometheus text"},
    {.pattern = "/openapi.json",
     .handler = &Api::describe_interface,
     .action = Action::kReach,
     .summary = "200, this interface as an OpenAPI 3.1 document"},
    {.pattern = "/{file...}",
     .query = kAnyQuery,
     .handler = &Api::viewer_file,
     .action = Action::kReach,
     .summary = "the built viewer"},
};

}  // namespace

RouteTable::RouteTable(std::span<const HttpMatter> matters) {
  // Append the last route at the end: it matches any path.
  const std::span<const Route> own(kRoutes);
  routes_.assign(own.begin(), own.end() - 1);
  for (const HttpMatter& matter : matters) {
    routes_.insert(routes_.end(), matter.routes.begin(), matter.routes.end());
  }
  routes_.push_back(own.back());
}

}  // namespace kerf::net
