// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_file.h"
#include "server/store/journal_writer.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::journal_together_test {
namespace {

const JournalHeader kHeader{"demo", "{\"name\":\"demo\"}", "/scenes", 1};

class JournalTogether : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "demo.kerf";
};

TEST_F(JournalTogether, GroupedCommandsAreCommittedTogether) {
  constexpr int kTogether = 40, kTimes = 400, kFlushed = 100;
  auto writer = test::value_of(JournalWriter::create(file_, kHeader));
  {
    // Commits the buffer as often as possible.
    const std::jthread committer([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) ASSERT_TRUE(writer.flush());
    });
    const std::vector<RecordedCommand> changes(kTogether, StrokeChange{1, true});
    for (int n = 1; n <= kTimes; ++n) {
      const auto last = test::value_of(writer.append_together(1, changes));
      EXPECT_EQ(last, static_cast<std::uint64_t>(kTogether * n));
      // However fast this loop is, some changes are appended after others have been committed.
      if (n % kFlushed == 0) {
        ASSERT_TRUE(writer.flush());
      }
    }
  }
  ASSERT_TRUE(writer.finish());
  const auto count = [this](const std::string& question) {
    return open_journal(file_, SqlMode::kRead)->integer(question).value();
  };
  EXPECT_EQ(count("SELECT sum(count) FROM batches"), kTogether * kTimes);
  EXPECT_GE(count("SELECT count(*) FROM batches"), kTimes / kFlushed);
  EXPECT_EQ(count("SELECT count(*) FROM batches WHERE count%40<>0"), 0) << "one was divided";
}

TEST_F(JournalTogether, GroupedCommandsAreRejectedTogether) {
  auto writer = test::value_of(JournalWriter::create(file_, kHeader));
  const std::vector<RecordedCommand> many(kJournalBufferRecords + 1, StrokeChange{1, true});
  EXPECT_EQ(test::error_of(writer.append_together(1, many)).code, JournalErrorCode::kFull);
  EXPECT_EQ(writer.last_sequence(), 0U);
  EXPECT_EQ(writer.lag(), 0U);
}

}  // namespace
}  // namespace kerf::journal_together_test
