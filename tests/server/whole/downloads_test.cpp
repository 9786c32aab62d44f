// SPDX-License-Identifier: Apache-2.0
// Downloads of a session over HTTP, including slow ones.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/whole/hand.h"
#include "tests/server/whole/whole_server.h"

namespace kerf::test::downloads_test {
namespace {

constexpr const char* kFrame =
    "%\nG21 G90 G17 G94\nT2 M6\nG0 X-15 Y-15 Z5\nG1 Z-3 F600\nX15 F1200\nY15\nG3 X-15 Y15 I-15 "
    "J0\nG1 Z5\nM2\n%\n";

class Downloads : public WholeServer {
 protected:
  void SetUp() override {
    WholeServer::SetUp();
    {
      Hand ada(port);
      ada.carve(300);
      participant = ada.participant;
    }
    wait_for(upload(kFrame, "pace=fast&name=a.ngc"), "finished");
  }
  Answer get(const std::string& name, const Headers& headers = {}) const {
    return ask("GET", "/v1/sessions/block/" + name, "", headers);
  }
  std::string fault(const std::string& name) { return error("GET", "/v1/sessions/block/" + name); }
  /// Returns the hash of the block that a program carves in a new session.
  std::string carved(const std::string& session, const std::string& text, const std::string& name) {
    create(session);
    wait_for(upload(text, "pace=fast&name=" + name, session), "finished");
    return hash(session);
  }
  static std::size_t count(const std::string& text, const std::string& word) {
    std::size_t found = 0;
    for (auto at = text.find(word); at != text.npos; at = text.find(word, at + 1)) ++found;
    return found;
  }
  /// Parses the numbers of a CSV line.
  static std::vector<double> numbers(const std::string& line) {
    std::vector<double> values;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) values.push_back(std::stod(field));
    return values;
  }
  static std::vector<std::string> lines(const std::string& text) {
    std::vector<std::string> all;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
  }

