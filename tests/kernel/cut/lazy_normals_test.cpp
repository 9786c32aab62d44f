// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/lazy_normals.h"

#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::lazy_normals_test {
namespace {

TEST(LazyNormals, BuffersStaySmallUnderAWideTool) {
  auto block = Sculpture::create({.stock = BoxStock{{0, 0, 0}, {200, 200, 50}},
                                  .rays = Rays::kTriDexel,
                                  .pitch_mm = 0.5,
                                  .keep_normals = true})
                   .value();
  block.apply(DefineTool{1, make_tool(FlatShape{30, 60}).value()}).value();
  // Each motion leaves new ends in about 11,000 columns.
  std::mt19937 engine(1);
  const test::Uniform random(engine);
  for (int n = 0; n < 600; ++n) {
    const Vec3 at{random(0, 200), random(0, 200), 40 - 0.05 * n};
    block.apply(MoveTool{1, {at, {0, 0, 1}}, {at + Vec3{5, 0, 0}, {0, 0, 1}}, 0.01, false}).value();
    if (n % 200 == 199) block.solid();  // computes all normals at once
  }
  EXPECT_GT(block.working_bytes(), 0U);
  EXPECT_LT(block.working_bytes(), 3 * (std::size_t{2} << 20));  // of three fields
}

}  // namespace
}  // namespace kerf::lazy_normals_test
