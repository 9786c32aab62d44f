// SPDX-License-Identifier: Apache-2.0
// Hostile HTTP requests: each gets its answer, and other clients are served.
#include <algorithm>
#include <string>
#include <vector>

#include "tests/server/whole/hand.h"
#include "tests/server/whole/watcher.h"
#include "tests/server/whole/whole_server.h"

namespace kerf::test::hostile_http_test {
namespace {

using namespace std::string_literals;

const std::string kEnd = "\r\n", kHost = "Host: localhost\r\n",
                  kGet = "GET /healthz HTTP/1.1\r\n" + kHost,
                  kPost = "POST /v1/sessions HTTP/1.1\r\n" + kHost,
                  kUpgrade = "GET /v1/sessions/block/view HTTP/1.1\r\n" + kHost +
                             "Connection: Upgrade\r\n",
                  kKey = "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n",
                  kVersion = "Sec-WebSocket-Version: 13\r\n",
                  kProtocol = "Sec-WebSocket-Protocol: kerf.view.v1\r\n",
                  kWebSocket = "Upgrade: websocket\r\n";

std::string plain(const std::string& first_line) { return first_line + kEnd + kHost + kEnd; }
std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int n = 0; n < count; ++n) all += text;
  return all;
}

struct Row {
  const char* name;
  std::string bytes;
  std::vector<unsigned> statuses;  ///< any of them is correct
};

