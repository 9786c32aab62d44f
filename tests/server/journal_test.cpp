// SPDX-License-Identifier: Apache-2.0
#include <sqlite3.h>

#include "server/store/journal_reader.h"
#include "server/store/journal_writer.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::journal_test {
namespace {

const JournalHeader kHeader{"demo", "{\"name\":\"demo\"}", "/scenes", 1};

MoveTool move_to(double x_mm) {
  return MoveTool{.tool = 1,
                  .from = {.tip_mm = {x_mm - 1, 0, 0}},
                  .to = {.tip_mm = {x_mm, 0, 0}},
                  .duration_s = 0.001};
}

/// The number of records that are still to come.
int rest_of(JournalReader& reader) {
  int count = 0;
  while (reader.next().value()) ++count;
  return count;
}

/// The number of records of a file.
int count_in(const std::filesystem::path& file) {
  auto reader = test::value_of(JournalReader::open(file));
  return rest_of(reader);
}

class Journal : public testing::Test {
 protected:
  /// Writes a journal of ten motions by participants 1 and 2, with one state hash.
  void write_ten() {
    auto writer = test::value_of(JournalWriter::create(file, kHeader));
    writer.append(JournalParticipant{1, "Ada", "#112233", "agent"});
    for (int i = 1; i <= 10; ++i) {
      const auto sequence =
          test::value_of(writer.append(static_cast<ParticipantId>(1 + i % 2), move_to(i)));
      EXPECT_EQ(sequence, static_cast<std::uint64_t>(i));
      ASSERT_TRUE(writer.flush());  // a batch for each record
    }
    writer.append(StateHash{10, 0xFEDCBA9876543210U});
    ASSERT_TRUE(writer.flush());
  }
  void sql(const std::string& text) const {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, text.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << text;
    sqlite3_close(database);
  }
  /// Reads up to the first error, which must be kCorrupt at `sequence`.
  void expect_corrupt_at(std::uint64_t sequence) const {
    auto reader = test::value_of(JournalReader::open(file));
    for (std::uint64_t good = 1; good < sequence; ++good) {
      const auto record = reader.next();
      ASSERT_TRUE(record && *record) << good;
    }
    const auto bad = test::error_of(reader.next());
    EXPECT_EQ(bad.code, JournalErrorCode::kCorrupt);
    EXPECT_EQ(bad.sequence, sequence);
    EXPECT_EQ(bad.file, file.string());
  }

  test::TemporaryFolder folder;
  std::filesystem::path file = folder / "demo.kerf";
};

TEST_F(Journal, RoundTrips) {
  write_ten();
  auto reader = test::value_of(JournalReader::open(file));
  EXPECT_EQ(reader.header().session, "demo");
  EXPECT_EQ(reader.header().scene_json, kHeader.scene_json);
  EXPECT_EQ(reader.header().base_folder, "/scenes");
  ASSERT_EQ(reader.participants().size(), 1U);
  EXPECT_EQ(reader.participants()[0].name, "Ada");
  ASSERT_EQ(reader.state_hashes().size(), 1U);
  EXPECT_EQ(reader.state_hashes()[0].hash, 0xFEDCBA9876543210U);
  for (int i = 1; i <= 10; ++i) {
    const auto record = reader.next();
    ASSERT_TRUE(record && *record);
    EXPECT_EQ((*record)->participant, static_cast<ParticipantId>(1 + i % 2));
    EXPECT_EQ(std::get<MoveTool>((*record)->command).to, move_to(i).to);
  }
  EXPECT_FALSE(test::value_of(reader.next()));
}

TEST_F(Journal, OpenContinuesAfterTheLastRecordAndIncrementsTheEpoch) {
  write_ten();
  auto writer = test::value_of(JournalWriter::open(file, 10));
  EXPECT_EQ(writer.epoch(), 2U);
  EXPECT_EQ(writer.append(1, move_to(11)).value(), 11U);
  ASSERT_TRUE(writer.flush());
  EXPECT_EQ(writer.lag(), 0U);
  EXPECT_EQ(count_in(file), 11);
}

TEST_F(Journal, StoresTheProgressOfAgentsWithTheirRecords) {
  const TokenHash token = *hash_token("0123456789abcdef0123456789abcdef");
  {
    auto writer = test::value_of(JournalWriter::create(file, kHeader));
    writer.append(JournalParticipant{1, "Ada", "#112233", "agent", token});
    writer.append(JournalParticipant{2, "Bob", "#112233", "agent"});
    EXPECT_EQ(writer.durable_sequence(), 0U);
    for (int i = 1; i <= 10; ++i) {
      ASSERT_TRUE(writer.append(1, move_to(i), {100U + static_cast<std::uint64_t>(i), false}));
      ASSERT_TRUE(writer.append(2, move_to(i), {7, false}));
    }
    ASSERT_TRUE(writer.flush());
    EXPECT_EQ(writer.durable_sequence(), 20U);
    writer.append(JournalParticipant{1, "Ada again", "#112233", "agent", token});
  }
  auto reader = test::value_of(JournalReader::open(file));
  EXPECT_EQ(reader.participants()[0].name, "Ada again");
  EXPECT_EQ(reader.participants()[0].agent_sequence, 110U);
  EXPECT_EQ(reader.participants()[0].token, token);
  EXPECT_FALSE(reader.participants()[1].token);
  EXPECT_EQ(JournalWriter::open(file, 20)->durable_sequence(), 20U);
}

TEST_F(Journal, AnAgentWhoseProgressIsDamagedMayNotResume) {
  const TokenHash token = *hash_token("0123456789abcdef0123456789abcdef");
  for (const char* damage : {"agent_sequence=109", "token=zeroblob(32)", "token=x'00'", "crc=5"}) {
    std::filesystem::remove(file);
    {
      auto writer = test::value_of(JournalWriter::create(file, kHeader));
      writer.append(JournalParticipant{1, "Ada", "#112233", "agent", token});
      writer.append(JournalParticipant{2, "Bob", "#112233", "agent", token});
      ASSERT_TRUE(writer.append(1, move_to(1), {110, false}));
      ASSERT_TRUE(writer.append(2, move_to(1), {7, false}));
    }
    sql("UPDATE agents SET " + std::string(damage) + " WHERE participant=1");
    auto reader = JournalReader::open(file);
    ASSERT_TRUE(reader) << damage << ": " << describe(reader.error());
    ASSERT_EQ(reader->participants().size(), 2U);
    EXPECT_FALSE(reader->participants()[0].token) << damage;
    EXPECT_EQ(reader->participants()[0].agent_sequence, 0U);
    EXPECT_EQ(reader->participants()[1].token, token);
    EXPECT_EQ(reader->participants()[1].agent_sequence, 7U);
    EXPECT_EQ(rest_of(*reader), 2);
  }
}

TEST(ResumeToken, IsRandomAndHashedWithSha256) {
  const auto a = random_token(), b = random_token();
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->size(), 32U);
  EXPECT_NE(*a, *b);
  EXPECT_TRUE(are_equal(*hash_token(*a), *hash_token(*a)));
  EXPECT_FALSE(are_equal(*hash_token(*a), *hash_token(*b)));
  // sha256sum of the text
  const TokenHash hash = *hash_token("00000000000000000000000000000000");
  EXPECT_EQ(std::to_integer<int>(hash[0]), 0x84);
  EXPECT_EQ(std::to_integer<int>(hash[31]), 0x5a);
  for (const char* text :
       {"", "0", "0000000000000000000000000000000g", "000000000000000000000000000000000"}) {
    EXPECT_FALSE(hash_token(text)) << text;
  }
}

