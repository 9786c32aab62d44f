// SPDX-License-Identifier: Apache-2.0
// One allocation fails somewhere during a request. Afterwards either the block matches the journal,
// or the request was rejected and has changed nothing.
#include "tests/server/memory_fixture.h"
#include "tests/support/test.h"

namespace kerf::memory_test {
namespace {

TEST_F(SessionWithoutMemory, UndoSucceedsOrChangesNothing) {
  carve_three_strokes();
  constexpr std::uint64_t kMany = 1'000'000'000;
  std::uint64_t allocations = 0;
  {
    const test::FailingMemory counted(kMany);
    ASSERT_TRUE(turn());
    allocations = kMany - counted.left();
  }
  is_undone_ = true;
  std::mt19937_64 random(setting("KERF_SEED", 1));
  const unsigned failures = setting("KERF_EFFORT", kEffort);
  for (unsigned n = 0; n < failures && !HasFailure(); ++n) {
    const std::uint64_t k = 1 + random() % allocations;
    SCOPED_TRACE("allocation " + std::to_string(k));
    const std::uint64_t before = session_->sequence(), shape = hash();
    bool is_done = false;
    {
      const test::FailingMemory memory(k);
      try {
        is_done = turn();
      } catch (const std::bad_alloc&) {
      }
    }
    settle();
    ASSERT_FALSE(session_->is_between_records());
    EXPECT_EQ(hash(), never_happened());
    const bool is_journaled = session_->sequence() != before;
    EXPECT_EQ(is_done, is_journaled);
    if (is_journaled) {
      is_undone_ = !is_undone_;
    } else {
      EXPECT_EQ(hash(), shape);
    }
  }
  const std::uint64_t left = hash();
  reload();
  EXPECT_EQ(hash(), left);
}

/// Each allocation of the first look at the history fails once. Lists that hold the records read so
/// far grow at the beginning, so the failure of one would leave a part of a record in the history.
TEST_F(SessionWithoutMemory, HistoryIsReadAgainAfterAnExceptionHasEndedItsReading) {
  carve_three_strokes();
  constexpr std::uint64_t kMany = 1'000'000'000;
  const auto look = [&](std::uint64_t k) {
    reload();
    EXPECT_TRUE(session_->flush());
    const test::FailingMemory memory(k);
    try {
      (void)session_->past().strokes(0);
    } catch (const std::bad_alloc&) {
    }
    return k - memory.left();
  };
  const std::uint64_t allocations = look(kMany);
  ASSERT_GT(allocations, 50U);
  for (std::uint64_t k = 1; k <= allocations && !HasFailure(); ++k) {
    SCOPED_TRACE("allocation " + std::to_string(k));
    look(k);
    ASSERT_TRUE(turn());
    is_undone_ = !is_undone_;
    EXPECT_EQ(hash(), never_happened());
  }
}

}  // namespace
}  // namespace kerf::memory_test
