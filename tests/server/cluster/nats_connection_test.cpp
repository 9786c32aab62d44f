// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/nats_connection.h"

#include "tests/server/cluster/nats_fixture.h"
#include "tests/server/random_runs.h"
#include "tests/support/test.h"

namespace kerf::nats_connection_test {
namespace {

using std::chrono::milliseconds;

class NatsConnectionTest : public test::NatsTest {
 protected:
  void SetUp() override {
    NatsTest::SetUp();
    if (!nats_) return;
    ASSERT_TRUE(nats_->make_stream("S", "s.*", 1, Keep::kLastOfSubject));
  }
};

TEST_F(NatsConnectionTest, WatchesAndListenersEndWhileTheirMessagesArrive) {
  constexpr unsigned kCycles = 100;
  constexpr int kMessages = 200;
  const std::vector<std::byte> bytes(64);
  for (unsigned n = 0; n < kCycles * setting("KERF_EFFORT", 1); ++n) {
    std::atomic<int> heard = 0;
    auto watch = nats_->watch("S", "s.*");
    auto listener = nats_->listen("s2.live", [&](const StreamMessage&) { ++heard; });
    ASSERT_TRUE(watch && listener);
    for (int k = 0; k < kMessages; ++k) {
      nats_->send("s.live", bytes);
      nats_->send("s2.live", bytes);
    }
    EXPECT_TRUE(test::value_of(watch->next(milliseconds(2000))));
  }
}

TEST_F(NatsConnectionTest, AWatchMayOutliveItsConnection) {
  auto watch = test::value_of(nats_->watch("S", "s.*"));
  nats_.reset();
  EXPECT_TRUE(watch.next(milliseconds(0)).has_value());
}

}  // namespace
}  // namespace kerf::nats_connection_test
