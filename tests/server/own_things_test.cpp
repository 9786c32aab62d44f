// SPDX-License-Identifier: Apache-2.0
// Every command on an item that somebody has made, by every role, for the caller's own item and for
// another's.
#include "tests/server/api_rights_fixture.h"
#include "tests/support/test.h"

namespace kerf::net::own_things_test {
namespace {

const std::string kBlock = "/v1/sessions/block/";
/// At feed rate this runs until it is cancelled: the executor has no clock.
const std::string kProgramText = "G21 G90\nT1 M6\nG0 X0 Y0 Z5\nG1 Z-1 F60\nG1 X9\nG1 X0\nM30\n";
const std::string kPartText =
    "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

enum class Thing : std::uint8_t { kProgram, kPin, kVersion, kTarget, kStroke, kUndoneStroke };

/// A command. "#" stands for the item.
struct Command {
  const char* name;
  Thing thing;
  const char *method, *path;
  bool changes_block = false;  ///< rejected for muted callers
};

constexpr Command kCommands[] = {
    {"Pause", Thing::kProgram, "PATCH", "programs/#?do=pause"},
    {"Resume", Thing::kProgram, "PATCH", "programs/#?do=resume", true},
    {"Step", Thing::kProgram, "PATCH", "programs/#?do=step", true},
    {"Pace", Thing::kProgram, "PATCH", "programs/#?pace=fast", true},
    {"Speed", Thing::kProgram, "PATCH", "programs/#?speed=2", true},
    {"Cancel", Thing::kProgram, "DELETE", "programs/#"},
    {"RemovePin", Thing::kPin, "DELETE", "pins/#"},
    {"RenameVersion", Thing::kVersion, "PATCH", "versions/#?name=renamed"},
    {"DeleteVersion", Thing::kVersion, "DELETE", "versions/#"},
    {"ReplaceTarget", Thing::kTarget, "POST", "targets?name=#"},
    {"DeleteTarget", Thing::kTarget, "DELETE", "targets/#"},
    {"Undo", Thing::kStroke, "POST", "undo?strokes=#", true},
    {"Redo", Thing::kUndoneStroke, "POST", "redo?strokes=#", true},
};

class OwnThings : public ApiRightsTest, public testing::WithParamInterface<Command> {
 protected:
  void SetUp() override {
    ApiRightsTest::SetUp();
    ada_ = invite("role=sculptor&name=Ada");
    bo_ = invite("role=sculptor&name=Bo");
  }
  ApiResponse send(const std::string& method, const std::string& path, const std::string& token,
                   const std::string& body = {}) {
    ApiRequest request = *parse_target(kBlock + path);
    request.method = method;
    request.token = token;
    request.body = body;
    return api->handle(request);
  }
  std::string member(const ApiResponse& response, const char* name) {
    EXPECT_EQ(response.status / 100, 2U) << response.body;
    return Json::parse(response.body).at(name).dump();
  }
  /// Cuts a stroke with the token's agent, which stays. Returns the stroke's number.
  std::string stroke(const std::string& token) {
    const ParticipantId id = join(token);
    const std::uint64_t first = session->sequence() + 1;
    wire::MotionSample samples[2];
    for (std::uint64_t n = 0; n < 2; ++n) {
      samples[n].agent_sequence = n + 1;
      samples[n].time_us = 1000 * (n + 1);
      samples[n].tip_mm = {10 + 0.1 * double(n), 0, -1};
      samples[n].tool_id = 1;
      samples[n].buttons = wire::kButtonCutting;
    }
    EXPECT_TRUE(session->move(id, samples).rejections.empty());
    return std::to_string(first);
  }
  /// Makes an item and returns its name in paths.
  std::string make(Thing thing, const std::string& token) {
    switch (thing) {
      case Thing::kProgram:
        return member(send("POST", "programs?pace=feed", token, kProgramText), "id");
      case Thing::kPin:
        return member(send("POST", "pins?text=here&at_mm=0,0,0&normal=0,0,1", token), "pin");
      case Thing::kVersion:
        send("DELETE", "versions/renamed", kAdmin);
        send("DELETE", "versions/mine", kAdmin);
        member(send("POST", "versions?name=mine", token), "name");
        return "mine";
      case Thing::kTarget:
        send("DELETE", "targets/part.obj", kAdmin);
        member(send("POST", "targets?name=part.obj", token, kPartText), "name");
        return "part.obj";
      case Thing::kStroke:
        return stroke(token);
      case Thing::kUndoneStroke: {
        const std::string id = stroke(token);
        member(send("POST", "undo?strokes=" + id, kAdmin), "sequence");
        return id;
      }
    }
    return "";
  }
  ApiResponse command(const std::string& thing, const std::string& token) {
    std::string path = GetParam().path;
    path.replace(path.find('#'), 1, thing);
    return send(GetParam().method, path, token,
                GetParam().thing == Thing::kTarget ? kPartText : "");
  }
  std::string grant_of(const std::string& token) { return access->identify(token, "block").grant; }
  void set_role(const std::string& token, Role role) {
    ASSERT_TRUE(access->set_role(grant_of(token), role));
    session->people().set_role_of(grant_of(token), role);
  }
  static std::string code(const ApiResponse& response) {
    return Json::parse(response.body).at("error").at("code");
  }

