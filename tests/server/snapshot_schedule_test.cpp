// SPDX-License-Identifier: Apache-2.0
// The schedule of a session's snapshots.
#include "server/session/snapshot_schedule.h"

#include "server/platform/clock.h"
#include "tests/support/test.h"

namespace kerf::snapshot_schedule_test {
namespace {

TEST(SnapshotSchedules, AreDueByReplayTimeAndByAgeButNotTooOften) {
  using std::chrono::milliseconds, std::chrono::seconds, std::chrono::minutes;
  const Clock::time_point start{};
  SnapshotSchedule schedule({seconds(1), minutes(10), seconds(2)}, 100, milliseconds(400), start);
  EXPECT_FALSE(schedule.is_due(100, seconds(5), start)) << "nothing is new";
  EXPECT_FALSE(schedule.is_due(101, milliseconds(590), start));
  EXPECT_TRUE(schedule.is_due(101, milliseconds(600), start))
      << "400 ms were replayed at the start";
  EXPECT_TRUE(schedule.is_due(700'000, milliseconds(0), start)) << "records must be read, too";
  EXPECT_TRUE(schedule.is_due(101, milliseconds(0), start + minutes(10)));
  schedule.begin(101, seconds(2), start);
  EXPECT_FALSE(schedule.is_due(102, seconds(9), start + seconds(1))) << "one is being written";
  schedule.end(true, start + seconds(1));
  EXPECT_FALSE(schedule.is_due(102, milliseconds(3990), start + seconds(10)));
  EXPECT_TRUE(schedule.is_due(102, milliseconds(3990), start + seconds(11)))
      << "ten times as long after it";
  EXPECT_TRUE(schedule.is_due(102, seconds(4), start + seconds(2))) << "twice the limit: at once";
  EXPECT_FALSE(schedule.is_due(102, milliseconds(2990), start + seconds(11)));
  schedule.begin(102, seconds(9), start + seconds(11));
  schedule.end(false, start + seconds(11));
  EXPECT_FALSE(schedule.is_due(102, seconds(9), start + seconds(12))) << "it failed";
  EXPECT_TRUE(schedule.is_due(102, seconds(9), start + seconds(13))) << "once more";
}

// A server killed at any moment, whose session only carves and whose snapshots take a second to
// write.
TEST(SnapshotSchedules, KeepEveryRestartBelowThreeSeconds) {
  using std::chrono::milliseconds, std::chrono::seconds, std::chrono::minutes;
  const Clock::time_point start{};
  SnapshotSchedule schedule({seconds(1), minutes(10), seconds(2)}, 0, seconds(0), start);
  milliseconds written_at{-1};  // record of the one being written
  milliseconds longest{0}, writing{0};
  for (milliseconds work{0}; work < minutes(2); work += milliseconds(10)) {
    const auto sequence = static_cast<std::uint64_t>(work.count());
    if (work == written_at) {
      schedule.end(true, start + work);
      written_at = milliseconds(-1);
    }
    if (written_at > work) writing += milliseconds(10);
    if (schedule.is_due(sequence, work, start + work)) {
      schedule.begin(sequence, work, start + work);
      written_at = work + seconds(1);
    }
    longest = std::max(
        longest, std::chrono::duration_cast<milliseconds>(schedule.replay_time(sequence, work)));
  }
  EXPECT_LE(longest, milliseconds(3050));
  EXPECT_LT(writing, minutes(1) + seconds(1));
}

}  // namespace
}  // namespace kerf::snapshot_schedule_test
