// SPDX-License-Identifier: Apache-2.0
#include <pthread.h>

#include "haptic_agent/realtime/realtime_thread.h"
#include "tests/support/test.h"

namespace kerf::agent::thread_stack_test {
namespace {

std::size_t stack_of_a_new_thread() {
  std::size_t bytes = 0;
  std::thread([&bytes] {
    pthread_attr_t attributes;
    ASSERT_EQ(pthread_getattr_np(pthread_self(), &attributes), 0);
    EXPECT_EQ(pthread_attr_getstacksize(&attributes, &bytes), 0);
    pthread_attr_destroy(&attributes);
  }).join();
  return bytes;
}

TEST(ThreadStacks, LaterThreadsGetALimitedStack) {
  pthread_attr_t before;
  ASSERT_EQ(pthread_getattr_default_np(&before), 0);
  EXPECT_GT(stack_of_a_new_thread(), kThreadStackBytes);
  EXPECT_EQ(limit_thread_stacks(), 0);
  EXPECT_EQ(stack_of_a_new_thread(), kThreadStackBytes);
  EXPECT_EQ(pthread_setattr_default_np(&before), 0);
  pthread_attr_destroy(&before);
}

}  // namespace
}  // namespace kerf::agent::thread_stack_test
