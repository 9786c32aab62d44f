// SPDX-License-Identifier: Apache-2.0
// Batches that no writer stores: their checksums are right but their contents are not.
#include <sqlite3.h>

#include "server/store/journal_reader.h"
#include "server/store/journal_writer.h"
#include "server/store/record_batch.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::hostile_batch_test {
namespace {

/// Flags of a record (web/manual/kerf-file.md).
constexpr unsigned kOther = 1, kSameAxis = 8, kDuration = 64, kExactDuration = 128;

/// A batch of one motion with these flags, which repeats the last pose.
std::vector<std::byte> motion(unsigned flags, double exact_s = 0) {
  BitWriter out;
  out.bits(1, 1);
  out.bits(0, 1);
  out.bits(flags | kSameAxis, 8);
  if ((flags & kExactDuration) != 0) out.bits(std::bit_cast<std::uint64_t>(exact_s), 64);
  for (int i = 0; i < 3; ++i) {
    NumberSize coordinate;
    out.number(0, coordinate);
  }
  return out.take();
}

TEST(HostileBatch, ExactDurationsOutOfRangeAreRejected) {
  const unsigned flags = kDuration | kExactDuration;
  for (const double good : {0.0, 1e-300, 1.0 / 3, 1e6}) {
    const auto records = BatchDecoder().decode(motion(flags, good), 1);
    ASSERT_TRUE(records) << good << ": " << records.error();
    EXPECT_EQ(std::get<MoveTool>(records->at(0).command).duration_s, good);
  }
  for (const double bad : {-0.0, -1.0, 2e6, 1e300, std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_FALSE(BatchDecoder().decode(motion(flags, bad), 1)) << bad;
  }
  const auto alone = BatchDecoder().decode(motion(kExactDuration, 1), 1);  // without flag 64
  ASSERT_FALSE(alone);
  EXPECT_EQ(alone.error(), "a motion has an invalid duration");
}

TEST(HostileBatch, MoreParticipantsThanTheEncoderKeepsAreRejected) {
  BatchDecoder decoder;
  const auto decode = [&](bool restarts, std::uint64_t first, std::uint64_t count) {
    BitWriter out;
    NumberSize participants;
    out.bits(restarts ? 1 : 0, 1);
    for (std::uint64_t n = 0; n < count; ++n) {
      out.bits(0, 1);
      out.bits(kOther | kSameAxis, 8);
      out.number(first + n, participants);
      for (int i = 0; i < 3; ++i) {
        NumberSize coordinate;
        out.number(0, coordinate);
      }
    }
    return decoder.decode(out.take(), count).has_value();
  };
  EXPECT_TRUE(decode(true, 1, MotionStates::kMax));
  EXPECT_TRUE(decode(true, 1, MotionStates::kMax)) << "a batch that restarts forgets those before";
  EXPECT_FALSE(decode(true, 1, MotionStates::kMax + 1));
}

/// Encodes batches of the given sizes, each record by another participant. Returns for each batch
/// whether it can be decoded without its predecessors.
std::vector<bool> restarts_of(const std::vector<std::size_t>& batches) {
  BatchEncoder encoder;
  BatchDecoder decoder;
  ParticipantId id = 0;
  std::vector<bool> restarts;
  for (const std::size_t count : batches) {
    std::vector<BatchRecord> records(count);
    for (BatchRecord& record : records) record = {++id, MoveTool{}};
    const auto bytes = encoder.encode(records);
    const auto decoded = decoder.decode(bytes, records.size());
    if (decoded) {
      EXPECT_EQ(decoded->back().participant, id);
    } else {
      ADD_FAILURE() << decoded.error();
    }
    restarts.push_back(BatchDecoder().decode(bytes, records.size()).has_value());
  }
  return restarts;
}

TEST(HostileBatch, TheEncoderRestartsBeforeItHasTooManyParticipants) {
  EXPECT_EQ(restarts_of({2000, 64'000}), (std::vector{true, true}));
  EXPECT_EQ(restarts_of({2000, 60'000}), (std::vector{true, false}));
}

TEST(HostileBatch, TheEncoderRestartsAfterABoundedNumberOfRecords) {
  const auto restarts = restarts_of(std::vector<std::size_t>(50, 100));
  for (std::size_t n = 0; n < restarts.size(); ++n) EXPECT_EQ(restarts[n], n % 21 == 0) << n;
}

/// Returns whether a journal with this batch, with a valid checksum, can be read.
bool can_read(const BatchHead& head, const std::vector<std::byte>& bytes) {
  test::TemporaryFolder folder;
  const auto file = folder / "demo.kerf";
  EXPECT_TRUE(JournalWriter::create(file, {"demo", "{}", ""})->finish());
  std::string hex;
  for (const std::byte byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", std::to_integer<unsigned>(byte));
    hex += digits;
  }
  const std::string sql = "INSERT INTO batches VALUES(" + std::to_string(head.first) + "," +
                          std::to_string(head.count) + "," + std::to_string(head.wall_ms) + "," +
                          std::to_string(head.span_ms) + ",x'" + hex + "'," +
                          std::to_string(batch_checksum(head, bytes)) + ")";
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sql;
  sqlite3_close(database);
  auto reader = JournalReader::open(file);
  EXPECT_TRUE(reader);
  const auto record = reader->next();
  if (record) return record->has_value();
  EXPECT_EQ(record.error().code, JournalErrorCode::kCorrupt);
  EXPECT_EQ(record.error().sequence, head.first);
  return false;
}

TEST(HostileBatch, TimesAndCountsThatNoWriterStoresAreCorruption) {
  const auto one = motion(0);
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max(),
                         kMin = std::numeric_limits<std::int64_t>::min();
  EXPECT_TRUE(can_read({1, 1, kWallMaxMs, kSpanMaxMs}, one));
  EXPECT_TRUE(can_read({1, 1, -kWallMaxMs, 0}, one));
  for (const std::int64_t wall : {kWallMaxMs + 1, -kWallMaxMs - 1, kMax, kMin}) {
    EXPECT_FALSE(can_read({1, 1, wall, 0}, one)) << wall;
  }
  for (const std::int64_t span : {kSpanMaxMs + 1, std::int64_t{-1}, kMax, kMin}) {
    EXPECT_FALSE(can_read({1, 1, 0, span}, one)) << span;
  }
  const auto motions = [](std::uint64_t count) {
    BatchEncoder encoder;
    return encoder.encode(std::vector<BatchRecord>(count, {1, MoveTool{}}));
  };
  EXPECT_TRUE(can_read({1, kBatchRecordsMax, 0, 0}, motions(kBatchRecordsMax)));
  EXPECT_FALSE(can_read({1, kBatchRecordsMax + 1, 0, 0}, motions(kBatchRecordsMax + 1)));
}

}  // namespace
}  // namespace kerf::hostile_batch_test
