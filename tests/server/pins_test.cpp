// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "server/store/journal_file.h"
#include "server/store/pin.h"
#include "server/store/plain_text.h"
#include "tests/server/undo_fixture.h"

namespace kerf {
namespace {

class Pins : public SessionUndo {
 protected:
  static Pin pin(const std::string& text, const std::string& person = "") {
    return {0, text, {1.5, -2, 1e-3}, {0, 0.6, 0.8}, 0, 3000, "Ada", person};
  }
  static Caller sculptor(const std::string& grant) {
    Caller caller;
    caller.role = Role::kSculptor;
    caller.is_personal = true;
    caller.grant = grant;
    return caller;
  }
  PinFault fault(std::uint32_t number, const Caller& caller) {
    const auto removed = session_->remove_pin(number, caller);
    EXPECT_FALSE(removed);
    return removed ? PinFault::kPaused : removed.error().fault;
  }
};

TEST_F(Pins, OutlastARestartWithAllTheySay) {
  create();
  const ParticipantId ada = join("Ada");
  stroke(ada, {-15, 0, -2}, {15, 0, -2});
  const std::uint64_t record = session_->sequence();
  EXPECT_EQ(session_->set_pin(pin("too deep?"))->number, 1U);
  EXPECT_EQ(session_->set_pin(pin("gone"))->number, 2U);
  EXPECT_EQ(session_->set_pin(pin("third"))->number, 3U);
  ASSERT_TRUE(session_->remove_pin(2, Caller::local()));
  for (int round = 0; round < 2; ++round) {
    const auto pins = session_->pins();
    ASSERT_EQ(pins.size(), 2U);
    EXPECT_EQ(pins[0].number, 1U);
    EXPECT_EQ(pins[0].text, "too deep?");
    EXPECT_EQ(pins[0].at_mm.x, 1.5);
    EXPECT_EQ(pins[0].at_mm.z, 1e-3);
    EXPECT_EQ(pins[0].normal.y, 0.6);
    EXPECT_EQ(pins[0].normal.z, 0.8);
    EXPECT_EQ(pins[0].record, record);
    EXPECT_EQ(pins[0].created_ms, 3000);
    EXPECT_EQ(pins[0].author, "Ada");
    EXPECT_EQ(pins[1].number, 3U);
    reload();
  }
  EXPECT_EQ(session_->set_pin(pin("next"))->number, 4U);
}

TEST_F(Pins, AreRemovedByThoseWhoSetThemAndByOwners) {
  create();
  session_->set_pin(pin("ada's", "a"));
  session_->set_pin(pin("nobody's"));
  const Caller ada = sculptor("a"), bo = sculptor("b");
  EXPECT_EQ(fault(1, bo), PinFault::kNotAllowed);
  EXPECT_EQ(fault(2, bo), PinFault::kNotAllowed);
  EXPECT_EQ(fault(7, ada), PinFault::kUnknown);
  EXPECT_TRUE(session_->remove_pin(1, ada));
  EXPECT_EQ(fault(1, ada), PinFault::kUnknown);
  EXPECT_TRUE(session_->remove_pin(2, Caller::local()));
}

TEST_F(Pins, AreLimitedInNumber) {
  create();
  for (std::size_t n = 0; n < kPinsMax; ++n) ASSERT_TRUE(session_->set_pin(pin("one")));
  EXPECT_EQ(session_->set_pin(pin("more")).error().fault, PinFault::kLimit);
  ASSERT_TRUE(session_->remove_pin(1, Caller::local()));
  EXPECT_TRUE(session_->set_pin(pin("more")));
}

TEST_F(Pins, AreInAFrameWhenOneHasChanged) {
  create();
  EXPECT_FALSE(session_->frame(true).pins);
  session_->set_pin(pin("one"));
  ASSERT_TRUE(session_->frame(false).pins);
  EXPECT_FALSE(session_->frame(false).pins);
  EXPECT_EQ(session_->frame(true).pins->size(), 1U);
  ASSERT_TRUE(session_->remove_pin(1, Caller::local()));
  const auto pins = session_->frame(false).pins;
  ASSERT_TRUE(pins);
  EXPECT_TRUE(pins->empty());
}

TEST_F(Pins, OfABranchAreThoseThatWereSetUpToItsPoint) {
  create();
  const ParticipantId ada = join("Ada");
  session_->set_pin(pin("before"));
  const std::uint64_t record = session_->sequence();
  stroke(ada, {-15, 0, -2}, {15, 0, -2});
  session_->set_pin(pin("after"));
  ASSERT_TRUE(session_->flush());
  const auto branched = registry_->branch("other", *session_, record);
  ASSERT_TRUE(branched) << branched.error().reason;
  const auto pins = (*branched)->pins();
  ASSERT_EQ(pins.size(), 1U);
  EXPECT_EQ(pins[0].text, "before");
}

TEST_F(Pins, ADamagedRowIsLeftOut) {
  create();
  session_->set_pin(pin("good"));
  session_->set_pin(pin("bad"));
  ASSERT_TRUE(session_->flush());
  session_.reset();
  registry_.reset();
  {
    auto journal = open_journal(folder_->path() / "block.kerf", SqlMode::kWrite);
    ASSERT_TRUE(journal);
    ASSERT_TRUE(journal->execute("UPDATE pins SET x=x+1 WHERE number=2"));
    const auto pins = read_pins(*journal, 1000);
    ASSERT_TRUE(pins);
    ASSERT_EQ(pins->size(), 1U);
    EXPECT_EQ(pins->at(0).text, "good");
  }
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
}  // namespace kerf
