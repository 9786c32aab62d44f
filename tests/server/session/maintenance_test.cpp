// SPDX-License-Identifier: Apache-2.0
// The commands of kerf-server that check, copy, replay and salvage the files of a data folder.
#include "server/maintenance.h"

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <utility>

#include "server/session_log.h"
#include "server/store/folder_lock.h"
#include "tests/server/damage_fixture.h"

namespace kerf::maintenance_test {
namespace {

class Maintenance : public DamageTest {
 protected:
  struct Outcome {
    int status = 0;
    std::string said;  ///< on both streams
    bool has(const std::string& words) const { return said.contains(words); }
    bool matches(const std::string& pattern) const {
      return std::regex_search(said, std::regex(pattern, std::regex::multiline));
    }
  };
  template <typename Command>
  static Outcome run(Command command) {
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    Outcome outcome{.status = command(), .said = testing::internal::GetCapturedStdout()};
    outcome.said += testing::internal::GetCapturedStderr();
    return outcome;
  }
  static Outcome check(const std::filesystem::path& data) {
    return run([&] { return check_data(data); });
  }
  static Outcome back_up_to(const std::filesystem::path& data, const std::filesystem::path& to) {
    return run([&] { return back_up(data, to); });
  }
  Outcome replayed() const {
    return run([this] { return replay_journal(journal()); });
  }
  void sql(const std::string& statement) const {
    auto database = SqlDatabase::open(journal(), SqlMode::kWrite);
    ASSERT_TRUE(database && database->execute(statement)) << statement;
  }
  std::filesystem::path snapshot() const { return snapshot_file(journal()); }
  std::filesystem::path previous() const { return previous_snapshot_file(journal()); }
  /// Returns the hash of the session in another folder.
  static std::uint64_t hash_in(const std::filesystem::path& data, const std::string& closed = "") {
    test::ManualExecutor workers;
    SessionRegistry other(
        RegistryOptions{data, 4, {}}, [](const std::string&) { return std::make_shared<AtOnce>(); },
        workers);
    other.load_all();
    LoadReport report;
    EXPECT_TRUE(closed.empty() || other.reopen(closed, report));
    const auto session = other.find("block");
    EXPECT_TRUE(session);
    return session ? session->solid().hash() : 0;
  }
};

TEST_F(Maintenance, GoodFilesPassAndAReplayComparesHashesAndSnapshots) {
  leave();
  const Outcome checked = check(folder.path());
  EXPECT_EQ(checked.status, 0) << checked.said;
  for (const char* file :
       {"block.kerf: good", "block.kerf-snapshot: good", "block.kerf-snapshot-previous: good"}) {
    EXPECT_TRUE(checked.has(file)) << checked.said;
  }
  const Outcome equal = replayed();
  EXPECT_EQ(equal.status, 0) << equal.said;
  EXPECT_TRUE(equal.has("equal: ") && equal.has(" and two snapshots")) << equal.said;
}

TEST_F(Maintenance, TablesWhoseRowsAreDamagedAreNamed) {
  leave();
  reload();
  for (const char* target : {"versions?name=rough", "pins?text=here&at_mm=0,0,0&normal=0,0,1"}) {
    const auto set = ask("POST", std::string("/v1/sessions/block/") + target);
    EXPECT_EQ(set.status, 201U) << set.body;
  }
  ASSERT_TRUE(session->flush());
  restart();
  EXPECT_EQ(check(folder.path()).status, 0);
  for (const std::string table : {"versions", "pins"}) {
    sql("UPDATE " + table + " SET crc=crc+1");
    const Outcome checked = check(folder.path());
    EXPECT_EQ(checked.status, 1);
    EXPECT_TRUE(checked.matches("the checksums of \\d+ rows of " + table + " are wrong"))
        << checked.said;
    sql("UPDATE " + table + " SET crc=crc-1");
  }
  EXPECT_EQ(check(folder.path()).status, 0);
}

TEST_F(Maintenance, ABackupOfARunningServerServesTheSameBlock) {
  leave();
  reload();
  const std::filesystem::path to = folder / "copies";
  const Outcome copied = back_up_to(folder.path(), to);
  EXPECT_EQ(copied.status, 0) << copied.said;
  EXPECT_EQ(copied.said, (to / "block.kerf").string() + "\n");
  stroke(join(), 8);  // the server continues
  EXPECT_EQ(check(to).status, 0);
  EXPECT_EQ(hash_in(to), hash);
  for (const auto& file : {snapshot(), previous()}) {
    EXPECT_TRUE(std::filesystem::exists(to / file.filename())) << file;
  }
  const Outcome again = back_up_to(folder.path(), to);
  EXPECT_EQ(again.status, 1) << "no file is replaced";
  EXPECT_TRUE(again.has("block.kerf")) << again.said;
  EXPECT_EQ(back_up_to(folder / "missing", to).status, 1);
}

TEST_F(Maintenance, ClosedSessionsAreCheckedAndCopiedToo) {
  leave();
  reload();
  session.reset();
  ASSERT_TRUE(registry->close("block", false));
  const std::string name = registry->closed().at(0).name;
  const std::filesystem::path to = folder / "copies";
  const Outcome copied = back_up_to(folder.path(), to);
  EXPECT_EQ(copied.status, 0) << copied.said;
  EXPECT_EQ(copied.said, (to / "closed" / (name + ".kerf")).string() + "\n");
  const Outcome checked = check(to);
  EXPECT_EQ(checked.status, 0) << checked.said;
  EXPECT_TRUE(checked.has("closed/" + name + ".kerf: good")) << checked.said;
  EXPECT_EQ(hash_in(to, name), hash);
  std::ofstream(to / "closed" / "broken.kerf") << "nonsense";
  const Outcome broken = check(to);
  EXPECT_EQ(broken.status, 1);
  EXPECT_TRUE(broken.has("closed/broken.kerf: ")) << broken.said;
}

TEST_F(Maintenance, FaultsAreNamedWithTheRemedy) {
  leave();
  std::filesystem::resize_file(snapshot(), std::filesystem::file_size(snapshot()) - 1);
  const Outcome cut = check(folder.path());
  EXPECT_EQ(cut.status, 1);
  EXPECT_TRUE(cut.has("block.kerf: good")) << cut.said;
  EXPECT_TRUE(cut.has("block.kerf-snapshot: it is truncated -> delete it")) << cut.said;
  restart();
  const LoadReport report = registry->load_all();
  const Outcome loaded = run([&] {
    log_report(report);
    return 0;
  });
  EXPECT_TRUE(
      loaded.matches("session block: its snapshot was ignored: it is truncated; "
                     "the one before it, after record \\d+, was used"))
      << loaded.said;
  EXPECT_EQ(registry->find("block")->solid().hash(), hash);
  restart();
  // Store a wrong hash for the last record.
  sql("INSERT OR REPLACE INTO state_hashes SELECT max(first+count)-1, 2989 FROM batches");
  const Outcome differs = replayed();
  EXPECT_EQ(differs.status, 1);
  EXPECT_TRUE(
      differs.matches("differs: record \\d+ of participant \\d+ at 20\\d\\d-.*Z: replay gives"))
      << differs.said;
  sql("UPDATE batches SET bytes=zeroblob(7) WHERE first=(SELECT max(first) FROM batches)");
  const Outcome corrupt = check(folder.path());
  EXPECT_EQ(corrupt.status, 1);
  EXPECT_TRUE(corrupt.matches("block.kerf: corrupt_journal: record \\d+: .* -> restore a copy"))
      << corrupt.said;
  EXPECT_EQ(replayed().status, 1);
  sql("PRAGMA user_version=77");
  EXPECT_TRUE(check(folder.path())
                  .matches("^block.kerf-snapshot-previous: its journal cannot be read -> keep it"));
  std::filesystem::remove(journal());
  EXPECT_TRUE(check(folder.path()).has("there is no journal block.kerf"));
  EXPECT_EQ(check(folder / "none").status, 1);
}

TEST_F(Maintenance, ADamagedPageIsFoundInAnyTable) {
  leave(false);
  std::int64_t page = 0, size = 0;
  {
    auto database = SqlDatabase::open(journal(), SqlMode::kWrite);
    ASSERT_TRUE(database);
    const auto number = [&](const char* query) {
      auto rows = database->prepare(query);
      EXPECT_TRUE(rows && rows->step());
      return rows->integer(0);
    };
    page = number("SELECT rootpage FROM sqlite_master WHERE name='program_lines'");
    size = number("PRAGMA page_size");
  }
  EXPECT_EQ(check(folder.path()).status, 0);
  std::fstream file(journal(), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp((page - 1) * size);
  file << std::string(static_cast<std::size_t>(size), '\xFF') << std::flush;
  const Outcome checked = check(folder.path());
  EXPECT_EQ(checked.status, 1);
  EXPECT_TRUE(checked.matches("block.kerf: corrupt_journal: .*age .* -> restore a copy"))
      << checked.said;
}

TEST_F(Maintenance, FolderWithoutAServersFilesIsAnError) {
  const test::TemporaryFolder other;
  const Outcome outcomes[] = {check(other.path()), back_up_to(other.path(), other / "to")};
  for (const Outcome& outcome : outcomes) {
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(outcome.has("no server has used this folder")) << outcome.said;
  }
  EXPECT_TRUE(std::filesystem::is_empty(other.path()));
  {
    const auto lock = FolderLock::take(other.path());
  }
  EXPECT_EQ(check(other.path()).status, 0) << "of a server without sessions";
  EXPECT_EQ(check(other.path()).said, "");
}

TEST_F(Maintenance, SalvageReportsWhatItKeeps) {
  leave();
  damage_record(journal(), strokes[0] + 3);
  const Outcome salvaged = run([this] { return salvage(journal(), folder / "out"); });
  EXPECT_EQ(salvaged.status, 0) << salvaged.said;
  EXPECT_TRUE(salvaged.has("kept: the block after record")) << salvaged.said;
  EXPECT_TRUE(salvaged.has("written: " + (folder / "out").string())) << salvaged.said;
}

}  // namespace
}  // namespace kerf::maintenance_test
