// SPDX-License-Identifier: Apache-2.0
// The past of a session: undo, points in time, versions, branches, and viewers that look back.
#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "server/maintenance.h"
#include "tests/server/whole/hand.h"
#include "tests/server/whole/watcher.h"
#include "tests/server/whole/whole_server.h"

namespace kerf::test::past_test {
namespace {

using WallClock = std::chrono::system_clock;

/// Formats a time as in RFC 3339.
std::string utc(WallClock::time_point time) {
  const auto us = std::chrono::floor<std::chrono::microseconds>(time.time_since_epoch()).count();
  const std::time_t seconds = us / 1'000'000;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  char text[32], fraction[16];
  (void)std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &parts);
  (void)std::snprintf(fraction, sizeof fraction, ".%06dZ", static_cast<int>(us % 1'000'000));
  return std::string(text) + fraction;
}

class PointsInTime : public WholeServer {
 protected:
  static constexpr const char* kSession = "/v1/sessions/block/";
  Answer get(const std::string& path) const { return ask("GET", kSession + path); }
  std::string fault(const std::string& path) { return error("GET", kSession + path); }
  Json post(const std::string& path) { return made("POST", kSession + path); }
  Json strokes(const std::string& session = "block") {
    return made("GET", "/v1/sessions/" + session + "/strokes").at("strokes");
  }
  static void seek(Watcher& viewer, const Json& fields) {
    Json message = {{"type", "seek"}};
    message.update(fields);
    viewer.send(message);
  }
  /// Waits until a viewer has all tiles of a record. Returns its state hash.
  static std::string reached(Watcher& viewer, std::uint64_t record, double rate = 0) {
    for (;;) {
      const Json state = viewer.settled();
      if (!state.contains("at")) continue;
      if (state.at("at").at("record") == record && state.at("at").at("rate") == rate) {
        return state.at("state_hash");
      }
    }
  }
  /// Waits until a viewer is back in the present.
  static void wait_for_the_present(Watcher& viewer) {
    while (viewer.settled().contains("at")) continue;
  }
};

TEST_F(PointsInTime, StrokesAreUndoneRedoneAndPersisted) {
  auto ada = std::make_unique<Hand>(port), bo = std::make_unique<Hand>(port, "block", "Bo");
  auto eve = std::make_unique<Watcher>(port);
  ada->stroke(0);
  const std::string before = hash();
  bo->stroke(6);
  const std::string after = hash();
  const Json undone = post("undo?participant=" + std::to_string(bo->participant));
  EXPECT_EQ(hash(), before);
  EXPECT_GT(undone.at("returned_mm3"), 100);
  ASSERT_EQ(strokes().size(), 2U);
  EXPECT_EQ(strokes().at(0).at("undone"), false);
  EXPECT_EQ(strokes().at(1).at("undone"), true);
  eve->settled(before);
  ada.reset();
  bo.reset();
  eve.reset();
  restart();
  EXPECT_EQ(hash(), before);
  const std::uint64_t number = undone.at("strokes").at(0);
  const std::string now = get("model.stl").body;
  EXPECT_TRUE(get("model.stl?at=" + undone.at("sequence").dump()).body == now);
  EXPECT_TRUE(get("model.stl?at=" + std::to_string(number - 1)).body == now);
  EXPECT_EQ(fault("model.stl?at=99999"), "404 no_record");
  const std::string one = "redo?strokes=" + std::to_string(number);
  post(one);
  EXPECT_EQ(hash(), after);
  for (const auto& [path, status] : {std::pair<std::string, unsigned>{one, 409},
                                     {"undo?strokes=999999", 409},
                                     {"undo?strokes=x", 400},
                                     {"undo", 400},
                                     {"undo?strokes=1&participant=1", 400}}) {
    EXPECT_EQ(ask("POST", kSession + path).status, status) << path;
  }
  EXPECT_EQ(hash(), after);
}

TEST_F(PointsInTime, HaveTheirBlockAndForces) {
  const auto start = WallClock::now();
  Hand ada(port);
  ada.stroke(0);
  const auto between = WallClock::now() + std::chrono::milliseconds(50);  // record times are
                                                                          // accurate to about 10 ms
  const std::string then = get("model.stl").body;
  while (WallClock::now() <= between + std::chrono::milliseconds(50)) get("strokes");
  ada.stroke(8);
  const std::string now = get("model.stl").body;
  EXPECT_TRUE(then != now);
  EXPECT_TRUE(get("model.stl?at=" + utc(between)).body == then);
  EXPECT_TRUE(get("model.stl?at=" + utc(WallClock::now())).body == now);
  const std::string before = get("model.stl?at=" + utc(start - std::chrono::minutes(1))).body;
  EXPECT_TRUE(before != then && before != now);
  EXPECT_EQ(fault("model.stl?at=" + utc(WallClock::now() + std::chrono::hours(1))),
            "404 no_record");
  EXPECT_EQ(fault("model.stl?at=99999"), "404 no_record");
  EXPECT_EQ(fault("model.stl?at=yesterday"), "404 unknown_version");
  EXPECT_EQ(fault("model.stl?at=a%2Fb"), "400 bad_at");
  EXPECT_EQ(fault("model.stl?at=2026-02-30T00:00:00Z"), "404 unknown_version");
  const std::string motions = get("forces.csv").body;
  const Json plot = get("forces?points=10").json();
  const auto counts = plot.at("motions").get<std::vector<int>>();
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0),
            std::ranges::count(motions, '\n') - 1);
  EXPECT_LE(plot.at("first").size(), 10U);
  const auto most = plot.at("force_n").at("max").get<std::vector<double>>();
  EXPECT_GT(*std::ranges::max_element(most), 0.1);
  for (const auto& [query, answer] : {std::pair{"points=0", "400 bad_points"},
                                      {"points=5001", "400 bad_points"},
                                      {"points=x", "400 bad_points"},
                                      {"from=5&to=4", "400 bad_span"},
                                      {"from=x", "400 bad_span"},
                                      {"participant=x", "400 bad_participant"}}) {
    EXPECT_EQ(fault(std::string("forces?") + query), answer) << query;
  }
}