/// Request lines, and wrong Host fields.
const std::vector<Row> kStarts = {
    {"nothing but a line break", "\r\n\r\n", {400}},
    {"no Host", "GET /healthz HTTP/1.1\r\n\r\n", {400}},
    {"two Hosts", kGet + kHost + kEnd, {400}},
    {"an empty Host, as RFC 9112 allows", "GET /healthz HTTP/1.1\r\nHost:\r\n\r\n", {200}},
    {"a foreign Host", "GET /healthz HTTP/1.1\r\nHost: evil.example\r\n\r\n", {421}},
    {"a Host with a path", "GET /healthz HTTP/1.1\r\nHost: localhost/evil\r\n\r\n", {400, 421}},
    {"a Host with an @", "GET /healthz HTTP/1.1\r\nHost: localhost@evil.example\r\n\r\n", {421}},
    {"a Host with a letter for a port",
     "GET /healthz HTTP/1.1\r\nHost: localhost:x\r\n\r\n",
     {400, 421}},
    {"HTTP 1.0 without Host", "GET /healthz HTTP/1.0\r\n\r\n", {200, 400}},
    {"HTTP 0.9", "GET /healthz\r\n\r\n", {400}},
    {"HTTP 2.0", plain("GET /healthz HTTP/2.0"), {400, 505}},
    {"the preface of HTTP/2", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", {400, 505}},
    {"a version of letters", plain("GET /healthz HTTP/a.b"), {400}},
    {"the hello of TLS",
     "\x16\x03\x01\x02\0\x01\0\x01\xfc\x03\x03"s + std::string(40, '\0'),
     {400}},
    {"an unknown method", plain("BREW /healthz HTTP/1.1"), {405}},
    {"a method in lower case", plain("get /healthz HTTP/1.1"), {400, 405}},
    {"an empty method", plain(" /healthz HTTP/1.1"), {400}},
    {"a method with a bracket", plain("GE(T /healthz HTTP/1.1"), {400}},
    {"CONNECT", plain("CONNECT evil.example:443 HTTP/1.1"), {400, 405}},
    {"TRACE", plain("TRACE /healthz HTTP/1.1"), {405}},
    {"OPTIONS of everything", plain("OPTIONS * HTTP/1.1"), {400}},
    {"PUT of a session",
     "PUT /v1/sessions/block HTTP/1.1\r\n" + kHost + "Content-Length: 0\r\n\r\n",
     {405}},
    {"a target without a slash", plain("GET healthz HTTP/1.1"), {400}},
    {"an empty target", plain("GET  HTTP/1.1"), {400}},
    {"a space in the target", plain("GET /health z HTTP/1.1"), {400}},
    {"a control character in the target", plain("GET /he\x01lthz HTTP/1.1"), {400}},
    {"an encoded zero in the target", plain("GET /healthz%00 HTTP/1.1"), {400, 404}},
    {"a percent sign without digits", plain("GET /%zz HTTP/1.1"), {400}},
    {"a percent sign at the end", plain("GET /% HTTP/1.1"), {400}},
    {"a path out of the folder", plain("GET /../../etc/passwd HTTP/1.1"), {400, 404}},
    {"an encoded path out of the folder",
     plain("GET /%2e%2e/%2e%2e/etc/passwd HTTP/1.1"),
     {400, 404}},
    {"an encoded slash", plain("GET /..%2f..%2fetc%2fpasswd HTTP/1.1"), {400, 404}},
    {"a backslash", plain("GET /..\\..\\etc\\passwd HTTP/1.1"), {400, 404}},
    {"a hidden file", plain("GET /.git/config HTTP/1.1"), {404}},
    {"bytes that are not UTF-8 in the target", plain("GET /\xff\xfe HTTP/1.1"), {400, 404}},
    {"a target of 3000 bytes", plain("GET /" + std::string(3000, 'a') + " HTTP/1.1"), {400, 414}},
    {"a target of 20 kB", plain("GET /" + std::string(20000, 'a') + " HTTP/1.1"), {400, 414, 431}},
    {"a broken query", plain("GET /v1/sessions/block/model.stl?encoding=%f HTTP/1.1"), {400}},
    {"a session id of dots", plain("GET /v1/sessions/.. HTTP/1.1"), {400, 404}},
    {"a program number beyond 64 bits",
     plain("GET /v1/sessions/block/programs/99999999999999999999 HTTP/1.1"),
     {404}},
};

/// Header fields.
const std::vector<Row> kHeaders = {
    {"a header of 20 kB", kGet + "X: " + std::string(20000, 'a') + "\r\n\r\n", {431}},
    {"2000 headers", kGet + repeated("X: y\r\n", 2000) + kEnd, {431}},
    {"a header without a colon", kGet + "nonsense\r\n\r\n", {400}},
    {"a header without a name", kGet + ": value\r\n\r\n", {400}},
    {"a space before the colon", kGet + "X : y\r\n\r\n", {400}},
    {"a header name in parentheses", kGet + "(X): y\r\n\r\n", {400}},
    {"a zero in a header",
     kGet + "X: a\0"
            "b\r\n\r\n"s,
     {400}},
    {"a lone carriage return in a header", kGet + "X: a\rb\r\n\r\n", {400}},
    {"a lone line feed in a header", kGet + "X: a\nY: b\r\n\r\n", {400}},
    {"a foreign Origin that changes something",
     kPost + "Origin: https://evil.example\r\nContent-Length: 0\r\n\r\n",
     {403}},
    {"the Origin null that changes something",
     kPost + "Origin: null\r\nContent-Length: 0\r\n\r\n",
     {403}},
    {"a range of letters", kGet + "Range: bytes=a-b\r\n\r\n", {200}},
    {"a range beyond 64 bits", kGet + "Range: bytes=99999999999999999999-\r\n\r\n", {200, 416}},
    {"a hundred ranges", kGet + "Range: bytes=" + repeated("0-0,", 100) + "1-1\r\n\r\n", {200}},
    {"a wild If-None-Match",
     kGet + "If-None-Match: \"" + std::string(1000, 'a') + ", *\r\n\r\n",
     {200}},
};

/// Lengths and codings of bodies.
const std::vector<Row> kBodies = {
    {"a negative length", kPost + "Content-Length: -1\r\n\r\n", {400}},
    {"a length with a plus", kPost + "Content-Length: +5\r\n\r\nhello", {400}},
    {"a length of letters", kPost + "Content-Length: ten\r\n\r\n", {400}},
    {"a length in hexadecimal", kPost + "Content-Length: 0x5\r\n\r\nhello", {400}},
    {"a length beyond 64 bits", kPost + "Content-Length: 99999999999999999999\r\n\r\n", {400}},
    {"two different lengths",
     kPost + "Content-Length: 5\r\nContent-Length: 6\r\n\r\nhello!",
     {400}},
    {"a list of lengths", kPost + "Content-Length: 5, 6\r\n\r\nhello!", {400}},
    {"length and chunks",
     kPost + "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
     {400}},
    {"an unknown transfer coding", kPost + "Transfer-Encoding: gzip\r\n\r\n", {400, 411, 501}},
    {"chunked twice",
     kPost + "Transfer-Encoding: chunked, chunked\r\n\r\n0\r\n\r\n",
     {400, 411, 501}},
    {"chunked, then another coding",
     kPost + "Transfer-Encoding: chunked, gzip\r\n\r\n0\r\n\r\n",
     {400, 411, 501}},
    {"a body in chunks: its length must be known",
     kPost + "Transfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n",
     {411}},
    {"a body in chunks where none is expected",
     kGet + "Transfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n",
     {411}},
    {"an unknown transfer coding where no body is expected",
     kGet + "Transfer-Encoding: xchunked\r\n\r\n",
     {411}},
    {"a chunk of letters", kPost + "Transfer-Encoding: chunked\r\n\r\nxyz\r\nhello", {411}},
    {"a huge chunk", kPost + "Transfer-Encoding: chunked\r\n\r\n7FFFFFFFFFFFFFFF\r\n", {411}},
    {"a body of 2 MB for a scene", kPost + "Content-Length: 2000000\r\n\r\n", {413}},
    {"a body of a terabyte", kPost + "Content-Length: 1000000000000\r\n\r\n", {413}},
    {"a program of a terabyte",
     "POST /v1/sessions/block/programs HTTP/1.1\r\n" + kHost +
         "Content-Length: 1000000000000\r\n\r\n",
     {413}},
    {"an empty scene", kPost + "Content-Length: 0\r\n\r\n", {400}},
    {"a scene that is not UTF-8", kPost + "Content-Length: 4\r\n\r\n\xff\xfe\xfd\xfc", {400}},
    {"a scene of brackets",
     kPost + "Content-Length: 100000\r\n\r\n" + std::string(100000, '['),
     {400}},
    {"a scene of numbers that overflow",
     kPost + "Content-Length: 25\r\n\r\n{\"name\":1e999,\"stock\":1e9",
     {400}},
    {"a body for a GET", kGet + "Content-Length: 5\r\n\r\nhello", {200, 413}},
    {"a body of 1 MB for a GET", kGet + "Content-Length: 1000000\r\n\r\n", {413}},
};

/// Upgrades.
const std::vector<Row> kUpgrades = {
    {"an upgrade to something else",
     kUpgrade + "Upgrade: h2c\r\n" + kKey + kVersion + kEnd,
     {400, 426}},
    {"an upgrade without a key", kUpgrade + kWebSocket + kVersion + kProtocol + kEnd, {400, 426}},
    {"an upgrade with a short key",
     kUpgrade + kWebSocket + kVersion + kProtocol + "Sec-WebSocket-Key: abc\r\n\r\n",
     {400, 426}},
    {"an upgrade of an old version",
     kUpgrade + kWebSocket + kKey + kProtocol + "Sec-WebSocket-Version: 8\r\n\r\n",
     {400, 426}},
    {"an upgrade by POST",
     "POST" + kUpgrade.substr(3) + kWebSocket + kKey + kVersion + kProtocol + kEnd,
     {400, 405, 426}},
    {"an upgrade without the protocol", kUpgrade + kWebSocket + kKey + kVersion + kEnd, {400}},
};

class HostileHttp : public WholeServer {
 protected:
  /// Returns all answers to `bytes`, after which the peer ends its stream.
  std::string answers(const std::string& bytes) const {
    const Peer peer(port);
    peer.send(bytes);
    peer.end_sending();
    return peer.rest();
  }
  void expect_answers(const std::vector<Row>& rows) {
    for (const Row& row : rows) {
      const unsigned status = read_answer(answers(row.bytes)).status;
      EXPECT_NE(std::ranges::find(row.statuses, status), row.statuses.end())
          << row.name << ": " << status;
    }
  }
  void TearDown() override {
    Hand ada(port);
    ada.move({{-10, 12, -1}});
    ada.move({{-9, 12, -1}});
    EXPECT_GT(ada.result().removed_mm3, 0) << "the server serves the others";
  }
};

TEST_F(HostileHttp, EachFirstLineGetsItsAnswer) { expect_answers(kStarts); }
TEST_F(HostileHttp, EachHeaderGetsItsAnswer) { expect_answers(kHeaders); }
TEST_F(HostileHttp, EachLengthAndCodingGetsItsAnswer) { expect_answers(kBodies); }
TEST_F(HostileHttp, EachUpgradeGetsItsAnswer) { expect_answers(kUpgrades); }

// A proxy that read the rest as the body would forward a smuggled request.
TEST_F(HostileHttp, BytesAfterAnUnknownTransferCodingAreNoRequest) {
  for (const std::string method : {"GET", "OPTIONS"}) {
    const std::string all =
        answers(method + " /v1/sessions HTTP/1.1\r\n" + kHost + "Origin: http://localhost\r\n" +
                "Transfer-Encoding: xchunked\r\n\r\n" + kGet + kEnd);
    EXPECT_TRUE(all.starts_with("HTTP/1.1 ")) << all;
    EXPECT_EQ(all.find("HTTP/1.1 ", 1), all.npos) << all;
  }
}

TEST_F(HostileHttp, ConnectionsCarrySuccessiveRequests) {
  const std::string all = answers(repeated(kGet + kEnd, 3));
  int found = 0;
  for (auto at = all.find("{\"status\":\"ok\"}"); at != all.npos;
       at = all.find("{\"status\":\"ok\"}", at + 1)) {
    ++found;
  }
  EXPECT_EQ(found, 3) << all;
}

// With two, a proxy and the server might see different hosts.
TEST_F(HostileHttp, EveryRequestNeedsOneHost) {
  for (const std::string line :
       {"GET /healthz HTTP/1.1\r\n", "DELETE /v1/sessions/block HTTP/1.1\r\n",
        "GET /v1/sessions/block/agent HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"}) {
    for (const std::string& hosts : {""s, kHost + "Host: b\r\n", kHost + kHost}) {
      const Answer answer = read_answer(answers(line + hosts + kKey + kVersion + kEnd));
      EXPECT_EQ(answer.status, 400U) << line << hosts;
      EXPECT_EQ(answer.code(), "bad_host") << line << hosts;
    }
  }
  EXPECT_EQ(read_answer(answers("GET /healthz HTTP/1.0\r\n\r\n")).status, 200U);
  EXPECT_EQ(info().at("id"), "block");
}

TEST_F(HostileHttp, TwoHundredSlowRequestsDelayNobody) {
  const std::vector<std::string> begun = {kGet, kPost + "Content-Length: 1000\r\n\r\n",
                                          kUpgrade + kWebSocket};
  std::vector<Peer> slow;
  for (std::size_t n = 0; n < 200; ++n) {
    const std::string& request = begun[n % begun.size()];
    slow.emplace_back(port).send(request.substr(0, 5 + n % (request.size() - 5)));
  }
  Hand ada(port);
  Watcher eve(port);
  for (int step = 0; step < 20; ++step) {
    for (const Peer& peer : slow) peer.send("a");
    ada.move({{0.1 * step, 0, -1}});
    ada.result();
    EXPECT_EQ(ask("GET", "/healthz").status, 200U);
  }
  eve.settled(hash());
  EXPECT_EQ(info().at("motions"), 19);
}

class ManyConnections : public HostileHttp {
 protected:
  void SetUp() override {
    options.connections_max = 50;
    HostileHttp::SetUp();
  }
};

TEST_F(ManyConnections, FromOneClientExcludeNobody) {
  Hand ada(port);
  // A client of another network, whose connection is idle meanwhile.
  const Peer patient(port, "127.0.0.2");
  std::vector<Peer> idle;
  for (int n = 0; n < 80; ++n) idle.emplace_back(port).send("GET /healthz");
  const Peer late(port, "127.0.0.3");
  for (const Peer* peer : {&patient, &late}) {
    peer->send(kGet + "Connection: close\r\n\r\n");
    EXPECT_EQ(read_answer(peer->rest()).status, 200U);
  }
  ada.move({{0, 0, -1}, {1, 0, -1}});
  EXPECT_GT(ada.result().removed_mm3, 0);
}

}  // namespace
}  // namespace kerf::test::hostile_http_test
