// SPDX-License-Identifier: Apache-2.0
// A file that was carved elsewhere, merged over HTTP.
#include <fstream>
#include <iterator>

#include "server/store/journal_writer.h"
#include "tests/server/api_rights_fixture.h"

namespace kerf::net::api_merge_test {
namespace {

const std::string kMerge = "/v1/sessions/block/merge";

class ApiMerge : public ApiRightsTest {
 protected:
  void SetUp() override {
    ApiRightsTest::SetUp();
    cut(join(tokens[Role::kSculptor]), -4);
    ASSERT_TRUE(session->flush());
    ASSERT_TRUE(copy_journal(session->journal_file(), elsewhere));
  }
  /// Cuts a groove in the session.
  void cut(ParticipantId id, double y_mm) {
    for (int n = 0; n <= 10; ++n) {
      const wire::MotionSample sample{.agent_sequence = ++sequence,
                                      .time_us = 1000 * sequence,
                                      .tip_mm = {-15.0 + 3 * n, y_mm, -2},
                                      .tool_id = 1,
                                      .buttons = wire::kButtonCutting};
      ASSERT_TRUE(session->move(id, {&sample, 1}).rejections.empty());
    }
  }
  /// Cuts a groove in the copy. Returns its stroke.
  std::uint64_t cut_elsewhere(double y_mm) {
    const std::uint64_t last = JournalReader::open(elsewhere)->last_sequence();
    auto writer = JournalWriter::open(elsewhere, last).value();
    writer.append(JournalParticipant{40, "Grace", "#112233", "agent"});
    const MoveTool groove{1, {{-15, y_mm, -3}, {0, 0, 1}}, {{15, y_mm, -3}, {0, 0, 1}}, 0.1, false};
    const auto stroke = writer.append(40, groove, {.begins_stroke = true});
    EXPECT_TRUE(writer.finish());
    return *stroke;
  }
  std::string content() const {
    std::ifstream in(elsewhere, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  Json post(const std::string& query, const std::string& body, unsigned status,
            Role role = Role::kAdministrator) {
    const ApiResponse response = ask("POST", kMerge + query, tokens[role], body);
    EXPECT_EQ(response.status, status) << query << " " << response.body;
    return Json::parse(response.body);
  }
  std::string code(const std::string& query, const std::string& body, unsigned status) {
    return post(query, body, status).at("error").at("code");
  }
  double removed_mm3(const std::string& id) { return registry->find(id)->info().removed_mm3; }
  std::size_t leftovers() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
      count += entry.path().filename().string().starts_with("merge-") ? 1 : 0;
    }
    return count;
  }

  test::TemporaryFolder other_folder;
  std::filesystem::path elsewhere = other_folder / "elsewhere.kerf";
  std::uint64_t sequence = 0;
};

TEST_F(ApiMerge, MakesASessionWithTheStrokesOfBoth) {
  const std::uint64_t stroke = cut_elsewhere(8);
  cut(join(tokens[Role::kSculptor]), -12);
  const std::uint64_t before = session->solid().hash();
  const Json merged = post("?session=both", content(), 201);
  EXPECT_EQ(merged.at("id"), "both");
  ASSERT_EQ(merged.at("strokes").size(), 1U);
  EXPECT_EQ(merged.at("strokes")[0].at("stroke"), stroke);
  EXPECT_EQ(merged.at("strokes")[0].at("author"), "Grace");
  EXPECT_EQ(merged.at("motions"), 1);
  EXPECT_EQ(merged.at("people"), 1);
  EXPECT_EQ(session->solid().hash(), before);
  EXPECT_GT(removed_mm3("both"), removed_mm3("block") + 100);
  const Json strokes = made("GET", "/v1/sessions/both/strokes", kAdmin);
  EXPECT_EQ(strokes.at("strokes").size(), 3U);
  EXPECT_EQ(leftovers(), 0U);
  EXPECT_EQ(post("?session=again", content(), 201).at("motions"), 1);
  EXPECT_EQ(registry->find("again")->solid().hash(), registry->find("both")->solid().hash());
}

TEST_F(ApiMerge, ListsAndTakesChosenStrokes) {
  cut_elsewhere(8);
  const std::uint64_t second = cut_elsewhere(14);
  const Json list = post("?dry_run=1", content(), 200);
  ASSERT_EQ(list.at("strokes").size(), 2U);
  EXPECT_EQ(list.at("strokes")[1].at("stroke"), second);
  EXPECT_EQ(registry->list().size(), 1U);
  const Json one = post("?strokes=" + std::to_string(second), content(), 201);
  ASSERT_EQ(one.at("strokes").size(), 1U);
  EXPECT_EQ(one.at("strokes")[0].at("stroke"), second);
}

TEST_F(ApiMerge, RejectsWhatCannotBeMerged) {
  cut_elsewhere(8);
  const std::string reason = post("", "solid cube", 422).at("error").at("reason");
  EXPECT_EQ(reason, "the file: file is not a database");
  EXPECT_EQ(code("", "solid cube", 422), "bad_journal");
  EXPECT_EQ(code("", content().substr(0, 5000), 422), "bad_journal");
  EXPECT_EQ(code("?strokes=9999", content(), 409), "unknown_stroke");
  EXPECT_EQ(code("?strokes=1,x", content(), 400), "bad_value");
  EXPECT_EQ(code("?strokes=", content(), 400), "bad_value");
  EXPECT_EQ(code("?session=No", content(), 400), "bad_id");
  EXPECT_EQ(code("?session=block", content(), 409), "session_exists");
  post("", content(), 403, Role::kOwner);
  auto database = SqlDatabase::open(elsewhere, SqlMode::kWrite);
  ASSERT_TRUE(database->execute("CREATE VIEW more AS SELECT * FROM batches"));
  EXPECT_EQ(code("", content(), 422), "bad_journal");
  EXPECT_EQ(registry->list().size(), 1U);
  EXPECT_EQ(leftovers(), 0U);
}

TEST_F(ApiMerge, RejectsABlockOfAnotherScene) {
  std::string scene = kScene;
  scene.replace(scene.find("0.5"), 3, "0.4");
  const auto other = registry->create("other", scene, SceneSource{});
  ASSERT_TRUE(other && (*other)->flush());
  std::filesystem::remove(elsewhere);
  ASSERT_TRUE(copy_journal((*other)->journal_file(), elsewhere));
  EXPECT_EQ(code("", content(), 409), "different_block");
}

}  // namespace
}  // namespace kerf::net::api_merge_test
