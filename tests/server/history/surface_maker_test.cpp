// SPDX-License-Identifier: Apache-2.0
#include "server/history/surface_maker.h"

#include "server/history/block_history.h"
#include "server/history/column_end.h"
#include "server/history/journal_records.h"
#include "tests/server/history/recorded_job.h"
#include "tests/support/test.h"

namespace kerf::surface_maker_test {
namespace {

using test::RecordedJob;

bool holds(const SolidSnapshot& solid, const StockCell& cell) {
  const auto field = std::ranges::find(solid.fields, cell.axis,
                                       [](const DexelSnapshot& f) { return f.grid().axis; });
  std::vector<Dexel> scratch;
  return std::ranges::any_of(field->column(cell.i, cell.j, scratch), [&](const Dexel& dexel) {
    return dexel.bottom <= cell.depth && cell.depth < dexel.top;
  });
}

/// Returns for each cell the record that removes it when a block is carved motion by motion.
std::vector<std::optional<std::uint64_t>> removals(const RecordedJob& job, const MotionSet& set,
                                                   const std::vector<StockCell>& cells) {
  std::vector<std::optional<std::uint64_t>> found(cells.size());
  Sculpture block = Sculpture::create(job.settings()).value();
  for (const JournalRecord& record : job.records()) {
    const auto command = kernel_command(record.command);
    const bool is_move = std::holds_alternative<MoveTool>(record.command);
    if (!command || record.sequence > set.last) continue;
    if (is_move && set.without.contains(record.stroke)) continue;
    block.apply(*command).value();
    const SolidSnapshot solid = block.solid();
    for (std::size_t n = 0; n < cells.size(); ++n) {
      if (!found[n] && !holds(solid, cells[n])) found[n] = record.sequence;
    }
  }
  return found;
}

std::vector<StockCell> some_cells(RecordedJob& job, const SolidSnapshot& solid, int count) {
  std::vector<StockCell> cells;
  for (int n = 0; n < count; ++n) {
    const DexelGrid& grid = solid.fields[job.random()() % solid.fields.size()].grid();
    const auto below = [&](std::int32_t limit) {
      return static_cast<std::int32_t>(job.random()() % static_cast<unsigned>(limit));
    };
    StockCell cell{grid.axis, below(grid.columns_x), below(grid.columns_y),
                   below(grid.height_quanta)};
    if (grid.axis == RayAxis::kZ && n % 2 == 0) {  // near the top, where most is cut
      cell.depth = grid.height_quanta - 1 - below(grid.height_quanta / 3);
    }
    cells.push_back(cell);
  }
  return cells;
}

TEST(SurfaceMaker, IsTheMotionThatRemovedTheCell) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    RecordedJob job(test::job_settings(rays, 0.5), 51 + static_cast<unsigned>(rays));
    job.carve(150);
    job.redefine();
    job.carve(100);
    const SolidSnapshot start = Sculpture::create(job.settings()).value().solid();
    BlockHistory history(journal_records(job.file()), job.settings(), start);
    ASSERT_TRUE(history.catch_up());
    std::ptrdiff_t removed = 0;
    for (int question = 0; question < 3; ++question) {
      const MotionSet set = job.some();
      const auto cells = some_cells(job, start, 60);
      const auto expected = removals(job, set, cells);
      removed += std::ranges::count_if(expected, [](const auto& r) { return r.has_value(); });
      for (std::size_t n = 0; n < cells.size(); ++n) {
        const auto maker = test::value_of(history.first_to_remove(cells[n], set));
        ASSERT_EQ(maker.has_value(), expected[n].has_value()) << "cell " << n;
        if (!maker) continue;
        EXPECT_EQ(maker->record, *expected[n]) << "cell " << n;
        EXPECT_LE(maker->stroke.id, maker->record);
        EXPECT_FALSE(set.without.contains(maker->stroke.id));
      }
    }
    EXPECT_GT(removed, 10);
  }
}

TEST(SurfaceMaker, IsEmptyForExistingStock) {
  RecordedJob job(test::job_settings(Rays::kDexel, 0.5), 61);
  job.carve(100);
  const SolidSnapshot start = Sculpture::create(job.settings()).value().solid();
  BlockHistory history(journal_records(job.file()), job.settings(), start);
  ASSERT_TRUE(history.catch_up());
  EXPECT_FALSE(test::value_of(history.first_to_remove({RayAxis::kZ, 3, 3, 0}, {})).has_value());
}

TEST(SurfaceOwners, AreTheParticipantsThatRemovedTheStockFirst) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    RecordedJob job(test::job_settings(rays, 0.5), 71 + static_cast<unsigned>(rays));
    job.carve(1500);  // more than a window of records
    job.redefine();
    job.carve(300);
    const SolidSnapshot start = Sculpture::create(job.settings()).value().solid();
    BlockHistory history(journal_records(job.file()), job.settings(), start);
    ASSERT_TRUE(history.catch_up());
    for (int question = 0; question < 3; ++question) {
      const MotionSet set = job.some();
      auto cells = some_cells(job, start, 150);
      for (std::size_t n = 0; n < 150; n += 3) {  // in one column, some queried twice
        cells.push_back(cells[n]);
        const std::int32_t depth = std::max(cells[n].depth - static_cast<std::int32_t>(n % 4), 0);
        cells.push_back({cells[n].axis, cells[n].i, cells[n].j, depth});
      }
      const auto owners = test::value_of(history.owners(cells, set));
      ASSERT_EQ(owners.size(), cells.size());
      std::set<ParticipantId> found;
      for (std::size_t n = 0; n < cells.size(); ++n) {
        const auto maker = history.first_to_remove(cells[n], set).value();
        ASSERT_EQ((owners)[n], maker ? maker->stroke.participant : 0) << "cell " << n;
        found.insert((owners)[n]);
      }
      EXPECT_GE(found.size(), 3U);
    }
  }
}

TEST(SurfaceOwners, AreEmptyWithoutQueries) {
  RecordedJob job(test::job_settings(Rays::kDexel, 0.5), 81);
  job.carve(50);
  BlockHistory history(journal_records(job.file()), job.settings(),
                       Sculpture::create(job.settings()).value().solid());
  ASSERT_TRUE(history.catch_up());
  EXPECT_TRUE(history.owners({}, {}).value().empty());
}

TEST(ColumnEnd, IsTheNearestOnTheSelectedFace) {
  const SculptureSettings settings = test::job_settings(Rays::kTriDexel, 0.5);
  const SolidSnapshot solid = Sculpture::create(settings).value().solid();
  const auto top = test::value_of(nearest_end(solid, {10.1, 10.2, 0.03}, {0, 0, 1}, 1));
  EXPECT_EQ(top.axis, RayAxis::kZ);
  EXPECT_TRUE(top.is_top);
  EXPECT_EQ(top.at_mm, (Vec3{10.25, 10.25, 0}));
  EXPECT_EQ(top.normal, (Vec3{0, 0, 1}));
  // At an edge the normal selects the face.
  const auto side = test::value_of(nearest_end(solid, {0, 10.2, -0.1}, {-1, 0, 0}, 1));
  EXPECT_EQ(side.axis, RayAxis::kX);
  EXPECT_FALSE(side.is_top);
  EXPECT_EQ(side.at_mm.x, 0);
  EXPECT_FALSE(nearest_end(solid, {10, 10, -5}, {0, 0, 1}, 1));
  EXPECT_FALSE(nearest_end(solid, {1e5, -1e5, 0}, {0, 0, 1}, 1));
}

}  // namespace
}  // namespace kerf::surface_maker_test
