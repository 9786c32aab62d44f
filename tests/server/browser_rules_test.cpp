// SPDX-License-Identifier: Apache-2.0
#include "server/http/browser_rules.h"

#include "tests/support/test.h"

namespace kerf::net::browser_rules_test {
namespace {

std::string header(const ApiResponse& response, std::string_view name) {
  for (const auto& [key, value] : response.headers) {
    if (key == name) return value;
  }
  return "";
}

HttpOptions options_with(std::vector<std::string> hosts, std::vector<std::string> origins) {
  return HttpOptions{.allow_hosts = std::move(hosts), .allow_origins = std::move(origins)};
}

TEST(ServerAddress, HasASchemeAHostAndNoPath) {
  for (const char* good : {"http://127.0.0.1:8081", "https://kerf.example", "https://[::1]:8443"}) {
    EXPECT_TRUE(is_server_address(good)) << good;
  }
  for (const char* bad :
       {"", "kerf.example", "ftp://kerf.example", "http://", "http://a/b", "http://a?b",
        "http://a b", "http://a@b", "http://a:x", "http://[::1", "http://a:", "http://a:0",
        "http://a:99999", "http://]:1", "http://[a]:1", "http://a:80:81", "http://[::1]x"}) {
    EXPECT_FALSE(is_server_address(bad)) << bad;
  }
}

TEST(BrowserRules, AddressesAndLocalhostAreAllowedAsHosts) {
  const HttpOptions plain;
  for (const char* host : {"127.0.0.1", "127.0.0.1:8080", "192.168.1.7:80", "[::1]", "[::1]:8080",
                           "[fe80::1]:8080", "localhost", "localhost:8080", "LOCALHOST", ""}) {
    EXPECT_TRUE(host_allowed(host, plain)) << host;
  }
}

TEST(BrowserRules, OtherNamesAreRejectedAsHosts) {
  const HttpOptions plain;
  for (const char* host :
       {"evil.example", "evil.example:8080", "localhost.evil.example", "127.0.0.1.evil.example",
        "evil.localhost", "localhost:8080x", "localhost:999999", "[::1", "[::1]x", "[localhost]x",
        "1.2.3", "0x7f000001", "127.1", ":8080", "localhost; script-src *"}) {
    EXPECT_FALSE(host_allowed(host, plain)) << host;
  }
}

TEST(BrowserRules, NamedHostsAndTheHostsOfNamedOriginsAreAllowed) {
  const HttpOptions named = options_with({"workshop", "kerf.lan:8443"}, {"https://kerf.example"});
  for (const char* host : {"workshop", "Workshop:8080", "kerf.lan:8443", "kerf.lan", "kerf.example",
                           "kerf.example:443"}) {
    EXPECT_TRUE(host_allowed(host, named)) << host;
  }
  EXPECT_FALSE(host_allowed("workshop.evil.example", named));
  EXPECT_FALSE(host_allowed("https://kerf.example", named));
}

TEST(BrowserRules, AnOriginThatEqualsAForeignHostIsNotAllowed) {
  const HttpOptions named = options_with({"workshop"}, {"https://kerf.example"});
  EXPECT_FALSE(origin_allowed({"evil.example:8080", "http://evil.example:8080"}, named));
  EXPECT_TRUE(origin_allowed({"127.0.0.1:8080", "http://127.0.0.1:8080"}, named));
  EXPECT_TRUE(origin_allowed({"workshop:8080", "http://workshop:8080"}, named));
  EXPECT_TRUE(origin_allowed({"127.0.0.1:8080", "https://kerf.example"}, named));
  EXPECT_TRUE(origin_allowed({"127.0.0.1:8080", ""}, named));
  for (const char* origin : {"null", "http://127.0.0.1:8081", "https://kerf.example.evil",
                             "http://kerf.example", "://"}) {
    EXPECT_FALSE(origin_allowed({"127.0.0.1:8080", origin}, named)) << origin;
  }
}

TEST(BrowserRules, PageLoadsFromItsOwnServerOnly) {
  ApiResponse page{.content_type = "text/html; charset=utf-8"};
  add_browser_headers({"localhost:8080", ""}, {}, page);
  const std::string policy = header(page, "Content-Security-Policy");
  EXPECT_TRUE(policy.contains("default-src 'self';"));
  EXPECT_TRUE(policy.contains("frame-ancestors 'none'"));
  EXPECT_TRUE(policy.contains("connect-src 'self' ws://localhost:8080 wss://localhost:8080"));
  EXPECT_FALSE(policy.contains("'unsafe-eval'"));
  EXPECT_EQ(header(page, "X-Content-Type-Options"), "nosniff");
  EXPECT_EQ(header(page, "X-Frame-Options"), "DENY");
  EXPECT_EQ(header(page, "Referrer-Policy"), "no-referrer");
  ApiResponse data;
  add_browser_headers({"localhost:8080", ""}, {}, data);
  EXPECT_EQ(header(data, "Content-Security-Policy"), "default-src 'none'; frame-ancestors 'none'");
}

TEST(BrowserRules, TlsIsStickyExceptForLocalhost) {
  const auto transport = [](std::string_view host, bool is_secure) {
    ApiResponse page;
    add_browser_headers({.host = host, .origin = "", .is_secure = is_secure}, {}, page);
    return header(page, "Strict-Transport-Security");
  };
  EXPECT_TRUE(transport("kerf.example", true).starts_with("max-age="));
  EXPECT_EQ(transport("kerf.example", false), "");
  EXPECT_EQ(transport("localhost:8080", true), "") << "other ports are other programs";
}

TEST(BrowserRules, ThePageMayAlsoUseTheOtherServersOfItsCluster) {
  HttpOptions options;
  options.other_servers = [] {
    return std::vector<std::string>{"http://10.0.0.2:8080", "https://heir.example"};
  };
  ApiResponse page{.content_type = "text/html"};
  add_browser_headers({"localhost:8080", ""}, options, page);
  EXPECT_TRUE(header(page, "Content-Security-Policy")
                  .contains(" http://10.0.0.2:8080 ws://10.0.0.2:8080"
                            " https://heir.example wss://heir.example data:"));
}

TEST(BrowserRules, PagesOfTheClusterMayUseThisServerWithTheirPass) {
  HttpOptions options;
  options.page_servers = [] { return std::vector<std::string>{"http://10.0.0.2:8080"}; };
  options.allow_origins = {"https://site.example"};
  const auto with_pass = [&](std::string_view origin) {
    ApiResponse data;
    add_browser_headers({"localhost:8080", origin}, options, data);
    EXPECT_EQ(header(data, "Access-Control-Allow-Origin"),
              origin_allowed({"localhost:8080", origin}, options) ? origin : "");
    return header(data, "Access-Control-Allow-Credentials");
  };
  EXPECT_EQ(with_pass("http://10.0.0.2:8080"), "true");
  EXPECT_EQ(with_pass("https://site.example"), "");
  EXPECT_EQ(with_pass("http://10.0.0.3:8080"), "");
}

TEST(BrowserRules, WorkersMayRunWebAssembly) {
  ApiResponse script{.content_type = "text/javascript; charset=utf-8"};
  add_browser_headers({"localhost:8080", ""}, {}, script);
  EXPECT_EQ(header(script, "Content-Security-Policy"),
            "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; frame-ancestors 'none'");
}

TEST(BrowserRules, NamedSitesMayFrameTheEmbeddedPageOnly) {
  HttpOptions options;
  const auto frames = [&](std::string_view target, const char* type = "text/html") {
    ApiResponse response{.content_type = type};
    add_browser_headers({.host = "localhost", .origin = "", .target = target}, options, response);
    const std::string policy = header(response, "Content-Security-Policy");
    const auto begin = policy.find("frame-ancestors ");
    const bool is_denied = header(response, "X-Frame-Options") == "DENY";
    const std::string sites = policy.substr(begin + std::string_view("frame-ancestors ").size());
    EXPECT_EQ(is_denied, sites == "'none'") << target;
    return sites;
  };
  EXPECT_EQ(frames("/?session=a&embed"), "'none'");
  options.embed_origins = {"https://wiki.example", "http://10.0.0.1:81"};
  for (const char* target : {"/?session=a&embed", "/?embed=1", "/?%65mbed&session=a"}) {
    EXPECT_EQ(frames(target), "https://wiki.example http://10.0.0.1:81") << target;
  }
  for (const char* target : {"/", "/?session=a", "/?session=embed", "/?Embed", "/?session=a#embed",
                             "/index.html?embed", "/?embed%", ""}) {
    EXPECT_EQ(frames(target), "'none'") << target;
  }
  EXPECT_EQ(frames("/?embed", "application/json"), "'none'");
}

TEST(BrowserRules, OnlyPagesOfNamedOriginsMayReadResponses) {
  const HttpOptions named = options_with({}, {"https://kerf.example"});
  const auto allowed = [&](const char* origin) {
    ApiResponse response;
    add_browser_headers({"127.0.0.1", origin}, named, response);
    EXPECT_EQ(header(response, "Vary"), "Origin");
    return header(response, "Access-Control-Allow-Origin");
  };
  EXPECT_EQ(allowed("https://kerf.example"), "https://kerf.example");
  EXPECT_EQ(allowed("https://evil.example"), "");
  EXPECT_EQ(allowed(""), "");
}

}  // namespace
}  // namespace kerf::net::browser_rules_test
