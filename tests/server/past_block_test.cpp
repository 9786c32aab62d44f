// SPDX-License-Identifier: Apache-2.0
#include "server/session/past_block.h"

#include <expected>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "kernel/surface/tile_mesh.h"
#include "server/session/history_turns.h"
#include "server/session/session_export.h"
#include "server/session/session_past_source.h"
#include "server/store/sqlite.h"
#include "tests/server/undo_fixture.h"

namespace kerf::past_block_test {
namespace {

using namespace std::chrono_literals;

class Past : public SessionUndo {
 protected:
  void carve(const char* rays = "\"dexel\"") {
    std::string scene = kScene;
    scene.replace(scene.find("\"dexel\""), 7, rays);
    create(scene);
    const ParticipantId ada = join("Ada"), bo = join("Bo");
    const StrokeId a = stroke(ada, {-15, 0, -2}, {15, 0, -2});
    const StrokeId b = stroke(bo, {0, -15, -3}, {0, 15, -3});
    undo({a, b});
    stroke(ada, {-15, 8, -2}, {15, 8, -2});
    redo({b});
    stroke(bo, {-15, -8, -4}, {15, -8, -1});
  }
  std::uint64_t hash_at(std::uint64_t record) {
    SerialWorkers alone;
    return session_->past().solid_at(record, alone).value().value().hash();
  }
  static bool seek(PastBlock& block, std::uint64_t record) {
    const auto done = block.seek(record, {});
    EXPECT_TRUE(done) << done.error();
    return done.value_or(false);
  }
};

/// Has no tiles while it is busy.
class BusySource final : public PastSource {
 public:
  BusySource(std::unique_ptr<PastSource> source, const bool& is_busy)
      : source_(std::move(source)), is_busy_(is_busy) {}
  std::shared_ptr<const Scene> scene() const override { return source_->scene(); }
  std::expected<std::optional<std::vector<TileReplacement>>, std::string> tiles_at(
      std::uint64_t record, const std::stop_token& stop) override {
    if (is_busy_) return std::unexpected(kOthersAskHistory);
    return source_->tiles_at(record, stop);
  }
  std::expected<std::int64_t, std::string> time_of(std::uint64_t record) override {
    return source_->time_of(record);
  }
  std::expected<std::vector<JournalRecord>, std::string> records_after(
      std::uint64_t record, std::size_t count, const std::stop_token& stop) override {
    return source_->records_after(record, count, stop);
  }

