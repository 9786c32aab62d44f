// SPDX-License-Identifier: Apache-2.0
// Rules for browsers (origins, hosts, headers), metrics, and draining by a request.
#include <unistd.h>

#include <array>
#include <atomic>
#include <fstream>
#include <regex>
#include <set>
#include <string>

#include "tests/server/whole/hand.h"
#include "tests/server/whole/whole_server.h"
#include "tests/support/content_of.h"

namespace kerf::test::pages_test {
namespace {

class Pages : public WholeServer {
 protected:
  void SetUp() override {
    options.http.web_folder = folder / "web";
    std::filesystem::create_directories(folder / "web" / "assets");
    std::ofstream(folder / "web" / "index.html") << "<!doctype html><title>page</title>";
    std::ofstream(folder / "web" / "assets" / "a.js") << "1";
    std::ofstream(folder / "web" / ".secret") << "x";
    options.http.allow_hosts = {"workshop"};
    options.http.allow_origins = {"https://kerf.example"};
    WholeServer::SetUp();
  }
};

TEST_F(Pages, ANameThatAForeignDnsPointsHereIsRejected) {
  for (const std::string& host :
       {std::string("evil.example"), "evil.example:" + std::to_string(port)}) {
    for (const auto& [method, target] : {std::pair{"GET", "/v1/sessions"},
                                         {"DELETE", "/v1/sessions/block"},
                                         {"GET", "/"},
                                         {"GET", "/healthz"}}) {
      EXPECT_EQ(error(method, target, "", {{"Host", host}, {"Origin", "http://" + host}}),
                "421 bad_host")
          << host << target;
    }
  }
  for (const char* host :
       {"127.0.0.1", "localhost:1", "[::1]", "workshop", "WORKSHOP:8080", "kerf.example"}) {
    EXPECT_EQ(ask("GET", "/v1/sessions", "", {{"Host", host}}).status, 200U) << host;
  }
  EXPECT_EQ(info().at("motions"), 0);
}

TEST_F(Pages, FromAllowedOriginsMayReadAndChange) {
  const std::string origin = "https://kerf.example";
  EXPECT_EQ(
      ask("GET", "/v1/sessions", "", {{"Origin", origin}}).header("Access-Control-Allow-Origin"),
      origin);
  const Answer preflight = ask("OPTIONS", "/v1/sessions", "",
                               {{"Origin", origin}, {"Access-Control-Request-Method", "POST"}});
  EXPECT_EQ(preflight.status, 204U);
  EXPECT_EQ(preflight.header("Access-Control-Allow-Origin"), origin);
  EXPECT_TRUE(preflight.header("Access-Control-Allow-Methods").contains("POST"));
  EXPECT_EQ(ask("DELETE", "/v1/sessions/block", "", {{"Origin", origin}}).status, 200U);
}

TEST_F(Pages, FromOtherOriginsMayNeitherReadNorChange) {
  const Headers evil = {{"Origin", "https://evil.example"}};
  const Answer read = ask("GET", "/v1/sessions", "", evil);
  EXPECT_EQ(read.status, 200U);
  EXPECT_EQ(read.header("Access-Control-Allow-Origin"), "");
  Headers asking = evil;
  asking.emplace_back("Access-Control-Request-Method", "POST");
  const Answer preflight = ask("OPTIONS", "/v1/sessions", "", asking);
  EXPECT_EQ(preflight.status, 403U);
  EXPECT_EQ(preflight.header("Access-Control-Allow-Methods"), "");
  EXPECT_EQ(error("DELETE", "/v1/sessions/block", "", evil), "403 bad_origin");
}

TEST_F(Pages, EveryResponseRestrictsWhatABrowserDoesWithIt) {
  for (const char* target :
       {"/", "/v1/sessions", "/v1/sessions/block/model.stl", "/nothing", "/healthz"}) {
    const Answer answer = ask("GET", target);
    EXPECT_EQ(answer.header("X-Content-Type-Options"), "nosniff") << target;
    EXPECT_EQ(answer.header("Referrer-Policy"), "no-referrer") << target;
    EXPECT_TRUE(answer.header("Content-Security-Policy").contains("frame-ancestors 'none'"))
        << target;
  }
  EXPECT_TRUE(ask("GET", "/").header("Content-Security-Policy").contains("script-src 'self'"));
}

TEST_F(Pages, AreServedWithoutHiddenFilesAndFolders) {
  EXPECT_TRUE(ask("GET", "/?session=block").body.contains("<title>page"));
  const Answer script = ask("GET", "/assets/a.js");
  EXPECT_EQ(script.status, 200U);
  EXPECT_EQ(script.header("Content-Type"), "text/javascript; charset=utf-8");
  EXPECT_TRUE(script.header("Cache-Control").contains("immutable"));
  for (const char* target : {"/.secret", "/assets", "/assets/..%2findex.html", "/nothing",
                             "/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd"}) {
    EXPECT_EQ(error("GET", target), "404 not_found") << target;
  }
}

class ForwardedPages : public WholeServer {};

TEST_F(ForwardedPages, AreRejectedWithoutRights) {
  EXPECT_EQ(error("GET", "/v1/sessions", "", {{"X-Forwarded-For", "203.0.113.7"}}),
            "403 forwarded");
  EXPECT_EQ(ask("GET", "/v1/sessions").status, 200U);
}

class Drain : public WholeServer {
 protected:
  void SetUp() override {
    options.http.request_stop = [this] { ++asked_; };
    WholeServer::SetUp();
  }
  std::atomic<int> asked_ = 0;
};

TEST_F(Drain, AnAdministratorDrainsByARequest) {
  for (const char* query : {"", "?to=", "?to=elsewhere", "?to=http://a/b"}) {
    EXPECT_EQ(ask("POST", std::string("/v1/drain") + query).status, 400U) << query;
  }
  EXPECT_EQ(asked_, 0);
  Hand ada(port);
  ada.move({{0, 0, -1}, {1, 0, -1}});
  ada.result();
  const Answer answer = ask("POST", "/v1/drain?to=http://127.0.0.1:9");
  EXPECT_EQ(answer.status, 202U);
  EXPECT_EQ(answer.json(), Json({{"to", "http://127.0.0.1:9"}}));
  EXPECT_TRUE(eventually([&] { return asked_ == 1; }));
  server.reset();  // like the process when it is asked to stop
  EXPECT_EQ(ada.receive("bye").at("redirect"), "http://127.0.0.1:9");
}

/// The server, the README and the dashboard have the same metrics.
class ListedMetrics : public WholeServer {
 protected:
  static std::string source(const std::string& file) {
    return test::content_of(KERF_SOURCE_DIR "/" + file);
  }
  /// Returns all matches of an expression's first group.
  static std::set<std::string> names(const std::string& text, const char* expression) {
    const std::regex pattern(expression, std::regex::multiline);
    std::set<std::string> found;
    for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match)
      found.insert((*match)[1]);
    return found;
  }
  std::set<std::string> served() {
    Hand ada(port);
    ada.move({{0, 0, -1}, {1, 0, -1}});
    ada.result();
    return names(ask("GET", "/metrics").body, "^# TYPE (\\S+)");
  }
};

TEST_F(ListedMetrics, MatchTheReadme) {
  std::set<std::string> listed;
  for (const std::string& cell : names(source("server/metrics/README.md"), "^\\| (`[^|]*)\\|")) {
    listed.merge(names(cell, "\\b(kerf_[a-z_]+)"));
  }
  std::set<std::string> expected = served();
  // Absent here: a counter whose labels have no counts, and the metrics of --nats and TLS.
  expected.insert({"kerf_refused_total", "kerf_copied_record", "kerf_copy_lag_records",
                   "kerf_copied_snapshot_record", "kerf_certificate_days_left"});
  EXPECT_EQ(listed, expected);
}

TEST_F(ListedMetrics, MatchTheDashboard) {
  std::set<std::string> known = served();
  known.insert("kerf_refused_total");
  int expressions = 0;
  const Json dashboard = Json::parse(source("docker/grafana.json"));
  for (const Json& panel : dashboard.at("panels")) {
    for (const Json& target : panel.at("targets")) {
      ++expressions;
      for (std::string name : names(target.at("expr"), "\\b(kerf_[a-z_]+)")) {
        if (name.ends_with("_bucket")) name.resize(name.size() - 7);
        EXPECT_TRUE(known.contains(name)) << name;
      }
    }
  }
  EXPECT_GT(expressions, 12);
}

}  // namespace
}  // namespace kerf::test::pages_test
