// SPDX-License-Identifier: Apache-2.0
// Scenes that name meshes.
#include <unistd.h>

#include "server/formats/scene.h"
#include "tests/support/test.h"

namespace kerf::scene_mesh_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class MeshScene : public testing::Test {
 protected:
  MeshScene() { std::filesystem::create_directories(folder_); }
  ~MeshScene() override { std::filesystem::remove_all(folder_); }
  std::expected<Scene, SceneError> scene_of(const std::string& file, const std::string& shape) {
    return parse_scene(text_of(file, shape),
                       {.name = "s.json", .base_folder = folder_, .load_mesh = load_mesh});
  }
  static std::string text_of(const std::string& file, const std::string& shape) {
    return R"({"stock": {"shape": ")" + shape + R"(", "file": ")" + file +
           R"("}, "tools": [{"id": 1, "shape": "ball", "diameter_mm": 2, "length_mm": 9}]})";
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("kerf-mesh-" + std::to_string(::getpid()));
  const std::string tetrahedron_ =
      "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
};

TEST_F(MeshScene, ObstaclesAreReadRelativeToTheScene) {
  write("wall.stl",
        "solid wall\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nendsolid wall\n");
  const auto with_obstacle = [&](const std::string& file) {
    write("s.json",
          R"({"stock": {"shape": "box", "min_mm": [0, 0, 0], "max_mm": [9, 9, 9]}, "tools": [)"
          R"({"id": 1, "shape": "ball", "diameter_mm": 2, "length_mm": 9}], "obstacles": [)"
          R"({"shape": "stl", "file": ")" +
              file + "\"}]}");
    return load_scene(folder_ / "s.json");
  };
  const auto scene = test::value_of(with_obstacle("wall.stl"));
  EXPECT_EQ(std::get<MeshObstacle>(scene.settings.obstacles[0].shape).triangles.size(), 1u);
  EXPECT_EQ(scene.obstacle_files[0].file, "wall.stl");
  EXPECT_THAT(to_string(with_obstacle("none.stl").error()), HasSubstr("cannot be read"));
  EXPECT_THAT(to_string(with_obstacle("s.json").error()), HasSubstr("obstacles[0].file"));
}

TEST_F(MeshScene, StockIsTheFilesSolid) {
  write("t.obj", tetrahedron_);
  for (const char* shape : {"mesh", "stl"}) {
    const auto scene = test::value_of(scene_of("t.obj", shape));
    EXPECT_EQ(std::get<BoxStock>(scene.settings.stock).max_mm, (Vec3{10, 10, 10}));
    const auto sculpture = test::value_of(Sculpture::create(scene.settings));
    EXPECT_NEAR(sculpture.stock_volume_mm3(), 1000.0 / 6, 0.3);
    // The canonical text names the file; viewers get the bounding box.
    EXPECT_THAT(scene_json(scene), HasSubstr(R"("stock":{"shape":"mesh","file":"t.obj"})"));
    EXPECT_THAT(stock_json(scene), HasSubstr("box"));
    EXPECT_TRUE(scene.files.empty());
  }
}

TEST_F(MeshScene, KeptFilesReplaceTheBaseFolder) {
  write("t.obj", tetrahedron_);
  const auto first = test::value_of(parse_scene(
      text_of("t.obj", "mesh"),
      {.base_folder = folder_, .files = {}, .keep_files = true, .load_mesh = load_mesh}));
  EXPECT_EQ(first.files.at("t.obj"), tetrahedron_);
  std::filesystem::remove(folder_ / "t.obj");
  const auto again = test::value_of(
      parse_scene(scene_json(first),
                  {.name = "s", .base_folder = {}, .files = first.files, .load_mesh = load_mesh}));
  EXPECT_EQ(*again.settings.stock_mesh, *first.settings.stock_mesh);
}

