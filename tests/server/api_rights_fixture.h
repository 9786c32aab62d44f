// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "server/http/api.h"
#include "server/matters.h"
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::net {

using Json = nlohmann::json;
inline const std::string kAdmin = "0123456789abcdef0123456789abcdef";

/// An executor that runs work at once: handlers wait for the session's executor.
class EagerExecutor final : public Executor {
 public:
  void post(Work work) override { work(); }
  void post_after(std::chrono::microseconds, Work) override {}
};

class ApiRightsTest : public testing::Test {
 protected:
  void SetUp() override {
    options.data_folder = folder.path();
    registry.emplace(
        RegistryOptions{.data_folder = folder.path(), .sessions_max = 4, .matters = matters()},
        [this](const std::string&) { return executor; }, workers);
    session = *registry->create("block", kScene, SceneSource{});
    open(kAdmin, false);
  }
  void open(const std::string& admin, bool is_open) {
    api.reset();
    access = *Access::open({.admin_token = admin, .open = is_open});
    api.emplace(options, *registry, metrics, *access, http_matters());
    for (const Role role : {Role::kWatcher, Role::kSculptor, Role::kOwner}) {
      tokens[role] = access->invite("block", {.role = role})->token;
    }
    tokens[Role::kAdministrator] = admin;
  }
  ApiResponse ask(const std::string& method, std::string_view target, const std::string& token,
                  const std::string& body = {}) {
    ApiRequest request = *parse_target(target);
    request.method = method;
    request.token = token;
    request.body = body;
    return api->handle(request);
  }
  Json made(const std::string& method, std::string_view target, const std::string& token,
            unsigned status = 200) {
    const ApiResponse response = ask(method, target, token);
    EXPECT_EQ(response.status, status) << method << " " << target << " " << response.body;
    return Json::parse(response.body);
  }
  std::string invite(const std::string& query) {
    return made("POST", "/v1/sessions/block/invitations?" + query, tokens[Role::kOwner], 201)
        .at("token");
  }
  ParticipantId join(const std::string& token, ParticipantKind kind = ParticipantKind::kAgent) {
    const Caller caller = access->identify(token, "block");
    JoinRequest request{kind, caller.name, "", 0, true};
    request.role = caller.role;
    request.grant = caller.grant;
    request.is_personal = caller.is_personal;
    request.is_muted = caller.is_muted;
    return session->join(request)->id;
  }

  test::TemporaryFolder folder;
  HttpOptions options;
  Metrics metrics;
  std::shared_ptr<EagerExecutor> executor = std::make_shared<EagerExecutor>();
  EagerExecutor workers;
  std::optional<SessionRegistry> registry;
  std::shared_ptr<Session> session;
  std::unique_ptr<Access> access;
  std::optional<Api> api;
  std::map<Role, std::string> tokens;
};

}  // namespace kerf::net