 private:
  std::unique_ptr<PastSource> source_;
  const bool& is_busy_;
};

TEST_F(Past, AChangeThatCouldNotBePlayedIsPlayedLater) {
  carve();
  bool is_busy = false;
  auto source = std::make_unique<BusySource>(past_of(session_), is_busy);
  PastBlock block = PastBlock::create(std::move(source)).value();
  ASSERT_TRUE(seek(block, 10));
  const std::uint64_t last = session_->sequence();
  is_busy = true;
  EXPECT_FALSE(block.play({.record = last}, 1h, {}));
  is_busy = false;
  ASSERT_TRUE(block.play({.record = last}, 1h, {}));
  EXPECT_EQ(block.record(), last);
  EXPECT_EQ(block.solid().hash(), hash_at(last));
}

TEST_F(Past, SeeksToAnyRecordToTheBit) {
  for (const char* rays : {"\"dexel\"", "\"tri-dexel\""}) {
    renew();
    carve(rays);
    PastBlock block = PastBlock::create(past_of(session_)).value();
    std::mt19937 random(3);
    const std::uint64_t last = session_->sequence();
    for (int n = 0; n < 8; ++n) {
      const std::uint64_t record = n == 0 ? last : random() % last;
      ASSERT_TRUE(seek(block, record));
      EXPECT_EQ(block.record(), record);
      EXPECT_EQ(block.solid().hash(), hash_at(record)) << record;
    }
    EXPECT_FALSE(seek(block, last + 1));
    EXPECT_LE(block.record(), last);
  }
}

TEST_F(Past, IsTheSameAtEverySpeed) {
  carve();
  const std::uint64_t last = session_->sequence();
  ASSERT_TRUE(session_->flush());
  for (const int steps : {1, 7, 200}) {
    PastBlock block = PastBlock::create(past_of(session_)).value();
    ASSERT_TRUE(seek(block, 1));
    const std::int64_t begin_ms = block.time_ms();
    PastBlock end = PastBlock::create(past_of(session_)).value();
    ASSERT_TRUE(seek(end, last));
    const std::int64_t span_ms = end.time_ms() - begin_ms;
    for (int n = 0; n <= steps; ++n) {
      const auto played = block.play({.ms = begin_ms + span_ms * n / steps}, 10s, {});
      ASSERT_TRUE(played) << played.error();
      EXPECT_FALSE(played->is_late);
      EXPECT_EQ(played->next_ms == 0, n == steps);
      ASSERT_EQ(block.solid().hash(), hash_at(block.record())) << block.record();
    }
    EXPECT_EQ(block.record(), last);
    EXPECT_EQ(block.solid().hash(), hash());
    EXPECT_NEAR(block.removed_mm3(), session_->info().removed_mm3, 1e-6);
  }
}

TEST_F(Past, ConsecutiveStrokeChangesAppearOnTime) {
  create();
  const StrokeId a = stroke(join("Ada"), {-15, 0, -2}, {15, 0, -2});
  const std::uint64_t carved = session_->sequence();
  const std::uint64_t undone = undo({a}).sequence;
  std::this_thread::sleep_for(20ms);
  redo({a});
  ASSERT_TRUE(session_->flush());
  PastBlock block = PastBlock::create(past_of(session_)).value();
  ASSERT_TRUE(seek(block, undone));
  const std::int64_t undone_ms = block.time_ms();
  ASSERT_TRUE(seek(block, carved));
  const auto played = block.play({.ms = undone_ms}, 10s, {});
  ASSERT_TRUE(played) << played.error();
  EXPECT_EQ(block.record(), undone);
  EXPECT_GT(played->next_ms, undone_ms);
  EXPECT_EQ(block.solid().hash(), hash_at(undone));
  ASSERT_TRUE(block.play({}, 10s, {}));
  EXPECT_EQ(block.record(), session_->sequence());
  EXPECT_EQ(block.solid().hash(), hash());
}

TEST_F(Past, LateBlockContinuesWhereItStopped) {
  carve();
  ASSERT_TRUE(session_->flush());
  PastBlock block = PastBlock::create(past_of(session_)).value();
  int turns = 0;
  for (bool is_late = true; is_late; ++turns) {
    const auto played = block.play({}, 0s, {});
    ASSERT_TRUE(played) << played.error();
    is_late = played->is_late;
    if (turns == 0) {
      EXPECT_EQ(block.record(), 0U);
    }
    if (!is_late) break;
    ASSERT_TRUE(block.play({}, 100us, {}));
    if (block.record() == session_->sequence()) break;
  }
  EXPECT_EQ(block.solid().hash(), hash());
  // Later records are found.
  stroke(join("Cy"), {10, 10, -2}, {15, 15, -2});
  ASSERT_TRUE(session_->flush());
  ASSERT_TRUE(block.play({}, 10s, {}));
  EXPECT_EQ(block.solid().hash(), hash());
}

TEST_F(Past, NamesTheTilesWhoseSurfaceChanges) {
  carve();
  ASSERT_TRUE(session_->flush());
  PastBlock block = PastBlock::create(past_of(session_)).value();
  const DexelGrid grid = block.solid().grid();
  const auto positions = [&](TileIndex tile) {
    return mesh_tile(block.solid(), tile).positions_mm;
  };
  std::map<TileIndex, decltype(positions({}))> shown;
  const auto show = [&](std::span<const TileIndex> tiles) {
    for (const TileIndex tile : tiles) shown[tile] = positions(tile);
  };
  std::vector<TileIndex> all;
  for (int y = 0; y < grid.tiles_y(); ++y) {
    for (int x = 0; x < grid.tiles_x(); ++x) all.push_back({x, y});
  }
  show(all);
  std::mt19937 random(5);
  for (int n = 0; n < 6; ++n) {
    ASSERT_TRUE(seek(block, random() % session_->sequence()));
    ASSERT_TRUE(block.play({.ms = block.time_ms() + 5}, 10s, {}));
    auto changed = block.take_changed();
    std::ranges::sort(changed);
    show(tiles_to_remesh(grid, changed));
    for (const TileIndex tile : all) {
      ASSERT_EQ(shown[tile], positions(tile)) << tile.x << " " << tile.y;
    }
  }
}

TEST_F(Past, ToolForcesEqualForcesCsv) {
  create();
  const ParticipantId ada = join("Ada");
  stroke(ada, {-15, 0, -2}, {15, 0, -2});
  ASSERT_TRUE(session_->flush());
  std::stringstream csv;
  ASSERT_TRUE(export_forces(session_->journal_file(), {}, csv));
  std::string line, last;
  while (std::getline(csv, line)) last = line;
  PastBlock block = PastBlock::create(past_of(session_)).value();
  EXPECT_TRUE(block.tools().tools.empty());
  ASSERT_TRUE(block.play({}, 10s, {}));
  ASSERT_EQ(block.tools().tools.size(), 1U);
  const wire::ToolState& tool = block.tools().tools[0];
  EXPECT_EQ(tool.participant, ada);
  EXPECT_EQ(tool.tip_mm.x, 15);
  std::vector<float> values;
  std::stringstream cells(last);
  for (std::string cell; std::getline(cells, cell, ',');) values.push_back(std::stof(cell));
  EXPECT_FLOAT_EQ(tool.force_n.x, values.at(7));
  EXPECT_FLOAT_EQ(tool.torque_nmm.y, values.at(11));
  EXPECT_GT(std::abs(tool.force_n.x), 0.01F);
  ASSERT_TRUE(seek(block, 3));
  EXPECT_TRUE(block.tools().tools.empty());
}

TEST_F(Past, ReadsNothingAtTheEndOfTheJournal) {
  carve();
  ASSERT_TRUE(session_->flush());
  PastBlock block = PastBlock::create(past_of(session_)).value();
  ASSERT_TRUE(block.play({}, 10s, {}));
  ASSERT_EQ(block.record(), session_->sequence());
  const auto file = session_->journal_file();
  const auto away = folder_->path() / "away";
  std::filesystem::rename(file, away);
  const auto played = block.play({}, 10s, {});
  std::filesystem::rename(away, file);
  ASSERT_TRUE(played) << played.error();
  EXPECT_FALSE(played->is_late);
  EXPECT_EQ(played->next_ms, 0);
}

TEST_F(Past, PlaysFromTheMiddleOfTheJournal) {
  carve();
  ASSERT_TRUE(session_->flush());
  {
    auto journal = SqlDatabase::open(session_->journal_file(), SqlMode::kWrite);
    ASSERT_TRUE(journal->execute("UPDATE session SET crc=crc+1"));
  }
  PastBlock block = PastBlock::create(past_of(session_)).value();
  const auto played = block.play({}, 10s, {});
  ASSERT_TRUE(played) << played.error();
  EXPECT_EQ(block.solid().hash(), hash());
}

/// When first given work, lets another thread ask for the session's strokes and begins late. Notes
/// whether the answer came before it was given more work.
class AskingWorkers final : public Workers {
 public:
  explicit AskingWorkers(Session& session) : session_(session) {}
  int count() const override { return 1; }
  void run(int jobs, const std::function<void(int)>& job) override {
    if (!answer_.valid()) {
      std::promise<void> asking;
      auto asks = asking.get_future();
      answer_ = std::async(std::launch::async, [this, asking = std::move(asking)]() mutable {
        asking.set_value();
        return session_.past().strokes(0);
      });
      asks.wait();
      std::this_thread::sleep_for(300ms);
    } else if (!is_first_) {
      is_first_ = answer_.wait_for(1s) == std::future_status::ready;
    }
    for (int n = 0; n < jobs; ++n) job(n);
  }
  bool is_answered_first() const { return is_first_.value_or(false); }
  std::size_t strokes() { return answer_.get().value().size(); }

