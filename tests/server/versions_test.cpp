// SPDX-License-Identifier: Apache-2.0
#include "server/versions/versions.h"

#include "server/matters.h"
#include "server/store/journal_file.h"
#include "tests/server/undo_fixture.h"
#include "tests/support/test.h"

namespace kerf::versions_test {
namespace {

NamedVersion named(const std::string& name, std::uint64_t record) {
  return {name, record, 1000, 2000, "Ada", ""};
}

class VersionsTest : public SessionUndo {
 protected:
  VersionsTest() { matters_ = net::matters(); }
  Versions& versions() { return session_->matters().get<Versions>(); }
};

TEST_F(VersionsTest, SurviveARestartAndAreNotReplaced) {
  create();
  const ParticipantId ada = join("Ada");
  stroke(ada, {-15, 0, -2}, {15, 0, -2});
  const std::uint64_t record = session_->sequence();
  ASSERT_TRUE(versions().name(named("first", record)));
  ASSERT_TRUE(versions().name(named("gone", 1)));
  stroke(ada, {-15, 8, -2}, {15, 8, -2});
  EXPECT_STREQ(versions().name(named("first", 1)).error().code, "version_exists");
  EXPECT_STREQ(versions().name(named("later", session_->sequence() + 1)).error().code, "no_record");
  ASSERT_TRUE(versions().remove("gone", Caller::local()));
  EXPECT_STREQ(versions().remove("gone", Caller::local()).error().code, "unknown_version");
  for (int round = 0; round < 2; ++round) {
    const auto list = versions().list();
    ASSERT_EQ(list.size(), 1U);
    EXPECT_EQ(list[0].name, "first");
    EXPECT_EQ(list[0].record_ms, 1000);
    EXPECT_EQ(list[0].created_ms, 2000);
    EXPECT_EQ(list[0].author, "Ada");
    EXPECT_EQ(versions().record_named("first"), record);
    EXPECT_EQ(versions().record_named("gone"), std::nullopt);
    reload();
  }
}

TEST_F(VersionsTest, RenamedVersionKeepsItsAuthorAndTimes) {
  create();
  NamedVersion first = named("first", 1);
  first.person = "ada's pass";
  ASSERT_TRUE(versions().name(first));
  ASSERT_TRUE(versions().name(named("other", 1)));
  Caller bo, ada;
  bo.role = ada.role = Role::kSculptor;
  bo.is_personal = ada.is_personal = true;
  bo.grant = "bo's pass";
  ada.grant = first.person;
  EXPECT_FALSE(Versions::may_change(first, bo));
  EXPECT_STREQ(versions().rename("first", "mine", bo).error().code, "not_allowed");
  EXPECT_STREQ(versions().rename("none", "mine", ada).error().code, "unknown_version");
  EXPECT_STREQ(versions().rename("first", "other", ada).error().code, "version_exists");
  EXPECT_TRUE(versions().rename("first", "first", ada));
  EXPECT_TRUE(Versions::may_change(first, ada));
  ASSERT_TRUE(versions().rename("first", "second", ada));
  ASSERT_TRUE(versions().rename("other", "zeroth", Caller::local()));
  for (int round = 0; round < 2; ++round) {
    const auto list = versions().list();
    ASSERT_EQ(list.size(), 2U);
    EXPECT_EQ(list[0].name, "second");
    EXPECT_EQ(list[0].author, first.author);
    EXPECT_EQ(list[0].person, first.person);
    EXPECT_EQ(list[0].record_ms, first.record_ms);
    EXPECT_EQ(list[0].created_ms, first.created_ms);
    EXPECT_EQ(list[1].name, "zeroth");
    reload();
  }
}

TEST_F(VersionsTest, AreRenamedInOneTransaction) {
  create();
  ASSERT_TRUE(versions().name(named("first", 1)));
  ASSERT_TRUE(session_->flush());
  ASSERT_TRUE(versions().rename("first", "second", Caller::local()));
  EXPECT_LE(session_->journal_lag(), 1U) << "a crash between two changes leaves both names";
  reload();
  EXPECT_EQ(versions().list().size(), 1U);
  EXPECT_EQ(versions().list()[0].name, "second");
  // Rename it back: a row of that name may be left from before.
  ASSERT_TRUE(versions().rename("second", "first", Caller::local()));
  reload();
  ASSERT_EQ(versions().list().size(), 1U);
  EXPECT_EQ(versions().list()[0].name, "first");
}

TEST_F(VersionsTest, AreLimitedInNumber) {
  create();
  for (std::size_t n = 0; n < kVersionsMax; ++n) {
    ASSERT_TRUE(versions().name(named("v" + std::to_string(n), 1)));
  }
  EXPECT_EQ(versions().name(named("more", 1)).error().code, "limit");
}

TEST_F(VersionsTest, DamagedRowIsLeftOut) {
  create();
  ASSERT_TRUE(versions().name(named("good", 1)));
  ASSERT_TRUE(versions().name(named("bad", 1)));
  ASSERT_TRUE(session_->flush());
  session_.reset();
  registry_.reset();
  {
    auto journal = open_journal(folder_->path() / "block.kerf", SqlMode::kWrite);
    ASSERT_TRUE(journal->execute("UPDATE versions SET record=2 WHERE name='bad'"));
  }
  reload();
  ASSERT_EQ(versions().list().size(), 1U);
  EXPECT_EQ(versions().list()[0].name, "good");
}

}  // namespace
}  // namespace kerf::versions_test
