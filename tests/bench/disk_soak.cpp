// SPDX-License-Identifier: Apache-2.0
// Makes the disk of a real server fail and kills the server at random moments, while four real
// links send samples at 1 kHz that cut fresh stock. Half of the kills come while the disk fails,
// half after it works again. Samples are rejected while it fails. No other sample may be lost:
//   * when the server is killed, its journal has everything that it had acknowledged as durable;
//   * when the agents are back, the journal has every motion that was answered as cut, once;
//   * the server's state hash is that of the motions in the journal, carved by this program.
//
//   disk_soak [--rounds N] [--seed N] [--server PATH]
//
// Prints the totals by fault, and the rejections. Exits with 1 if a motion is lost, cut twice, or a
// hash differs.
#include <fcntl.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "server/convert/sample_pose.h"
#include "server/formats/scene.h"
#include "server/session/hash_text.h"
#include "server/store/journal_reader.h"
#include "tests/bench/disk_faults.h"
#include "tests/bench/journal_copy.h"
#include "tests/bench/line_carver.h"

namespace {

using namespace kerf;
using bench::DiskControl;
using bench::DiskFault;
using bench::LineCarver;
using std::chrono::milliseconds;

constexpr int kRoundsPerSession = 20;
struct NamedFault {
  DiskFault fault;
  const char* name;
};
constexpr std::array<NamedFault, 4> kFaults = {{{DiskFault::kFull, "full"},
                                                {DiskFault::kWriteFails, "write fails"},
                                                {DiskFault::kWritesHalf, "writes half"},
                                                {DiskFault::kSyncFails, "fsync fails"}}};

/// The control that disk_faults.cpp reads in the server.
class Disk {
 public:
  explicit Disk(std::string file) : file_(std::move(file)) {
    const int descriptor = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (descriptor < 0 || ftruncate(descriptor, sizeof(DiskControl)) != 0)
      bench::fail("cannot write " + file_);
    void* memory =
        mmap(nullptr, sizeof(DiskControl), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    close(descriptor);
    if (memory == MAP_FAILED) bench::fail("cannot map " + file_);
    control_ = static_cast<DiskControl*>(memory);
    setenv("KERF_DISK_FAULTS", file_.c_str(), 1);
    setenv("LD_PRELOAD", KERF_DISK_FAULTS_LIBRARY, 1);
  }
  ~Disk() { std::filesystem::remove(file_); }
  Disk(const Disk&) = delete;
  Disk& operator=(const Disk&) = delete;
  void let(DiskFault fault) { control_->fault = fault; }
  std::uint32_t failed_calls() const { return control_->failed_calls; }

 private:
  std::string file_;
  volatile DiskControl* control_ = nullptr;
};

struct Totals {
  int kills = 0;
  std::uint64_t failed_calls = 0, made = 0, cut = 0, not_stored = 0;
  std::uint64_t durable_lost = 0, cut_lost = 0, cut_twice = 0, unequal = 0;
  bool failed() const { return durable_lost + cut_lost + cut_twice + unequal > 0; }
};

/// The motions of a session's journal, and the block carved by them.
class Journal {
 public:
  explicit Journal(std::filesystem::path file) : file_(std::move(file)) {
    const Scene scene = parse_scene(bench::kCarverScene, SceneSource{}).value();
    block_.emplace(Sculpture::create(scene.settings).value());
  }
  /// Reads and carves the records that were added since the last call.
  void read_on(Totals& totals) {
    const bench::JournalCopy copy(file_);
    auto reader = JournalReader::open(copy.file(), RecordOrder::kSequence, {}, next_);
    if (!reader) bench::fail(describe(reader.error()));
    for (;;) {
      auto record = reader->next();
      if (!record) bench::fail(describe(record.error()));
      if (!*record) break;
      next_ = (*record)->sequence + 1;
      if (const auto* move = std::get_if<MoveTool>(&(*record)->command)) {
        if (!ends_[(*record)->participant].insert(key(move->to)).second) ++totals.cut_twice;
      }
      if (const auto command = kernel_command((*record)->command)) block_->apply(*command).value();
    }
  }
  bool has(ParticipantId participant, const ToolPose& end) {
    return ends_[participant].contains(key(end));
  }
  std::string hash() { return hash_text(block_->state_hash()); }

 private:
  using Key = std::array<double, 3>;
  static Key key(const ToolPose& pose) { return {pose.tip_mm.x, pose.tip_mm.y, pose.tip_mm.z}; }

  std::filesystem::path file_;
  std::optional<Sculpture> block_;
  std::uint64_t next_ = 1;
  std::map<ParticipantId, std::set<Key>> ends_;
};

/// A carver and its samples.
struct Hand {
  Hand(int number, std::uint16_t port, const std::string& session)
      : carver(number, port, session) {}
  void take_made(Totals& totals) {
    for (const wire::MotionSample& sample : carver.take_made()) {
      made.push_back(sample);
      ++totals.made;
    }
  }
  /// Returns whether a journal has the motion of a sample. The first sample only positions the
  /// tool.
  bool is_in(Journal& journal, std::uint64_t number) const {
    return number == 1 || journal.has(carver.participant(), to_pose(made.at(number - 1)).value());
  }

  LineCarver carver;
  std::vector<wire::MotionSample> made;
};

class Soak {
 public:
  Soak(const std::string& program, std::uint64_t seed)
      : disk_((std::filesystem::temp_directory_path() /
               ("kerf-disk-faults-" + std::to_string(getpid())))
                  .string()),
        server_(program, {"--snapshot-after", "0.1"}),
        random_(seed) {}

