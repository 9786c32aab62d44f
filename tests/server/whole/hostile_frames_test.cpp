// SPDX-License-Identifier: Apache-2.0
// Frames that violate RFC 6455, peers that vanish, and declined upgrades.
#include <algorithm>
#include <string>
#include <vector>

#include "tests/server/whole/hand.h"
#include "tests/server/whole/watcher.h"
#include "tests/server/whole/whole_server.h"

namespace kerf::test::hostile_frames_test {
namespace {

using namespace std::string_literals;

struct Row {
  std::string name, bytes;
  std::vector<unsigned> codes;  ///< close codes that the server may send; empty for any
};

Row row(std::string name, const Frame& frame, std::vector<unsigned> codes = {1002}) {
  return {std::move(name), bytes_of(frame), std::move(codes)};
}

std::vector<Row> rows() {
  const std::string long_half(35'000, 'x');
  std::vector<Row> rows = {
      row("an unmasked text", {.payload = "{}", .is_masked = false}),
      row("an unmasked binary", {.first = 0x82, .payload = "abc", .is_masked = false}),
      row("an unmasked ping", {.first = 0x89, .payload = "", .is_masked = false}),
      row("all reserved bits", {.first = 0xF2, .payload = "abc"}),
      row("a continuation of nothing", {.first = 0x80, .payload = "x"}),
      row("a fragmented ping", {.first = 0x09, .payload = "x"}),
      row("a ping of 126 bytes", {.first = 0x89, .payload = std::string(126, 'x')}),
      row("a close of 126 bytes", {.first = 0x88, .payload = "\x03\xE8" + std::string(124, 'x')}),
      row("a close of one byte", {.first = 0x88, .payload = "\x03"}),
      row("a close with code 999", {.first = 0x88, .payload = "\x03\xE7"}),
      row("a close with code 1005", {.first = 0x88, .payload = "\x03\xED"}),
      row("a close with code 1006", {.first = 0x88, .payload = "\x03\xEE"}),
      row("a close whose reason is not UTF-8", {.first = 0x88, .payload = "\x03\xE8\xFF\xFE"}, {}),
      row("a length of 16 bits for five bytes",
          {.first = 0x82, .payload = "xxxxx", .length = "\x7E\0\x05"s}),
      row("a length of 64 bits for five bytes",
          {.first = 0x82, .payload = "xxxxx", .length = "\x7F" + std::string(7, '\0') + "\x05"}),
      row("a negative length",
          {.first = 0x82, .payload = "", .length = "\x7F" + std::string(8, '\xFF')}, {1002, 1009}),
      row("a length of 4 EB",
          {.first = 0x82, .payload = "", .length = "\x7F\x40" + std::string(7, '\0')}, {1009}),
      row("a message of 70 kB", {.first = 0x82, .payload = long_half + long_half}, {1009}),
      row("a text that is not UTF-8", {.payload = "\xFF\xFE"}, {}),
  };
  for (const int bit : {0x10, 0x20, 0x40}) {
    rows.push_back(row("reserved bit " + std::to_string(bit),
                       {.first = static_cast<unsigned char>(0x81 | bit), .payload = "{}"}));
  }
  for (const int opcode : {3, 4, 5, 6, 7, 11, 12, 13, 14, 15}) {
    rows.push_back(row("opcode " + std::to_string(opcode),
                       {.first = static_cast<unsigned char>(0x80 | opcode), .payload = ""}));
  }
  rows.push_back({"a text inside a fragmented text",
                  bytes_of({.first = 0x01, .payload = "{"}) + bytes_of({.payload = "}"}),
                  {1002}});
  rows.push_back({"fragments of 70 kB together",
                  bytes_of({.first = 0x02, .payload = long_half}) +
                      bytes_of({.first = 0x80, .payload = long_half}),
                  {1009}});
  return rows;
}

using HostileFrames = WholeServer;

TEST_F(HostileFrames, EachViolationClosesItsOwnConnection) {
  Hand ada(port);
  for (const Row& row : rows()) {
    Watcher mallory(port, {{"name", "Mallory"}});
    mallory.peer().send(row.bytes);
    const unsigned code = mallory.closed();
    const bool is_right =
        row.codes.empty() || std::ranges::find(row.codes, code) != row.codes.end();
    EXPECT_TRUE(is_right) << row.name << ": " << code;
  }
  Hand bad(port, "block", "Mallory");
  bad.peer().send(bytes_of({.first = 0x82, .payload = std::string(70'000, '\0')}));
  EXPECT_EQ(bad.closed(), 1009U) << "of an agent too";
  ada.move({{0, 0, -1}, {1, 0, -1}});
  EXPECT_GT(ada.result().removed_mm3, 0);
}

TEST_F(HostileFrames, AnAgentWhoseConnectionBreaksIsRemoved) {
  Hand ada(port);
  {
    Hand bob(port, "block", "Bob");
    while (ada.receive("participants").at("participants").size() < 2) continue;
    bob.peer().reset();
  }
  Json people = ada.receive("participants").at("participants");
  while (people.size() > 1) people = ada.receive("participants").at("participants");
  EXPECT_EQ(people.at(0).at("name"), "Ada");
}

TEST_F(HostileFrames, AckOfAnUnsentFrameIsABadSequence) {
  Watcher eve(port);
  eve.settled();
  const std::uint32_t epoch = eve.welcome.at("epoch");
  eve.send_binary(frame_of(wire::Ack{}, epoch, 12'345));
  EXPECT_EQ(eve.receive("error").at("code"), "bad_sequence");
  eve.send_binary(frame_of(wire::Ack{}, epoch + 1, 1));
  EXPECT_EQ(eve.receive("error").at("code"), "bad_epoch");
}

TEST_F(HostileFrames, AnUpgradeIsDeclinedWithItsReason) {
  const struct {
    const char *target, *protocol, *answer;
    Headers headers;
  } cases[] = {
      {"nobody/agent", "kerf.agent.v1", "404 unknown_session", {}},
      {"nobody/view", "kerf.view.v1", "404 unknown_session", {}},
      {"block/agent", "kerf.view.v1", "400 bad_protocol", {}},
      {"block/agent", "kerf.agent.v9", "400 bad_protocol", {}},
      {"block/view", "", "400 bad_protocol", {}},
      {"block/view", "kerf.view.v1", "403 bad_origin", {{"Origin", "https://evil.example"}}},
      {"block/agent",
       "kerf.agent.v1",
       "421 bad_host",
       {{"Host", "evil.example"}, {"Origin", "http://evil.example"}}},
      {"block/view",
       "kerf.view.v1",
       "421 bad_host",
       {{"Host", "evil.example"}, {"Origin", "http://evil.example"}}},
      {"block/spy", "kerf.view.v1", "404 not_found", {}},
  };
  for (const auto& [target, protocol, answer, headers] : cases) {
    const WebPeer peer(port, "/v1/sessions/"s + target, protocol, headers);
    EXPECT_EQ(std::to_string(peer.upgrade().status) + " " + peer.upgrade().code(), answer)
        << target << " " << protocol;
  }
  const WebPeer own(port, "/v1/sessions/block/view", "kerf.view.v1",
                    {{"Origin", "http://127.0.0.1:" + std::to_string(port)}});
  EXPECT_EQ(own.upgrade().status, 101U);
  EXPECT_EQ(error("GET", "/v1/sessions/block/agent"), "426 upgrade_required");
}

}  // namespace
}  // namespace kerf::test::hostile_frames_test
