// SPDX-License-Identifier: Apache-2.0
// The rights of callers over HTTP, without a socket.
#include "server/http/cookie.h"
#include "server/http/routes.h"
#include "tests/server/api_rights_fixture.h"
#include "tests/support/test.h"

namespace kerf::net::api_rights_test {
namespace {

std::string target_of(const Route& route) {
  std::string target(route.pattern);
  if (const auto id = target.find("{id}"); id != target.npos) target.replace(id, 4, "block");
  for (auto open = target.find('{'); open != target.npos; open = target.find('{')) {
    target.replace(open, target.find('}') - open + 1, "x");
  }
  return target;
}

TEST_F(ApiRightsTest, LinkPreviewsNeedAPubliclyVisibleSession) {
  options.web_folder = folder.path() / "web";
  std::filesystem::create_directory(options.web_folder);
  std::ofstream(options.web_folder / "index.html") << "<head><title>Kerf</title></head>";
  std::ofstream(options.web_folder / "index.html.br") << "packed";
  const auto page = [&](std::string_view target, const std::string& token) {
    ApiRequest request = *parse_target(target);
    request.method = "GET";
    request.host = "kerf.example:8080";
    request.token = token;
    request.accept_encoding = "br";
    const ApiResponse response = api->handle(request);
    EXPECT_EQ(response.status, 200U);
    return response.body;  // empty: the file as it is
  };
  EXPECT_EQ(page("/?session=block", kAdmin), "");
  open(kAdmin, true);  // strangers watch
  const std::string name = session->scene()->name;
  const std::string shown = page("/?session=block", "");
  EXPECT_TRUE(shown.contains("<meta property=\"og:title\" content=\"" + name + " · Kerf\">"))
      << shown;
  EXPECT_TRUE(
      shown.contains("\"og:image\" content=\"http://kerf.example:8080/v1/sessions/block/"
                     "picture.png?width=960\">"));
  EXPECT_TRUE(shown.ends_with("</head>"));
  for (const char* other : {"/", "/?session=none", "/index.html?session=block"}) {
    EXPECT_EQ(page(other, ""), "") << other;
  }
}

TEST(PagePreview, NamesCannotEndTheirAttribute) {
  const std::string page = with_preview("<head></head>", {"\"><script>&", "http://a/b?c&d"});
  EXPECT_TRUE(page.contains("content=\"&quot;>&lt;script>&amp;\"")) << page;
  EXPECT_TRUE(page.contains("content=\"http://a/b?c&amp;d\""));
  EXPECT_EQ(with_preview("no head", {"a", "b"}), "no head");
}

TEST_F(ApiRightsTest, EveryRouteAsksTheTable) {
  const auto check = [&](Role role, const std::string& token) {
    for (const Route& route : api->routes().all()) {
      ApiRequest request = *parse_target(target_of(route));
      request.method = std::string(route.methods.substr(0, route.methods.find(',')));
      request.token = token;
      Caller caller;
      const auto rejection =
          api->refuse(request, api->routes().match(request.method, request.path), caller);
      EXPECT_EQ(!rejection, may(role, route.action)) << route.pattern << to_string(role);
      if (!rejection) continue;
      EXPECT_EQ(rejection->status, role == Role::kNobody ? 401U : 403U);
      EXPECT_EQ(api->handle(request).status, rejection->status);
    }
  };
  for (const auto& [role, token] : tokens) check(role, token);
  check(Role::kNobody, "");
  check(Role::kNobody, "kerf_000000000000_00000000000000000000000000000000");
  open(kAdmin, true);
  check(Role::kGuest, "");
  open("", false);
  check(Role::kAdministrator, "");
}

TEST_F(ApiRightsTest, RoutesWithoutATokenMatchTheTable) {
  std::set<std::string> reachable;
  for (const Route& route : api->routes().all()) {
    if (may(Role::kNobody, route.action)) reachable.insert(std::string(route.pattern));
  }
  EXPECT_EQ(reachable, (std::set<std::string>{"/healthz", "/openapi.json", "/readyz",
                                              "/v1/sessions/{id}/join", "/{file...}"}));
}

TEST_F(ApiRightsTest, UploadsDoNotDeleteFilesOfOtherNetworks) {
  const auto upload = [&](const std::string& network, int n) {
    ApiRequest request = *parse_target("/v1/files?name=Part.OBJ");
    request.method = "POST";
    request.token = kAdmin;
    request.network = network;
    request.body = "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 " + std::to_string(9 + n) +
                   "\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    return Json::parse(api->handle(request).body).at("file").get<std::string>();
  };
  const std::string mine = upload("192.0.2.1", 0);
  EXPECT_EQ(mine.substr(16), ".obj");
  for (int n = 1; n < 18; ++n) upload("192.0.2.2", n);
  std::string scene = kScene;
  const auto at = scene.find("\"stock\"");
  scene.replace(at, scene.find('}', at) + 1 - at,
                R"("stock":{"shape":"mesh","file":")" + mine + "\"}");
  ApiRequest request = *parse_target("/v1/sessions?id=mine");
  request.method = "POST";
  request.token = kAdmin;
  request.body = scene;
  const ApiResponse made = api->handle(request);
  EXPECT_EQ(made.status, 201U) << made.body;
}

TEST_F(ApiRightsTest, AStrangerLearnsNothingOfTheSessions) {
  for (const char* path : {"/v1/sessions/block", "/v1/sessions/other", "/v1/sessions/block/x",
                           "/v1/sessions/other/join", "/v1/sessions"}) {
    const std::string method = std::string_view(path).ends_with("join") ? "POST" : "GET";
    EXPECT_EQ(ask(method, path, "").status, 401U) << path;
  }
  EXPECT_EQ(ask("GET", "/v1/sessions/other", tokens[Role::kOwner]).status, 401U);
  EXPECT_EQ(ask("GET", "/v1/sessions/other", kAdmin).status, 404U);
}

TEST_F(ApiRightsTest, ListsContainTheCallersSessionOnly) {
  ASSERT_TRUE(registry->create("other", kScene, SceneSource{}));
  EXPECT_EQ(made("GET", "/v1/sessions", kAdmin).at("sessions").size(), 2U);
  const Json own = made("GET", "/v1/sessions", tokens[Role::kWatcher]).at("sessions");
  ASSERT_EQ(own.size(), 1U);
  EXPECT_EQ(own[0].at("id"), "block");
}

TEST_F(ApiRightsTest, VersionsAreDeletedByTheirAuthorsAndByOwners) {
  const std::string versions = "/v1/sessions/block/versions";
  const auto passes = [&] {
    ApiRequest request = *parse_target("/v1/sessions/block/join?name=Ada");
    request.method = "POST";
    request.token = invite("role=sculptor");
    return pass_of_cookies(api->handle(request).headers.at(0).second);
  };
  const std::string ada = passes(), bo = passes();
  const Json first = made("POST", versions + "?name=first%20try", ada, 201);
  EXPECT_EQ(first.at("author"), "Ada");
  EXPECT_EQ(first.at("record"), session->sequence());
  made("POST", versions + "?name=second&at=1", ada, 201);
  made("POST", versions + "?name=third&at=second", bo, 201);
  EXPECT_EQ(made("POST", versions + "?name=second", bo, 409).at("error").at("code"),
            "version_exists");
  for (const char* bad : {"", "?name=", "?name=17", "?name=live", "?name=2026-11-22T14:03:00Z",
                          "?name=a%2Fb", "?name=x&at=a%2Fb"}) {
    made("POST", versions + bad, ada, 400);
  }
  made("POST", versions + "?name=x&at=99", ada, 404);
  made("POST", versions + "?name=x&at=unknown", ada, 404);
  made("POST", versions + "?name=x", tokens[Role::kWatcher], 403);
  const Json list = made("GET", versions, tokens[Role::kWatcher]).at("versions");
  ASSERT_EQ(list.size(), 3U);
  EXPECT_EQ(list[1].at("name"), "second");
  EXPECT_EQ(list[2].at("record"), 1);
  made("DELETE", versions + "/first%20try", bo, 403);
  made("DELETE", versions + "/first%20try", ada);
  made("DELETE", versions + "/first%20try", ada, 404);
  made("DELETE", versions + "/second", tokens[Role::kOwner]);
}

TEST_F(ApiRightsTest, AdministratorsBranchSessions) {
  const std::string from = "/v1/sessions?id=other&from=block@";
  made("POST", from + "1", tokens[Role::kOwner], 403);
  made("POST", from + "99", kAdmin, 404);
  made("POST", from + "a%2Fb", kAdmin, 400);
  made("POST", "/v1/sessions?id=other&from=nobody", kAdmin, 404);
  ApiRequest with_scene = *parse_target(from + "1");
  with_scene.method = "POST";
  with_scene.token = kAdmin;
  with_scene.body = kScene;
  EXPECT_EQ(api->handle(with_scene).status, 400U);
  EXPECT_TRUE(made("GET", "/v1/sessions/block", kAdmin).at("parent").is_null());
  made("POST", "/v1/sessions/block/versions?name=mine", kAdmin, 201);
  const Json other = made("POST", from + "mine", kAdmin, 201);
  EXPECT_EQ(other.at("url"), "/v1/sessions/other");
  EXPECT_EQ(other.at("parent").at("session"), "block");
  EXPECT_EQ(made("GET", "/v1/sessions/other", kAdmin).at("parent"), other.at("parent"));
  made("POST", from + "1", kAdmin, 409);
  made("POST", "/v1/sessions?from=other", kAdmin, 201);
}

TEST_F(ApiRightsTest, InvitationsAreCreatedListedAndRevoked) {
  const Json made_one = made("POST", "/v1/sessions/block/invitations?role=sculptor&hours=2",
                             tokens[Role::kOwner], 201);
  const std::string token = made_one.at("token"), id = made_one.at("id");
  EXPECT_EQ(made_one.at("link"), "/?session=block#invite=" + token);
  EXPECT_EQ(
      made_one.at("expires_s").get<std::int64_t>() - made_one.at("created_s").get<std::int64_t>(),
      7200);
  const ApiResponse list = ask("GET", "/v1/sessions/block/invitations", tokens[Role::kOwner]);
  EXPECT_TRUE(list.body.contains(id));
  EXPECT_FALSE(list.body.contains(token.substr(token.rfind('_'))));
  EXPECT_EQ(ask("GET", "/v1/sessions/block", token).status, 200U);
  made("DELETE", "/v1/sessions/block/invitations/" + id, tokens[Role::kOwner]);
  EXPECT_EQ(ask("GET", "/v1/sessions/block", token).status, 401U);
  EXPECT_EQ(ask("DELETE", "/v1/sessions/block/invitations/" + id, kAdmin).status, 404U);
  for (const char* bad : {"role=administrator", "role=guest", "hours=1", "role=owner&hours=0",
                          "role=owner&hours=nan", "role=owner&hours=1e9"}) {
    made("POST", std::string("/v1/sessions/block/invitations?") + bad, kAdmin, 400);
  }
}

TEST_F(ApiRightsTest, AnInvitationIsExchangedForAPassInACookie) {
  const ApiResponse response =
      ask("POST", "/v1/sessions/block/join?name=Grace", invite("role=sculptor"));
  ASSERT_EQ(response.status, 201U) << response.body;
  EXPECT_EQ(Json::parse(response.body).at("role"), "sculptor");
  ASSERT_EQ(response.headers.size(), 1U);
  const auto& [name, cookie] = response.headers[0];
  EXPECT_EQ(name, "Set-Cookie");
  for (const char* part : {"; HttpOnly", "; SameSite=Strict", "; Path=/v1/sessions/block"}) {
    EXPECT_TRUE(cookie.contains(part)) << cookie;
  }
  EXPECT_FALSE(cookie.contains("Secure"));
  const std::string pass = pass_of_cookies(cookie);
  EXPECT_FALSE(response.body.contains(pass));
  const Caller caller = access->identify(pass, "block");
  EXPECT_EQ(caller.role, Role::kSculptor);
  EXPECT_EQ(caller.name, "Grace");
  EXPECT_EQ(ask("POST", "/v1/sessions/block/join", "kerf_x").status, 401U);
  ApiRequest over_tls = *parse_target("/v1/sessions/block/join");
  over_tls.method = "POST";
  over_tls.token = invite("role=watcher");
  over_tls.is_secure = true;
  EXPECT_TRUE(api->handle(over_tls).headers.at(0).second.contains("; Secure"));
}

TEST_F(ApiRightsTest, ReopenedLinkGivesTheSamePass) {
  ApiRequest request = *parse_target("/v1/sessions/block/join?name=Grace");
  request.method = "POST";
  request.token = invite("role=sculptor");
  request.pass = pass_of_cookies(api->handle(request).headers.at(0).second);
  const ApiResponse again = api->handle(request);
  EXPECT_EQ(again.status, 200U);
  EXPECT_TRUE(again.headers.empty());
  EXPECT_EQ(Json::parse(again.body).at("name"), "Grace");
  // A pass of another invitation does not count.
  request.token = invite("role=owner");
  EXPECT_EQ(api->handle(request).status, 201U);
}

TEST_F(ApiRightsTest, RemovedPersonCannotReturn) {
  const std::string ada = invite("role=sculptor&name=Ada");
  const ParticipantId id = join(ada), again = join(ada);
  std::vector<ParticipantId> removed;
  session->listen([&](const SessionEvent& event) {
    if (event.removed != 0) removed.push_back(event.removed);
  });
  const std::string target = "/v1/sessions/block/participants/" + std::to_string(id);
  EXPECT_EQ(ask("DELETE", target, tokens[Role::kSculptor]).status, 403U);
  made("DELETE", target + "?reason=enough", tokens[Role::kOwner]);
  EXPECT_EQ(std::set(removed.begin(), removed.end()), (std::set<ParticipantId>{id, again}));
  EXPECT_EQ(access->identify(ada, "block").role, Role::kNobody);
  EXPECT_EQ(ask("DELETE", "/v1/sessions/block/participants/99", kAdmin).status, 404U);
}

TEST_F(ApiRightsTest, MuteFollowsThePerson) {
  const std::string ada = invite("role=sculptor&name=Ada");
  const std::string target = "/v1/sessions/block/participants/" + std::to_string(join(ada));
  made("POST", target + "?muted=1", tokens[Role::kOwner]);
  EXPECT_TRUE(access->identify(ada, "block").is_muted);
  EXPECT_TRUE(session->people().participant(join(ada))->is_muted);
  made("POST", target + "?muted=0", tokens[Role::kOwner]);
  EXPECT_FALSE(access->identify(ada, "block").is_muted);
  made("POST", target + "?muted=perhaps", tokens[Role::kOwner], 400);
}

TEST_F(ApiRightsTest, OwnershipIsTransferredBetweenPeople) {
  const std::string ada = invite("role=owner&name=Ada"), grace = invite("role=sculptor&name=Grace");
  const ParticipantId owner = join(ada), heir = join(grace);
  const ParticipantId passer = join(tokens[Role::kSculptor]);
  const std::string target = "/v1/sessions/block/participants/";
  made("POST", target + std::to_string(passer) + "?transfer=1", ada, 409);
  made("POST", target + std::to_string(heir) + "?transfer=1", tokens[Role::kOwner], 409);
  made("POST", target + std::to_string(heir) + "?transfer=1", ada);
  EXPECT_EQ(access->identify(grace, "block").role, Role::kOwner);
  EXPECT_EQ(access->identify(ada, "block").role, Role::kSculptor);
  EXPECT_EQ(session->people().participant(heir)->role, Role::kOwner);
  EXPECT_EQ(session->people().participant(owner)->role, Role::kSculptor);
  made("POST", target + std::to_string(owner) + "?role=watcher", grace);
  EXPECT_EQ(session->people().participant(owner)->role, Role::kWatcher);
  made("POST", target + std::to_string(owner) + "?role=administrator", grace, 400);
}

TEST_F(ApiRightsTest, RegionsAreReservedAndReleased) {
  const ParticipantId ada = join(tokens[Role::kSculptor]), grace = join(tokens[Role::kSculptor]);
  const std::string target = "/v1/sessions/block/regions";
  made("POST", target + "?min_mm=0,-20,-20&max_mm=20,20,0&participant=" + std::to_string(ada),
       tokens[Role::kOwner], 201);
  const Json list = made("GET", target, tokens[Role::kWatcher]).at("regions");
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].at("participant"), ada);
  wire::MotionSample samples[2];
  for (std::uint64_t n = 0; n < 2; ++n) {
    samples[n].agent_sequence = n + 1;
    samples[n].time_us = 1000 * (n + 1);
    samples[n].tip_mm = {10 + 0.1 * double(n), 0, -1};
    samples[n].tool_id = 1;
    samples[n].buttons = wire::kButtonCutting;
  }
  EXPECT_TRUE(session->move(ada, samples).rejections.empty());
  EXPECT_EQ(session->move(grace, samples).rejections.at(0).code, wire::ErrorCode::kReserved);
  made("DELETE", target + "/1", tokens[Role::kOwner]);
  samples[0].agent_sequence = 3;
  samples[0].time_us = 3000;
  EXPECT_TRUE(session->move(grace, std::span(samples).first(1)).rejections.empty());
  for (const char* bad : {"min_mm=0,0,0", "min_mm=0,0,0&max_mm=1,1,0", "min_mm=0,0&max_mm=1,1,1",
                          "min_mm=0,0,x&max_mm=1,1,1", "min_mm=0,0,0,0&max_mm=1,1,1",
                          "min_mm=nan,0,0&max_mm=1,1,1"}) {
    made("POST", target + "?" + bad, kAdmin, 400);
  }
}

