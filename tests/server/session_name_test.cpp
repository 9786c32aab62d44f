// SPDX-License-Identifier: Apache-2.0
// The name of a session: who may change it, who hears of it, and where it is kept.
#include "server/session/session_name.h"

#include <nlohmann/json.hpp>

#include "server/matters.h"
#include "server/session/journal_check.h"
#include "server/store/journal_branch.h"
#include "tests/server/api_rights_fixture.h"
#include "tests/server/undo_fixture.h"
#include "tests/support/test.h"

namespace kerf::session_name_test {
namespace {

class SessionNames : public SessionUndo {
 protected:
  SessionNames() { matters_ = net::matters(); }
  std::string name() { return session_->scene()->name; }
  std::string fault(const std::string& name) { return fault_of(*session_, name); }
  std::string fault_of(Session& session, const std::string& name) {
    auto renamed = std::async(std::launch::async, [&] { return registry_->rename(session, name); });
    while (renamed.wait_for(std::chrono::microseconds(200)) != std::future_status::ready) {
      executor_->run();
    }
    const auto answer = renamed.get();
    return answer ? "" : answer.error().code;
  }
};

TEST_F(SessionNames, SurviveRestartsAndRecordsThatAreLost) {
  create();
  const std::string first = name();
  ASSERT_EQ(fault("Owl"), "");
  stroke(join("Ada"), {-15, 0, -2}, {15, 0, -2});
  ASSERT_EQ(fault("Barn owl, 2"), "");
  for (int round = 0; round < 2; ++round) {
    EXPECT_EQ(name(), "Barn owl, 2");
    EXPECT_FALSE(session_->scene()->tools.empty());
    reload();
  }
  ASSERT_EQ(fault(first), "");
  reload();
  EXPECT_EQ(name(), first);
}

TEST_F(SessionNames, AreThoseOfBranchesAtAnyRecord) {
  create();
  stroke(join("Ada"), {-15, 0, -2}, {15, 0, -2});
  ASSERT_EQ(fault("Owl"), "");
  const auto early = registry_->branch("early", *session_, 4);
  ASSERT_TRUE(early);
  EXPECT_EQ((*early)->scene()->name, "Owl");
  const auto named = registry_->branch("", *session_, session_->sequence(), {}, {}, "Owl 2");
  ASSERT_TRUE(named);
  EXPECT_EQ((*named)->id(), "owl-2");
}

TEST_F(SessionNames, AreDifferentAndPlain) {
  create();
  const auto other = registry_->branch("other", *session_, session_->sequence());
  ASSERT_TRUE(other);
  ASSERT_EQ(fault("Owl"), "");
  EXPECT_EQ(fault("Owl"), "") << "it has this name";
  EXPECT_EQ(fault_of(**other, "Owl"), "name_taken");
  EXPECT_EQ(fault(""), "bad_name");
  EXPECT_EQ(fault("two\nlines"), "bad_name");
  EXPECT_EQ(fault(std::string(kSessionNameBytesMax, 'x')), "");
  EXPECT_EQ(fault(std::string(kSessionNameBytesMax + 1, 'x')), "bad_name");
}

TEST_F(SessionNames, AreToldToViewersOnce) {
  create();
  EXPECT_TRUE(session_->frame(true).matters.empty());
  ASSERT_EQ(fault("Owl"), "");
  const auto frame = session_->frame(false);
  ASSERT_EQ(frame.matters.size(), 1U);
  EXPECT_EQ(nlohmann::json::parse(frame.matters[0].text),
            nlohmann::json::parse(R"({"type":"name","name":"Owl"})"));
  ASSERT_EQ(fault("Owl"), "");
  EXPECT_TRUE(session_->frame(false).matters.empty());
}

}  // namespace
}  // namespace kerf::session_name_test

namespace kerf::net::session_name_test {
namespace {

TEST_F(ApiRightsTest, OwnersRenameASessionAndAdministratorsDuplicateIt) {
  const std::string path = "/v1/sessions/block";
  made("PATCH", path + "?name=Owl", tokens[Role::kSculptor], 403);
  EXPECT_EQ(made("PATCH", path, tokens[Role::kOwner], 400).at("error").at("code"), "bad_name");
  EXPECT_EQ(made("PATCH", path + "?name=Barn%20owl", tokens[Role::kOwner]).at("name"), "Barn owl");
  const auto listed = [&](Role role) {
    return made("GET", "/v1/sessions", tokens[role]).at("sessions");
  };
  EXPECT_EQ(listed(Role::kSculptor)[0].at("name"), "Barn owl");
  EXPECT_EQ(listed(Role::kSculptor)[0].at("may_rename"), false);
  EXPECT_EQ(listed(Role::kOwner)[0].at("may_rename"), true);
  EXPECT_EQ(listed(Role::kOwner)[0].at("may_close"), true);
  const std::string copy = "/v1/sessions?from=block&name=";
  made("POST", copy + "Owl", tokens[Role::kOwner], 403);
  EXPECT_EQ(made("POST", copy + "Barn%20owl", kAdmin, 409).at("error").at("code"), "name_taken");
  EXPECT_EQ(made("POST", copy + "Barn%20owl%202", kAdmin, 201).at("id"), "barn-owl-2");
  EXPECT_EQ(listed(Role::kAdministrator)[0].at("name"), "Barn owl 2");
  EXPECT_EQ(ask("POST", "/v1/sessions?name=Owl", kAdmin, kScene).status, 400U);
}

}  // namespace
}  // namespace kerf::net::session_name_test
