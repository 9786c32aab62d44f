// SPDX-License-Identifier: Apache-2.0
// Tokens, invitations and the powers of owners, over HTTP and WebSockets.
#include <filesystem>
#include <string>
#include <utility>

#include "server/log/log.h"
#include "server/maintenance.h"
#include "tests/server/whole/hand.h"
#include "tests/server/whole/watcher.h"
#include "tests/server/whole/whole_server.h"

namespace kerf::test::rights_test {
namespace {

class Invitations : public WholeServer {
 protected:
  void SetUp() override {
    admin = "0123456789abcdef0123456789abcdef";
    testing::internal::CaptureStderr();
    log::open();
    WholeServer::SetUp();
  }
  void TearDown() override {
    server.reset();
    const std::string text = testing::internal::GetCapturedStderr();
    log::open();
    EXPECT_FALSE(text.contains(admin)) << "no token is in the log";
    EXPECT_FALSE(text.contains("kerf_")) << text;
  }
  Json invite(const std::string& query) {
    return made("POST", "/v1/sessions/block/invitations?role=" + query);
  }
  std::string token(const std::string& query) { return invite(query).at("token"); }
  Hand hand(const std::string& token, const std::string& name = "Ada") const {
    return Hand(port, "block", name, Json::object(), bearer(token));
  }
  unsigned upgrade(const std::string& kind, const Headers& headers = {}) const {
    return WebPeer(port, "/v1/sessions/block/" + kind, "kerf." + kind + ".v1", headers)
        .upgrade()
        .status;
  }
  /// Sends a request with other headers than the administrator's.
  Answer ask_with(const std::string& method, const std::string& target,
                  const Headers& headers) const {
    return test::ask(port, method, target, "", headers);
  }
};

TEST_F(Invitations, WithoutATokenThereIsNothingButThePage) {
  for (const char* path : {"/v1/sessions", "/v1/sessions/block", "/v1/sessions/other", "/metrics",
                           "/v1/sessions/block/model.stl"}) {
    const Answer answer = ask_with("GET", path, {});
    EXPECT_EQ(answer.status, 401U) << path;
    EXPECT_EQ(answer.code(), "no_token") << path;
  }
  EXPECT_EQ(ask_with("GET", "/healthz", {}).status, 200U);
  EXPECT_EQ(upgrade("agent"), 401U);
  EXPECT_EQ(upgrade("view"), 401U);
}

// The client announces 60 MB and sends nothing. The server answers without waiting.
TEST_F(Invitations, TheBodyOfAStrangerIsNotRead) {
  const Answer answer = ask_with("POST", "/v1/files", {{"Content-Length", "62914560"}});
  EXPECT_EQ(answer.status, 401U);
  EXPECT_EQ(answer.code(), "no_token");
}

TEST_F(Invitations, ABrowserExchangesTheLinkForACookie) {
  const std::string link = invite("watcher").at("link");
  const std::string token = link.substr(link.find("#invite=") + 8);
  const Answer joined = ask_with("POST", "/v1/sessions/block/join?name=Eve", bearer(token));
  EXPECT_EQ(joined.status, 201U);
  const std::string pass = joined.header("Set-Cookie");
  const Headers cookie = {{"Cookie", pass.substr(0, pass.find(';'))}};
  Watcher eve(port, {{"name", "Mallory"}}, "block", cookie);
  EXPECT_EQ(eve.welcome.at("role"), "watcher");
  EXPECT_FALSE(eve.welcome.at("may").dump().contains("carve"));
  ASSERT_EQ(eve.welcome.at("participants").size(), 1U);
  EXPECT_EQ(eve.welcome.at("participants").at(0).at("name"), "Eve");
  EXPECT_EQ(upgrade("agent", cookie), 403U);
  EXPECT_EQ(ask_with("DELETE", "/v1/sessions/block", cookie).status, 403U);
}

TEST_F(Invitations, AnOwnerMutesAndRemoves) {
  const Headers owner = bearer(token("owner"));
  Hand ada = hand(token("sculptor&name=Ada")), grace = hand(token("sculptor&name=Grace"));
  const std::string person = "/v1/sessions/block/participants/" + std::to_string(ada.participant);
  EXPECT_EQ(ask_with("POST", person + "?muted=1", owner).status, 200U);
  ada.move({{0, 0, -1}, {1, 0, -1}});
  EXPECT_EQ(ada.receive("error").at("code"), "muted");
  EXPECT_EQ(ask_with("POST", person + "?muted=0", owner).status, 200U);
  ada.move({{2, 0, -1}});
  EXPECT_GT(ada.result().removed_mm3, 0);
  EXPECT_EQ(ask_with("DELETE", person + "?reason=enough", owner).status, 200U);
  const Json error = ada.receive("error");
  EXPECT_EQ(error.at("code"), "removed");
  EXPECT_EQ(error.at("reason"), "enough");
  EXPECT_EQ(error.at("fatal"), true);
  ada.closed();
  grace.move({{0, 5, -1}, {1, 5, -1}});
  EXPECT_GT(grace.result().removed_mm3, 0);
}

TEST_F(Invitations, RevocationAndExpiryEndConnections) {
  const Json invitation = invite("watcher");
  // Valid for long enough to join with it.
  const std::string one = invitation.at("token"), brief = token("watcher&hours=0.0009");
  Watcher first(port, Json::object(), "block", bearer(one)),
      second(port, Json::object(), "block", bearer(brief));
  // Opened before the invitation expires, and idle until then.
  WebPeer spare(port, "/v1/sessions/block/view", "kerf.view.v1", bearer(one));
  made("DELETE", "/v1/sessions/block/invitations/" + invitation.at("id").get<std::string>());
  spare.send({{"type", "hello"}});
  EXPECT_EQ(spare.receive("error").at("code"), "not_allowed");
  EXPECT_EQ(first.receive("error").at("code"), "removed");
  EXPECT_EQ(second.receive("error").at("code"), "not_allowed");
  for (const std::string& token : {one, brief}) {
    EXPECT_EQ(ask_with("GET", "/v1/sessions/block", bearer(token)).code(), "bad_token");
  }
}

TEST_F(Invitations, OnlyTrustedProxiesDescribeTheirClients) {
  for (const bool is_trusted : {false, true}) {
    if (is_trusted) {
      options.http.proxies = *net::TrustedProxies::parse({"10.0.0.1", "127.0.0.0/8"});
      options.http.allow_hosts = {"kerf.example"};
      restart();
    }
    const auto forwarded = [&](const std::string& target, const std::string& token) {
      Headers headers = bearer(token);
      headers.insert(headers.end(), {{"X-Forwarded-For", "203.0.113.9"},
                                     {"X-Forwarded-Proto", "https"},
                                     {"X-Forwarded-Host", "kerf.example"}});
      return ask_with("POST", "/v1/sessions/block/" + target, headers);
    };
    const Json made = forwarded("invitations?role=watcher", admin).json();
    const std::string start =
        is_trusted ? "https://kerf.example" : "http://127.0.0.1:" + std::to_string(port);
    EXPECT_EQ(made.at("url"), start + made.at("link").get<std::string>());
    const Answer joined = forwarded("join", made.at("token"));
    EXPECT_EQ(joined.header("Set-Cookie").contains("; Secure"), is_trusted);
  }
}

TEST_F(Invitations, SurviveARestartAndAreInABackup) {
  const std::string ada = token("sculptor&name=Ada"), eve = token("watcher&name=Eve");
  restart();
  {
    const Hand again = hand(ada, "Somebody");
    EXPECT_EQ(again.welcome.at("role"), "sculptor");
    const Json people =
        ask_with("GET", "/v1/sessions/block", bearer(ada)).json().at("participants");
    ASSERT_EQ(people.size(), 1U);
    EXPECT_EQ(people.at(0).at("name"), "Ada");
  }
  const std::filesystem::path copies = folder / "copies";
  testing::internal::CaptureStdout();
  EXPECT_EQ(back_up(data(), copies), 0);
  testing::internal::GetCapturedStdout();
  using enum std::filesystem::perms;
  const auto mode = std::filesystem::status(copies / "rights.db").permissions();
  EXPECT_EQ(mode & (group_all | others_all), none);
  const auto copy = make(copies);
  EXPECT_TRUE(eventually([&] {
    return test::ask(copy->port(), "GET", "/v1/sessions/block", "", bearer(eve)).status == 200;
  }));
}

class OpenServer : public WholeServer {
 protected:
  void SetUp() override {
    options.open = true;
    start();
    ASSERT_TRUE(server->sessions().create("block", kBlock.dump(), SceneSource{}));
  }
};

TEST_F(OpenServer, GuestsWatchAndCarveButCannotDestroy) {
  Watcher eve(port);
  EXPECT_EQ(eve.welcome.at("role"), "guest");
  Hand ada(port);
  ada.move({{0, 0, -1}, {0.1, 0, -1}});
  EXPECT_GT(ada.result().removed_mm3, 0);
  const std::string session = "/v1/sessions/block";
  for (const auto& [method, target] :
       {std::pair<const char*, std::string>{"DELETE", session},
        {"POST", "/v1/sessions"},
        {"POST", "/v1/files"},
        {"GET", "/metrics"},
        {"POST", session + "/programs?name=x.ngc"},
        {"DELETE", session + "/participants/" + std::to_string(ada.participant)},
        {"POST", session + "/invitations?role=owner"}}) {
    EXPECT_EQ(ask(method, target, "x").status, 403U) << method << " " << target;
  }
}

TEST(Reach, AServerThatOthersCanReachNeedsRights) {
  const TemporaryFolder folder;
  const auto fault = [&](const char* address, const std::vector<std::string>& proxies) {
    net::ServerOptions options{
        .address = address,
        .port = 0,
        .http = {.data_folder = folder.path(), .proxies = *net::TrustedProxies::parse(proxies)},
        .udp = {.on = false}};
    const auto server = net::Server::create(options);
    const auto listening = (*server)->listen();
    return listening ? std::string() : listening.error();
  };
  EXPECT_TRUE(fault("0.0.0.0", {}).contains("0.0.0.0 can be reached from other machines"));
  EXPECT_TRUE(fault("0.0.0.0", {}).contains("--admin-token-file"));
  EXPECT_TRUE(fault("0.0.0.0", {}).contains("--open"));
  EXPECT_TRUE(fault("127.0.0.1", {"127.0.0.1"}).contains("--admin-token-file"));
  EXPECT_EQ(fault("127.0.0.1", {}), "");
}

TEST(Reach, AnAdministratorsTokenIsLongAndNeverPrinted) {
  const TemporaryFolder folder;
  net::ServerOptions options{.http = {.data_folder = folder.path()}, .admin_token = "too-short"};
  const auto server = net::Server::create(options);
  ASSERT_FALSE(server);
  EXPECT_FALSE(server.error().contains("too-short")) << server.error();
}

TEST(Reach, ServerOnAllAddressesStatesAUsableOne) {
  const TemporaryFolder folder;
  for (const char* address : {"0.0.0.0", "::"}) {
    net::ServerOptions options{.address = address,
                               .port = 0,
                               .http = {.data_folder = folder.path()},
                               .udp = {.on = false},
                               .open = true};
    const auto server = net::Server::create(options);
    ASSERT_TRUE(server);
    ASSERT_TRUE((*server)->listen());
    EXPECT_TRUE((*server)->url().starts_with("http://localhost:")) << (*server)->url();
  }
}

}  // namespace
}  // namespace kerf::test::rights_test
