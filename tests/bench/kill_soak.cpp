// SPDX-License-Identifier: Apache-2.0
// Kills a real server at random moments while four real links send samples at 1 kHz that cut fresh
// stock, and restarts it on the same journal. After each kill it checks that the journal has what
// the server had acknowledged as durable, and after the agents have come back that the block is
// that of an uninterrupted run.
//
//   kill_soak [--rounds N] [--seed N] [--snapshot-after S] [--server PATH]
//
// The server writes snapshots after S seconds of replay, 0.1 by default, so that most restarts
// begin with one.
// Prints the totals; exits with 1 if anything was lost or cut twice, or a hash differs.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <deque>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "haptic_agent/link/server_link.h"
#include "haptic_agent/realtime/clock.h"
#include "server/convert/sample_pose.h"
#include "server/formats/scene.h"
#include "server/session/hash_text.h"
#include "server/store/journal_reader.h"
#include "tests/bench/live_client.h"

namespace {

using namespace kerf;
using namespace kerf::agent;
using std::chrono::milliseconds;

constexpr int kAgents = 4;
/// A restart replays the journal; a new session keeps it short.
constexpr int kRoundsPerSession = 20;
/// A user whose agent has lost its server stops moving.
constexpr std::uint64_t kUnansweredMax = 2000;
constexpr auto kSettleLimit = std::chrono::seconds(60);

constexpr const char* kScene = R"({"name":"kill",
  "stock":{"shape":"box","min_mm":[-100,-100,-40],"max_mm":[100,100,0]},
  "accuracy":{"rays":"dexel","pitch_mm":0.5,"tolerance_mm":0.01,"motion":"tight"},
  "tools":[{"id":1,"shape":"ball","diameter_mm":6,"length_mm":60}],
  "machine":{"kinematics":"tool-vector"}})";

/// An agent that carves line after line of its own quarter of the block, layer after layer.
class Carver final : public StockListener {
 public:
  Carver(int number, std::uint16_t port, const std::string& session)
      : y_mm_(-97.0 + 50.0 * number),
        link_({.server = {.host = "127.0.0.1", .port = std::to_string(port)},
               .session = session,
               .hello = {.name = "carver " + std::to_string(number), .color = "", .tool_id = 1},
               .traffic = {.copy = this},
               .patience_s = 300,
               .notice = {},
               .failed = {}},
              ring_, wrenches_) {
    link_.start();
    const auto welcome = link_.wait_welcome();
    if (!welcome) bench::fail(welcome.error());
    participant_ = welcome->participant;
    thread_ = std::thread([this] { run(); });
  }
  ~Carver() override {
    stop_.store(true);
    thread_.join();
  }

  void move(bool moving) { moving_.store(moving); }
  /// Waits until the samples made so far are answered.
  bool settle() const {
    const auto end = bench::Clock::now() + kSettleLimit;
    std::this_thread::sleep_for(milliseconds(5));  // a sample that is being made
    while (felt_.load() < made_.load()) {
      if (bench::Clock::now() > end) return false;
      std::this_thread::sleep_for(milliseconds(2));
    }
    return true;
  }
  LinkReport finish() {
    link_.stop(10);
    return link_.report();
  }
  std::uint64_t felt() const { return felt_.load(); }
  std::uint64_t durable() const { return durable_.load(); }
  ParticipantId participant() const { return participant_; }
  /// The poses made since the last call.
  std::vector<wire::MotionSample> take_made() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(samples_, {});
  }

  void take_stock(std::span<const std::byte>) override {}
  void take_result(const wire::Result& result) override {
    felt_.store(std::max(felt_.load(), result.agent_sequence));
    durable_.store(std::max(durable_.load(), result.durable_sequence));
  }
  bool wants_reset() override { return false; }

 private:
  void run() {
    auto next = bench::Clock::now();
    while (!stop_.load()) {
      next = std::max(next + milliseconds(1), bench::Clock::now() - milliseconds(20));
      std::this_thread::sleep_until(next);
      if (!moving_.load() || made_.load() > felt_.load() + kUnansweredMax) continue;
      make_sample();
    }
  }
  void make_sample() {
    constexpr double kStepMm = 0.1, kLineMm = 190, kLinesPerLayer = 40;
    const double along = kStepMm * static_cast<double>(made_.load());
    const double line = std::floor(along / kLineMm), layer = std::floor(line / kLinesPerLayer);
    const double x = along - line * kLineMm;
    // A thread that was late makes several at once; they must not look like a fast motion.
    last_us_ = std::max(last_us_ + 900, monotonic_us());
    // No three samples are on a line, so that a backlog is not shortened.
    const double zigzag = made_.load() % 2 == 0 ? 0.03 : 0;
    const wire::MotionSample sample{
        .time_us = last_us_,
        .tip_mm = {std::fmod(line, 2) == 0 ? x - kLineMm / 2 : kLineMm / 2 - x,
                   y_mm_ + line - layer * kLinesPerLayer + along * 1e-4, -1 - layer - zigzag},
        .tool_id = 1,
        .buttons = wire::kButtonCutting};
    {
      const std::scoped_lock lock(mutex_);
      samples_.push_back(sample);
    }
    made_.fetch_add(1);
    if (!ring_.push(sample)) bench::fail("the ring of samples is full");
    link_.sample_ready();
  }

  double y_mm_;
  std::uint64_t last_us_ = 0;
  SampleRing ring_;
  LatestValue<ServerWrench> wrenches_;
  std::atomic<std::uint64_t> felt_{0}, durable_{0}, made_{0};
  std::atomic<bool> moving_{false}, stop_{false};
  std::mutex mutex_;
  std::vector<wire::MotionSample> samples_;
  ParticipantId participant_ = 0;
  ServerLink link_;
  std::thread thread_;
};

