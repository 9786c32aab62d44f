// SPDX-License-Identifier: Apache-2.0
#include "server/people/invitation_handlers.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "server/http/api_services.h"
#include "server/http/cookie.h"
#include "server/http/number.h"
#include "server/http/responses.h"
#include "server/rights/access.h"
#include "server/session/session.h"
#include "server/threads/run_and_wait.h"

namespace kerf::net {
namespace {

using Json = nlohmann::json;

constexpr double kHoursDefault = 7 * 24, kHoursMax = 366 * 24;
constexpr std::int64_t kSecondsPerHour = 3600;

Json grant_json(const Grant& grant) {
  Json json = {{"id", grant.id},
               {"role", to_string(grant.role)},
               {"created_s", grant.created_s},
               {"expires_s", grant.expires_s},
               {"name", grant.name},
               {"color", grant.color},
               {"muted", grant.muted}};
  if (grant.uses > 0) json["uses"] = grant.uses;
  if (!grant.is_pass()) json["used"] = grant.used;
  if (grant.is_pass()) json["invitation"] = grant.invitation;
  return json;
}

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

ApiResponse joined(const Caller& caller) {
  return json_response(
      200,
      text_of({{"role", to_string(caller.role)}, {"name", caller.name}, {"color", caller.color}}));
}

}  // namespace

ApiResponse list_invitations(const ApiCall& call) {
  Json list = Json::array();
  for (const Grant& grant : call.services.access.grants(call.session->id()))
    list.push_back(grant_json(grant));
  return json_response(200, text_of({{"invitations", list}}));
}

ApiResponse invite(const ApiCall& call) {
  const auto value = [&](const char* name) {
    const std::string* given = call.request.query_value(name);
    return given == nullptr ? std::string() : *given;
  };
  if (call.services.access.regime() == Regime::kLocal) {
    return error_response(409, "no_rights",
                          "on this server everybody may do everything; start it with "
                          "--admin-token-file to invite people");
  }
  const auto role = parse_role(value("role"));
  if (!role) return error_response(400, "bad_role", "role must be watcher, sculptor or owner");
  const std::string hours_text = value("hours");
  const auto hours = hours_text.empty() ? kHoursDefault : parse_number<double>(hours_text);
  if (!hours || !(*hours > 0 && *hours <= kHoursMax)) {
    return error_response(400, "bad_hours", "hours must be a number above 0, at most 8784");
  }
  const std::string uses_text = value("uses");
  const auto uses = uses_text.empty() ? 0 : parse_number<std::int64_t>(uses_text);
  if (!uses || (!uses_text.empty() && *uses < 1)) {
    return error_response(400, "bad_uses", "uses must be a number from 1 to 2000");
  }
  Invitation invitation;
  invitation.uses = *uses;
  invitation.role = *role;
  invitation.lifetime_s = static_cast<std::int64_t>(std::ceil(*hours * kSecondsPerHour));
  invitation.name = value("name");
  invitation.color = value("color");
  const auto issued = call.services.access.invite(call.session->id(), invitation);
  if (!issued) return error_response(issued.error());
  (void)call.session->flush();
  Json json = grant_json(issued->grant);
  json["token"] = issued->token;
  const std::string link = "/?session=" + call.session->id() + "#invite=" + issued->token;
  json["link"] = link;
  const ApiRequest& request = call.request;
  if (!request.host.empty()) {
    json["url"] = (request.is_secure ? "https://" : "http://") + request.host + link;
  }
  return json_response(201, text_of(json));
}

ApiResponse revoke(const ApiCall& call) {
  auto ended = call.services.access.revoke(call.session->id(), call.captured);
  if (!ended) return error_response(ended.error());
  (void)call.session->flush();
  run_and_wait(call.session->executor(), [&] {
    call.session->remove_holders(*ended, "the invitation was revoked");
    return true;
  });
  return json_response(200, text_of({{"revoked", *ended}}));
}

ApiResponse redeem(const ApiCall& call) {
  const std::string& id = call.session->id();
  const ApiRequest& request = call.request;
  if (call.services.access.regime() == Regime::kLocal) return joined(call.caller);
  // If a link is opened again, return the pass that the browser has.
  const Caller holder = call.services.access.identify(request.pass, id);
  for (const Grant& grant : call.services.access.grants(id)) {
    const bool is_theirs = grant.is_pass() && grant.id == holder.grant;
    if (is_theirs && grant.invitation == call.caller.grant) return joined(holder);
  }
  const std::string* name = request.query_value("name");
  const auto issued =
      call.services.access.redeem(request.token, id, name == nullptr ? "" : *name, request.network);
  if (!issued) {
    if (issued.error().kind != ErrorKind::kUnknown) return error_response(issued.error());
    return error_response(401, "bad_token", issued.error().reason);
  }
  (void)call.session->flush();
  ApiResponse response = joined(call.services.access.identify(issued->token, id));
  response.status = 201;
  const std::int64_t lifetime_s = issued->grant.expires_s - issued->grant.created_s;
  response.headers.emplace_back("Set-Cookie",
                                pass_cookie(id, issued->token, lifetime_s, request.is_secure));
  return response;
}

}  // namespace kerf::net
