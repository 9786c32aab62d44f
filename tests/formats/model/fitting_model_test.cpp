// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/fitting_model.h"

#include <unistd.h>

#include "kernel/dexel/mesh_stock.h"
#include "server/formats/model/mesh_reader.h"
#include "tests/formats/model/carved_mesh.h"
#include "tests/support/model_files.h"
#include "tests/support/test.h"

namespace kerf::fitting_model_test {
namespace {

class FittingModelTest : public ::testing::Test {
 protected:
  ~FittingModelTest() override { std::filesystem::remove(path_); }
  FittingModel write(ModelFormat format, const ModelLimits& limits) {
    const auto model = write_fitting_model(
        path_, solid_, {.format = format, .encoding = model_encodings(format).front()}, limits);
    EXPECT_TRUE(model);
    return model.value_or(FittingModel{});
  }

  const SolidSnapshot solid_ = test::carved_block(5);
  const std::filesystem::path path_ =
      std::filesystem::path(::testing::TempDir()) / (std::to_string(::getpid()) + "_fitting");
};

TEST_F(FittingModelTest, ModelWithinTheLimitsIsExact) {
  const auto exact = write(ModelFormat::kStl, {});
  EXPECT_FALSE(exact.exact_triangles);
  const std::string bytes = test::content_of(path_);
  SnapshotMesh mesh(solid_);
  ASSERT_TRUE(write_model(path_, mesh, {}));
  EXPECT_EQ(bytes, test::content_of(path_));
}

TEST_F(FittingModelTest, ModelAboveTheLimitsIsSimplifiedUntilReadable) {
  const auto exact = write(ModelFormat::kStl, {});
  for (const auto& [format, read_as] : {std::pair{ModelFormat::kStl, MeshFileFormat::kStl},
                                        std::pair{ModelFormat::kObj, MeshFileFormat::kObj},
                                        std::pair{ModelFormat::kGlb, MeshFileFormat::kGlb}}) {
    for (const std::uint64_t triangles :
         {exact.summary.triangles - 1, exact.summary.triangles / 8}) {
      const ModelLimits limits{.bytes = 100 * triangles, .triangles = triangles};
      const FittingModel model = write(format, limits);
      EXPECT_EQ(model.exact_triangles, exact.summary.triangles);
      EXPECT_LE(model.tolerance_mm, solid_.grid().pitch_mm);
      const std::string bytes = test::content_of(path_);
      EXPECT_LE(bytes.size(), limits.bytes);
      const auto mesh =
          test::value_of(read_mesh(read_as, std::as_bytes(std::span(bytes)), triangles));
      EXPECT_EQ(mesh_stock_fault(mesh), "");
      EXPECT_EQ(mesh.triangles.size(), model.summary.triangles);
    }
  }
}

TEST_F(FittingModelTest, FirstSufficientToleranceIsUsed) {
  const auto exact = write(ModelFormat::kStl, {});
  const auto fine = write(ModelFormat::kStl, {.triangles = exact.summary.triangles - 1});
  EXPECT_EQ(fine.tolerance_mm, 0.05 * solid_.grid().pitch_mm);
  const auto coarse = write(ModelFormat::kStl, {.triangles = fine.summary.triangles - 1});
  EXPECT_EQ(coarse.tolerance_mm, 0.2 * solid_.grid().pitch_mm);
  // Too large for simplification.
  const auto huge = write(ModelFormat::kStl, {.triangles = 1, .simplified_max = 1});
  EXPECT_FALSE(huge.exact_triangles);
  EXPECT_EQ(huge.summary.triangles, exact.summary.triangles);
}

}  // namespace
}  // namespace kerf::fitting_model_test
