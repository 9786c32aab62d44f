// SPDX-License-Identifier: Apache-2.0
// Vertices stay near the true surface although the mesh does not intersect itself.

#include "tests/kernel/extremes/random_carving.h"
#include "tests/support/self_intersection.h"
#include "tests/support/test.h"

namespace kerf::vertex_error_test {
namespace {

using test::ToolJob;

/// Expects no crossings in the mesh of a job, and with three fields its vertices within half a
/// pitch of the true solid. One field knows walls to half a pitch only.
void judge(unsigned seed, std::size_t every) {
  const auto tools = test::every_tool(ToolJob::kToolScale);
  const test::NamedTool& tool = tools[seed / 2 % tools.size()];
  const Rays rays = seed % 2 == 0 ? Rays::kDexel : Rays::kTriDexel;
  SCOPED_TRACE(tool.name + ", seed " + std::to_string(seed) + ", " + to_string(rays));
  ToolJob job(seed, tool.tool, rays);
  const auto meshes = test::mesh_all(job.sculpture.solid());
  EXPECT_EQ(test::count_self_intersections(meshes, 2 * ToolJob::kPitchMm).pairs, 0U);
  if (rays == Rays::kDexel) return;
  const std::vector<double> errors = job.errors(meshes, every);
  ASSERT_FALSE(errors.empty());
  EXPECT_LE(*std::ranges::max_element(errors), 0.5);
}

TEST(VertexError, IsBelowHalfAPitchWithoutCrossings) {
  constexpr std::size_t kEvery = 7;
  for (unsigned seed = 0; seed < 44; ++seed) judge(seed, kEvery);
}

// Found by surface_bench vertices: up to 0.65 of the pitch, at vertices on faces between cells of
// several sheets, and in cells whose planes do not meet in one crease.
TEST(VertexError, IsBelowHalfAPitchInFormerlyWorseJobs) {
  for (const unsigned seed : {25U, 109U, 209U, 275U, 287U, 347U, 407U, 437U}) judge(seed, 1);
}

}  // namespace
}  // namespace kerf::vertex_error_test
