// SPDX-License-Identifier: Apache-2.0
// Salvage of damaged journals.
#include "server/session/journal_salvage.h"

#include <map>

#include "server/session/journal_check.h"
#include "server/session/replay.h"
#include "server/store/journal_scan.h"
#include "tests/server/damage_fixture.h"

namespace kerf::journal_salvage_test {
namespace {

class JournalSalvage : public DamageTest {
 protected:
  std::filesystem::path out() const { return folder / "salvaged.kerf"; }
  /// Salvages the journal and puts the new one in its place.
  SalvagedJournal replace() {
    auto salvaged = salvage_journal(journal(), out());
    EXPECT_TRUE(salvaged) << describe(salvaged.error());
    const CheckedFile checked = check_journal(out());
    for (const FileFault& fault : checked.faults) ADD_FAILURE() << fault.problem;
    remove_journal(journal());
    std::filesystem::rename(out(), journal());
    return salvaged.value_or(SalvagedJournal{});
  }
  std::uint64_t undo(std::uint64_t stroke) {
    SerialWorkers alone;
    const auto undone =
        session->stroke_changes().change({.strokes = {stroke}, .caller = Caller::local()}, alone);
    EXPECT_TRUE(undone) << undone.error().reason;
    return session->solid().hash();
  }
  std::uint64_t hash_at(std::uint64_t record) {
    SerialWorkers alone;
    const auto solid = session->past().solid_at(record, alone);
    EXPECT_TRUE(solid && *solid);
    return solid && *solid ? (*solid)->hash() : 0;
  }
};

TEST_F(JournalSalvage, KeepsTheSnapshotAndLaterRecords) {
  leave();
  reload();
  const std::uint64_t then = hash_at(strokes[3] - 1), without = undo(strokes[3]);
  restart();
  damage_record(journal(), strokes[0] + 3);
  const SalvagedJournal salvaged = replace();
  EXPECT_GT(salvaged.base, strokes[1]);
  EXPECT_LT(salvaged.base, strokes[2]);
  EXPECT_EQ(salvaged.damage.sequence, strokes[0] + 3);
  EXPECT_EQ(salvaged.last, last + 1) << "the undo too";
  EXPECT_EQ(salvaged.hash, without);
  EXPECT_EQ(salvaged.fixed_strokes, 1U);
  EXPECT_TRUE(salvaged.ignored_changes.empty());

  reload();
  EXPECT_EQ(session->solid().hash(), without);
  EXPECT_EQ(hash_at(strokes[3] - 1), then);
  EXPECT_EQ(hash_at(last), hash);
  const auto list = session->past().strokes(0);
  ASSERT_TRUE(list && !list->empty());
  EXPECT_EQ(list->back().stroke.id, strokes[3]);
  EXPECT_TRUE(list->back().is_undone);
  // Lost records are reported, and never carved from the stock.
  const std::string session_path = "/v1/sessions/block";
  EXPECT_EQ(ask("GET", session_path + "/replay").status, 409U);
  EXPECT_EQ(ask("GET", session_path + "/probe?at_mm=0,-12,-2&normal=0,0,1&at=5").status, 404U);
  EXPECT_EQ(ask("GET", session_path + "/program.ngc").status, 200U);
  EXPECT_EQ(ask("GET", session_path + "/forces.csv").status, 200U);
  const auto unknown = ask("POST", session_path + "/undo?strokes=" + std::to_string(strokes[0]));
  EXPECT_EQ(unknown.status, 409U) << unknown.body;
}

TEST_F(JournalSalvage, SalvagedSessionContinues) {
  leave();
  damage_record(journal(), strokes[0] + 3);
  replace();
  reload();
  ASSERT_EQ(session->solid().hash(), hash);
  const auto joined = session->join({ParticipantKind::kAgent, "Bob", "", 1, true});
  const std::uint64_t added = stroke(joined->id, 8);
  const std::uint64_t both = session->solid().hash();
  EXPECT_EQ(undo(added), hash);
  reload();
  EXPECT_EQ(session->solid().hash(), hash);
  const auto replayed = replay(journal());
  ASSERT_TRUE(replayed) << describe(replayed.error());
  EXPECT_EQ(replayed->hash.hash, hash);
  const auto verified = verify_journal(journal());
  ASSERT_TRUE(verified);
  EXPECT_EQ(verified->difference, "");
  for (const std::uint64_t record : {strokes[3], session->sequence() - 1}) {
    const auto branch = registry->branch("twin" + std::to_string(record), *session, record);
    ASSERT_TRUE(branch) << branch.error().reason;
    EXPECT_EQ((*branch)->solid().hash(), hash_at(record));
  }
  EXPECT_EQ(hash_at(session->sequence() - 1), both);
}

TEST_F(JournalSalvage, KeepsEarlierRecordsWithoutASnapshot) {
  leave(false);
  reload();
  const std::uint64_t then = hash_at(strokes[2]);
  restart();
  remove_snapshots();
  damage_record(journal(), strokes[2] + 1);
  const SalvagedJournal salvaged = replace();
  EXPECT_EQ(salvaged.base, 0U);
  EXPECT_EQ(salvaged.last, strokes[2]);
  EXPECT_EQ(salvaged.last_before, last);
  EXPECT_EQ(salvaged.hash, then);
  reload();
  EXPECT_EQ(session->solid().hash(), then);
  EXPECT_EQ(ask("GET", "/v1/sessions/block/replay").status, 200U);
}

TEST_F(JournalSalvage, DamagedSnapshotIsSkippedForTheOneBefore) {
  leave();
  const auto head = read_snapshot_head(previous_snapshot_file(journal()));
  ASSERT_TRUE(head);
  ASSERT_GT(head->sequence, strokes[1]);
  reload();
  const std::uint64_t then = hash_at(head->sequence);
  restart();
  std::ofstream(snapshot_file(journal()), std::ios::app) << "more";
  damage_record(journal(), strokes[0] + 3);
  const auto salvaged = salvage_journal(journal(), out());
  ASSERT_TRUE(salvaged) << describe(salvaged.error());
  EXPECT_EQ(salvaged->base, head->sequence);
  EXPECT_EQ(salvaged->last, head->sequence) << "the records after it continue from damaged ones";
  EXPECT_EQ(salvaged->hash, then);
  EXPECT_EQ(salvaged->last_before, last);
}

TEST_F(JournalSalvage, UndoOfAStrokeWithoutRecordsHasNoEffect) {
  leave();
  reload();
  const std::uint64_t without = undo(strokes[0]);
  restart();
  damage_record(journal(), strokes[1]);
  ASSERT_NE(without, hash);
  const SalvagedJournal salvaged = replace();
  EXPECT_EQ(salvaged.ignored_changes, std::vector{last + 1});
  EXPECT_EQ(salvaged.hash, hash);
  reload();
  EXPECT_EQ(session->solid().hash(), hash);
}

TEST_F(JournalSalvage, NewJournalEndsBeforeDamageAfterTheSnapshot) {
  leave();
  reload();
  const std::uint64_t then = hash_at(strokes[3] + 4);
  restart();
  damage_record(journal(), strokes[0]);
  damage_record(journal(), strokes[3] + 5);
  const SalvagedJournal salvaged = replace();
  EXPECT_GT(salvaged.base, 0U);
  EXPECT_EQ(salvaged.last, strokes[3] + 4);
  EXPECT_EQ(salvaged.hash, then);
}

TEST_F(JournalSalvage, ASalvagedJournalCanBeSalvagedAgain) {
  leave();
  damage_record(journal(), strokes[0] + 3);
  const std::uint64_t base = replace().base;
  reload();
  std::map<std::uint64_t, std::uint64_t> then;
  for (std::uint64_t record = base; record <= strokes[3]; ++record) {
    then[record] = hash_at(record);
  }
  restart();
  remove_snapshots();
  damage_record(journal(), strokes[3] + 1);
  const SalvagedJournal salvaged = replace();
  EXPECT_EQ(salvaged.base, 0U);
  EXPECT_EQ(salvaged.last, salvaged.damage.sequence - 1);
  ASSERT_TRUE(then.contains(salvaged.last));
  EXPECT_EQ(salvaged.hash, then[salvaged.last]);
}

TEST_F(JournalSalvage, FailureReplacesAndLeavesNothing) {
  leave(false);
  std::ofstream(out()) << "mine";
  const auto taken = salvage_journal(journal(), out());
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().code, JournalErrorCode::kExists);
  EXPECT_EQ(std::filesystem::file_size(out()), 4U);
  std::filesystem::remove(out());
  damage_record(journal(), 1);
  const auto lost = salvage_journal(journal(), out());
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().code, JournalErrorCode::kCorrupt);
  EXPECT_EQ(lost.error().sequence, 1U);
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    EXPECT_FALSE(entry.path().filename().string().starts_with("salvaged")) << entry.path();
  }
}

TEST_F(JournalSalvage, IntactJournalIsKeptWhole) {
  leave();
  const SalvagedJournal salvaged = replace();
  EXPECT_EQ(salvaged.damage.reason, "");
  EXPECT_EQ(salvaged.last, last);
  EXPECT_EQ(salvaged.hash, hash);
  const auto lines = describe_salvage(salvaged);
  ASSERT_FALSE(lines.empty());
  EXPECT_EQ(lines.front(), "no record is damaged: all of them are kept");
}

}  // namespace
}  // namespace kerf::journal_salvage_test
