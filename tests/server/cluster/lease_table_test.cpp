// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/lease_table.h"

#include "tests/support/test.h"

namespace kerf::lease_table_test {
namespace {

using Ids = std::vector<std::string>;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kTakenNs = LeaseTime{}.taken_ns();

Lease held_by(const std::string& node, std::uint32_t epoch = 1) {
  return Lease{
      .node = node, .run = node + "'s run", .address = "http://" + node + ":8080", .epoch = epoch};
}

class LeaseTableTest : public testing::Test {
 protected:
  LeaseTable table_{"a", "a's run"};
};

TEST_F(LeaseTableTest, ALeaseIsTakenOnlyWhenItHasNotChangedForThreeSeconds) {
  table_.note("s", held_by("b"), 7, 0);
  EXPECT_EQ(table_.takeable(3 * kSecond), Ids());
  EXPECT_EQ(table_.address_of("s", 3 * kSecond), "http://b:8080");
  table_.note("s", held_by("b"), 7, 3 * kSecond);  // seen again, and not renewed
  EXPECT_EQ(table_.takeable(kTakenNs), Ids{"s"});
  EXPECT_TRUE(table_.is_moving("s", kTakenNs));
  EXPECT_EQ(table_.address_of("s", kTakenNs), std::nullopt);
  table_.note("s", held_by("b"), 8, kTakenNs);
  EXPECT_EQ(table_.takeable(2 * kTakenNs - 1), Ids());
}

TEST_F(LeaseTableTest, ALeaseLastsAsLongAsItsOwnerStates) {
  Lease lease = held_by("b");
  lease.time = {kSecond};
  const auto stated = test::value_of(decode_lease(encode_lease(lease)));
  table_.note("s", stated, 7, 0);
  table_.note("t", held_by("b"), 8, 0);
  EXPECT_EQ(table_.takeable(kSecond * 31 / 25 - 1), Ids());
  EXPECT_EQ(table_.takeable(kSecond * 31 / 25), Ids{"s"});
}

TEST_F(LeaseTableTest, PartlyLostLeaseBecomesFreeAndKeepsItsEpoch) {
  table_.note("s", held_by("b", 5), 47, 0);
  table_.correct("s", {24, held_by("c", 3)}, 9 * kSecond);
  EXPECT_EQ(table_.find("s")->revision, 24U);
  EXPECT_EQ(table_.find("s")->lease.node, "c");
  EXPECT_EQ(table_.find("s")->lease.epoch, 5U) << "an owner of epoch 5 may be about to come back";
  EXPECT_EQ(table_.takeable(9 * kSecond + kTakenNs - 1), Ids());
  EXPECT_EQ(table_.takeable(9 * kSecond + kTakenNs), Ids{"s"});
  table_.correct("s", {0, std::nullopt}, 20 * kSecond);
  EXPECT_EQ(table_.find("s")->revision, 0U);
  EXPECT_EQ(table_.takeable(20 * kSecond + kTakenNs), Ids{"s"}) << "whatever NATS has lost";
  table_.correct("unknown", {0, std::nullopt}, 20 * kSecond);
  EXPECT_EQ(table_.find("unknown"), nullptr);
}

TEST_F(LeaseTableTest, TimeWithoutObservationsDoesNotCount) {
  table_.note("s", held_by("b"), 7, 0);
  table_.begin(10 * kSecond);
  EXPECT_EQ(table_.takeable(13 * kSecond), Ids());
  EXPECT_EQ(table_.takeable(10 * kSecond + kTakenNs), Ids{"s"});
}

TEST_F(LeaseTableTest, AReleasedLeaseIsFreeAtOnceForTheServerThatItNames) {
  Lease lease = held_by("b");
  lease.state = LeaseState::kReleased;
  table_.note("any", lease, 1, 0);
  lease.to = "a";
  table_.note("mine", lease, 2, 0);
  lease.to = "c";
  table_.note("other", lease, 3, 0);
  EXPECT_EQ(table_.takeable(0), (Ids{"any", "mine"}));
  EXPECT_EQ(table_.takeable(2 * kSecond), (Ids{"any", "mine", "other"}));
}

TEST_F(LeaseTableTest, ClosedSessionHasNoServer) {
  Lease lease = held_by("b");
  lease.state = LeaseState::kClosed;
  table_.note("s", lease, 1, 0);
  EXPECT_EQ(table_.takeable(100 * kSecond), Ids());
  EXPECT_FALSE(table_.is_moving("s", 0));
  EXPECT_FALSE(table_.address_of("s", 0));
  EXPECT_TRUE(table_.elsewhere().empty());
}

TEST_F(LeaseTableTest, PeersAreNotSentToAServerThatIsAboutToStop) {
  Lease lease = held_by("b");
  lease.to = "a";
  table_.note("s", lease, 1, 0);
  EXPECT_TRUE(table_.is_moving("s", 0));
  EXPECT_FALSE(table_.address_of("s", 0));
  EXPECT_EQ(table_.takeable(0), Ids()) << "it still has the lease";
}

TEST_F(LeaseTableTest, ASessionWithoutCopyNeedsItsLostServerUntilTheLeaseChanges) {
  table_.note("s", held_by("b"), 7, 0);
  EXPECT_EQ(table_.needed_server("s"), std::nullopt);
  table_.note_uncopied("s", 6);
  EXPECT_TRUE(table_.is_moving("s", kTakenNs)) << "an earlier lease";
  table_.note_uncopied("s", 7);
  EXPECT_EQ(table_.needed_server("s"), "b");
  EXPECT_FALSE(table_.is_moving("s", kTakenNs)) << "nobody else can continue it";
  EXPECT_EQ(table_.address_of("s", kTakenNs), std::nullopt);
  EXPECT_EQ(table_.takeable(kTakenNs), Ids{"s"}) << "it is tried again";
  table_.note("s", held_by("b", 2), 8, kTakenNs);
  EXPECT_EQ(table_.needed_server("s"), std::nullopt);
  EXPECT_EQ(table_.address_of("s", kTakenNs), "http://b:8080");
}

TEST_F(LeaseTableTest, NoRedirectToThisServer) {
  table_.note("s", held_by("a"), 1, 0);
  EXPECT_FALSE(table_.address_of("s", 0));
  EXPECT_TRUE(table_.is_moving("s", 0)) << "it is about to be opened, or was lost";
  EXPECT_TRUE(table_.elsewhere().empty());
}

TEST_F(LeaseTableTest, OnlyRecentlyHeardServersCount) {
  table_.note("a", {.run = "a's run", .address = "http://a"}, 0);
  table_.note("b", {.run = "b's run", .address = "http://b"}, 0);
  table_.note("c", {.run = "c's run", .address = ""}, 0);  // it stops
  table_.note("s", held_by("b"), 1, 0);
  table_.note("t", held_by("b"), 2, 0);
  Lease closed = held_by("b");
  closed.state = LeaseState::kClosed;
  table_.note("u", closed, 3, 0);
  const auto others = table_.others(4 * kSecond);
  ASSERT_EQ(others.size(), 1U);
  EXPECT_EQ(others[0].name, "b");
  EXPECT_EQ(others[0].address, "http://b");
  EXPECT_EQ(others[0].sessions, 2U);
  EXPECT_TRUE(table_.others(6 * kSecond).empty());
}

TEST_F(LeaseTableTest, PagesOfADepartedServerContinueForADay) {
  table_.note("a", {.run = "a's run", .address = "http://a"}, 0);
  table_.note("b", {.run = "b's run", .address = "http://b"}, 0);
  table_.note("b", {.run = "b's run", .address = ""}, kSecond);  // it stops
  EXPECT_EQ(table_.page_servers(kPageLifeNs - 1), Ids{"http://b"});
  EXPECT_EQ(table_.page_servers(kPageLifeNs), Ids());
  table_.note("b", {.run = "another", .address = "http://b:81"}, 2 * kSecond);
  EXPECT_EQ(table_.page_servers(3 * kSecond), (Ids{"http://b", "http://b:81"}));
}

TEST_F(LeaseTableTest, FollowOnlyServersGetNoSessions) {
  const NodeNote note{.run = "b's run", .address = "http://b", .only_follows = true};
  EXPECT_TRUE(decode_node(encode_node(note))->only_follows);
  table_.note("b", note, 0);
  EXPECT_EQ(table_.others(0).size(), 1U);
  EXPECT_FALSE(table_.least_loaded(0));
  table_.note("c", {.run = "c's run", .address = "http://c"}, 0);
  table_.note("s", held_by("c"), 1, 0);
  EXPECT_EQ(table_.least_loaded(0)->name, "c");
}

TEST_F(LeaseTableTest, TheServerWithTheFewestSessionsIsTheLeastLoadedOne) {
  const auto state = [&](const std::string& node) {
    table_.note(node, {.run = node + "'s run", .address = "http://" + node}, 0);
  };
  EXPECT_FALSE(table_.least_loaded(0));
  for (const char* node : {"a", "b", "c"}) state(node);
  table_.note("s", held_by("b"), 1, 0);
  EXPECT_EQ(table_.least_loaded(0)->name, "c");
  table_.expect_session("c");
  table_.expect_session("c");
  EXPECT_EQ(table_.least_loaded(0)->name, "b");
  table_.note("t", held_by("c"), 2, 0);  // one of the two
  EXPECT_EQ(table_.least_loaded(0)->name, "b") << "c has one and is to get another";
  table_.note("u", held_by("c"), 3, 0);
  table_.note("v", held_by("b"), 4, 0);
  table_.note("w", held_by("b"), 5, 0);
  EXPECT_EQ(table_.least_loaded(0)->sessions, 2U) << "of c, which has what it was to get";
}

TEST_F(LeaseTableTest, ExpectedSessionIsGivenUp) {
  table_.note("b", {.run = "b's run", .address = "http://b"}, 0);
  table_.expect_session("b");
  table_.note("b", {.run = "b's run", .address = "http://b"}, kSecond);
  EXPECT_EQ(table_.least_loaded(kSecond)->sessions, 1U) << "its client may come yet";
  table_.note("b", {.run = "b's run", .address = "http://b"}, 2 * kSecond);
  EXPECT_EQ(table_.least_loaded(2 * kSecond)->sessions, 0U);
}

TEST(Lease, RoundTrips) {
  Lease written = held_by("b", 9);
  written.state = LeaseState::kReleased;
  written.to = "c";
  written.shown.name = "Ammonite \"7\"";
  written.shown.motions = 5;
  written.shown.removed_mm3 = 2.5;
  written.shown.participants = 3;
  written.shown.created_ms = 11;
  written.shown.active_ms = 12;
  const auto read = test::value_of(decode_lease(encode_lease(written)));
  EXPECT_EQ(read.state, LeaseState::kReleased);
  EXPECT_EQ(std::tie(read.node, read.run, read.address, read.to, read.shown.name),
            std::tie(written.node, written.run, written.address, written.to, written.shown.name));
  EXPECT_EQ(read.epoch, 9U);
  EXPECT_EQ(read.shown.motions, 5U);
  EXPECT_EQ(read.shown.removed_mm3, 2.5);
  EXPECT_EQ(read.shown.participants, 3U);
  EXPECT_EQ(read.shown.created_ms, 11);
  EXPECT_EQ(read.shown.active_ms, 12);
}

TEST(Lease, MalformedLeasesAreRejected) {
  const auto decode = [](const std::string& text) {
    return decode_lease(std::as_bytes(std::span(text)));
  };
  EXPECT_FALSE(decode(""));
  EXPECT_FALSE(decode("[]"));
  EXPECT_FALSE(decode("{}"));
  EXPECT_FALSE(decode(R"({"state":"held","node":1,"run":"r","address":"x","epoch":1})"));
  EXPECT_TRUE(decode(R"({"state":"held","node":"b","run":"r","address":"x","epoch":1})"));
}

TEST(Lease, SubjectsNameSessionsAndServers) {
  EXPECT_EQ(session_of_subject(lease_subject("demo")), "demo");
  EXPECT_EQ(node_of_subject(node_subject("b")), "b");
  EXPECT_FALSE(session_of_subject(node_subject("b")));
  EXPECT_FALSE(node_of_subject(lease_subject("demo")));
}

}  // namespace
}  // namespace kerf::lease_table_test