TEST_F(Journal, StoresTheKernelVersionOfItsNewestHash) {
  write_ten();
  EXPECT_EQ(JournalReader::open(file)->header().kernel_version, kKernelVersion);
  sql("UPDATE kernel_versions SET version=77");
  EXPECT_EQ(JournalReader::open(file)->header().kernel_version, 77);
  {
    auto writer = test::value_of(JournalWriter::open(file, 10));
    writer.append_recarved(StateHash{10, 42});
    ASSERT_TRUE(writer.flush());
  }
  const auto reader = JournalReader::open(file);
  EXPECT_EQ(reader->header().kernel_version, kKernelVersion);
  EXPECT_EQ(reader->state_hashes().back().hash, 42U);
}

TEST_F(Journal, MissingKernelVersionMeansTheFirst) {
  write_ten();
  sql("DROP TABLE kernel_versions; PRAGMA user_version = 1");
  EXPECT_EQ(JournalReader::open(file)->header().kernel_version, kFirstKernelVersion);
  {
    auto writer = test::value_of(JournalWriter::open(file, 10));
    writer.append_recarved(StateHash{10, 42});
    ASSERT_TRUE(writer.flush());
  }
  EXPECT_EQ(JournalReader::open(file)->header().kernel_version, kKernelVersion);
}

TEST_F(Journal, ConcurrentReaderSeesCommittedRecords) {
  auto writer = test::value_of(JournalWriter::create(file, kHeader));
  for (int i = 1; i <= 1000; ++i) ASSERT_TRUE(writer.append(1, move_to(i)));
  ASSERT_TRUE(writer.flush());
  for (int i = 1001; i <= 2000; ++i) ASSERT_TRUE(writer.append(1, move_to(i)));
  EXPECT_GE(count_in(file), 1000);
}

TEST_F(Journal, DestructorCommitsPendingRecords) {
  {
    auto writer = JournalWriter::create(file, kHeader);
    for (int i = 1; i <= 100; ++i) ASSERT_TRUE(writer->append(1, move_to(i)));
  }
  EXPECT_EQ(count_in(file), 100);
}

TEST_F(Journal, FinishClosesTheFileAndRejectsAppends) {
  auto writer = JournalWriter::create(file, kHeader);
  for (int i = 1; i <= 100; ++i) ASSERT_TRUE(writer->append(1, move_to(i)));
  ASSERT_TRUE(writer->finish());
  EXPECT_FALSE(std::filesystem::exists(file.string() + "-wal"));
  EXPECT_FALSE(writer->append(1, move_to(101)));
  EXPECT_FALSE(writer->flush());
  std::filesystem::rename(file, folder / "moved.kerf");
  EXPECT_EQ(count_in(folder / "moved.kerf"), 100);
}

