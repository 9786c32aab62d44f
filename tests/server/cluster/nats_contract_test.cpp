// SPDX-License-Identifier: Apache-2.0
// The properties of NATS that Kerf relies on. The same cases test the real nats-server and its
// model in tests/sim (nats_under_test.h).
#include "server/cluster/nats_connection.h"
#include "tests/server/cluster/nats_under_test.h"
#include "tests/support/eventually.h"
#include "tests/support/test.h"

namespace kerf::nats_contract_test {
namespace {

using std::chrono::milliseconds;

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

std::string text_of(const StreamMessage& message) {
  return {reinterpret_cast<const char*>(message.bytes.data()), message.bytes.size()};
}

class NatsContract : public testing::Test {
 protected:
  void SetUp() override {
    if (!server_.is_there()) GTEST_SKIP() << "nats-server is not installed";
    auto opened = test::value_of(NatsConnection::open(server_.url(), "contract"));
    ASSERT_TRUE(opened.is_connected());
    nats_.emplace(std::move(opened));
    ASSERT_TRUE(nats_->make_stream("ALL", "all.*", 1));
    ASSERT_TRUE(nats_->make_stream("LAST", "last.>", 1, Keep::kLastOfSubject));
  }
  NatsResult<std::uint64_t> publish(const std::string& subject, const std::string& text,
                                    std::uint64_t after) {
    return nats_->publish(subject, bytes_of(text), "id " + std::to_string(++ids_), after);
  }
  /// Publishes a message that must be stored. Returns its number.
  std::uint64_t stored(const std::string& subject, const std::string& text, std::uint64_t after) {
    const auto number = publish(subject, text, after);
    EXPECT_TRUE(number) << number.error().reason;
    return number.value_or(0);
  }
  static std::string next(NatsWatch& watch) {
    const auto message = watch.next(milliseconds(2000));
    if (!message || !*message) return "none";
    return (*message)->subject + " " + std::to_string((*message)->sequence) + " " +
           text_of(**message);
  }