TEST_F(PointsInTime, ViewersLookBackWhileTheSessionContinues) {
  Hand ada(port);
  Watcher past(port), live(port, {{"name", "Bo"}});
  std::map<std::uint64_t, std::string> hashes;
  for (const double y : {-8, 0, 8}) {
    ada.stroke(y, 80);
    hashes[info().at("state_sequence")] = hash();
  }
  ASSERT_EQ(hashes.size(), 3U);
  past.settled(hash());
  const std::uint64_t first = hashes.begin()->first, second = std::next(hashes.begin())->first,
                      last = hashes.rbegin()->first;
  for (const std::uint64_t record : {second, first, last, first}) {
    seek(past, {{"at", record}});
    EXPECT_EQ(reached(past, record), hashes[record]) << record;
  }
  EXPECT_EQ(past.welcomes, 2);
  EXPECT_EQ(past.tiles.size(), 9U);
  // It plays to the end while Ada continues to carve and the other viewer sees the present.
  ada.stroke(4);
  const std::string now = hash();
  const std::uint64_t end = info().at("state_sequence");
  EXPECT_FALSE(live.settled(now).contains("at"));
  seek(past, {{"rate", 64}});
  EXPECT_EQ(reached(past, end, 64), now);
  ASSERT_EQ(past.tools.size(), 1U);
  EXPECT_EQ(past.tools[0].participant, ada.participant);
  seek(past, {{"at", end - 5}, {"rate", 0.25}});
  EXPECT_EQ(reached(past, end, 0.25), now);
  // Back in the present it has the same tiles as a new viewer.
  seek(past, {{"at", first}});
  reached(past, first);
  seek(past, {{"at", "live"}});
  wait_for_the_present(past);
  EXPECT_EQ(past.last.at("state_hash"), now);
  Watcher fresh(port);
  fresh.settled(now);
  ASSERT_EQ(past.tiles.size(), fresh.tiles.size());
  for (const auto& [place, tile] : fresh.tiles) EXPECT_TRUE(past.tiles[place].mesh == tile.mesh);
  EXPECT_EQ(live.welcomes, 1);
}

