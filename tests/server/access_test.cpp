// SPDX-License-Identifier: Apache-2.0
#include "server/rights/access.h"

#include <sys/stat.h>

#include "server/rights/admin_token.h"
#include "server/rights/rights.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::access_test {
namespace {

const std::string kAdmin = "0123456789abcdef0123456789abcdef";

class AccessTest : public testing::Test {
 protected:
  void SetUp() override { reopen(); }
  void reopen(bool open = false, const std::string& admin = kAdmin) {
    access.reset();
    auto opened =
        Access::open({.folder = folder.path(), .admin_token = admin, .open = open, .now_s = [this] {
                        return now_s;
                      }});
    ASSERT_TRUE(opened) << opened.error();
    access = *std::move(opened);
  }
  Issued invite(Role role, const std::string& name = "", std::int64_t lifetime_s = 3600) {
    auto issued = access->invite("block", {.role = role, .lifetime_s = lifetime_s, .name = name});
    EXPECT_TRUE(issued);
    return *std::move(issued);
  }
  Role role_of(const std::string& token, std::string_view session = "block") const {
    return access->identify(token, session).role;
  }

  test::TemporaryFolder folder;
  std::int64_t now_s = 1'700'000'000;
  std::unique_ptr<Access> access;
};

TEST(Rights, TheReadmeHoldsTheTable) {
  const std::string readme = test::content_of(KERF_SOURCE_DIR "/server/rights/README.md");
  EXPECT_TRUE(readme.contains(rights_markdown()))
      << "server/rights/README.md must contain this table:\n"
      << rights_markdown();
}

TEST(Rights, EachInvitedRoleIncludesTheLowerOnes) {
  constexpr Role kRoles[] = {Role::kWatcher, Role::kSculptor, Role::kOwner, Role::kAdministrator};
  for (std::size_t n = 0; n + 1 < std::size(kRoles); ++n) {
    for (int number = 0; number <= static_cast<int>(Action::kCloseSession); ++number) {
      const auto action = static_cast<Action>(number);
      EXPECT_LE(may(kRoles[n], action), may(kRoles[n + 1], action)) << to_string(action);
    }
  }
  EXPECT_FALSE(may(Role::kWatcher, Action::kCarve));
  EXPECT_FALSE(may(Role::kSculptor, Action::kInvite));
  EXPECT_FALSE(may(Role::kOwner, Action::kAdminister));
  for (const Action action : {Action::kCloseSession, Action::kModerate, Action::kRunPrograms,
                              Action::kInvite, Action::kAdminister}) {
    EXPECT_FALSE(may(Role::kGuest, action)) << to_string(action);
    EXPECT_FALSE(may(Role::kNobody, action)) << to_string(action);
  }
}

TEST_F(AccessTest, TokensGrantTheirRoleInTheirSessionOnly) {
  const Issued sculptor = invite(Role::kSculptor);
  EXPECT_EQ(role_of(sculptor.token), Role::kSculptor);
  EXPECT_EQ(role_of(sculptor.token, "other"), Role::kNobody);
  EXPECT_EQ(role_of(sculptor.token, ""), Role::kSculptor);
  EXPECT_EQ(access->identify(sculptor.token, "").session, "block");
  EXPECT_EQ(role_of(kAdmin, "other"), Role::kAdministrator);
  EXPECT_EQ(role_of(""), Role::kNobody);
}

TEST_F(AccessTest, UnknownTokensIdentifyNobody) {
  const Issued owner = invite(Role::kOwner);
  std::vector<std::string> others = {"kerf_", "x", kAdmin + "0", kAdmin.substr(1), owner.grant.id};
  for (std::size_t n = 0; n < owner.token.size(); ++n) {
    std::string changed = owner.token;
    changed[n] = changed[n] == 'a' ? 'b' : 'a';
    others.push_back(changed);
    others.push_back(owner.token.substr(0, n));
  }
  for (const std::string& other : others) {
    EXPECT_EQ(role_of(other), Role::kNobody) << other;
    EXPECT_EQ(access->identify(other, "block").has_bad_token, !other.empty()) << other;
  }
}

TEST_F(AccessTest, PassesExpireWithTheirInvitation) {
  const Issued invitation = invite(Role::kSculptor, "", 60);
  const auto pass = test::value_of(access->redeem(invitation.token, "block", "Ada"));
  EXPECT_EQ(access->identify(pass.token, "block").remaining_s, 60);
  now_s += 59;
  EXPECT_EQ(role_of(pass.token), Role::kSculptor);
  now_s += 1;
  EXPECT_EQ(role_of(pass.token), Role::kNobody);
  EXPECT_EQ(role_of(invitation.token), Role::kNobody);
  EXPECT_FALSE(access->redeem(invitation.token, "block", "Eve"));
  EXPECT_TRUE(access->grants("block").empty());
}

TEST_F(AccessTest, InvitationsHaveALimitedNumberOfUses) {
  EXPECT_FALSE(access->invite("block", {.uses = -1}));
  EXPECT_FALSE(access->invite("block", {.uses = 2001}));
  const Issued invitation = access->invite("block", {.uses = 2}).value();
  const auto ada = test::value_of(access->redeem(invitation.token, "block", "Ada"));
  EXPECT_EQ(ada.grant.uses, 0);
  ASSERT_TRUE(access->redeem(invitation.token, "block", "Grace"));
  // A removed person cannot return through the same link, even after a restart.
  ASSERT_TRUE(access->revoke("block", ada.grant.id));
  EXPECT_EQ(access->redeem(invitation.token, "block", "Ada").error().kind, ErrorKind::kConflict);
  reopen();
  EXPECT_EQ(access->redeem(invitation.token, "block", "Ada").error().kind, ErrorKind::kConflict);
  for (const Grant& grant : access->grants("block")) {
    EXPECT_EQ(grant.used, grant.is_pass() ? 0 : 2);
  }
}

TEST_F(AccessTest, OneNetworkDoesNotUseUpAnInvitation) {
  access = *Access::open({.admin_token = kAdmin});  // without a file
  const Issued invitation = invite(Role::kWatcher);
  const auto redeem = [&](const std::string& network) {
    return access->redeem(invitation.token, "block", "Eve", network);
  };
  for (std::size_t n = 0; n < Access::kNetworkPassesMax; ++n) ASSERT_TRUE(redeem("10.0.0.1"));
  EXPECT_EQ(redeem("10.0.0.1").error().kind, ErrorKind::kConflict);
  EXPECT_TRUE(redeem("10.0.0.2"));
}

TEST_F(AccessTest, FilesWithoutUseCountsAreContinued) {
  access.reset();
  std::filesystem::remove(folder.path() / GrantFile::kName);
  {
    auto file =
        test::value_of(SqlDatabase::open(folder.path() / GrantFile::kName, SqlMode::kCreate));
    ASSERT_TRUE(
        file.execute("CREATE TABLE grants(id TEXT PRIMARY KEY, session TEXT, role TEXT, "
                     "invitation TEXT, name TEXT, color TEXT, created_s INTEGER, "
                     "expires_s INTEGER, muted INTEGER, hash BLOB) WITHOUT ROWID; "
                     "INSERT INTO grants VALUES('0123456789ab','block','owner','','Ada',"
                     "'',1,0,0,zeroblob(32));"));
  }
  reopen();
  ASSERT_EQ(access->grants("block").size(), 1U);
  EXPECT_EQ(access->grants("block").front().name, "Ada");
  invite(Role::kWatcher);
  reopen();
  EXPECT_EQ(access->grants("block").size(), 2U);
}

TEST_F(AccessTest, RevokingAnInvitationRevokesItsPasses) {
  const Issued invitation = invite(Role::kWatcher), other = invite(Role::kWatcher);
  const auto pass = test::value_of(access->redeem(invitation.token, "block", "Ada"));
  EXPECT_FALSE(access->revoke("other", invitation.grant.id));
  EXPECT_EQ(test::value_of(access->revoke("block", invitation.grant.id)).size(), 2U);
  EXPECT_EQ(role_of(pass.token), Role::kNobody);
  EXPECT_EQ(role_of(invitation.token), Role::kNobody);
  EXPECT_EQ(role_of(other.token), Role::kWatcher);
  reopen();
  EXPECT_EQ(role_of(pass.token), Role::kNobody);
  EXPECT_EQ(role_of(other.token), Role::kWatcher);
}

TEST_F(AccessTest, NameColorAndMuteOfAPersonSurviveARestart) {
  const Issued invitation = invite(Role::kSculptor);
  const auto ada = access->redeem(invitation.token, "block", "Ada");
  const auto grace = access->redeem(invitation.token, "block", "Grace");
  ASSERT_TRUE(ada && grace);
  EXPECT_NE(ada->grant.color, grace->grant.color);
  ASSERT_TRUE(access->set_muted(ada->grant.id, true));
  ASSERT_TRUE(access->set_role(grace->grant.id, Role::kOwner));
  reopen();
  const Caller again = access->identify(ada->token, "block");
  EXPECT_EQ(again.name, "Ada");
  EXPECT_EQ(again.color, ada->grant.color);
  EXPECT_TRUE(again.is_muted);
  EXPECT_TRUE(again.is_personal);
  EXPECT_FALSE(access->identify(invitation.token, "block").is_personal);
  EXPECT_EQ(role_of(grace->token), Role::kOwner);
}

TEST_F(AccessTest, PeopleHaveDistinctLastingColors) {
  std::set<std::string> colors;
  for (const char* name : {"Ada", "Grace", "Mary"}) {
    const auto by_name = access->invite("block", {.role = Role::kSculptor, .name = name}).value();
    const std::string color = by_name.grant.color;
    EXPECT_EQ(access->redeem(by_name.token, "block", "").value().grant.color, color);
    // An agent presents the invitation itself each time.
    EXPECT_EQ(access->identify(by_name.token, "block").color, color);
    colors.insert(color);
    colors.insert(access->redeem(invite(Role::kWatcher).token, "block", "").value().grant.color);
  }
  EXPECT_EQ(colors.size(), 6U);
  EXPECT_FALSE(colors.contains(""));
  for (int n = 0; n < 10; ++n) ASSERT_TRUE(access->redeem(invite(Role::kOwner).token, "block", ""));
}

TEST_F(AccessTest, DecisionsAboutANamedInvitationApplyToItsLink) {
  const auto ada = access->invite("block", {.role = Role::kSculptor, .name = "Ada"}).value();
  const auto pass = access->redeem(ada.token, "block", "").value();
  EXPECT_EQ(test::value_of(access->set_role(pass.grant.id, Role::kWatcher)).size(), 2U);
  EXPECT_EQ(access->identify(ada.token, "block").role, Role::kWatcher);
  ASSERT_TRUE(access->set_muted(pass.grant.id, true));
  const auto again = access->redeem(ada.token, "block", "").value();
  EXPECT_EQ(access->identify(again.token, "block").role, Role::kWatcher);
  EXPECT_TRUE(access->identify(again.token, "block").is_muted);
  EXPECT_EQ(access->root_of(again.grant.id), ada.grant.id);
  EXPECT_EQ(access->revoke("block", access->root_of(pass.grant.id))->size(), 3U);
  EXPECT_EQ(access->identify(ada.token, "block").role, Role::kNobody);
}

TEST_F(AccessTest, DecisionsAboutOneHolderOfASharedLinkAffectNobodyElse) {
  const auto shared = access->invite("block", {.role = Role::kOwner}).value();
  const auto one = access->redeem(shared.token, "block", "One").value();
  const auto two = access->redeem(shared.token, "block", "Two").value();
  ASSERT_TRUE(access->set_muted(one.grant.id, true));
  EXPECT_FALSE(access->identify(two.token, "block").is_muted);
  EXPECT_EQ(access->root_of(one.grant.id), one.grant.id);
  // A person who gives ownership away does not regain it through the link.
  ASSERT_TRUE(access->step_down(one.grant.id, Role::kSculptor));
  EXPECT_EQ(access->identify(one.token, "block").role, Role::kSculptor);
  EXPECT_EQ(access->identify(two.token, "block").role, Role::kOwner);
  const auto again = access->redeem(shared.token, "block", "One").value();
  EXPECT_EQ(access->identify(again.token, "block").role, Role::kSculptor);
}

TEST_F(AccessTest, InvitationColorIsOptional) {
  for (const char* color : {"red", "#12345", "#1234567", "#12345g", "red;"}) {
    EXPECT_FALSE(access->invite("block", {.role = Role::kWatcher, .color = color})) << color;
  }
  EXPECT_TRUE(access->invite("block", {.role = Role::kWatcher, .color = "#12aBcf"}));
}

TEST_F(AccessTest, PassesCannotBeUsedAsInvitations) {
  const auto pass = test::value_of(access->redeem(invite(Role::kOwner).token, "block", "Ada"));
  EXPECT_FALSE(access->redeem(pass.token, "block", "Eve"));
}

TEST_F(AccessTest, TokensAreStoredHashedInAPrivateFile) {
  const Issued invitation = invite(Role::kOwner, "Ada");
  const std::string secret = invitation.token.substr(invitation.token.rfind('_') + 1);
  ASSERT_EQ(secret.size(), 32U);
  const auto file = folder.path() / GrantFile::kName;
  const std::string bytes = test::content_of(file);
  EXPECT_TRUE(bytes.contains(invitation.grant.id));
  EXPECT_FALSE(bytes.contains(secret));
  EXPECT_FALSE(bytes.contains(kAdmin));
  struct stat status{};
  ASSERT_EQ(stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
}

TEST_F(AccessTest, AnOpenServerHasGuestsAndALocalOneAdministrators) {
  const Issued owner = invite(Role::kOwner);
  reopen(true);
  EXPECT_EQ(access->regime(), Regime::kOpen);
  EXPECT_EQ(role_of(""), Role::kGuest);
  EXPECT_EQ(role_of("kerf_of_yesterday"), Role::kGuest);
  EXPECT_EQ(role_of(owner.token), Role::kOwner);
  reopen(false, "");
  EXPECT_EQ(access->regime(), Regime::kLocal);
  EXPECT_EQ(role_of(""), Role::kAdministrator);
}

TEST_F(AccessTest, ASessionOfTheSameIdBeginsWithoutRights) {
  const Issued owner = invite(Role::kOwner);
  ASSERT_TRUE(access->reserve("block", {.min_mm = {0, 0, 0}, .max_mm = {1, 1, 1}}));
  ASSERT_TRUE(access->forget("block"));
  EXPECT_EQ(role_of(owner.token), Role::kNobody);
  reopen();
  EXPECT_EQ(role_of(owner.token), Role::kNobody);
  EXPECT_TRUE(access->regions("block").empty());
}

TEST_F(AccessTest, RegionsSurviveARestart) {
  ASSERT_TRUE(access->reserve("block", {.min_mm = {0, 0.25, 0}, .max_mm = {1, 1, 1}}));
  const auto second = test::value_of(access->reserve(
      "block", {.min_mm = {2, 0, 0}, .max_mm = {3, 1, 1}, .participant = 7, .person = "p"}));
  ASSERT_TRUE(access->release("block", 1));
  EXPECT_FALSE(access->release("block", 1));
  reopen();
  const auto regions = access->regions("block");
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].id, second);
  EXPECT_EQ(regions[0].min_mm, (Vec3{2, 0, 0}));
  EXPECT_EQ(regions[0].participant, 7U);
  EXPECT_EQ(regions[0].person, "p");
}