TEST_F(MeshScene, InvalidMeshIsRejectedWithReasonAndPath) {
  const auto reason_of = [&](const std::string& file) {
    const auto scene = scene_of(file, "mesh");
    EXPECT_FALSE(scene.has_value()) << file;
    return scene ? std::string() : to_string(scene.error());
  };
  write("open.obj", tetrahedron_.substr(0, tetrahedron_.size() - 8));
  EXPECT_THAT(reason_of("open.obj"), HasSubstr("stock.file"));
  EXPECT_THAT(reason_of("open.obj"), HasSubstr("3 open edges"));
  write("bad.obj", "v 0 0 zero\n");
  EXPECT_THAT(reason_of("bad.obj"), HasSubstr("line 1"));
  write("short.stl", "short");
  EXPECT_THAT(reason_of("short.stl"), HasSubstr("after 5 bytes"));
  EXPECT_THAT(reason_of("none.ply"), HasSubstr("cannot be read"));
  EXPECT_THAT(reason_of("part.step"), HasSubstr("cannot be read"));
  write("part.step", "ISO-10303-21;");
  EXPECT_THAT(reason_of("part.step"), HasSubstr("must be a .stl, .ply, .obj, .3mf or .glb file"));
  write("t.obj", tetrahedron_);
  const auto error = test::error_of(parse_scene(text_of("t.obj", "mesh"), {}));
  EXPECT_EQ(error.path, "stock.file");
  EXPECT_THAT(error.reason, HasSubstr("may not name a file"));
}

TEST_F(MeshScene, MeshesArePlacedAndRepaired) {
  write("open.obj", tetrahedron_.substr(0, tetrahedron_.size() - 8));
  const std::string mesh = R"({"shape": "mesh", "file": "open.obj", "repair": true, "placement": )"
                           R"({"unit": "cm", "scale": [1, 1, 2], "rotate_deg": [0, 0, 90], )"
                           R"("translate_mm": [0, 5, 0]}})";
  const std::string text =
      R"({"stock": )" + mesh + R"(, "obstacles": [)" + mesh +
      R"(], "tools": [{"id": 1, "shape": "ball", "diameter_mm": 2, "length_mm": 9}]})";
  const SceneSource source{
      .name = "s", .base_folder = folder_, .keep_files = true, .load_mesh = load_mesh};
  const auto scene = test::value_of(parse_scene(text, source));
  const BoxStock box = std::get<BoxStock>(scene.settings.stock);
  EXPECT_EQ(box.min_mm, (Vec3{-100, 5, 0}));
  EXPECT_EQ(box.max_mm, (Vec3{0, 105, 200}));
  EXPECT_EQ(scene.stock_repair.holes_closed, 1u);
  EXPECT_EQ(std::get<MeshObstacle>(scene.settings.obstacles[0].shape).triangles.size(), 4u);
  // Journals keep the canonical text and the file.
  const auto again = test::value_of(
      parse_scene(scene_json(scene),
                  {.name = "s", .base_folder = {}, .files = scene.files, .load_mesh = load_mesh}));
  EXPECT_EQ(*again.settings.stock_mesh, *scene.settings.stock_mesh);
  EXPECT_EQ(scene_json(again), scene_json(scene));

  const auto reason_of = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    const auto rejected = parse_scene(changed, source);
    return rejected ? std::string() : to_string(rejected.error());
  };
  EXPECT_THAT(reason_of("\"repair\": true", "\"repair\": false"),
              AllOf(HasSubstr("3 open edges"), HasSubstr("\"repair\": true closes")));
  EXPECT_THAT(reason_of("true", "1"), HasSubstr("stock.repair must be true or false"));
  EXPECT_THAT(reason_of("cm", "km"), HasSubstr("placement.unit must be mm, cm, m or inch"));
  EXPECT_THAT(reason_of("[1, 1, 2]", "[1, 0, 2]"), HasSubstr("placement.scale must be three"));
  EXPECT_THAT(reason_of("90]", "720]"), HasSubstr("placement.rotate_deg must be three angles"));
  EXPECT_THAT(reason_of("scale", "scales"), HasSubstr("scales"));
}

}  // namespace
}  // namespace kerf::scene_mesh_test