TEST_F(PointsInTime, ProgramsAreSentAgainAfterEachSeek) {
  const Json program =
      upload("G21 G90 G94\nT2 M6\nG0 X0 Y0 Z5\nG1 Z-2 F3000\nM2\n", "pace=fast&name=p.ngc");
  wait_for(program, "finished");
  Watcher eve(port);
  EXPECT_EQ(eve.receive("programs").at("programs").size(), 1U);
  for (const Json& at : {Json(1), Json("live")}) {
    seek(eve, {{"at", at}});
    eve.receive("welcome");
    EXPECT_EQ(eve.receive("programs").at("programs").size(), 1U) << at;
  }
}

TEST_F(PointsInTime, ImpossibleSeeksAreRejected) {
  Hand(port).stroke(0);
  std::vector<std::unique_ptr<Watcher>> viewers;
  for (int n = 0; n < 5; ++n) viewers.push_back(std::make_unique<Watcher>(port));
  Watcher &first = *viewers.front(), &last = *viewers.back();
  for (const Json& fields : {Json{{"at", 9999}}, Json{{"rate", 1}}, Json{{"at", "then"}},
                             Json{{"at", 1}, {"rate", 99}}}) {
    seek(first, fields);
    EXPECT_EQ(first.receive("error").at("code"), "bad_message") << fields;
  }
  EXPECT_EQ(first.welcomes, 1);
  for (int n = 0; n < 4; ++n) {
    seek(*viewers[n], {{"at", 1}});
    reached(*viewers[n], 1);
  }
  seek(last, {{"at", 1}});
  EXPECT_EQ(last.receive("error").at("code"), "busy");
  seek(first, {{"at", 9999}});
  EXPECT_EQ(first.receive("error").at("code"), "bad_message");
  seek(first, {{"at", "live"}});
  wait_for_the_present(first);
  seek(last, {{"at", 1}});
  reached(last, 1);
}

TEST_F(PointsInTime, VersionAndItsBranchSurviveARestart) {
  const std::string untouched = hash();
  auto ada = std::make_unique<Hand>(port);
  ada->stroke(0);
  const Json version = post("versions?name=one+stroke");
  const std::string then = hash();
  ada->stroke(8);
  post("undo?participant=" + std::to_string(ada->participant));
  const std::string now = hash();
  const Json parent = made("POST", "/v1/sessions?id=other&from=block@one+stroke").at("parent");
  EXPECT_EQ(parent.at("session"), "block");
  EXPECT_EQ(parent.at("record"), version.at("record"));
  EXPECT_EQ(hash("other"), then);
  auto bo = std::make_unique<Hand>(port, "other", "Bo");
  bo->stroke(-8);
  const std::string carved = hash("other");
  EXPECT_EQ(hash(), now);
  EXPECT_EQ(strokes().at(0), strokes("other").at(0));
  const std::uint64_t shared = strokes().at(0).at("id"), own = strokes("other").at(1).at("id");
  ada.reset();
  bo.reset();
  server.reset();
  const auto replayed = [&](const std::string& session, const std::vector<std::uint64_t>& without) {
    testing::internal::CaptureStdout();
    EXPECT_EQ(without.empty() ? replay_journal(journal(session))
                              : replay_without(journal(session), without),
              0);
    const std::string text = testing::internal::GetCapturedStdout();
    return text.substr(text.find("hash ") + 5, 16);
  };
  EXPECT_EQ(replayed("block", {shared}), untouched);
  EXPECT_EQ(replayed("other", {own}), then);
  EXPECT_EQ(replayed("other", {shared, own}), untouched);
  EXPECT_EQ(replay_without(journal(), {99'999}), 1);
  EXPECT_EQ(replayed("block", {}), now);
  EXPECT_EQ(replayed("other", {}), carved);
  start();
  EXPECT_EQ(hash(), now);
  EXPECT_EQ(hash("other"), carved);
  EXPECT_EQ(info("other").at("parent"), parent);
  EXPECT_EQ(get("versions").json().at("versions").at(0).at("name"), "one stroke");
  EXPECT_TRUE(get("model.stl?at=one+stroke").header("ETag").contains(then));
  EXPECT_EQ(fault("model.stl?at=two"), "404 unknown_version");
}

}  // namespace
}  // namespace kerf::test::past_test
