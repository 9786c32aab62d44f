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
     .action = Action::kWatch,
     .summary = "200, who could carve, also those who have left: number, name, color, kind"},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/join",
     .query = "name",
     .answer = &redeem,
     .runs = Runs::kSession,
     .action = Action::kReach,
     .summary = "exchanges an invitation for a pass, in a cookie; 201 `{role, name, color}`"},
    {.pattern = "/v1/sessions/{id}/invitations",
     .answer = &list_invitations,
     .runs = Runs::kSession,
     .action = Action::kInvite,
     .summary = "200, invitations and passes, without their tokens"},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/invitations",
     .query = "role, hours, uses, name, color",
     .answer = &invite,
     .runs = Runs::kSession,
     .action = Action::kInvite,
     .summary = "201 `{id, role, expires_s, token, link}`"},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/invitations/{grant}",
     .answer = &revoke,
     .runs = Runs::kSession,
     .action = Action::kInvite,
     .summary = "revokes it and its passes, and removes their holders"},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/participants/{n}",
     .query = "muted=1, role, transfer=1",
     .answer = &change_participant,
     .runs = Runs::kSession,
     .action = Action::kModerate,
     .summary = "mutes, changes the role, hands ownership over"},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/participants/{n}",
     .query = "reason",
     .answer = &remove_participant,
     .runs = Runs::kSession,
     .action = Action::kModerate,
     .summary = "removes a participant, who gets the reason"},
    {.pattern = "/v1/sessions/{id}/regions",
     .answer = &list_regions,
     .action = Action::kWatch,
     .at_owner = true,
     .summary = "200, the reserved regions"},
    {.methods = "POST",
     .pattern = "/v1/sessions/{id}/regions",
     .query = "min_mm, max_mm, participant",
     .answer = &reserve,
     .runs = Runs::kSession,
     .action = Action::kModerate,
     .summary = "reserves a box for a participant, or for the owners; 201 `{region}`"},
    {.methods = "DELETE",
     .pattern = "/v1/sessions/{id}/regions/{n}",
     .answer = &release,
     .runs = Runs::kSession,
     .action = Action::kModerate,
     .summary = "releases a region"},
};

}  // namespace

HttpMatter http_people() { return {.routes = kRoutes}; }

}  // namespace kerf::net
