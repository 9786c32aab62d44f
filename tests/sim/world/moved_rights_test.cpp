// SPDX-License-Identifier: Apache-2.0
// Rights, reserved regions, target parts and programs move with a session to the server that goes
// on with it.
#include <string>

#include "tests/sim/world/cluster.h"

namespace kerf::sim::moved_rights_test {
namespace {

const std::string kAdmin = kAdminToken;
const std::string kSession = "/v1/sessions/block";
constexpr const char* kTetrahedron =
    "solid t\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\n"
    "endfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\n"
    "endfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\n"
    "endfacet\nfacet normal 0 0 0\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\n"
    "endfacet\nendsolid t\n";

std::string bearer(const std::string& token) { return "Authorization: Bearer " + token + "\r\n"; }
std::string with_cookie(const std::string& cookie) { return "Cookie: " + cookie + "\r\n"; }

/// A program with so many cutting blocks.
std::string zigzag(int blocks) {
  std::string text = "G21 G90 G17 G94\nT2 M6\nG0 X0 Y0 Z5\nG1 Z-2 F3000\n";
  for (int n = 0; n < blocks; ++n) {
    text += "G1 X" + std::to_string(n % 2) + " Y" + std::to_string(0.01 * n) + " F6000\n";
  }
  return text + "M2\n";
}

class MovedRights : public ClusterTest {
 protected:
  static void start(Cluster& servers, const std::string& name, Follow follow = Follow::kNone) {
    servers.start(name, [follow](net::ServerOptions& options) {
      options.admin_token = kAdmin;
      options.cluster.follow = follow;
    });
  }
  static Json done(Cluster& servers, const std::string& at, const std::string& method,
                   const std::string& target, const std::string& fields,
                   const std::string& body = {}) {
    const auto answer = servers.ask(at, method, target, body, fields);
    EXPECT_EQ(answer.status / 100, 2) << method << " " << target << ": " << answer.body;
    return answer.status / 100 == 2 ? Json::parse(answer.body) : Json::object();
  }
  static Json invite(Cluster& servers, const std::string& query) {
    return done(servers, "a", "POST", kSession + "/invitations?" + query, bearer(kAdmin));
  }
  /// The cookie of a pass that is given for an invitation.
  static std::string redeem(Cluster& servers, const std::string& at, const std::string& token,
                            const std::string& name) {
    const auto answer = servers.ask(at, "POST", kSession + "/join?name=" + name, {}, bearer(token));
    EXPECT_EQ(answer.status, 201) << answer.body;
    return answer.cookie;
  }
  static int status(Cluster& servers, const std::string& at, const std::string& fields) {
    return servers.ask(at, "GET", kSession, {}, fields).status;
  }
  static bool is_here(Cluster& servers, const std::string& at) {
    const Json info = servers.info(at, "block", bearer(kAdmin));
    return info.is_object() && info.at("paused").is_null() && info.at("followed") == false;
  }
  static void create(Cluster& servers) {
    EXPECT_TRUE(servers.until([&] {
      return servers.ask("a", "POST", "/v1/sessions?id=block&here=1", kScene, bearer(kAdmin))
                 .status == 201;
    }));
  }
  /// The program that ran is listed as stopped; the one that had ended is not.
  static void check_program(Cluster& servers, const std::string& text, int line) {
    const Json listed =
        done(servers, "b", "GET", kSession + "/programs", bearer(kAdmin)).at("programs");
    ASSERT_EQ(listed.size(), 1U);
    EXPECT_EQ(listed[0].at("name"), "job.ngc");
    EXPECT_EQ(listed[0].at("state"), "cancelled");
    EXPECT_GE(listed[0].at("line").get<int>(), line - 1) << "it went on between look and end";
    EXPECT_TRUE(listed[0].at("error").get<std::string>().contains(
        "all before line " + listed[0].at("line").dump() + " is cut"));
    EXPECT_EQ(
        servers
            .ask("b", "GET", listed[0].at("url").get<std::string>() + "/source", {}, bearer(kAdmin))
            .body,
        text);
  }
  static void move(Cluster& servers, bool by_kill, Follow follow) {
    start(servers, "a");
    create(servers);
    const std::string link = invite(servers, "role=watcher").at("token");
    const std::string unused = invite(servers, "role=owner&uses=1").at("token");
    const std::string named = invite(servers, "role=sculptor&name=Grace").at("token");
    const Json revoked = invite(servers, "role=sculptor");
    const std::string eve = redeem(servers, "a", link, "Eve");
    const std::string gone = redeem(servers, "a", revoked.at("token"), "Bob");
    done(servers, "a", "POST", kSession + "/regions?min_mm=2,2,-5&max_mm=9,9,0", bearer(kAdmin));
    const Json regions = done(servers, "a", "GET", kSession + "/regions", bearer(kAdmin));
    const Json part = done(servers, "a", "POST", kSession + "/targets?name=t.stl&shift_mm=1,2,3",
                           bearer(named), kTetrahedron);
    const Json brief = done(servers, "a", "POST", kSession + "/programs?name=short.ngc&pace=fast",
                            bearer(kAdmin), zigzag(3));
    const std::string text = zigzag(3000);
    const Json job = done(servers, "a", "POST", kSession + "/programs?name=job.ngc&speed=0.1",
                          bearer(kAdmin), text);
    start(servers, "b", follow);
    // Who shows a token is sent to the session, at the other server; strangers are not.
    EXPECT_TRUE(servers.until([&] {
      const int shown = status(servers, "b", bearer(named));
      return shown == 200 || shown == 307;
    }));
    EXPECT_EQ(status(servers, "b", {}), 401);
    done(servers, "a", "DELETE", kSession + "/invitations/" + revoked.at("id").get<std::string>(),
         bearer(kAdmin));
    const auto state = [&](const Json& program, const char* field) {
      return done(servers, "a", "GET", program.at("url"), bearer(kAdmin)).at(field);
    };
    EXPECT_TRUE(servers.until([&] { return state(brief, "state") == "finished"; }));
    EXPECT_TRUE(servers.until([&] { return state(job, "line") > 4; }));
    const int line = state(job, "line");
    // The program adds records all the time: wait for those until now.
    const std::uint64_t last = servers.info("a", "block", bearer(kAdmin)).at("state_sequence");
    EXPECT_TRUE(servers.until([&] {
      const Json copied = servers.info("a", "block", bearer(kAdmin)).at("copied");
      return copied.is_object() && copied.at("record") >= last;
    }));
    by_kill ? servers.kill("a") : servers.stop("a");
    EXPECT_TRUE(servers.until([&] { return is_here(servers, "b"); }));
    EXPECT_EQ(status(servers, "b", with_cookie(eve)), 200);
    EXPECT_EQ(status(servers, "b", bearer(revoked.at("token"))), 401);
    EXPECT_EQ(status(servers, "b", with_cookie(gone)), 401);
    const std::string zoe = redeem(servers, "b", unused, "Zoe");
    EXPECT_EQ(servers.ask("b", "POST", kSession + "/join", {}, bearer(unused)).status, 409);
    // An owner invites, a watcher does not.
    const auto invites = [&](const std::string& cookie) {
      return servers
          .ask("b", "POST", kSession + "/invitations?role=watcher", {},
               with_cookie(cookie) + "Origin: " + servers.address("b") + "\r\n")
          .status;
    };
    EXPECT_EQ(invites(zoe), 201);
    EXPECT_EQ(invites(eve), 403);
    EXPECT_EQ(done(servers, "b", "GET", kSession + "/regions", bearer(named)), regions);
    EXPECT_EQ(done(servers, "b", "GET", kSession + "/targets", bearer(named)).at("targets"),
              Json::array({part}));
    check_program(servers, text, line);
  }
};

TEST_F(MovedRights, AfterAKill) {
  EXPECT_EQ(faults_of([](Cluster& servers) { move(servers, true, Follow::kNone); }), "");
}

TEST_F(MovedRights, AfterAPlannedStop) {
  EXPECT_EQ(faults_of([](Cluster& servers) { move(servers, false, Follow::kNone); }), "");
}

TEST_F(MovedRights, AfterAKillWithAServerThatFollows) {
  EXPECT_EQ(faults_of([](Cluster& servers) { move(servers, true, Follow::kAll); }), "");
}

TEST_F(MovedRights, AServerThatFollowsKnowsPassesAndEndsThoseThatAreRevoked) {
  EXPECT_EQ(
      faults_of([](Cluster& servers) {
        start(servers, "a");
        create(servers);
        const Json invitation = invite(servers, "role=watcher");
        start(servers, "b", Follow::kAll);
        const std::string token = invitation.at("token");
        EXPECT_TRUE(servers.until([&] { return status(servers, "b", bearer(token)) == 200; }));
        Page page("block", {servers.at("b").port()}, 7, token);
        page.start();
        const std::string hash = servers.info("a", "block", bearer(token)).at("state_hash");
        EXPECT_TRUE(page.shows(std::stoull(hash, nullptr, 16), 10 * kSecond));
        done(servers, "a", "DELETE",
             kSession + "/invitations/" + invitation.at("id").get<std::string>(), bearer(kAdmin));
        // The follower does not know it any more: the owner has the last word.
        EXPECT_TRUE(servers.until([&] { return status(servers, "b", bearer(token)) == 307; }));
        EXPECT_EQ(status(servers, "a", bearer(token)), 401);
        sleep_until(now() + kSecond);
        page.stop();
        ASSERT_FALSE(page.errors().empty());
        EXPECT_EQ(page.errors().front(), "the invitation was revoked");
      }),
      "");
}

}  // namespace
}  // namespace kerf::sim::moved_rights_test
