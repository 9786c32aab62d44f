// SPDX-License-Identifier: Apache-2.0
#include "server/store/write_fence.h"

#include "server/platform/clock.h"
#include "server/store/journal_file.h"
#include "server/store/journal_writer.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::write_fence_test {
namespace {

constexpr std::int64_t kHour = 3'600'000'000'000;

TEST(WriteFence, IsClosedUntilItIsExtendedAndNeverMovesBack) {
  WriteFence fence;
  EXPECT_FALSE(fence.is_open());
  fence.extend(Clock::boot_ns() + kHour);
  fence.extend(Clock::boot_ns() - 1);
  EXPECT_TRUE(fence.is_open());
}

TEST(WriteFence, CannotBeOpenedAgainOnceItHasEnded) {
  WriteFence fence;
  fence.extend(Clock::boot_ns() + kHour);
  fence.end();
  fence.extend(Clock::boot_ns() + 2 * kHour);
  EXPECT_FALSE(fence.is_open());
}

TEST(WriteFence, AJournalAcceptsCommandsOnlyWhileItIsOpen) {
  const test::TemporaryFolder folder;
  auto writer = test::value_of(JournalWriter::create(folder / "demo.kerf", {"demo", "{}", {}, 1}));
  const auto fence = std::make_shared<WriteFence>();
  writer.keep_within(fence);
  EXPECT_EQ(test::error_of(writer.append(1, MoveTool{})).code, JournalErrorCode::kLease);
  EXPECT_TRUE(writer.is_fenced());
  EXPECT_EQ(writer.pause()->code, JournalErrorCode::kLease);
  fence->extend(Clock::boot_ns() + kHour);
  EXPECT_EQ(writer.append(1, MoveTool{}), 1U);
  EXPECT_FALSE(writer.is_fenced());
  EXPECT_FALSE(writer.pause());
  fence->end();
  EXPECT_FALSE(writer.append(1, MoveTool{}));
  ASSERT_TRUE(writer.flush()) << "what was accepted is committed";
  EXPECT_EQ(writer.durable_sequence(), 1U);
}

TEST(RaiseEpoch, NextOpeningHasAtLeastThatEpoch) {
  const test::TemporaryFolder folder;
  const auto file = folder / "demo.kerf";
  ASSERT_TRUE(JournalWriter::create(file, {"demo", "{}", {}, 1}));
  ASSERT_TRUE(raise_epoch(file, 9));
  EXPECT_EQ(JournalWriter::open(file, 0)->epoch(), 9U);
  ASSERT_TRUE(raise_epoch(file, 5));
  EXPECT_EQ(JournalWriter::open(file, 0)->epoch(), 10U);
}

}  // namespace
}  // namespace kerf::write_fence_test
