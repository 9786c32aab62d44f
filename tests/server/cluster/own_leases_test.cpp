// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/own_leases.h"

#include "server/platform/clock.h"
#include "tests/server/cluster/nats_fixture.h"
#include "tests/support/test.h"

namespace kerf::own_leases_test {
namespace {

class OwnLeasesTest : public test::NatsTest {
 protected:
  void SetUp() override {
    NatsTest::SetUp();
    if (!nats_) return;
    ASSERT_TRUE(nats_->make_stream(kClusterStream, kClusterSubjects, 1, Keep::kLastOfSubject));
    a_.emplace(*nats_, "a");
    b_.emplace(*nats_, "b");
  }
  void TearDown() override {
    a_.reset();
    b_.reset();
    NatsTest::TearDown();
  }

  static Lease lease(const std::string& run, std::uint32_t epoch) {
    return {
        .node = run, .run = run, .address = "http://" + run, .epoch = epoch, .to = {}, .shown = {}};
  }
  StreamMessage stored() { return **nats_->last_message(kClusterStream, lease_subject("s")); }

  std::optional<OwnLeases> a_, b_;
};

TEST_F(OwnLeasesTest, ConcurrentClaimsHaveOneWinner) {
  ASSERT_TRUE(a_->take("s", lease("a", 1), 0));
  EXPECT_TRUE(test::error_of(b_->take("s", lease("b", 1), 0)).is_lost);
  EXPECT_TRUE(a_->fence("s")->is_open());
  EXPECT_FALSE(b_->fence("s")->is_open());
  const std::uint64_t revision = stored().sequence;
  ASSERT_TRUE(a_->renew("s", {}));
  EXPECT_FALSE(b_->take("s", lease("b", 2), revision)) << "it was renewed since";
  EXPECT_EQ(decode_lease(stored().bytes)->node, "a");
}

TEST_F(OwnLeasesTest, SucceededOwnerIsFenced) {
  ASSERT_TRUE(a_->take("s", lease("a", 1), 0));
  const auto fence = a_->fence("s");
  ASSERT_TRUE(b_->take("s", lease("b", 2), stored().sequence));
  EXPECT_TRUE(test::error_of(a_->renew("s", {})).is_lost);
  EXPECT_FALSE(fence->is_open());
  EXPECT_FALSE(a_->find("s"));
  a_->give_back("s", LeaseState::kReleased, {});
  EXPECT_EQ(decode_lease(stored().bytes)->node, "b");
  EXPECT_EQ(decode_lease(stored().bytes)->epoch, 2U);
}

TEST_F(OwnLeasesTest, LeaseOfARolledBackNatsIsReadAndTaken) {
  ASSERT_TRUE(a_->take("s", lease("a", 1), 0));
  const StreamMessage early = stored();
  for (int n = 0; n < 3; ++n) ASSERT_TRUE(a_->renew("s", {}));
  const std::uint64_t seen = stored().sequence;
  // Restores the store of an earlier moment.
  ASSERT_TRUE(nats_->delete_stream(kClusterStream));
  ASSERT_TRUE(nats_->make_stream(kClusterStream, kClusterSubjects, 1, Keep::kLastOfSubject));
  const auto error = test::error_of(b_->take("s", lease("b", 2), seen));
  ASSERT_TRUE(error.stored);
  EXPECT_EQ(error.stored->revision, 0U);
  EXPECT_FALSE(error.stored->lease);
  ASSERT_TRUE(nats_->publish(lease_subject("s"), early.bytes, "early", 0));

  const auto failed = test::error_of(b_->take("s", lease("b", 2), seen));
  EXPECT_EQ(failed.reason,
            "NATS has lost messages: revision 4 of its lease was seen, the newest one now is 1");
  ASSERT_TRUE(failed.stored && failed.stored->lease);
  EXPECT_EQ(failed.stored->lease->node, "a");
  EXPECT_TRUE(b_->take("s", lease("b", 2), failed.stored->revision));
  EXPECT_EQ(decode_lease(stored().bytes)->node, "b");
}

TEST_F(OwnLeasesTest, LostAnswerToARenewalIsRecognizedAsOwn) {
  ASSERT_TRUE(a_->take("s", lease("a", 1), 0));
  const StreamMessage first = stored();
  ASSERT_TRUE(nats_->publish(lease_subject("s"), first.bytes, "lost", first.sequence));
  EXPECT_TRUE(a_->renew("s", {}));
  EXPECT_TRUE(a_->fence("s")->is_open());
}

TEST_F(OwnLeasesTest, LateAnswerTakesALeaseOnce) {
  // Longer than one attempt waits, shorter than all of them.
  process_.suspend();
  std::jthread later([this] {
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    process_.resume();
  });
  ASSERT_TRUE(a_->take("s", lease("a", 1), 0));
  EXPECT_TRUE(a_->find("s"));
  const StreamMessage first = stored();
  EXPECT_EQ(decode_lease(first.bytes)->node, "a");
  EXPECT_FALSE(b_->take("s", lease("b", 1), 0));
  ASSERT_TRUE(a_->renew("s", {}));
  EXPECT_EQ(stored().sequence, first.sequence + 1);
}

TEST_F(OwnLeasesTest, ReleasedLeaseMayBeTaken) {
  ASSERT_TRUE(a_->take("s", lease("a", 1), 0));
  const auto fence = a_->fence("s");
  a_->give_back("s", LeaseState::kReleased, "b");
  EXPECT_FALSE(fence->is_open());
  EXPECT_EQ(decode_lease(stored().bytes)->state, LeaseState::kReleased);
  EXPECT_EQ(decode_lease(stored().bytes)->to, "b");
  EXPECT_TRUE(b_->take("s", lease("b", 2), stored().sequence));
  EXPECT_TRUE(b_->due(Clock::boot_ns()).empty());
  EXPECT_EQ(b_->due(Clock::boot_ns() + LeaseTime{}.renew_ns()), std::vector<std::string>{"s"});
}

}  // namespace
}  // namespace kerf::own_leases_test