  void run_session(const std::string& id, int rounds) {
    bench::post(server_.port(), "/v1/sessions?id=" + id, bench::kCarverScene);
    Journal journal(server_.folder() / (id + kJournalExtension));
    std::deque<Hand> hands;
    for (int n = 0; n < bench::kCarvers; ++n) hands.emplace_back(n, server_.port(), id);
    wait_until_durable(
        id);  // their joins too: a participant that is not would come back as another
    for (int round = 0; round < rounds; ++round) {
      const std::size_t fault = random_() % kFaults.size();
      Totals& totals = totals_[fault];
      for (Hand& hand : hands) hand.carver.move(true);
      fail_and_kill(kFaults[fault].fault, totals);
      check_durable(journal, hands, totals);
      server_.start();
      wait(200);
      for (Hand& hand : hands) hand.carver.move(false);
      for (Hand& hand : hands) {
        if (!hand.carver.settle()) bench::fail("an agent did not come back");
      }
      wait_until_durable(id);
      check_cut(journal, hands, totals);
      if (info(id, "state_hash") != journal.hash()) ++totals.unequal;
    }
    for (Hand& hand : hands) {
      for (const auto& [code, complaint] : hand.carver.finish().complaints) {
        complaints_[code] += complaint.count;
      }
    }
  }

  bool print() const {
    std::printf("%-12s %6s %8s %9s %9s %10s %8s %8s %6s %8s\n", "the disk", "kills", "failed",
                "samples", "cut", "not on the", "durable", "cut and", "cut", "hash");
    std::printf("%-12s %6s %8s %9s %9s %10s %8s %8s %6s %8s\n", "", "", "calls", "", "", "disk",
                "lost", "lost", "twice", "differs");
    bool failed = false;
    for (std::size_t n = 0; n < kFaults.size(); ++n) {
      const Totals& totals = totals_[n];
      std::printf("%-12s %6d %8llu %9llu %9llu %10llu %8llu %8llu %6llu %8llu\n", kFaults[n].name,
                  totals.kills, print_of(totals.failed_calls), print_of(totals.made),
                  print_of(totals.cut), print_of(totals.not_stored), print_of(totals.durable_lost),
                  print_of(totals.cut_lost), print_of(totals.cut_twice), print_of(totals.unequal));
      failed = failed || totals.failed();
    }
    for (const auto& [code, count] : complaints_)
      std::printf("rejected, %s: %llu\n", code.c_str(), print_of(count));
    return !failed;
  }

 private:
  static unsigned long long print_of(std::uint64_t value) { return value; }
  void wait(unsigned ms_max) { std::this_thread::sleep_for(milliseconds(random_() % ms_max)); }
  std::string info(const std::string& id, const std::string& name) {
    return bench::json_field(bench::get(server_.port(), "/v1/sessions/" + id), name);
  }

  void wait_until_durable(const std::string& id) {
    while (info(id, "journal_lag") != "0") std::this_thread::sleep_for(milliseconds(5));
  }

  void fail_and_kill(DiskFault fault, Totals& totals) {
    wait(300);
    const std::uint32_t failed_before = disk_.failed_calls();
    disk_.let(fault);
    wait(400);
    const bool heals = random_() % 2 == 0;
    if (heals) {
      disk_.let(DiskFault::kNone);
      wait(2000);  // the journal tries again every second
    }
    server_.kill_hard();
    disk_.let(DiskFault::kNone);
    ++totals.kills;
    totals.failed_calls += disk_.failed_calls() - failed_before;
  }

  /// Looks in the journal after the kill for the motions of samples that were acknowledged as
  /// durable.
  static void check_durable(Journal& journal, std::deque<Hand>& hands, Totals& totals) {
    std::this_thread::sleep_for(milliseconds(20));  // answers in transit to the agents
    journal.read_on(totals);
    for (Hand& hand : hands) {
      hand.take_made(totals);
      for (const std::uint64_t number : hand.carver.cut()) {
        if (hand.is_in(journal, number)) continue;
        ++(number <= hand.carver.durable() ? totals.durable_lost : totals.not_stored);
      }
    }
  }

  /// Looks for the motion of each sample that was answered as cut.
  static void check_cut(Journal& journal, std::deque<Hand>& hands, Totals& totals) {
    journal.read_on(totals);
    for (Hand& hand : hands) {
      hand.take_made(totals);
      for (const std::uint64_t number : hand.carver.take_cut()) {
        ++totals.cut;
        if (!hand.is_in(journal, number)) ++totals.cut_lost;
      }
    }
  }

  Disk disk_;
  bench::ServerProcess server_;
  std::mt19937_64 random_;
  std::array<Totals, kFaults.size()> totals_;
  std::map<std::string, std::uint64_t> complaints_;  ///< of the server, by code
};

}  // namespace

int main(int count, char** arguments) {
  std::string program = KERF_SERVER_PROGRAM;
  int rounds = 100;
  std::uint64_t seed = 1;
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string name = arguments[i];
    if (name == "--rounds") rounds = std::atoi(arguments[i + 1]);
    if (name == "--seed") seed = std::strtoull(arguments[i + 1], nullptr, 10);
    if (name == "--server") program = arguments[i + 1];
  }
  Soak soak(program, seed);
  for (int round = 0; round < rounds; round += kRoundsPerSession) {
    soak.run_session("disk" + std::to_string(round), std::min(kRoundsPerSession, rounds - round));
  }
  return soak.print() ? 0 : 1;
}