TEST_F(ApiRightsTest, AForwardedRequestNeedsRights) {
  ApiRequest request = *parse_target("/v1/sessions");
  request.method = "GET";
  request.is_forwarded = true;
  request.token = kAdmin;
  EXPECT_EQ(api->handle(request).status, 200U);
  open("", false);
  EXPECT_EQ(api->handle(request).status, 403U);
  request.is_forwarded = false;
  EXPECT_EQ(api->handle(request).status, 200U);
}

TEST_F(ApiRightsTest, ClosingASessionDeletesItsGrants) {
  const std::string owner = tokens[Role::kOwner];
  EXPECT_EQ(ask("DELETE", "/v1/sessions/block?purge=1", tokens[Role::kSculptor]).status, 403U);
  made("DELETE", "/v1/sessions/block?purge=1", owner);
  ASSERT_TRUE(registry->create("block", kScene, SceneSource{}));
  EXPECT_EQ(ask("GET", "/v1/sessions/block", owner).status, 401U);
}

TEST(Cookies, PassIsFoundAmongOtherCookies) {
  EXPECT_EQ(pass_of_cookies("a=b; kerf_pass=kerf_1_2; c=d"), "kerf_1_2");
  EXPECT_EQ(pass_of_cookies("kerf_pass=x"), "x");
  EXPECT_EQ(pass_of_cookies("xkerf_pass=x; ="), "");
  EXPECT_EQ(pass_of_cookies(""), "");
  EXPECT_EQ(bearer_token("Bearer  abc "), "abc");
  EXPECT_EQ(bearer_token("bearer abc"), "abc");
  EXPECT_EQ(bearer_token("Basic abc"), "");
  EXPECT_EQ(bearer_token("Bearer"), "");
  EXPECT_TRUE(pass_cookie("block", "t", 60, true).ends_with("; Secure"));
}

}  // namespace
}  // namespace kerf::net::api_rights_test
