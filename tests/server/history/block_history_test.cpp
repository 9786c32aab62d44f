// SPDX-License-Identifier: Apache-2.0
#include "server/history/block_history.h"

#include "server/history/journal_records.h"
#include "tests/server/history/recorded_job.h"
#include "tests/support/test.h"
#include "tests/support/thread_workers.h"

namespace kerf::block_history_test {
namespace {

using test::RecordedJob;

SolidSnapshot start_of(const SculptureSettings& settings) {
  return Sculpture::create(settings).value().solid();
}

/// Returns the hash of a block whose tiles all come from the history.
std::uint64_t hash_of(const RecordedJob& job, BlockHistory& history, const MotionSet& set,
                      Workers& workers) {
  const auto tiles = history.carve(history.tiles(), set, workers);
  EXPECT_TRUE(tiles.has_value()) << tiles.error();
  Sculpture block = Sculpture::create(job.settings()).value();
  block.replace(*tiles);
  return block.state_hash();
}

TEST(BlockHistory, CarvesAnySetOfMotionsToTheBit) {
  unsigned seed = 1;
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    RecordedJob job(test::job_settings(rays, 0.5), seed++);
    BlockHistory history(journal_records(job.file()), job.settings(), start_of(job.settings()));
    for (int round = 0; round < 4; ++round) {
      job.carve(120);
      if (round == 1) job.redefine();
      ASSERT_TRUE(history.catch_up());
      EXPECT_EQ(history.last(), job.records().size());
      for (int question = 0; question < 4; ++question) {
        const MotionSet set = job.some();
        test::ThreadWorkers workers(1 + question % 3);
        EXPECT_EQ(hash_of(job, history, set, workers), job.block(set).state_hash())
            << "round " << round << " question " << question;
      }
    }
  }
}

TEST(BlockHistory, ReachesAnySetOfStrokesToTheBit) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    RecordedJob job(test::job_settings(rays, 0.5), 21 + static_cast<unsigned>(rays));
    BlockHistory history(journal_records(job.file()), job.settings(), start_of(job.settings()));
    job.carve(250);
    job.redefine();
    job.carve(150);
    ASSERT_TRUE(history.catch_up());
    MotionSet set{.last = history.last()};
    Sculpture block = job.block(set);
    for (int question = 0; question < 12; ++question) {
      // Some of the named strokes do not change: the block may be in either state.
      StrokeSet changed = job.some().without;
      for (const StrokeId id : changed) {
        if (job.random()() % 4 == 0) continue;
        if (set.without.erase(id) == 0) set.without.insert(id);
      }
      test::ThreadWorkers workers(1 + question % 3);
      const auto tiles = test::value_of(
          history.change(block.solid(), *history.reach(changed), changed, set, workers));
      EXPECT_TRUE(std::ranges::is_sorted(tiles, {}, &TileReplacement::at));
      block.replace(tiles);
      ASSERT_EQ(block.state_hash(), job.block(set).state_hash()) << "question " << question;
    }
  }
}

TEST(BlockHistory, ChangesNoTileWithMotionsAfterTheSet) {
  RecordedJob job(test::job_settings(Rays::kDexel, 0.5), 31);
  job.carve(200);
  BlockHistory history(journal_records(job.file()), job.settings(), start_of(job.settings()));
  ASSERT_TRUE(history.catch_up());
  for (int n = 0; n < 8; ++n) {
    const std::uint64_t last = 60 + job.random()() % 100;
    const StrokeId stroke = job.strokes()[job.random()() % 5];
    const MotionSet set{.last = last, .without = {stroke}};
    Sculpture block = job.block({.last = last});
    SerialWorkers alone;
    block.replace(*history.change(block.solid(), *history.reach({stroke}), {stroke}, set, alone));
    EXPECT_EQ(block.state_hash(), job.block(set).state_hash());
  }
}

TEST(BlockHistory, TilesOutOfReachOfAStrokeDoNotChange) {
  RecordedJob job(test::job_settings(Rays::kTriDexel, 0.5), 3);
  job.carve(300);
  BlockHistory history(journal_records(job.file()), job.settings(), start_of(job.settings()));
  ASSERT_TRUE(history.catch_up());
  SerialWorkers alone;
  std::size_t tiles = 0;
  for (int n = 0; n < 6; ++n) {
    const StrokeId stroke = job.strokes()[job.random()() % job.strokes().size()];
    Sculpture block = job.block({});
    const auto reach = test::value_of(history.reach({stroke}));
    tiles += reach.size();
    const MotionSet without{.last = history.last(), .without = {stroke}};
    block.replace(*history.carve(reach, without, alone));
    EXPECT_EQ(block.state_hash(), job.block(without).state_hash());
  }
  EXPECT_LT(tiles, 6 * history.tiles().size() * 3 / 4);
}

