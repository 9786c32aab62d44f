// SPDX-License-Identifier: Apache-2.0
#include "server/http/routes.h"

#include "server/http/api.h"

namespace kerf::net {
namespace {

constexpr std::size_t kSceneBytesMax = std::size_t{1} << 20;

constexpr Route kRoutes[] = {
    {.pattern = "/v1/sessions", .handler = &Api::list_sessions, .action = Action::kList},
    {.methods = "POST",
     .pattern = "/v1/sessions",
     .query = "id, from, name, dry_run=1, here=1",
     .handler = &Api::create_session,
     .body_bytes_max = kSceneBytesMax,
     .runs = Runs::kWork,
     .action = Action::kAdminister},
    {.pattern = "/v1/templates", .handler = &Api::list_templates, .action = Action::kList},
    {.pattern = "/v1/sessions/{id}",
     .handler = &Api::session_info,
     .runs = Runs::kSession,
     .action = Action::kWatch},
    {.methods = "PATCH",
     .pattern = "/v1/sessions/{id}",
     .query = "name",
     .handler = &Api::rename_session,
     .runs = Runs::kHistory,
     .action = Action::kRenameSession},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}",
     .query = "purge=1",
     .handler = &Api::close_session,
     .runs = Runs::kWork,
     .action = Action::kCloseSession},
    {.pattern = "/v1/closed",
     .handler = &Api::list_closed,
     .runs = Runs::kWork,
     .action = Action::kAdminister},
    {.methods = "POST",
     .pattern = "/v1/closed/{name}",
     .handler = &Api::reopen_session,
     .runs = Runs::kWork,
     .action = Action::kAdminister},
    {.methods = "DELETE",
     .pattern = "/v1/closed/{name}",
     .handler = &Api::delete_closed,
     .runs = Runs::kWork,
     .action = Action::kAdminister},
    {.methods = "GET",
     .pattern = "/v1/sessions/{id}/agent",
     .action = Action::kCarve,
     .upgrade = Upgrade::kAgent},
    {.methods = "GET",
     .pattern = "/v1/sessions/{id}/view",
     .action = Action::kWatch,
     .upgrade = Upgrade::kViewer},
    {.methods = "POST",
     .pattern = "/v1/drain",
     .query = "to",
     .handler = &Api::drain,
     .action = Action::kAdminister},
    {.methods = "POST",
     .pattern = "/v1/files",
     .query = "name, repair=1",
     .handler = &Api::upload_file,
     .body_bytes_max = kFileBytesMax,
     .runs = Runs::kRead,
     .action = Action::kAdminister},
    {.pattern = "/healthz", .handler = &Api::health, .action = Action::kReach},
    {.pattern = "/readyz", .handler = &Api::ready, .action = Action::kReach},
    {.pattern = "/metrics", .handler = &Api::metrics, .action = Action::kAdminister},
    {.pattern = "/openapi.json", .handler = &Api::describe_interface, .action = Action::kReach},
    {.pattern = "/{file...}",
     .query = kAnyQuery,
     .handler = &Api::viewer_file,
     .action = Action::kReach},
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
