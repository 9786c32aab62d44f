// SPDX-License-Identifier: Apache-2.0
// Kills a real server at random moments while four real links send samples at 1 kHz that cut fresh
// stock, and restarts it on the same journal. After each kill it checks that the journal has
// everything that the server had acknowledged as durable, and after the agents are back that the
// block is that of an uninterrupted run.
//
//   kill_soak [--rounds N] [--seed N] [--snapshot-after S] [--server PATH]
//
// The server writes snapshots after S seconds of replay, 0.1 by default, so that most restarts
// begin with one.
// Prints the totals; exits with 1 if anything was lost or cut twice, or a hash differs.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <thread>

#include "server/convert/sample_pose.h"
#include "server/formats/scene.h"
#include "server/session/hash_text.h"
#include "tests/bench/journal_copy.h"
#include "tests/bench/line_carver.h"

namespace {

using namespace kerf;
using bench::LineCarver;
using std::chrono::milliseconds;

/// A restart replays the journal, which a new session keeps short.
constexpr int kRoundsPerSession = 20;

/// The block of an uninterrupted run.
class Reference {
 public:
  Reference() : block_(make()) {}
  void carve(LineCarver& carver) {
    auto& last = last_[carver.participant()];
    for (const wire::MotionSample& sample : carver.take_made()) {
      const ToolPose pose = to_pose(sample).value();
      if (last) {
        if (!block_.apply(MoveTool{1, *last, pose, 0.001, false})) bench::fail("bad motion");
        ++motions_;
      }
      last = pose;
    }
  }
  std::uint64_t motions() const { return motions_; }
  std::string hash() { return hash_text(block_.state_hash()); }

 private:
  static Sculpture make() {
    const Scene scene = parse_scene(bench::kCarverScene, SceneSource{}).value();
    Sculpture block = Sculpture::create(scene.settings).value();
    for (const auto& [id, tool] : scene.tools) block.apply(DefineTool{id, tool.tool}).value();
    return block;
  }
  Sculpture block_;
  std::map<ParticipantId, std::optional<ToolPose>> last_;
  std::uint64_t motions_ = 0;
};

struct Totals {
  int kills = 0, unequal = 0;
  std::uint64_t motions = 0, not_stored = 0, worst_not_stored = 0;
  std::uint64_t durable_lost = 0, resent_lost = 0, cut_twice = 0, resent = 0, resumed = 0;
  double down_s = 0;
};

void kill_once(bench::ServerProcess& server, const std::filesystem::path& journal,
               std::deque<LineCarver>& carvers, Totals& totals) {
  const auto start = bench::Clock::now();
  server.kill_hard();
  std::this_thread::sleep_for(milliseconds(20));  // answers in transit to the agents
  const auto found = bench::JournalCopy(journal).agent_sequences();
  std::uint64_t lost = 0;
  for (const LineCarver& carver : carvers) {
    const auto at = found.find(carver.participant());
    const std::uint64_t has = at == found.end() ? 0 : at->second;
    lost += carver.felt() - std::min(carver.felt(), has);
    totals.durable_lost += carver.durable() - std::min(carver.durable(), has);
  }
  ++totals.kills;
  totals.not_stored += lost;
  totals.worst_not_stored = std::max(totals.worst_not_stored, lost);
  server.start();
  totals.down_s += std::chrono::duration<double>(bench::Clock::now() - start).count();
}

void run_session(bench::ServerProcess& server, const std::string& id, int rounds,
                 std::mt19937_64& random, Totals& totals) {
  bench::post(server.port(), "/v1/sessions?id=" + id, bench::kCarverScene);
  const auto journal = server.folder() / (id + kJournalExtension);
  Reference reference;
  std::deque<LineCarver> carvers;
  for (int n = 0; n < bench::kCarvers; ++n) carvers.emplace_back(n, server.port(), id);
  for (int round = 0; round < rounds; ++round) {
    for (LineCarver& carver : carvers) carver.move(true);
    std::this_thread::sleep_for(milliseconds(50 + random() % 400));
    kill_once(server, journal, carvers, totals);
    std::this_thread::sleep_for(milliseconds(random() % 200));
    for (LineCarver& carver : carvers) carver.move(false);
    for (LineCarver& carver : carvers) {
      if (!carver.settle()) bench::fail("an agent did not come back");
      reference.carve(carver);
    }
    const std::string info = bench::get(server.port(), "/v1/sessions/" + id);
    const std::uint64_t motions = std::stoull(bench::json_field(info, "motions"));
    totals.resent_lost += reference.motions() - std::min(reference.motions(), motions);
    totals.cut_twice += motions - std::min(reference.motions(), motions);
    if (bench::json_field(info, "state_hash") != reference.hash()) ++totals.unequal;
  }
  totals.motions += reference.motions();
  for (LineCarver& carver : carvers) {
    const agent::LinkReport report = carver.finish();
    totals.resent += report.resent;
    totals.resumed += report.resumed;
    for (const auto& [code, complaint] : report.complaints) {
      std::printf("%s: %s\n", code.c_str(), complaint.first_reason.c_str());
    }
  }
}

}  // namespace

int main(int count, char** arguments) {
  std::string program = KERF_SERVER_PROGRAM;
  int rounds = 100;
  std::uint64_t seed = 1;
  std::string snapshot_after = "0.1";
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string name = arguments[i];
    if (name == "--rounds") rounds = std::atoi(arguments[i + 1]);
    if (name == "--snapshot-after") snapshot_after = arguments[i + 1];
    if (name == "--seed") seed = std::strtoull(arguments[i + 1], nullptr, 10);
    if (name == "--server") program = arguments[i + 1];
  }
  std::mt19937_64 random(seed);
  Totals totals;
  bench::ServerProcess server(program, {"--snapshot-after", snapshot_after});
  for (int round = 0; round < rounds; round += kRoundsPerSession) {
    run_session(server, "kill" + std::to_string(round), std::min(kRoundsPerSession, rounds - round),
                random, totals);
  }
  std::printf(
      "kills                          %d, %d agents at 1 kHz, %llu motions\n"
      "answered, not on the disk      %llu motions, at most %llu at once\n"
      "durable-acknowledged lost      %llu\n"
      "resent                         %llu samples over %llu resumed connections\n"
      "resent lost                    %llu\n"
      "cut twice                      %llu\n"
      "hash differs                   %d of %d\n"
      "down                           %.2f s on average\n",
      totals.kills, bench::kCarvers, static_cast<unsigned long long>(totals.motions),
      static_cast<unsigned long long>(totals.not_stored),
      static_cast<unsigned long long>(totals.worst_not_stored),
      static_cast<unsigned long long>(totals.durable_lost),
      static_cast<unsigned long long>(totals.resent),
      static_cast<unsigned long long>(totals.resumed),
      static_cast<unsigned long long>(totals.resent_lost),
      static_cast<unsigned long long>(totals.cut_twice), totals.unequal, totals.kills,
      totals.down_s / std::max(totals.kills, 1));
  const bool failed =
      totals.durable_lost + totals.resent_lost + totals.cut_twice > 0 || totals.unequal > 0;
  return failed ? 1 : 0;
}