TEST_F(Journal, CreateDoesNotOverwriteAnExistingJournal) {
  write_ten();
  EXPECT_EQ(test::error_of(JournalWriter::create(file, kHeader)).code, JournalErrorCode::kExists);
}

TEST_F(Journal, DamageIsReportedWithItsRecord) {
  struct Damage {
    const char *name, *sql;
    std::uint64_t record;
  };
  for (const auto& [name, text, record] : {
           Damage{"a changed byte",
                  "UPDATE batches SET bytes = CAST(substr(bytes,1,1) || x'A5' || substr(bytes,3) "
                  "AS BLOB) WHERE first = 4",
                  4},
           Damage{"a changed time", "UPDATE batches SET wall_ms = wall_ms + 1 WHERE first = 6", 6},
           Damage{"a missing record", "DELETE FROM batches WHERE first = 3", 3},
           Damage{"swapped records",
                  "UPDATE batches SET first = 99 WHERE first = 2;"
                  "UPDATE batches SET first = 2 WHERE first = 4;"
                  "UPDATE batches SET first = 4 WHERE first = 99",
                  2},
       }) {
    SCOPED_TRACE(name);
    remove_journal(file);
    write_ten();
    sql(text);
    expect_corrupt_at(record);
  }
}

TEST_F(Journal, MissingTailIsDetectedByTheNewestHash) {
  write_ten();
  sql("DELETE FROM batches WHERE first > 8");
  auto reader = test::value_of(JournalReader::open(file));
  EXPECT_EQ(reader.dropped_hashes(), 1U);
  EXPECT_TRUE(reader.state_hashes().empty());
  EXPECT_EQ(rest_of(reader), 8);
}

TEST_F(Journal, DamageIsDetectedByParticipantToo) {
  for (const char* damage :
       {"DELETE FROM batches WHERE first = 3", "UPDATE batches SET first = -7 WHERE first = 3",
        "UPDATE batches SET count = 2 WHERE first = 4"}) {
    remove_journal(file);
    write_ten();
    sql(damage);
    auto reader = test::value_of(JournalReader::open(file, RecordOrder::kParticipant));
    auto record = reader.next();
    while (record && *record) record = reader.next();
    ASSERT_FALSE(record) << damage;
    EXPECT_EQ(record.error().code, JournalErrorCode::kCorrupt);
  }
}

TEST_F(Journal, ChangedSceneIsDetected) {
  write_ten();
  sql("UPDATE session SET scene = '{}'");
  EXPECT_EQ(test::error_of(JournalReader::open(file)).code, JournalErrorCode::kCorrupt);
}

TEST_F(Journal, ForeignVersionIsReported) {
  write_ten();
  sql("PRAGMA user_version = 7");
  const auto error = test::error_of(JournalReader::open(file));
  EXPECT_EQ(error.code, JournalErrorCode::kForeignVersion);
  EXPECT_NE(error.reason.find("version 7"), std::string::npos);
}

TEST_F(Journal, DatabaseOfAnotherProgramIsNotAJournal) {
  sql("CREATE TABLE songs(name TEXT)");
  EXPECT_EQ(test::error_of(JournalReader::open(file)).code, JournalErrorCode::kNotAJournal);
}

TEST_F(Journal, TextFileIsNotAJournal) {
  std::ofstream(file) << std::string(5000, 'x');
  EXPECT_EQ(test::error_of(JournalReader::open(file)).code, JournalErrorCode::kNotAJournal);
}

TEST_F(Journal, MissingFileIsNotFound) {
  EXPECT_EQ(test::error_of(JournalReader::open(file)).code, JournalErrorCode::kNotFound);
}

TEST_F(Journal, EveryTruncationIsATypedError) {
  {
    auto writer = JournalWriter::create(file, kHeader);
    for (int i = 1; i <= 500; ++i) ASSERT_TRUE(writer->append(1, move_to(i)));
    writer->append(StateHash{500, 1});
  }
  const auto whole = std::filesystem::file_size(file);
  for (std::uintmax_t size = 0; size < whole; size += 1777) {
    const auto cut = folder / "cut.kerf";
    std::filesystem::copy_file(file, cut, std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(cut, size);
    auto reader = JournalReader::open(cut);
    bool failed = !reader;
    while (!failed) {
      const auto record = reader->next();
      failed = !record;
      if (record && !*record) break;
    }
    EXPECT_TRUE(failed) << "cut to " << size << " of " << whole << " bytes";
  }
}

TEST_F(Journal, CopyIsComplete) {
  auto writer = JournalWriter::create(file, kHeader);
  for (int i = 1; i <= 50; ++i) ASSERT_TRUE(writer->append(1, move_to(i)));
  ASSERT_TRUE(writer->flush());
  ASSERT_TRUE(copy_journal(file, folder / "copy.kerf"));
  EXPECT_EQ(count_in(folder / "copy.kerf"), 50);
}

}  // namespace
}  // namespace kerf::journal_test