  std::string ada_, bo_;
};

TEST_P(OwnThings, SculptorsControlTheirOwnThingsAndOwnersAll) {
  for (const Role role : {Role::kWatcher, Role::kSculptor, Role::kOwner}) {
    for (const bool is_own : {true, false}) {
      const std::string thing = make(GetParam().thing, is_own ? ada_ : bo_);
      set_role(ada_, role);
      const bool may_do = role == Role::kOwner || (role == Role::kSculptor && is_own);
      const ApiResponse response = command(thing, ada_);
      EXPECT_EQ(response.status / 100, may_do ? 2U : 4U)
          << to_string(role) << is_own << response.body;
      if (!may_do) {
        EXPECT_EQ(code(response), "not_allowed");
        // The item is unchanged.
        EXPECT_EQ(command(thing, kAdmin).status / 100, 2U) << to_string(role) << is_own;
      }
      set_role(ada_, Role::kSculptor);
    }
  }
  EXPECT_EQ(command(make(GetParam().thing, ada_), kAdmin).status / 100, 2U);
  EXPECT_EQ(command(make(GetParam().thing, ada_), "").status, 401U);
}

TEST_P(OwnThings, AMutedParticipantDoesNotChangeTheBlock) {
  const std::string thing = make(GetParam().thing, ada_);
  const auto mute = [&](bool muted) {
    ASSERT_TRUE(access->set_muted(grant_of(ada_), muted));
    session->people().set_muted_of(grant_of(ada_), muted);
  };
  mute(true);
  const ApiResponse response = command(thing, ada_);
  EXPECT_EQ(response.status, GetParam().changes_block                                ? 403U
                             : GetParam().path == std::string_view("targets?name=#") ? 201U
                                                                                     : 200U)
      << response.body;
  if (!GetParam().changes_block) return;
  EXPECT_EQ(code(response), "muted");
  mute(false);
  EXPECT_EQ(command(thing, ada_).status, 200U);
}

INSTANTIATE_TEST_SUITE_P(Commands, OwnThings, testing::ValuesIn(kCommands),
                         [](const auto& one) { return std::string(one.param.name); });

using SharedThings = ApiRightsTest;

TEST_F(SharedThings, ListsStateWhetherTheCallerMayChangeAnItem) {
  const std::string ada = invite("role=sculptor&name=Ada"), bo = invite("role=sculptor&name=Bo");
  ApiRequest request = *parse_target(kBlock + "programs?pace=feed");
  request.method = "POST";
  request.body = kProgramText;
  request.token = ada;
  EXPECT_TRUE(Json::parse(api->handle(request).body).at("may_control").get<bool>());
  request = *parse_target(kBlock + "targets?name=part.obj");
  request.method = "POST";
  request.body = kPartText;
  request.token = ada;
  ASSERT_EQ(api->handle(request).status, 201U);
  const auto listed = [&](const std::string& token) {
    return std::pair(
        made("GET", kBlock + "programs", token).at("programs").at(0).at("may_control").get<bool>(),
        made("GET", kBlock + "targets", token).at("targets").at(0).at("may_change").get<bool>());
  };
  EXPECT_EQ(listed(ada), std::pair(true, true));
  EXPECT_EQ(listed(bo), std::pair(false, false));
  EXPECT_EQ(listed(tokens[Role::kOwner]), std::pair(true, true));
}

TEST_F(SharedThings, HoldersOfAnInvitationShareControlOfItsPrograms) {
  ApiRequest request = *parse_target(kBlock + "programs?pace=feed");
  request.method = "POST";
  request.body = kProgramText;
  request.token = tokens[Role::kSculptor];
  ASSERT_EQ(api->handle(request).status, 202U);
  EXPECT_EQ(ask("DELETE", kBlock + "programs/1", invite("role=sculptor")).status, 403U);
  EXPECT_EQ(ask("DELETE", kBlock + "programs/1", tokens[Role::kSculptor]).status, 200U);
}

}  // namespace
}  // namespace kerf::net::own_things_test