  test::NatsUnderTest server_;
  std::optional<NatsConnection> nats_;
  int ids_ = 0;
};

TEST_F(NatsContract, AMessageIsStoredAfterTheLastOneOfItsSubjectOnly) {
  EXPECT_EQ(stored("all.a", "1", 0), 1U);
  EXPECT_EQ(stored("all.b", "1", 0), 2U);
  EXPECT_EQ(stored("all.a", "2", 1), 3U);
  for (const std::uint64_t wrong : {0U, 1U, 2U, 4U}) {
    const auto refused = publish("all.a", "3", wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().code, NatsErrorCode::kNotNext);
  }
  EXPECT_EQ((*nats_->last_message("ALL", "all.a"))->sequence, 3U);
}

TEST_F(NatsContract, AMessageWhoseIdIsKnownIsNotStoredAgain) {
  ASSERT_EQ(*nats_->publish("all.a", bytes_of("x"), "same", 0), 1U);
  EXPECT_EQ(nats_->publish("all.a", bytes_of("x"), "same", 0).value_or(0), 1U);
  EXPECT_EQ((*nats_->last_message("ALL", "all.a"))->sequence, 1U);
}

TEST_F(NatsContract, LastMessageOfAPatternIsFound) {
  EXPECT_FALSE(nats_->last_message("ALL", "all.*")->has_value());
  EXPECT_EQ(nats_->last_message("NONE", "all.*").error().code, NatsErrorCode::kAbsent);
  stored("all.a", "1", 0);
  stored("all.b", "2", 0);
  EXPECT_EQ(text_of(**nats_->last_message("ALL", "all.*")), "2");
  EXPECT_EQ(text_of(**nats_->last_message("ALL", "all.a")), "1");
  EXPECT_FALSE(nats_->last_message("ALL", "all.c")->has_value());
}

TEST_F(NatsContract, StreamOfLastMessagesForgetsOlderOnes) {
  stored("last.x.a", "1", 0);
  stored("last.x.b", "2", 0);
  stored("last.x.a", "3", 1);
  std::vector<std::string> read;
  ASSERT_TRUE(nats_->read("LAST", "last.>", [&](const StreamMessage& message) {
    read.push_back(std::to_string(message.sequence) + text_of(message));
    return true;
  }));
  EXPECT_EQ(read, (std::vector<std::string>{"22", "33"}));
}

TEST_F(NatsContract, WatchGivesTheNewestOfEachSubjectAndThenUpdates) {
  stored("all.a", "old", 0);
  stored("all.b", "b", 0);
  stored("all.a", "a", 1);
  auto watch = test::value_of(nats_->watch("ALL", "all.*"));
  EXPECT_EQ(next(watch), "all.b 2 b");
  EXPECT_EQ(next(watch), "all.a 3 a");
  EXPECT_FALSE(watch.next(milliseconds(20))->has_value());
  stored("all.a", "next", 3);
  EXPECT_EQ(next(watch), "all.a 4 next");
  auto from = test::value_of(nats_->watch_from("ALL", "all.a", 2));
  EXPECT_EQ(next(from), "all.a 3 a");
  EXPECT_EQ(next(from), "all.a 4 next");
}

TEST_F(NatsContract, WatchOfAMissingStreamIsAnError) {
  EXPECT_EQ(nats_->watch("NONE", "none.*").error().code, NatsErrorCode::kAbsent);
}

TEST_F(NatsContract, ReadingStopsOnRequest) {
  for (std::uint64_t n = 0; n < 5; ++n) stored("all.a", std::to_string(n), n);
  int read = 0;
  ASSERT_TRUE(nats_->read("ALL", "all.a", [&](const StreamMessage&) { return ++read < 3; }));
  EXPECT_EQ(read, 3);
}

TEST_F(NatsContract, StreamsArePurgedAndDeleted) {
  for (std::uint64_t n = 0; n < 4; ++n) stored("all.a", std::to_string(n), n);
  ASSERT_TRUE(nats_->purge("ALL", 3));
  auto watch = nats_->watch_from("ALL", "all.a", 1);
  EXPECT_EQ(next(*watch), "all.a 3 2");
  std::vector<std::string> names = *nats_->streams();  // in any order
  std::ranges::sort(names);
  EXPECT_EQ(names, (std::vector<std::string>{"ALL", "LAST"}));
  ASSERT_TRUE(nats_->delete_stream("ALL"));
  EXPECT_EQ(*nats_->streams(), (std::vector<std::string>{"LAST"}));
  EXPECT_EQ(nats_->delete_stream("ALL").error().code, NatsErrorCode::kAbsent);
  EXPECT_EQ(test::error_of(publish("all.a", "x", 0)).code, NatsErrorCode::kRefused);
}

TEST_F(NatsContract, ListenersGetUnstoredMessages) {
  std::mutex mutex;
  std::vector<std::string> heard;
  auto listener = nats_->listen("live.*", [&](const StreamMessage& message) {
    const std::lock_guard lock(mutex);
    heard.push_back(message.subject + " " + text_of(message));
  });
  ASSERT_TRUE(listener);
  nats_->send("live.a", bytes_of("1"));
  nats_->send("other.a", bytes_of("2"));
  nats_->send("live.b", bytes_of("3"));
  EXPECT_TRUE(test::eventually([&] {
    const std::lock_guard lock(mutex);
    return heard == std::vector<std::string>{"live.a 1", "live.b 3"};
  }));
}

TEST_F(NatsContract, RestartedServerKeepsItsStreams) {
  stored("all.a", "before", 0);
  auto watch = nats_->watch("ALL", "all.*");
  EXPECT_EQ(next(*watch), "all.a 1 before");
  server_.stop();
  ASSERT_TRUE(test::eventually([&] { return !nats_->is_connected(); }));
  EXPECT_EQ(publish("all.a", "x", 1).error().code, NatsErrorCode::kAway);
  EXPECT_EQ(nats_->last_message("ALL", "all.a").error().code, NatsErrorCode::kAway);
  EXPECT_EQ(nats_->watch("ALL", "all.a").error().code, NatsErrorCode::kAway);
  EXPECT_FALSE(watch->next(milliseconds(10)).value_or(std::nullopt));
  server_.start();
  ASSERT_TRUE(test::eventually([&] { return nats_->is_connected(); }));
  EXPECT_EQ((*nats_->last_message("ALL", "all.a"))->sequence, 1U);
  ASSERT_TRUE(test::eventually([&] { return publish("all.a", "after", 1).has_value(); }));
  auto later = test::value_of(nats_->watch_from("ALL", "all.a", 2));
  EXPECT_EQ(next(later), "all.a 2 after");
}

}  // namespace
}  // namespace kerf::nats_contract_test
