#include "server/formats/glb.h"

#include <gtest/gtest.h>
#include <tiny_gltf.h>
#include <unistd.h>

#include "kernel/surface/tile_mesh.h"
#include "tests/support/carvings.h"

namespace kerf {
namespace {

tinygltf::Model load(const std::vector<std::byte>& glb) {
  tinygltf::Model model;
  std::string error, warning;
  const bool ok = tinygltf::TinyGLTF().LoadBinaryFromMemory(
      &model, &error, &warning, reinterpret_cast<const unsigned char*>(glb.data()),
      static_cast<unsigned>(glb.size()));
  EXPECT_TRUE(ok) << error;
  EXPECT_TRUE(warning.empty()) << warning;
  return model;
}

TEST(ModelGlb, HoldsEveryTileUnderOneRootInMetresAndYUp) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{100, 200, 300}, {120, 220, 310}}, 0.5);
  const DexelSnapshot snapshot = sculpture.snapshot();
  const auto glb = make_model_glb(snapshot, "a \"quoted\" name");
  ASSERT_TRUE(glb) << glb.error().reason;
  const tinygltf::Model model = load(*glb);
  EXPECT_EQ(model.asset.extras.Get("scene").Get<std::string>(), "a \"quoted\" name");
  const tinygltf::Node& root = model.nodes.at(0);
  EXPECT_EQ(root.name, "kerf");
  EXPECT_EQ(root.scale, (std::vector<double>{0.001, 0.001, 0.001}));
  EXPECT_EQ(root.children.size(), 4U);
  // World Z of the block is glTF's Y: its lowest plane lies at 0.3 m.
  EXPECT_NEAR(root.translation.at(0), 0.1, 1e-12);
  EXPECT_NEAR(root.translation.at(1), 0.3, 1e-12);
  EXPECT_NEAR(root.translation.at(2), -0.2, 1e-12);
  std::size_t triangles = 0, expected = 0;
  for (const tinygltf::Mesh& mesh : model.meshes) {
    const tinygltf::Primitive& primitive = mesh.primitives.at(0);
    triangles += model.accessors.at(std::size_t(primitive.indices)).count / 3;
    const auto& position = model.accessors.at(std::size_t(primitive.attributes.at("POSITION")));
    EXPECT_EQ(position.minValues.at(2), 0);
    EXPECT_EQ(position.maxValues.at(2), 10);
  }
  for (std::int32_t t = 0; t < 4; ++t) {
    expected += mesh_tile(snapshot, {t % 2, t / 2}).indices.size() / 3;
  }
  EXPECT_EQ(triangles, expected);
}

TEST(ModelGlb, OfNothingIsAnEmptyScene) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{0, 0, 0}, {4, 4, 4}}, 0.5);
  ASSERT_TRUE(sculpture.apply(DefineTool{1, make_tool(FlatShape{20, 40}).value()}));
  ASSERT_TRUE(sculpture.apply(MoveTool{1, {{2, 2, -1}}, {{2, 2, -1}}, 1, false}));
  const auto glb = make_model_glb(sculpture.snapshot(), "gone");
  ASSERT_TRUE(glb);
  EXPECT_TRUE(load(*glb).meshes.empty());
}

TEST(ModelGlb, FileAppearsWholeOrNotAtAll) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{0, 0, 0}, {4, 4, 4}}, 0.5);
  const DexelSnapshot snapshot = sculpture.snapshot();
  const std::filesystem::path folder(::testing::TempDir());
  const auto path = folder / (std::to_string(::getpid()) + "_model.glb");
  ASSERT_TRUE(write_model_glb_file(path, snapshot, "box"));
  EXPECT_EQ(std::filesystem::file_size(path), make_model_glb(snapshot, "box")->size());
  std::filesystem::remove(path);
  const auto nowhere = folder / "no_such_folder_for_kerf" / "model.glb";
  const auto result = write_model_glb_file(nowhere, snapshot, "box");
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().reason.find("model.glb"), std::string::npos);
}

}  // namespace
}  // namespace kerf
