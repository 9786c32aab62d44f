// SPDX-License-Identifier: Apache-2.0
#include "server/formats/scene_templates.h"

#include "server/formats/scene.h"
#include "tests/support/test.h"

namespace kerf::scene_templates_test {
namespace {

TEST(SceneTemplates, EachIsAValidScene) {
  std::set<std::string_view> ids;
  for (const SceneTemplate& one : scene_templates()) {
    EXPECT_TRUE(ids.insert(one.id).second) << one.id;
    EXPECT_FALSE(one.title.empty() || one.description.empty()) << one.id;
    const auto scene = parse_scene(one.scene, SceneSource{});
    ASSERT_TRUE(scene) << one.id << ": " << to_string(scene.error());
    EXPECT_TRUE(Sculpture::create(scene->settings)) << one.id;
    const Accuracy accuracy = accuracy_of(*scene);
    EXPECT_LT(predicted_bytes(accuracy, scene->settings.stock), 64e6) << one.id;
  }
  EXPECT_GE(ids.size(), 4U);
}

TEST(SceneTemplates, AmmoniteEqualsTheDemo) {
  const auto demo = test::value_of(load_scene(KERF_SOURCE_DIR "/haptic_agent/demo/demo.json"));
  for (const SceneTemplate& one : scene_templates()) {
    if (one.id != "ammonite") continue;
    EXPECT_EQ(scene_json(*parse_scene(one.scene, SceneSource{})), scene_json(demo));
    return;
  }
  FAIL() << "there is no ammonite";
}

}  // namespace
}  // namespace kerf::scene_templates_test