  std::uint64_t participant = 0;
};

TEST_F(Downloads, HaveTheStateHashAsETag) {
  const Answer model = get("model.stl");
  EXPECT_EQ(model.status, 200U);
  EXPECT_EQ(model.header("ETag"), "\"" + hash() + "\"");
  EXPECT_EQ(std::to_string(model.body.size()), model.header("Content-Length"));
  EXPECT_EQ((model.body.size() - 84) % 50, 0U);
  const Answer same = get("model.stl", {{"If-None-Match", model.header("ETag")}});
  EXPECT_EQ(same.status, 304U);
  EXPECT_EQ(same.body, "");
  const Answer head = ask("HEAD", "/v1/sessions/block/model.stl");
  EXPECT_EQ(head.status, 200U);
  EXPECT_EQ(head.body, "");
  EXPECT_EQ(head.header("Content-Length"), model.header("Content-Length"));
}

TEST_F(Downloads, HaveTypeFirstBytesAndNameOfEachFormat) {
  const struct {
    const char *name, *type, *begin, *file;
  } rows[] = {
      {"model.stl", "model/stl", "Kerf STL", "block.stl"},
      {"model.stl?encoding=ascii", "model/stl", "solid block", "block-ascii.stl"},
      {"model.glb", "model/gltf-binary", "glTF", "block.glb"},
      {"model.glb?encoding=quantized", "model/gltf-binary", "glTF", "block-quantized.glb"},
      {"model.glb?encoding=meshopt", "model/gltf-binary", "glTF", "block-meshopt.glb"},
      {"model.3mf", "model/3mf", "PK", "block.3mf"},
      {"model.ply", "application/vnd.ply", "ply", "block.ply"},
      {"model.obj", "model/obj", "# block", "block.obj"},
      {"program.ngc", "text/plain", "%", "block.ngc"},
      {"program.ngc?post=fanuc", "text/plain", "%\nO1000", "block-fanuc.ngc"},
      {"journal", "application/vnd.sqlite3", "SQLite", "block.kerf"},
      {"forces.csv", "text/csv", "t_s,x,y,z,", "block-forces.csv"},
      {"thin_walls.json", "application/json", "{", "block-thin_walls.json"},
  };
  for (const auto& [name, type, begin, file] : rows) {
    const Answer answer = get(name);
    EXPECT_EQ(answer.status, 200U) << name;
    EXPECT_EQ(answer.header("Content-Type"), type) << name;
    EXPECT_TRUE(answer.body.starts_with(begin)) << name;
    if (std::string_view(begin) == "{" || std::string_view(type) == "text/csv") continue;
    EXPECT_EQ(answer.header("Content-Disposition"),
              "attachment; filename=\"" + std::string(file) + "\"");
  }
  create("cup", scene_with({{"name", "Täßchen: 1/2"}}));
  EXPECT_EQ(ask("GET", "/v1/sessions/cup/model.stl").header("Content-Disposition"),
            "attachment; filename=\"T__chen- 1-2.stl\"; "
            "filename*=UTF-8''T%C3%A4%C3%9Fchen-%201-2.stl");
  EXPECT_EQ(fault("model.glb?encoding=ascii"), "400 bad_encoding");
  EXPECT_EQ(fault("model.dxf"), "404 not_found");
  EXPECT_EQ(fault("program.ngc?post=heidenhain"), "422 bad_post") << "the machine is tool-vector";
}

TEST_F(Downloads, ModelsHaveTheRequestedSize) {
  const Answer few = get("model.stl?triangles=500");
  EXPECT_LE((few.body.size() - 84) / 50, 500U);
  EXPECT_TRUE(few.header("Content-Disposition").contains("\"block-500-triangles.stl\""));
  EXPECT_LT(get("model.stl?error_mm=0.2").body.size(), get("model.stl").body.size());
  EXPECT_EQ(fault("model.stl?triangles=3"), "422 budget_impossible");
  EXPECT_EQ(get("model.stl?triangles=0").status, 400U);
  EXPECT_EQ(get("model.stl?error_mm=nan").status, 400U);
}

TEST_F(Downloads, AreSentInParts) {
  const Answer whole = get("model.stl");
  EXPECT_EQ(whole.header("Accept-Ranges"), "bytes");
  const std::size_t size = whole.body.size();
  const auto part = [&](const std::string& range, std::size_t first, std::size_t last) {
    const Answer answer = get("model.stl", {{"Range", "bytes=" + range}});
    EXPECT_EQ(answer.status, 206U) << range;
    EXPECT_TRUE(answer.body == whole.body.substr(first, last + 1 - first)) << range;
    EXPECT_EQ(
        answer.header("Content-Range"),
        "bytes " + std::to_string(first) + "-" + std::to_string(last) + "/" + std::to_string(size));
  };
  part("0-99", 0, 99);
  part("100-", 100, size - 1);
  part("-7", size - 7, size - 1);
  part("5-" + std::to_string(size + 9), 5, size - 1);
  const Answer beyond = get("model.stl", {{"Range", "bytes=" + std::to_string(size) + "-"}});
  EXPECT_EQ(beyond.status, 416U);
  EXPECT_EQ(beyond.code(), "bad_range");
  EXPECT_EQ(beyond.header("Content-Range"), "bytes */" + std::to_string(size));
  const auto if_range = [&](const std::string& tag) {
    return get("model.stl", {{"Range", "bytes=0-9"}, {"If-Range", tag}});
  };
  EXPECT_EQ(if_range(whole.header("ETag")).status, 206U);
  // The rest of an old file is useless once the block has changed.
  EXPECT_EQ(if_range("\"0000000000000000\"").status, 200U);
  EXPECT_TRUE(if_range("\"0000000000000000\"").body == whole.body);
  EXPECT_EQ(get("model.stl", {{"Range", "bytes=1-2,4-5"}}).status, 200U);
  EXPECT_EQ(get("model.stl", {{"Range", "lines=1-2"}}).status, 200U);
  EXPECT_EQ(get("program.apt", {{"Range", "bytes=0-6"}}).body, "PARTNO/");
}

TEST_F(Downloads, ProgramsCarveTheSameSolid) {
  for (const std::string name : {"program.ngc", "program.apt"}) {
    const std::string session = name == "program.ngc" ? "ngc" : "apt";
    EXPECT_EQ(carved(session, get(name).body, name), hash()) << name;
  }
}

TEST_F(Downloads, ProgramsSelectRecordsAndJoinWithinATolerance) {
  const std::size_t whole = count(get("program.apt").body, "GOTO/");
  const std::size_t part = count(get("program.apt?from=100&to=150").body, "GOTO/");
  EXPECT_GE(part, 40U);
  EXPECT_LE(part, 51U);
  const Answer joined = get("program.apt?tolerance_mm=0.05");
  EXPECT_TRUE(joined.body.contains("strays more than 0.05 mm"));
  EXPECT_LT(count(joined.body, "GOTO/"), whole * 2 / 3);
  EXPECT_TRUE(joined.header("Content-Disposition").contains("\"block-0.05mm.apt\""));
  carved("joined", joined.body, "j.apt");
  const double removed = info().at("removed_volume_mm3");
  EXPECT_NEAR(info("joined").at("removed_volume_mm3"), removed, 0.02 * removed);
  EXPECT_EQ(fault("program.ngc?from=x"), "400 bad_span");
  EXPECT_EQ(fault("program.ngc?to=-1"), "400 bad_span");
  EXPECT_EQ(fault("program.ngc?tolerance_mm=-1"), "400 bad_tolerance_mm");
  EXPECT_EQ(fault("program.ngc?participant=x"), "400 bad_participant");
}

TEST_F(Downloads, ForcesHaveALineForEachMotionAndTheWholeVolume) {
  const auto all = lines(get("forces.csv").body);
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(all[0], "t_s,x,y,z,i,j,k,fx_n,fy_n,fz_n,tx_nmm,ty_nmm,tz_nmm,removed_mm3,imprint_mm3");
  EXPECT_EQ(all.size() - 1, info().at("motions").get<std::size_t>());
  double removed = 0;
  for (std::size_t n = 1; n < all.size(); ++n) removed += numbers(all[n])[13];
  EXPECT_NEAR(removed, info().at("removed_volume_mm3"), 1e-6 * removed);
  const std::string of_ada = "forces.csv?participant=" + std::to_string(participant);
  EXPECT_EQ(lines(get(of_ada).body).size() - 1, 299U);
  const auto felt = lines(get("forces.csv?device_limits=0.01,1e9").body);
  ASSERT_EQ(felt.size(), all.size());
  EXPECT_TRUE(felt[0].starts_with(all[0] + ",felt_fx_n,felt_fy_n,"));
  for (std::size_t n = 1; n < felt.size(); ++n) {
    EXPECT_TRUE(felt[n].starts_with(all[n] + ","));
    const auto row = numbers(felt[n]);
    const double computed = std::hypot(row[7], row[8], row[9]);
    EXPECT_NEAR(std::hypot(row[15], row[16], row[17]), std::min(computed, 0.01), 1e-6);
  }
}

TEST_F(Downloads, ThinWallsNameThePitch) {
  const Json report = get("thin_walls.json").json();
  EXPECT_EQ(report.at("pitch_mm"), 0.5);
  EXPECT_EQ(report.at("count"), report.at("walls").size());
  EXPECT_TRUE(report.at("target").is_null());
}

TEST_F(Downloads, JournalOpensElsewhereWithTheSameHash) {
  const std::string expected = hash();
  std::ofstream(journal("copy"), std::ios::binary) << get("journal").body;
  restart();
  EXPECT_EQ(hash("copy"), expected);
  EXPECT_EQ(hash(), expected);
}

/// A fine cylinder: exports cannot merge the triangles of its side.
class LongDownloads : public WholeServer {
 protected:
  void SetUp() override {
    WholeServer::SetUp();
    const Json rod = {{"shape", "cylinder"},
                      {"center_mm", {0, 0}},
                      {"radius_mm", 20},
                      {"min_z_mm", -40},
                      {"max_z_mm", 0}};
    create("fine", scene_with({{"stock", rod}, {"accuracy", {{"pitch_mm", 0.1}}}}));
  }
  Json exports() { return made("GET", "/v1/sessions/fine/exports").at("exports"); }
  /// Starts a download and waits until the server is writing it.
  Peer begin() {
    Peer peer(port);
    peer.send("GET /v1/sessions/fine/model.obj?error_mm=0 HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_TRUE(eventually([&] { return !exports().empty() || peer.has_input(); }));
    EXPECT_FALSE(peer.has_input()) << "the file was made already";
    return peer;
  }
};

TEST_F(LongDownloads, AreListedWithTheirShares) {
  std::thread client([this] { ask("GET", "/v1/sessions/fine/model.obj?error_mm=0"); });
  Json now;
  EXPECT_TRUE(eventually([&] { return !(now = exports()).empty(); }));
  double share = 0;
  for (; !now.empty(); now = exports()) {
    EXPECT_EQ(now.at(0).at("name"), "model.obj");
    EXPECT_GE(now.at(0).at("share"), share);
    share = now.at(0).at("share");
    EXPECT_LE(share, 1);
  }
  client.join();
  EXPECT_TRUE(exports().empty());
}

TEST_F(LongDownloads, EndWhenTheirClientsAreGone) {
  begin();
  EXPECT_TRUE(eventually([&] { return exports().empty(); }));
  begin();  // it was not completed: another request makes the file again
}

TEST_F(LongDownloads, EndWithTheServer) {
  const Peer peer = begin();
  server.reset();
  EXPECT_FALSE(peer.rest().contains("200 OK"));
}

}  // namespace
}  // namespace kerf::test::downloads_test