TEST(BlockHistory, CachedTilesAreReusedAndLimited) {
  RecordedJob job(test::job_settings(Rays::kDexel, 0.5), 4);
  job.carve(300);
  SerialWorkers alone;
  BlockHistory history(journal_records(job.file()), job.settings(), start_of(job.settings()));
  BlockHistory forgetful(journal_records(job.file()), job.settings(), start_of(job.settings()),
                         HistoryMemory{.windows = 32, .tile_bytes = 30'000});
  for (BlockHistory* each : {&history, &forgetful}) {
    ASSERT_TRUE(each->catch_up());
    const MotionSet all{.last = each->last()};
    EXPECT_EQ(hash_of(job, *each, all, alone), job.block(all).state_hash());
    EXPECT_EQ(hash_of(job, *each, all, alone), job.block(all).state_hash());
    const MotionSet some = job.some();
    EXPECT_EQ(hash_of(job, *each, some, alone), job.block(some).state_hash());
    EXPECT_EQ(hash_of(job, *each, all, alone), job.block(all).state_hash());
  }
  EXPECT_GT(history.tile_bytes(), 60'000U);
  EXPECT_LE(forgetful.tile_bytes(), 30'000U);
}

TEST(BlockHistory, ReadsMoreRecordsThanItKeepsInMemory) {
  RecordedJob job(test::job_settings(Rays::kDexel, 2.5), 5);
  const HistoryMemory little{.windows = 2, .tile_bytes = 1'000};
  BlockHistory history(journal_records(job.file()), job.settings(), start_of(job.settings()),
                       little);
  for (int n = 0; n < 4; ++n) job.carve(8192, 1);
  ASSERT_TRUE(history.catch_up());
  SerialWorkers alone;
  const MotionSet early{.last = 12'000, .without = {job.strokes()[3], job.strokes()[1000]}};
  EXPECT_EQ(hash_of(job, history, early, alone), job.block(early).state_hash());
  const MotionSet late{.last = history.last(), .without = {job.strokes()[1], job.strokes().back()}};
  EXPECT_EQ(hash_of(job, history, late, alone), job.block(late).state_hash());
}

TEST(BlockHistory, ChangesOfStrokesMakeUpTheSetAfterEachRecord) {
  RecordedJob job(test::job_settings(Rays::kDexel, 0.5), 6);
  job.carve(60);
  const StrokeId a = job.strokes()[2], b = job.strokes()[4];
  job.change(a, true);
  const std::uint64_t first = job.records().size();
  job.carve(20);
  job.change(b, true);
  job.change(a, false);
  const std::uint64_t second = job.records().size();
  BlockHistory history(journal_records(job.file()), job.settings(), start_of(job.settings()));
  ASSERT_TRUE(history.catch_up());
  const StrokeTable& strokes = history.strokes();
  EXPECT_TRUE(strokes.at(first - 1).without.empty());
  EXPECT_EQ(strokes.at(first).without, StrokeSet{a});
  EXPECT_EQ(strokes.at(second - 1).without, (StrokeSet{a, b}));
  EXPECT_EQ(strokes.at(second).without, StrokeSet{b});
  EXPECT_TRUE(strokes.changes_between(first - 1, first));
  EXPECT_FALSE(strokes.changes_between(first, second - 2));
  ASSERT_EQ(strokes.all().size(), job.strokes().size());
  std::uint64_t motions = 0;
  for (const Stroke& stroke : strokes.all()) motions += stroke.motions;
  EXPECT_EQ(motions, 80U);
}

TEST(BlockHistory, StopsOnRequest) {
  RecordedJob job(test::job_settings(Rays::kDexel, 0.5), 7);
  job.carve(60);
  std::stop_source stop;
  BlockHistory history(journal_records(job.file()), job.settings(), start_of(job.settings()));
  ASSERT_TRUE(history.catch_up());
  stop.request_stop();
  EXPECT_FALSE(BlockHistory(journal_records(job.file()), job.settings(), start_of(job.settings()))
                   .catch_up(stop.get_token()));
  job.carve(10);
  ASSERT_TRUE(history.catch_up());
  SerialWorkers alone;
  const MotionSet all{.last = history.last()};
  EXPECT_FALSE(history.carve(history.tiles(), all, alone, stop.get_token()));
  EXPECT_EQ(hash_of(job, history, all, alone), job.block(all).state_hash());
}

/// Requests a stop after the first job of each batch.
class StoppingWorkers final : public Workers {
 public:
  int count() const override { return 2; }
  void run(int jobs, const std::function<void(int)>& job) override {
    for (int n = 0; n < jobs; ++n) {
      job(n);
      stop_.request_stop();
    }
  }
  std::stop_token token() const { return stop_.get_token(); }

 private:
  std::stop_source stop_;
};

TEST(BlockHistory, KeepsCarvedTilesWhenStopped) {
  RecordedJob job(test::job_settings(Rays::kDexel, 0.8), 8);
  job.carve(static_cast<int>(EraTiles::kRecords) + 600, 1);
  BlockHistory history(journal_records(job.file()), job.settings(), start_of(job.settings()));
  ASSERT_TRUE(history.catch_up());
  const MotionSet all{.last = history.last()};
  StoppingWorkers stopping;
  const auto error =
      test::error_of(history.carve(history.tiles(), all, stopping, stopping.token()));
  EXPECT_EQ(error, "stopped");
  const std::size_t kept = history.tile_bytes();
  EXPECT_GT(kept, 0U);
  SerialWorkers alone;
  EXPECT_EQ(hash_of(job, history, all, alone), job.block(all).state_hash());
  EXPECT_LT(kept, history.tile_bytes() / 4) << "jobs after the stop were carried out";
}

}  // namespace
}  // namespace kerf::block_history_test