 private:
  Session& session_;
  std::future<std::expected<std::vector<ListedStroke>, std::string>> answer_;
  std::optional<bool> is_first_;
};

TEST_F(Past, YieldsToStrokeRequests) {
  carve();
  AskingWorkers workers(*session_);
  const std::uint64_t last = session_->sequence();
  const auto solid = session_->past().solid_at(last, workers);
  ASSERT_TRUE(solid) << solid.error();
  EXPECT_EQ((*solid)->hash(), hash());
  EXPECT_TRUE(workers.is_answered_first());
  EXPECT_EQ(workers.strokes(), 4U);
}

TEST(HistoryTurns, LookBackYieldsToUrgentRequests) {
  HistoryTurns turns;
  std::stop_source first, second;
  auto look = turns.look_back(10s, first);
  ASSERT_TRUE(look);
  EXPECT_FALSE(turns.try_now());
  EXPECT_FALSE(first.stop_requested());
  auto asker = std::async(std::launch::async, [&] { return turns.ask(10s).owns_lock(); });
  for (int n = 0; n < 5000 && !first.stop_requested(); ++n) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(first.stop_requested());
  look.unlock();
  look = turns.look_back(10s, second);
  EXPECT_TRUE(look);
  EXPECT_TRUE(asker.get());
  EXPECT_FALSE(second.stop_requested());
  EXPECT_FALSE(std::async(std::launch::async, [&] { return turns.ask(1ms).owns_lock(); }).get());
  EXPECT_TRUE(second.stop_requested());
}

TEST_F(Past, StopsOnRequest) {
  carve();
  ASSERT_TRUE(session_->flush());
  std::stop_source stop;
  stop.request_stop();
  PastBlock block = PastBlock::create(past_of(session_)).value();
  EXPECT_FALSE(block.seek(session_->sequence(), stop.get_token()));
  EXPECT_FALSE(block.play({}, 10s, stop.get_token()));
  ASSERT_TRUE(block.play({}, 10s, {}));
  EXPECT_EQ(block.solid().hash(), hash());
}

}  // namespace
}  // namespace kerf::past_block_test
