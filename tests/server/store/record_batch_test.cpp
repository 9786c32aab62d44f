// SPDX-License-Identifier: Apache-2.0
// Batches of records, and journals of version 1.
#include "server/store/record_batch.h"

#include "server/store/journal_reader.h"
#include "server/store/journal_writer.h"
#include "tests/server/store/random_records.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::record_batch_test {
namespace {

using test::pose_of, test::random_records;

TEST(RecordBatch, DecodesToTheSameBits) {
  std::mt19937_64 random(5);
  BatchEncoder encoder;
  BatchDecoder decoder;
  for (int n = 0; n < 2 * BatchEncoder::kBatchesPerRestart; ++n) {
    const auto records = random_records(random, 1 + random() % 40);
    const auto bytes = encoder.encode(records);
    const auto decoded = test::value_of(decoder.decode(bytes, records.size()));
    ASSERT_EQ(decoded.size(), records.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
      EXPECT_EQ((decoded)[i].participant, records[i].participant);
      EXPECT_EQ((decoded)[i].begins_stroke, records[i].begins_stroke);
      // Bit for bit: -0 differs from 0.
      EXPECT_EQ(encode_command((decoded)[i].command), encode_command(records[i].command));
    }
  }
}

TEST(RecordBatch, ExtremeNumbersAreKept) {
  BatchEncoder encoder;
  BatchDecoder decoder;
  const double huge = std::numeric_limits<double>::max(),
               inf = std::numeric_limits<double>::infinity();
  std::vector<BatchRecord> records;
  for (const double value : {0.0, -0.0, 1e6, -1e6, 1e12, 1e-300, huge, -huge, inf}) {
    MoveTool move{.tool = std::numeric_limits<ToolId>::max(),
                  .from = {.tip_mm = {value, -value, 0}},
                  .to = {.tip_mm = {-value, value, value}, .axis = {0, value, 1}},
                  .duration_s = value};
    records.push_back({std::numeric_limits<ParticipantId>::max(), move, true});
  }
  const auto decoded = test::value_of(decoder.decode(encoder.encode(records), records.size()));
  for (std::size_t i = 0; i < records.size(); ++i) {
    EXPECT_EQ(encode_command((decoded)[i].command), encode_command(records[i].command)) << i;
  }
}

/// A path of segments as in a program: the duration of each is its travel at the feed rate.
std::vector<BatchRecord> program_records(int count) {
  std::vector<BatchRecord> records;
  ToolPose last = pose_of(20, 0, -1);
  for (int n = 1; n <= count; ++n) {
    const ToolPose pose =
        pose_of(std::round(20e3 * std::cos(0.02 * n)) / 1e3, 15 * std::sin(0.02 * n), -1);
    const double travel_mm = length(pose.tip_mm - last.tip_mm);
    records.push_back({1, MoveTool{1, last, pose, 60 * travel_mm / 800, false}, n == 1});
    last = pose;
  }
  return records;
}

TEST(RecordBatch, ADurationBetweenMicrosecondsTakesItsEightBytesAndNoWholeCommand) {
  BatchEncoder encoder;
  BatchDecoder decoder;
  const auto records = program_records(1000);
  const auto bytes = encoder.encode(records);
  EXPECT_LT(bytes.size(), 1000 * 18U);
  const auto decoded = test::value_of(decoder.decode(bytes, records.size()));
  for (std::size_t i = 0; i < records.size(); ++i) {
    EXPECT_EQ(encode_command((decoded)[i].command), encode_command(records[i].command)) << i;
  }
}

TEST(RecordBatch, ARepeatedExactDurationIsNotStoredAgain) {
  std::vector<BatchRecord> records;
  for (int n = 0; n < 1000; ++n) {
    records.push_back({1, MoveTool{1, pose_of(n, 0, 0), pose_of(n + 1, 0, 0), 1.0 / 3, false}});
  }
  BatchEncoder encoder;
  EXPECT_LT(encoder.encode(records).size(), 1000U);
}

TEST(RecordBatch, DamageNeverCrashesAndBatchesNeedTheirPredecessors) {
  std::mt19937_64 random(6);
  BatchEncoder encoder;
  const auto first = random_records(random, 30), second = random_records(random, 30);
  const auto one = encoder.encode(first), two = encoder.encode(second);
  BatchDecoder late;
  EXPECT_FALSE(late.decode(two, second.size()));
  for (int n = 0; n < 3000; ++n) {
    BatchDecoder decoder;
    auto damaged = one;
    for (int flips = 0; flips < 3; ++flips) {
      damaged[random() % damaged.size()] ^= std::byte{1} << (random() % 8);
    }
    if (n % 3 == 0) damaged.resize(random() % damaged.size());
    (void)decoder.decode(damaged, first.size());
    (void)decoder.decode(two, second.size());
  }
}

// The tables of an empty journal take one page each, however many motions follow.
TEST(RecordBatch, AHandAtOneKilohertzAddsTenBytesAMotion) {
  test::TemporaryFolder folder;
  const auto file = folder / "hand.kerf";
  constexpr int kMotions = 20'000;
  ASSERT_TRUE(JournalWriter::create(file, {"hand", "{}", "", 1}));
  const auto empty_bytes = std::filesystem::file_size(file);
  {
    auto writer = JournalWriter::open(file, 0);
    std::mt19937_64 random(1);
    std::normal_distribution<double> jitter_us(0, 20);
    std::uint64_t time_us = 0;
    ToolPose last;
    for (int i = 0; i <= kMotions; ++i) {
      const std::uint64_t before_us = time_us;
      time_us += 1000 + static_cast<std::uint64_t>(std::lround(jitter_us(random)));
      const double t = static_cast<double>(time_us) * 1e-6;
      const double lean = 0.3 * std::sin(1.1 * t), turn = 0.2 * std::sin(1.9 * t);
      const Vec3f axis(
          Vec3{std::sin(lean) * std::cos(turn), std::sin(turn), std::cos(lean) * std::cos(turn)});
      const ToolPose pose = pose_of(30 * std::sin(1.7 * t) + 10 * std::sin(5.1 * t),
                                    25 * std::sin(2.3 * t) + 0.1 * std::sin(60 * t),
                                    -3 + std::sin(3.1 * t), Vec3(axis));
      if (i > 0) {
        const double duration_s = static_cast<double>(time_us - before_us) * 1e-6;
        ASSERT_TRUE(writer->append(1, MoveTool{1, last, pose, duration_s, true}));
      }
      last = pose;
      if (i % 10 == 0) {
        ASSERT_TRUE(writer->flush());  // a commit every 10 ms
      }
    }
  }
  const auto added = std::filesystem::file_size(file) - empty_bytes;
  const double bytes = static_cast<double>(added) / kMotions;
  RecordProperty("bytes_per_motion", std::to_string(bytes));
  EXPECT_LT(bytes, 10.1);
}

TEST(JournalVersion1, IsReadAndContinuedWithBatches) {
  test::TemporaryFolder folder;
  const auto file = folder / "old.kerf";
  std::filesystem::copy_file(
      std::filesystem::path(KERF_SOURCE_DIR) / "tests/server/store/journal_v1.kerf", file);
  const auto read = [&](RecordOrder order) {
    std::vector<JournalRecord> records;
    auto reader = JournalReader::open(file, order);
    EXPECT_TRUE(reader);
    for (auto record = reader->next(); record && *record; record = reader->next()) {
      records.push_back(**record);
    }
    return records;
  };
  const auto before = read(RecordOrder::kSequence);
  ASSERT_EQ(before.size(), 43U);
  EXPECT_EQ(before[42].sequence, 43U);
  EXPECT_EQ(before[42].wall_ms, 0);
  EXPECT_EQ(before[42].stroke, 0U);
  EXPECT_EQ(JournalReader::open(file)->participants().size(), 3U);
  EXPECT_EQ(JournalReader::open(file)->state_hashes().back().hash, 0x81bcc4ed0f2d65feU);
  for (int n = 0; n < 2; ++n) {
    auto writer = test::value_of(JournalWriter::open(file, 43U + static_cast<std::uint64_t>(n)));
    EXPECT_EQ(writer.durable_sequence(), 43U + static_cast<std::uint64_t>(n));
    writer.append(JournalParticipant{4, "Eve", "#112233", "agent",
                                     hash_token("0123456789abcdef0123456789abcdef")});
    ASSERT_TRUE(writer.append(4, before[42].command, {5, true}));
  }
  auto after = read(RecordOrder::kSequence);
  ASSERT_EQ(after.size(), 45U);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(encode_command(after[i].command), encode_command(before[i].command));
    EXPECT_EQ(after[i].participant, before[i].participant);
  }
  EXPECT_GT(after[43].wall_ms, 1'700'000'000'000);
  EXPECT_EQ(after[43].stroke, 44U);
  EXPECT_EQ(after[44].stroke, 45U);
  EXPECT_EQ(JournalReader::open(file)->participants()[3].agent_sequence, 5U);
  const auto sorted = read(RecordOrder::kParticipant);
  std::ranges::sort(after, {}, [](const JournalRecord& record) {
    return std::pair(record.participant, record.sequence);
  });
  ASSERT_EQ(sorted.size(), after.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(sorted[i].sequence, after[i].sequence);
    EXPECT_EQ(sorted[i].stroke, after[i].stroke);
    EXPECT_EQ(sorted[i].wall_ms, after[i].wall_ms);
    EXPECT_EQ(encode_command(sorted[i].command), encode_command(after[i].command));
  }
}

}  // namespace
}  // namespace kerf::record_batch_test
