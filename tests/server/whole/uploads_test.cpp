// SPDX-License-Identifier: Apache-2.0
// Models that are uploaded and carved, and the memory of uploads.
#include <malloc.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/server/whole/hand.h"
#include "tests/server/whole/whole_server.h"

namespace kerf::test::uploads_test {
namespace {

class Models : public WholeServer {
 protected:
  static Json mesh_scene(const std::string& name, const std::string& file) {
    return scene_with({{"name", name}, {"stock", {{"shape", "mesh"}, {"file", file}}}});
  }
  std::string sent(const std::string& query, const std::string& body) {
    return made("POST", "/v1/files?" + query, body).at("file");
  }
};

TEST_F(Models, DownloadedModelsAreCarvedAndJournaled) {
  Hand(port).carve(100);
  const std::string model = ask("GET", "/v1/sessions/block/model.ply").body;
  create("again", mesh_scene("again", sent("name=model.ply", model)));
  const Json block = info();
  const double left =
      block.at("stock_volume_mm3").get<double>() - block.at("removed_volume_mm3").get<double>();
  EXPECT_NEAR(info("again").at("stock_volume_mm3"), left, 0.01 * left);
  Hand(port, "again").carve(100, 2);
  const Json before = info("again");
  EXPECT_GT(before.at("removed_volume_mm3"), 0);
  wait_for_the_journal("again");
  std::filesystem::remove_all(data() / "uploads");
  restart();
  EXPECT_EQ(info("again").at("state_hash"), before.at("state_hash"));
  EXPECT_EQ(info("again").at("stock_volume_mm3"), before.at("stock_volume_mm3"));
}

TEST_F(Models, HolesAreRepairedOnRequest) {
  const std::string leaky = "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\n";
  const Json answer = made("POST", "/v1/files?name=leaky.obj&repair=1", leaky);
  EXPECT_TRUE(answer.at("repaired").get<std::string>().contains("closed 1 hole"));
  Json scene = mesh_scene("closed", answer.at("file"));
  scene["stock"]["repair"] = true;
  create("closed", scene);
  EXPECT_NEAR(info("closed").at("stock_volume_mm3"), 9.0 * 9 * 9 / 6, 9);
}

TEST_F(Models, InvalidModelsAreNamed) {
  const std::string model = ask("GET", "/v1/sessions/block/model.ply").body;
  const std::string open = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const struct {
    const char* query;
    const std::string& body;
    const char* answer;
  } rows[] = {{"name=model.obj", open, "400 not_closed"},
              {"name=model.obj&repair=1", open, "400 not_repairable"},
              {"name=model.step", model, "400 bad_name"},
              {"name=", model, "400 bad_name"}};
  for (const auto& [query, body, answer] : rows) {
    EXPECT_EQ(error("POST", std::string("/v1/files?") + query, body), answer) << query;
  }
  EXPECT_EQ(error("POST", "/v1/files?name=model.ply", model.substr(0, model.size() - 20)),
            "400 truncated");
  EXPECT_EQ(error("GET", "/v1/files"), "405 bad_method");
  const Answer unknown = ask("POST", "/v1/sessions", mesh_scene("x", "model.ply").dump());
  EXPECT_EQ(unknown.status, 400U);
  EXPECT_EQ(unknown.code(), "bad_scene");
  EXPECT_EQ(unknown.json().at("error").at("path"), "stock.file");
}

constexpr std::size_t kBytes = 60'000;  ///< size of an upload

/// A server with memory for four uploads, two of them by one client.
class UploadMemory : public WholeServer {
 protected:
  void SetUp() override {
    options.http.upload_bytes = 4 * kBytes + kBytes / 2;
    WholeServer::SetUp();
  }
  /// Sends the header of an upload and the first part of it.
  Peer begin(const std::string& from) const {
    Peer peer(port, from);
    peer.send("POST /v1/files?name=a.stl HTTP/1.1\r\nHost: localhost\r\nContent-Length: " +
              std::to_string(kBytes) + "\r\n\r\n" + std::string(1000, ' '));
    return peer;
  }
  /// Waits until `count` uploads are rejected. Returns one answer.
  static Answer rejected(const std::vector<Peer>& peers, std::size_t count) {
    const auto answered = [&] {
      return static_cast<std::size_t>(
          std::ranges::count_if(peers, [](const Peer& peer) { return peer.has_input(); }));
    };
    EXPECT_TRUE(eventually([&] { return answered() == count; })) << answered();
    Answer one;
    for (const Peer& peer : peers) {
      if (!peer.has_input()) continue;
      std::string bytes;
      peer.receive(bytes);
      one = read_answer(bytes);
      EXPECT_EQ(one.status, 503U) << bytes;
      EXPECT_FALSE(one.header("Retry-After").empty());
    }
    return one;
  }
  void expect_taken() const {
    EXPECT_TRUE(eventually([&] {
      return ask("POST", "/v1/files?name=a.stl", std::string(kBytes, ' ')).status != 503;
    }));
  }
};

TEST_F(UploadMemory, CountsUploadsFromTheirHeaders) {
  std::vector<Peer> peers;
  for (int n = 0; n < 40; ++n) peers.push_back(begin("127.0.0." + std::to_string(2 + n)));
  EXPECT_TRUE(rejected(peers, 36).body.contains("all memory"));
  peers.clear();
  expect_taken();
}

TEST_F(UploadMemory, OneClientCannotUseItUp) {
  std::vector<Peer> peers;
  for (int n = 0; n < 10; ++n) peers.push_back(begin("127.0.0.2"));
  EXPECT_TRUE(rejected(peers, 8).body.contains("one client"));
  expect_taken();  // file of another client
}

/// Memory of this process in MB: now, and the peak since the last reset.
double status_mb(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(field)) return std::stod(line.substr(field.size())) / 1000;
  }
  return 0;
}

