// SPDX-License-Identifier: Apache-2.0
// The rights of a session at the server that takes it over.
#include "server/rights/access.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::access_move_test {
namespace {

const std::string kAdmin = "0123456789abcdef0123456789abcdef";

/// Stores the reports of an owner as a journal does.
class KeptRights {
 public:
  void take(AttachmentChange change) {
    std::erase_if(list, [&](const Attachment& one) {
      return one.kind == change.kind && one.name == change.name;
    });
    if (change.bytes) list.push_back({change.kind, change.name, *std::move(change.bytes)});
  }
  std::vector<Attachment> list;
};

class AccessMoveTest : public testing::Test {
 protected:
  void SetUp() override {
    access = *Access::open(
        {.folder = folder.path(), .admin_token = kAdmin, .now_s = [this] { return now_s; }});
    access->report_to([this](const std::string& session, AttachmentChange change) {
      ASSERT_EQ(session, "block");
      kept.take(std::move(change));
    });
    other = *Access::open(
        {.folder = elsewhere.path(), .admin_token = kAdmin, .now_s = [this] { return now_s; }});
  }
  Issued invite(Role role, const std::string& name = "", std::int64_t lifetime_s = 3600) {
    return *access->invite("block", {.role = role, .lifetime_s = lifetime_s, .name = name});
  }

  std::int64_t now_s = 1'700'000'000;
  KeptRights kept;
  test::TemporaryFolder folder, elsewhere;
  std::unique_ptr<Access> access, other;
};

TEST_F(AccessMoveTest, AttachmentsMoveRightsToAnotherServer) {
  const Issued open = invite(Role::kWatcher), named = invite(Role::kSculptor, "Ada");
  const Issued gone = invite(Role::kOwner), brief = invite(Role::kOwner, "", 10);
  const Issued pass = *access->redeem(open.token, "block", "Eve");
  const Issued gone_pass = *access->redeem(gone.token, "block", "Mallory");
  ASSERT_TRUE(access->set_muted(named.grant.id, true));
  ASSERT_TRUE(access->revoke("block", gone.grant.id));
  ASSERT_TRUE(access->reserve("block", {.min_mm = {0, 0, 0}, .max_mm = {1, 1, 1}}));
  ASSERT_TRUE(access->reserve("block", {.min_mm = {0, 0.25, 0}, .max_mm = {2, 1, 1}}));
  ASSERT_TRUE(access->release("block", 1));
  now_s += 11;
  ASSERT_TRUE(other->adopt("block", kept.list));
  EXPECT_EQ(other->identify(pass.token, "block").name, "Eve");
  EXPECT_EQ(other->identify(pass.token, "block").role, Role::kWatcher);
  EXPECT_EQ(other->identify(named.token, "block").role, Role::kSculptor);
  EXPECT_TRUE(other->identify(named.token, "block").is_muted);
  for (const Issued* ended : {&gone, &gone_pass, &brief}) {
    EXPECT_EQ(other->identify(ended->token, "block").role, Role::kNobody);
  }
  EXPECT_EQ(other->regions("block"), access->regions("block"));
  EXPECT_EQ(other->regions("block").size(), 1U);
  EXPECT_TRUE(other->redeem(open.token, "block", "Zoe")) << "an unused link is used there";
  other = *Access::open({.folder = elsewhere.path(), .admin_token = kAdmin});
  EXPECT_EQ(other->regions("block").size(), 1U) << "also after a restart there";
  // Reports contain no secret: the token is not in them.
  const std::string secret = pass.token.substr(pass.token.rfind('_') + 1);
  for (const Attachment& one : kept.list) {
    const std::string text(reinterpret_cast<const char*>(one.bytes.data()), one.bytes.size());
    EXPECT_FALSE(text.contains(secret));
  }
}

TEST_F(AccessMoveTest, RightsMissingFromTheAttachmentsEnd) {
  const Issued stays = invite(Role::kWatcher), ends = invite(Role::kOwner);
  ASSERT_TRUE(other->adopt("block", kept.list));
  EXPECT_EQ(*other->adopt("block", kept.list), std::vector<std::string>());
  ASSERT_TRUE(access->revoke("block", ends.grant.id));
  ASSERT_TRUE(access->reserve("block", {.min_mm = {0, 0, 0}, .max_mm = {1, 1, 1}}));
  EXPECT_EQ(*other->adopt("block", kept.list), std::vector{ends.grant.id});
  EXPECT_EQ(other->identify(ends.token, "block").role, Role::kNobody);
  EXPECT_EQ(other->identify(stays.token, "block").role, Role::kWatcher);
  EXPECT_EQ(other->regions("block").size(), 1U);
  ASSERT_TRUE(access->set_role(stays.grant.id, Role::kSculptor));
  EXPECT_EQ(*other->adopt("block", kept.list), std::vector<std::string>());
  EXPECT_EQ(other->identify(stays.token, "block").role, Role::kSculptor);
  ASSERT_TRUE(access->release("block", 1));
  ASSERT_TRUE(other->adopt("block", kept.list));
  EXPECT_TRUE(other->regions("block").empty());
}

TEST_F(AccessMoveTest, DamagedRightsAreIgnored) {
  const Issued owner = invite(Role::kOwner);
  ASSERT_TRUE(access->reserve("block", {.min_mm = {0, 0, 0}, .max_mm = {1, 1, 1}}));
  for (Attachment& one : kept.list) one.bytes.pop_back();
  ASSERT_TRUE(other->adopt("block", kept.list));
  EXPECT_EQ(other->identify(owner.token, "block").role, Role::kNobody);
  EXPECT_TRUE(other->regions("block").empty());
}

}  // namespace
}  // namespace kerf::access_move_test
