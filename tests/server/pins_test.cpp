// SPDX-License-Identifier: Apache-2.0
#include "server/pins/pins.h"

#include <nlohmann/json.hpp>

#include "server/matters.h"
#include "server/store/journal_file.h"
#include "server/store/list_table.h"
#include "server/store/plain_text.h"
#include "tests/server/undo_fixture.h"
#include "tests/support/test.h"

namespace kerf::pins_test {
namespace {

class PinsTest : public SessionUndo {
 protected:
  PinsTest() { matters_ = net::matters(); }
  Pins& pins() { return session_->matters().get<Pins>(); }
  static Pin pin(const std::string& text, const std::string& person = "") {
    return {0, text, {1.5, -2, 1e-3}, {0, 0.6, 0.8}, 0, 3000, "Ada", person};
  }
  static Caller sculptor(const std::string& grant) {
    return Caller{.role = Role::kSculptor, .grant = grant, .is_personal = true};
  }
  /// Sets a good pin and a bad one, whose row the statement then damages. Returns the journal.
  std::filesystem::path damage_second_pin(const std::string& statement) {
    create();
    pins().set(pin("good"));
    pins().set(pin("bad"));
    EXPECT_TRUE(session_->flush());
    session_.reset();
    registry_.reset();
    const auto file = folder_->path() / "block.kerf";
    auto journal = open_journal(file, SqlMode::kWrite);
    EXPECT_TRUE(journal && journal->execute(statement));
    return file;
  }
  std::string fault(std::uint32_t number, const Caller& caller) {
    const auto removed = pins().remove(number, caller);
    return removed ? "" : removed.error().code;
  }
};

TEST_F(PinsTest, SurviveARestart) {
  create();
  const ParticipantId ada = join("Ada");
  stroke(ada, {-15, 0, -2}, {15, 0, -2});
  const std::uint64_t record = session_->sequence();
  EXPECT_EQ(pins().set(pin("too deep?"))->number, 1U);
  EXPECT_EQ(pins().set(pin("gone"))->number, 2U);
  EXPECT_EQ(pins().set(pin("third"))->number, 3U);
  ASSERT_TRUE(pins().remove(2, Caller::local()));
  for (int round = 0; round < 2; ++round) {
    const auto list = pins().list();
    ASSERT_EQ(list.size(), 2U);
    EXPECT_EQ(list[0].number, 1U);
    EXPECT_EQ(list[0].text, "too deep?");
    EXPECT_EQ(list[0].at_mm.x, 1.5);
    EXPECT_EQ(list[0].at_mm.z, 1e-3);
    EXPECT_EQ(list[0].normal.y, 0.6);
    EXPECT_EQ(list[0].normal.z, 0.8);
    EXPECT_EQ(list[0].record, record);
    EXPECT_EQ(list[0].created_ms, 3000);
    EXPECT_EQ(list[0].author, "Ada");
    EXPECT_EQ(list[1].number, 3U);
    reload();
  }
  EXPECT_EQ(pins().set(pin("next"))->number, 4U);
}

TEST_F(PinsTest, AreRemovedByTheirAuthorsAndOwners) {
  create();
  pins().set(pin("ada's", "a"));
  pins().set(pin("nobody's"));
  const Caller ada = sculptor("a"), bo = sculptor("b");
  EXPECT_EQ(fault(1, bo), "not_allowed");
  EXPECT_EQ(fault(2, bo), "not_allowed");
  EXPECT_EQ(fault(7, ada), "unknown_pin");
  EXPECT_TRUE(pins().remove(1, ada));
  EXPECT_EQ(fault(1, ada), "unknown_pin");
  EXPECT_TRUE(pins().remove(2, Caller::local()));
}

TEST_F(PinsTest, AreLimitedInNumber) {
  create();
  for (std::size_t n = 0; n < kPinsMax; ++n) ASSERT_TRUE(pins().set(pin("one")));
  EXPECT_STREQ(pins().set(pin("more")).error().code, "limit");
  ASSERT_TRUE(pins().remove(1, Caller::local()));
  EXPECT_TRUE(pins().set(pin("more")));
}

TEST_F(PinsTest, AreSentWhenOneHasChanged) {
  create();
  EXPECT_TRUE(session_->frame(true).matters.empty());
  pins().set(pin("one"));
  EXPECT_EQ(session_->frame(false).matters.size(), 1U);
  EXPECT_TRUE(session_->frame(false).matters.empty());
  const auto all = session_->frame(true).matters;
  ASSERT_EQ(all.size(), 1U);
  const auto message = nlohmann::json::parse(all[0].text);
  EXPECT_EQ(message.at("type"), "pins");
  EXPECT_EQ(message.at("pins").size(), 1U);
  EXPECT_EQ(message.at("pins")[0].at("text"), "one");
  ASSERT_TRUE(pins().remove(1, Caller::local()));
  const auto none = session_->frame(false).matters;
  ASSERT_EQ(none.size(), 1U);
  EXPECT_TRUE(nlohmann::json::parse(none[0].text).at("pins").empty());
}

TEST_F(PinsTest, BranchInheritsEarlierPinsOnly) {
  create();
  const ParticipantId ada = join("Ada");
  pins().set(pin("before"));
  const std::uint64_t record = session_->sequence();
  stroke(ada, {-15, 0, -2}, {15, 0, -2});
  pins().set(pin("after"));
  ASSERT_TRUE(session_->flush());
  const auto branched = test::value_of(registry_->branch("other", *session_, record));
  const auto list = branched->matters().get<Pins>().list();
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].text, "before");
}

TEST_F(PinsTest, DamagedRowIsLeftOut) {
  const auto file = damage_second_pin("UPDATE pins SET x=x+1 WHERE number=2");
  auto journal = open_journal(file, SqlMode::kRead);
  ASSERT_TRUE(journal);
  const auto lists = read_lists(*journal, 1000);
  ASSERT_TRUE(lists);
  const auto& rows = lists->at("pins");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(pin_of(rows[0]).text, "good");
}

/// A bit that makes a row name a record which does not exist must not hide the row.
TEST_F(PinsTest, ARowThatNamesALaterRecordByDamageIsReported) {
  const auto file = damage_second_pin("UPDATE pins SET record=record+1024 WHERE number=2");
  const auto damaged = JournalReader::open(file)->damaged_rows();
  ASSERT_TRUE(damaged);
  ASSERT_EQ(damaged->size(), 1U);
  EXPECT_EQ(damaged->front().table, "pins");
  EXPECT_EQ(damaged->front().rows, 1);
}

TEST(PlainText, IsUtf8WithoutControlCharacters) {
  EXPECT_TRUE(is_plain_text("größer als 3 mm, 太深", 40));
  EXPECT_TRUE(is_plain_text("/", 1));
  for (const char* bad : {"", "two\nlines", "\x7F", "\xC3", "\xC0\xAF", "\xED\xA0\x80"}) {
    EXPECT_FALSE(is_plain_text(bad, 40));
  }
  EXPECT_TRUE(is_plain_text("four", 4));
  EXPECT_FALSE(is_plain_text("fives", 4));
}

}  // namespace
}  // namespace kerf::pins_test
