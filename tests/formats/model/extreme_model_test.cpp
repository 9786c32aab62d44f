// SPDX-License-Identifier: Apache-2.0
// Every writer and the simplification, on blocks of extreme proportions.

#include <unistd.h>

#include "server/formats/model/model_writer.h"
#include "server/formats/model/simplify_mesh.h"
#include "tests/support/extreme_block.h"
#include "tests/support/model_files.h"
#include "tests/support/test.h"

namespace kerf::extreme_model_test {
namespace {

namespace fs = std::filesystem;

/// Writes the surface in every format and expects each file to contain `triangles` triangles.
void write_everywhere(const SolidSnapshot& solid, std::size_t triangles) {
  const fs::path path =
      fs::path(::testing::TempDir()) / (std::to_string(::getpid()) + "_extreme_model");
  for (const ModelFormat format : kModelFormats) {
    for (const ModelEncoding encoding : model_encodings(format)) {
      SCOPED_TRACE(std::string(to_string(format)) + " " + to_string(encoding));
      SnapshotMesh mesh(solid);
      const auto written =
          test::value_of(write_model(path, mesh, {.format = format, .encoding = encoding}));
      // Quantized positions may coincide. Then triangles are dropped.
      const bool exact = format != ModelFormat::kGlb || encoding == ModelEncoding::kFloat;
      EXPECT_LE(written.triangles, triangles);
      if (exact) {
        EXPECT_EQ(written.triangles, triangles);
      }
      const std::string bytes = test::content_of(path);
      if (format == ModelFormat::kPly || format == ModelFormat::kObj) {
        const test::ReadModel model =
            format == ModelFormat::kPly ? test::read_ply_bytes(bytes) : test::read_obj_text(bytes);
        EXPECT_EQ(model.triangles.size(), triangles);
        EXPECT_EQ(test::unmatched_edges(model), 0U);
      } else if (format == ModelFormat::kStl) {
        const test::ReadModel model = encoding == ModelEncoding::kAscii
                                          ? test::read_stl_text(bytes)
                                          : test::read_stl_bytes(bytes);
        EXPECT_EQ(model.triangles.size(), triangles);
      } else if (format == ModelFormat::kGlb) {
        EXPECT_EQ(test::read_model_glb(bytes).triangles.size(), written.triangles);
      }
    }
  }
  fs::remove(path);
}

void expect_writable_everywhere(const SolidSnapshot& solid) {
  SnapshotMesh source(solid);
  const IndexedMesh exact = collect_mesh(source);
  EXPECT_TRUE(check_edges(exact.triangles).closed_manifold());
  write_everywhere(solid, exact.triangles.size());
  SnapshotMesh again(solid);
  const double error_mm = 0.2 * solid.grid().pitch_mm;
  const auto simple = test::value_of(simplify_mesh(again, {.triangles = {}, .error_mm = error_mm}));
  EXPECT_LE(simple.error_mm, error_mm);
  EXPECT_LE(simple.mesh.triangles.size(), exact.triangles.size());
  EXPECT_TRUE(check_edges(simple.mesh.triangles).closed_manifold());
}

TEST(ExtremeModel, BlockLowerThanHalfAPitchIsWrittenInEveryFormat) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (const StockShape& stock : {StockShape(BoxStock{{0, 0, 0}, {60, 40, 0.49}}),
                                    StockShape(CylinderStock{0, 0, 30, 0, 0.2})}) {
      const SolidSnapshot solid =
          Sculpture::create({.stock = stock, .rays = rays, .pitch_mm = 1})->solid();
      SnapshotMesh mesh(solid);
      EXPECT_GT(collect_mesh(mesh).triangles.size(), 0U);
      expect_writable_everywhere(solid);
    }
  }
}

TEST(ExtremeModel, RandomProportionsAreWrittenInEveryFormat) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " " + to_string(rays));
      test::ExtremeBlock block(seed, rays, 90);
      expect_writable_everywhere(block.make(int(seed % 3)).solid());
    }
  }
}

}  // namespace
}  // namespace kerf::extreme_model_test
