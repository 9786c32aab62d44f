// SPDX-License-Identifier: Apache-2.0
#include "server/http/proxies.h"

#include "server/http/request_head.h"
#include "tests/support/test.h"

namespace kerf::net::proxies_test {
namespace {

TrustedProxies proxies(const std::vector<std::string>& texts) {
  auto parsed = TrustedProxies::parse(texts);
  EXPECT_TRUE(parsed) << parsed.error();
  return parsed.value_or(TrustedProxies());
}

RequestHead forwarded_head() {
  return RequestHead{.host = "127.0.0.1:8080",
                     .address = "10.0.0.7",
                     .forwarded_for = "203.0.113.9",
                     .forwarded_host = "kerf.example",
                     .forwarded_proto = "https"};
}

TEST(TrustedProxies, AreAddressesAndNetworksOfBothFamilies) {
  const TrustedProxies some = proxies({"10.0.0.0/12", "192.168.1.5", "fd00::/8", "::1"});
  for (const char* inside :
       {"10.0.0.1", "10.15.255.255", "192.168.1.5", "fd12::1", "::1", "::ffff:10.1.2.3"}) {
    EXPECT_TRUE(some.contains(inside)) << inside;
  }
  for (const char* outside :
       {"10.16.0.1", "11.0.0.1", "192.168.1.6", "fe80::1", "::2", "", "x", "10.0.0.1:80"}) {
    EXPECT_FALSE(some.contains(outside)) << outside;
  }
  EXPECT_FALSE(proxies({}).contains("127.0.0.1"));
  EXPECT_TRUE(proxies({"0.0.0.0/0"}).contains("8.8.8.8"));
  EXPECT_FALSE(proxies({"0.0.0.0/0"}).contains("fd00::1"));
}

TEST(TrustedProxies, AnythingElseIsAnError) {
  for (const char* bad : {"", "localhost", "10.0.0.0/33", "10.0.0.0/", "10.0.0.0/-1", "::1/129",
                          "10.0.0.0/8/8", "10.0.0.0/8 "}) {
    EXPECT_FALSE(TrustedProxies::parse({bad})) << bad;
  }
}

TEST(TrustedProxies, ClientIsTheLastUntrustedAddress) {
  const TrustedProxies some = proxies({"10.0.0.0/8"});
  EXPECT_EQ(client_of("203.0.113.9", some), "203.0.113.9");
  // The client itself controls the values before it.
  EXPECT_EQ(client_of("10.1.1.1, 1.2.3.4, 203.0.113.9 , 10.0.0.3", some), "203.0.113.9");
  EXPECT_EQ(client_of("203.0.113.9:4711", some), "203.0.113.9");
  EXPECT_EQ(client_of("[2001:db8::1]:80", some), "2001:db8::1");
  EXPECT_EQ(client_of("10.0.0.1", some), "");
  EXPECT_EQ(client_of("unknown, 10.0.0.1", some), "");
  EXPECT_EQ(client_of("[", some), "");
  EXPECT_EQ(client_of("", some), "");
}

TEST(TrustedProxies, OnlyTrustedProxiesNameClients) {
  RequestHead head = forwarded_head();
  apply_forwarding(head, proxies({"10.0.0.0/8"}));
  EXPECT_EQ(head.address, "203.0.113.9");
  EXPECT_EQ(head.host, "kerf.example");
  EXPECT_TRUE(head.is_secure);

  RequestHead stranger = forwarded_head();
  apply_forwarding(stranger, proxies({"10.0.0.8"}));
  EXPECT_EQ(stranger.address, "10.0.0.7");
  EXPECT_EQ(stranger.host, "127.0.0.1:8080");
  EXPECT_FALSE(stranger.is_secure);
}

TEST(TrustedProxies, AForwardedNameMustBeAllowedToo) {
  RequestHead head = forwarded_head();
  head.target = "/healthz";
  HttpOptions options;
  apply_forwarding(head, proxies({"10.0.0.7"}));
  EXPECT_EQ(test::error_of(screen(head, options)).status, 421u);
  options.allow_hosts = {"kerf.example"};
  EXPECT_TRUE(screen(head, options));
}

TEST(NetworkOf, Ipv6ClientsAreGroupedBy64Bits) {
  EXPECT_EQ(network_of("203.0.113.9"), "203.0.113.9");
  EXPECT_EQ(network_of("::ffff:203.0.113.9"), "203.0.113.9");
  EXPECT_EQ(network_of("2001:db8:1:2:3:4:5:6"), network_of("2001:db8:1:2::9"));
  EXPECT_NE(network_of("2001:db8:1:2::9"), network_of("2001:db8:1:3::9"));
  EXPECT_EQ(network_of("x"), "x");
}

}  // namespace
}  // namespace kerf::net::proxies_test
