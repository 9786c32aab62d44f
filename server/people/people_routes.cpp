// SPDX-License-Identifier: Apache-2.0
#include "server/people/people_routes.h"

#include "server/http/routes.h"
#include "server/people/invitation_handlers.h"
#include "server/people/participant_handlers.h"
#include "server/people/region_handlers.h"

namespace kerf::net {
namespace {

constexpr Route kRoutes[] = {
    {.pattern = "/v1/sessions/{id}/authors",
     .answer = &list_authors,
     .runs = Runs::kHistory,
     .action = Action::kWatch},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/join",
     .query = "name",
     .answer = &redeem,
     .runs = Runs::kSession,
     .action = Action::kReach},
    {.pattern = "/v1/sessions/{id}/invitations",
     .answer = &list_invitations,
     .runs = Runs::kSession,
     .action = Action::kInvite},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/invitations",
     .query = "role, hours, uses, name, color",
     .answer = &invite,
     .runs = Runs::kSession,
     .action = Action::kInvite},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/invitations/{grant}",
     .answer = &revoke,
     .runs = Runs::kSession,
     .action = Action::kInvite},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/participants/{n}",
     .query = "muted=1, role, transfer=1",
     .answer = &change_participant,
     .runs = Runs::kSession,
     .action = Action::kModerate},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/participants/{n}",
     .query = "reason",
     .answer = &remove_participant,
     .runs = Runs::kSession,
     .action = Action::kModerate},
    {.pattern = "/v1/sessions/{id}/regions",
     .answer = &list_regions,
     .action = Action::kWatch,
     .at_owner = true},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/regions",
     .query = "min_mm, max_mm, participant",
     .answer = &reserve,
     .runs = Runs::kSession,
     .action = Action::kModerate},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/regions/{n}",
     .answer = &release,
     .runs = Runs::kSession,
     .action = Action::kModerate},
};

}  // namespace

HttpMatter http_people() { return {.routes = kRoutes}; }

}  // namespace kerf::net