/// The block of an uninterrupted run.
class Reference {
 public:
  Reference() : block_(make()) {}
  void carve(Carver& carver) {
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
    const Scene scene = parse_scene(kScene, SceneSource{}).value();
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

/// How far the journal has the samples of each agent, read from a copy of what the kill left.
std::map<ParticipantId, std::uint64_t> stored(const std::filesystem::path& journal) {
  const std::filesystem::path copy = journal.string() + ".copy";
  remove_journal(copy);
  for (const char* suffix : {"", "-wal"}) {
    std::error_code ignored;
    std::filesystem::copy_file(journal.string() + suffix, copy.string() + suffix, ignored);
  }
  std::map<ParticipantId, std::uint64_t> found;
  const auto reader = JournalReader::open(copy);
  if (!reader) bench::fail(describe(reader.error()));
  for (const JournalParticipant& participant : reader->participants()) {
    found[participant.participant] = participant.agent_sequence;
  }
  remove_journal(copy);
  return found;
}

std::string field(const std::string& json, const std::string& name) {
  const std::size_t at = json.find("\"" + name + "\":");
  if (at == std::string::npos) bench::fail("no " + name + " in " + json);
  const std::size_t start = json.find_first_not_of(" \"", at + name.size() + 3);
  return json.substr(start, json.find_first_of(",\"}", start) - start);
}

void kill_once(bench::ServerProcess& server, const std::filesystem::path& journal,
               std::deque<Carver>& carvers, Totals& totals) {
  const auto start = bench::Clock::now();
  server.kill_hard();
  std::this_thread::sleep_for(milliseconds(20));  // answers in transit to the agents
  const auto found = stored(journal);
  std::uint64_t lost = 0;
  for (const Carver& carver : carvers) {
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
  bench::post(server.port(), "/v1/sessions?id=" + id, kScene);
  const auto journal = server.folder() / (id + kJournalExtension);
  Reference reference;
  std::deque<Carver> carvers;
  for (int n = 0; n < kAgents; ++n) carvers.emplace_back(n, server.port(), id);
  for (int round = 0; round < rounds; ++round) {
    for (Carver& carver : carvers) carver.move(true);
    std::this_thread::sleep_for(milliseconds(50 + random() % 400));
    kill_once(server, journal, carvers, totals);
    std::this_thread::sleep_for(milliseconds(random() % 200));
    for (Carver& carver : carvers) carver.move(false);
    for (Carver& carver : carvers) {
      if (!carver.settle()) bench::fail("an agent did not come back");
      reference.carve(carver);
    }
    const std::string info = bench::get(server.port(), "/v1/sessions/" + id);
    const std::uint64_t motions = std::stoull(field(info, "motions"));
    totals.resent_lost += reference.motions() - std::min(reference.motions(), motions);
    totals.cut_twice += motions - std::min(reference.motions(), motions);
    if (field(info, "state_hash") != reference.hash()) ++totals.unequal;
  }
  totals.motions += reference.motions();
  for (Carver& carver : carvers) {
    const LinkReport report = carver.finish();
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
      totals.kills, kAgents, static_cast<unsigned long long>(totals.motions),
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
