// SPDX-License-Identifier: Apache-2.0
#include "server/session/past_block.h"

#include <random>
#include <sstream>

#include "kernel/surface/tile_mesh.h"
#include "server/session/session_export.h"
#include "tests/server/undo_fixture.h"

namespace kerf {
namespace {

using namespace std::chrono_literals;
constexpr std::int64_t kForever = std::numeric_limits<std::int64_t>::max();

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
    return session_->solid_at(record, alone).value().value().hash();
  }
  static bool seek(PastBlock& block, std::uint64_t record) {
    const auto done = block.seek(record, {});
    EXPECT_TRUE(done) << done.error();
    return done.value_or(false);
  }
};

TEST_F(Past, GoesToAnyRecordToTheBit) {
  for (const char* rays : {"\"dexel\"", "\"tri-dexel\""}) {
    renew();
    carve(rays);
    PastBlock block = PastBlock::create(session_).value();
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
    PastBlock block = PastBlock::create(session_).value();
    ASSERT_TRUE(seek(block, 1));
    const std::int64_t begin_ms = block.time_ms();
    PastBlock end = PastBlock::create(session_).value();
    ASSERT_TRUE(seek(end, last));
    const std::int64_t span_ms = end.time_ms() - begin_ms;
    for (int n = 0; n <= steps; ++n) {
      const auto played = block.play(begin_ms + span_ms * n / steps, 10s, {});
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

TEST_F(Past, ABlockThatIsLateGoesOnWhereItWas) {
  carve();
  ASSERT_TRUE(session_->flush());
  PastBlock block = PastBlock::create(session_).value();
  int turns = 0;
  for (bool is_late = true; is_late; ++turns) {
    const auto played = block.play(kForever, 0s, {});
    ASSERT_TRUE(played) << played.error();
    is_late = played->is_late;
    if (turns == 0) {
      EXPECT_EQ(block.record(), 0U);
    }
    if (!is_late) break;
    ASSERT_TRUE(block.play(kForever, 100us, {}));
    if (block.record() == session_->sequence()) break;
  }
  EXPECT_EQ(block.solid().hash(), hash());
  // What is journaled afterwards is found.
  stroke(join("Cy"), {10, 10, -2}, {15, 15, -2});
  ASSERT_TRUE(session_->flush());
  ASSERT_TRUE(block.play(kForever, 10s, {}));
  EXPECT_EQ(block.solid().hash(), hash());
}

TEST_F(Past, NamesTheTilesWhoseSurfaceChanges) {
  carve();
  ASSERT_TRUE(session_->flush());
  PastBlock block = PastBlock::create(session_).value();
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
    ASSERT_TRUE(block.play(block.time_ms() + 5, 10s, {}));
    auto changed = block.take_changed();
    std::ranges::sort(changed);
    show(tiles_to_remesh(grid, changed));
    for (const TileIndex tile : all) {
      ASSERT_EQ(shown[tile], positions(tile)) << tile.x << " " << tile.y;
    }
  }
}

TEST_F(Past, ToolsHaveTheForcesOfForcesCsv) {
  create();
  const ParticipantId ada = join("Ada");
  stroke(ada, {-15, 0, -2}, {15, 0, -2});
  ASSERT_TRUE(session_->flush());
  std::stringstream csv;
  ASSERT_TRUE(export_forces(session_->journal_file(), {}, csv));
  std::string line, last;
  while (std::getline(csv, line)) last = line;
  PastBlock block = PastBlock::create(session_).value();
  EXPECT_TRUE(block.tools().tools.empty());
  ASSERT_TRUE(block.play(kForever, 10s, {}));
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

TEST_F(Past, StopsWhenItIsAskedTo) {
  carve();
  ASSERT_TRUE(session_->flush());
  std::stop_source stop;
  stop.request_stop();
  PastBlock block = PastBlock::create(session_).value();
  EXPECT_FALSE(block.seek(session_->sequence(), stop.get_token()));
  EXPECT_FALSE(block.play(kForever, 10s, stop.get_token()));
  ASSERT_TRUE(block.play(kForever, 10s, {}));
  EXPECT_EQ(block.solid().hash(), hash());
}

}  // namespace
}  // namespace kerf
