// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "server/store/attachment.h"
#include "tests/server/api_rights_fixture.h"

namespace kerf::net::api_attachments_test {
namespace {

constexpr const char* kTetrahedron =
    "solid t\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\n"
    "endfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\n"
    "endfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\n"
    "endfacet\nfacet normal 0 0 0\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\n"
    "endfacet\nendsolid t\n";

HttpOptions options_of(const std::filesystem::path& folder) {
  return HttpOptions{.data_folder = folder};
}

/// A server with a folder of its own.
struct OtherServer {
  test::TemporaryFolder folder;
  HttpOptions options = options_of(folder.path());
  Metrics metrics;
  std::shared_ptr<EagerExecutor> executor = std::make_shared<EagerExecutor>();
  EagerExecutor workers;
  SessionRegistry registry{RegistryOptions{folder.path(), 4, SessionLimits{}},
                           [this](const std::string&) { return executor; }, workers};
  std::unique_ptr<Access> access = *Access::open({.folder = folder.path(), .admin_token = kAdmin});
  Api api{options, registry, metrics, *access, http_matters()};

  std::shared_ptr<Session> load() {
    EXPECT_TRUE(registry.load_all().failures.empty());
    return registry.find("block");
  }
  Json targets() {
    ApiRequest request = *parse_target("/v1/sessions/block/targets");
    request.method = "GET";
    request.token = kAdmin;
    return Json::parse(api.handle(request).body).at("targets");
  }
};

class ApiAttachmentsTest : public ApiRightsTest {
 protected:
  void SetUp() override {
    ApiRightsTest::SetUp();
    // Reopen as a server whose rights predate attachments.
    ASSERT_TRUE(registry->close("block", false));
    LoadReport report;
    session = *registry->reopen(registry->closed().front().name, report);
  }
  Json add_target(const std::string& name, const std::string& place = "0,0,0") {
    ApiRequest request =
        *parse_target("/v1/sessions/block/targets?name=" + name + "&shift_mm=" + place);
    request.method = "POST";
    request.token = kAdmin;
    request.body = kTetrahedron;
    const ApiResponse response = api->handle(request);
    EXPECT_EQ(response.status, 201U) << response.body;
    return Json::parse(response.body);
  }
  /// Copies the journal in its present state on the disk to another server.
  void move_to(OtherServer& other) {
    std::filesystem::remove(other.folder / "block.kerf");
    ASSERT_TRUE(copy_journal(session->journal_file(), other.folder / "block.kerf"));
  }
};

TEST_F(ApiAttachmentsTest, RightsRegionsAndTargetPartsMoveToTheNextServer) {
  const std::string invitation = invite("role=watcher");
  ASSERT_EQ(ask("POST", "/v1/sessions/block/regions?min_mm=0,0,-5&max_mm=5,5,0", kAdmin).status,
            201U);
  const Json part = add_target("t.stl", "1,2,3");
  add_target("gone.stl");
  ASSERT_EQ(ask("DELETE", "/v1/sessions/block/targets/gone.stl", kAdmin).status, 200U);
  OtherServer other;
  move_to(other);
  const auto moved = other.load();
  ASSERT_TRUE(moved);
  for (const Role role : {Role::kWatcher, Role::kSculptor, Role::kOwner}) {
    EXPECT_EQ(other.access->identify(tokens[role], "block").role, role) << "from before the start";
  }
  EXPECT_EQ(other.access->identify(invitation, "block").role, Role::kWatcher);
  EXPECT_EQ(other.access->regions("block").size(), 1U);
  EXPECT_EQ(other.targets(), Json::array({part}));
}

TEST_F(ApiAttachmentsTest, ReturningJournalReplacesTheServersData) {
  const std::string invitation = invite("role=watcher");
  add_target("t.stl");
  OtherServer other;
  move_to(other);
  ASSERT_TRUE(other.load());
  other.registry.hand_over("block", "it goes on elsewhere", "");
  EXPECT_EQ(other.access->identify(invitation, "block").role, Role::kNobody)
      << "rights are where the session is";
  EXPECT_FALSE(std::filesystem::exists(other.folder / "targets/block"));
  const auto id = access->identify(invitation, "block").grant;
  ASSERT_EQ(ask("DELETE", "/v1/sessions/block/invitations/" + id, kAdmin).status, 200U);
  ASSERT_EQ(ask("DELETE", "/v1/sessions/block/targets/t.stl", kAdmin).status, 200U);
  const std::string later = invite("role=owner");
  move_to(other);
  ASSERT_TRUE(other.load());
  EXPECT_EQ(other.access->identify(invitation, "block").role, Role::kNobody);
  EXPECT_EQ(other.access->identify(later, "block").role, Role::kOwner);
  EXPECT_EQ(other.targets(), Json::array());
}

TEST_F(ApiAttachmentsTest, NewSessionInheritsNothingFromItsId) {
  OtherServer other;
  const auto stale = other.access->invite("block", {.role = Role::kOwner});
  ASSERT_TRUE(stale);
  ASSERT_TRUE(other.registry.create("block", kScene, SceneSource{}));
  EXPECT_EQ(other.access->identify(stale->token, "block").role, Role::kNobody);
}

TEST_F(ApiAttachmentsTest, AClosedSessionAndADownloadHaveNoAttachments) {
  ASSERT_FALSE(read_attachments(session->journal_file())->empty());
  const ApiResponse journal = ask("GET", "/v1/sessions/block/journal", kAdmin);
  ASSERT_TRUE(journal.file);
  std::string bytes(journal.file->bytes(), '\0');
  journal.file->read(0, bytes.data(), bytes.size());
  const auto downloaded = folder / "downloaded.kerf";
  std::ofstream(downloaded, std::ios::binary) << bytes;
  EXPECT_TRUE(read_attachments(downloaded)->empty());
  EXPECT_FALSE(bytes.contains("grant"));
  EXPECT_TRUE(JournalReader::open(downloaded));
  ASSERT_EQ(ask("DELETE", "/v1/sessions/block", kAdmin).status, 200U);
  const auto closed = registry->closed_folder() / (registry->closed().front().name + ".kerf");
  EXPECT_TRUE(read_attachments(closed)->empty());
}

}  // namespace
}  // namespace kerf::net::api_attachments_test