TEST_F(AccessTest, LimitsAreErrors) {
  access = *Access::open({.admin_token = kAdmin});
  EXPECT_EQ(access->invite("block", {.lifetime_s = Access::kLifetimeMaxS + 1}).error().kind,
            ErrorKind::kInvalid);
  EXPECT_EQ(access->invite("block", {.name = std::string(65, 'a')}).error().kind,
            ErrorKind::kInvalid);
  for (std::size_t n = 0; n < Access::kRegionsMax; ++n) {
    ASSERT_TRUE(access->reserve("block", {.max_mm = {1, 1, 1}}));
  }
  EXPECT_EQ(access->reserve("block", {.max_mm = {1, 1, 1}}).error().kind, ErrorKind::kConflict);
  EXPECT_FALSE(Access::open({.admin_token = "short"}));
}

TEST(AdminToken, FileIsCreatedOnceAndPrivate) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "admin").string();
  const auto made = test::value_of(read_admin_token(file));
  EXPECT_GE(made.size(), kAdminTokenBytesMin);
  EXPECT_EQ(*read_admin_token(file), made);
  struct stat status{};
  ASSERT_EQ(stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  EXPECT_FALSE(read_admin_token((folder.path() / "no" / "folder").string()));
  std::ofstream(folder.path() / "empty").close();
  EXPECT_FALSE(read_admin_token((folder.path() / "empty").string()));
}

}  // namespace
}  // namespace kerf::access_test