// Sanitizers hold on to freed memory.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kHasOwnMemory = true;
#else
constexpr bool kHasOwnMemory = false;
#endif

class Memory : public WholeServer {
 protected:
  void SetUp() override {
    if (kHasOwnMemory) GTEST_SKIP() << "a sanitizer needs memory of its own";
    WholeServer::SetUp();
    malloc_trim(0);
  }
};

TEST_F(Memory, AbortedUploadsReleaseIt) {
  const std::string part(50'000'000, ' ');
  const double before = status_mb("VmRSS:");
  std::vector<Peer> peers;
  for (int n = 0; n < 3; ++n) {
    const Peer& peer = peers.emplace_back(port, "127.0.0." + std::to_string(2 + n));
    peer.send(
        "POST /v1/files?name=a.stl HTTP/1.1\r\nHost: localhost\r\nContent-Length: "
        "60000000\r\n\r\n");
    peer.send(part);
  }
  // Memory of earlier tests may be released in the meantime.
  EXPECT_TRUE(eventually([&] { return status_mb("VmRSS:") > before + 100; }));
  peers.clear();
  EXPECT_TRUE(eventually([&] { return status_mb("VmRSS:") < before + 30; }))
      << status_mb("VmRSS:") - before;
}

// Keeping all motions would take at least 112 bytes each: 90 MB. The programs take 30 to 50 MB,
// including memory of the threads.
TEST_F(Memory, ManyMotionsNeedLittle) {
  if (!(std::ofstream("/proc/self/clear_refs") << "5" << std::flush)) {
    GTEST_SKIP() << "this machine does not begin the peak again";
  }
  const double before = status_mb("VmHWM:");
  for (const char* text :
       {"T1 M6\nF1 G91 G81 X.1 Z-1 R1 L200000\nM2",
        "T1 M6\n#1=1\no1 while [#1 lt 200000]\n#1=[#1+1]\ng1 f9 x[sin[#1]]\no1 endwhile\nM2"}) {
    const Json program = upload(text, "pace=fast&name=p.ngc");
    EXPECT_GT(program.at("motions"), 150'000);
    ask("DELETE", program.at("url"));
  }
  EXPECT_LT(status_mb("VmHWM:") - before, 70);
}

}  // namespace
}  // namespace kerf::test::uploads_test
