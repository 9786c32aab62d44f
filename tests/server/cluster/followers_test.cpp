// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/followers.h"

#include "server/platform/clock.h"
#include "server/store/write_fence.h"
#include "tests/server/cluster/nats_fixture.h"
#include "tests/server/manual_executor.h"
#include "tests/support/eventually.h"
#include "tests/support/test.h"

namespace kerf::followers_test {
namespace {

class FollowersTest : public test::NatsTest {
 protected:
  std::shared_ptr<test::ManualExecutor> executor_ = std::make_shared<test::ManualExecutor>();
};

/// Bug: a viewer that arrived just after the leases were listed got a `bye`, as if the session had
/// ended.
TEST_F(FollowersTest, StaleListDoesNotEndNewlyWantedSessions) {
  RegistryOptions options{.data_folder = folder_.path()};
  SessionRegistry registry(options, [this](const std::string&) { return executor_; }, *executor_);
  Followers followers(*nats_, registry, "b", Follow::kViewed);
  const std::int64_t known_ns = Clock::boot_ns();
  ASSERT_TRUE(followers.want("demo"));
  // There is no copy, so following has failed. That is not known at first.
  ASSERT_TRUE(test::eventually([&] { return !followers.want("demo"); }));
  followers.set_elsewhere({}, {}, known_ns);
  EXPECT_FALSE(followers.want("demo")) << "it has ended, and begins again";
  followers.set_elsewhere({"demo"}, {}, Clock::boot_ns());
  EXPECT_FALSE(followers.want("demo"));
  followers.set_elsewhere({}, {"demo"}, Clock::boot_ns());
  EXPECT_FALSE(followers.want("demo"));
  followers.set_elsewhere({}, {}, Clock::boot_ns());
  EXPECT_TRUE(followers.want("demo")) << "it has not ended";
}

}  // namespace
}  // namespace kerf::followers_test
