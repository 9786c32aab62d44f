// SPDX-License-Identifier: Apache-2.0
// kerf-carve ends after SIGINT and SIGTERM in every phase of long work and leaves no file. Each
// test waits until the program itself shows the phase (its progress on a terminal, or the file that
// it writes) and then sends the signal. The jobs take far longer than the test may.
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::carve_stop_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kLookMs = 5;

// A process on a terminal of its own, so that it shows its progress.
class Process {
 public:
  Process(const fs::path& folder, std::vector<std::string> words) {
    words.insert(words.begin(), "kerf-carve");
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    id_ = ::forkpty(&terminal_, nullptr, nullptr, nullptr);
    if (id_ != 0) return;
    if (::chdir(folder.c_str()) != 0) ::_exit(9);
    ::execv(KERF_CARVE, argv.data());
    ::_exit(9);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process() {
    if (!ended_) {
      ::kill(id_, SIGKILL);
      ::waitpid(id_, nullptr, 0);
    }
    ::close(terminal_);
  }

  // Waits until `reached` holds. Returns false if the process ends first.
  template <class Reached>
  bool wait_until(Reached&& reached) {
    while (!reached(shown_))
      if (!listen()) return false;
    return true;
  }
  void signal(int number) const { ::kill(id_, number); }
  // Returns the exit status, or -1 if a signal ended the process.
  int end() {
    while (listen()) continue;
    int status = 0;
    ::waitpid(id_, &status, 0);
    ended_ = true;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  const std::string& shown() const { return shown_; }

 private:
  // Reads the terminal output. Returns false at the end of the process.
  bool listen() {
    pollfd ready{terminal_, POLLIN, 0};
    if (::poll(&ready, 1, kLookMs) <= 0) return true;
    char text[4096];
    const auto count = ::read(terminal_, text, sizeof text);
    if (count > 0) shown_.append(text, std::size_t(count));
    return count > 0;
  }

  int terminal_ = -1;
  pid_t id_ = -1;
  bool ended_ = false;
  std::string shown_;
};

class CarveStop : public testing::Test {
 protected:
  void SetUp() override {
    write("scene.json",
          R"({"stock": {"shape": "box", "min_mm": [0,0,0], "max_mm": [100,100,10]},
              "accuracy": {"pitch_mm": 1, "tolerance_mm": 0.01}, "tools": [
              {"id": 1, "shape": "cone_end", "diameter_mm": 400, "tip_angle_deg": 170,
               "length_mm": 400},
              {"id": 2, "shape": "bull_nose", "diameter_mm": 10, "corner_radius_mm": 2,
               "length_mm": 30}],
              "machine": {"kinematics": "tool-vector"}})");
    // One plunge of a flat cone: millions of triangles, none of which can be merged.
    write("cone.ngc", "G21 G90 T1 M6\nG0 X50 Y50 Z100 I0 J0 K1\nG1 Z2 F600\nM2\n");
    std::string turns = "G21 G90 T2 M6\nF1000\nG0 X50 Y50 Z8 I0 J0 K1\n";
    for (int n = 0; n < 400; ++n)
      turns += "G1 X" + std::to_string(10 + n % 80) + " Y" + std::to_string(10 + n / 80) +
               (n % 2 == 0 ? " I0.1 J0.1 K1\n" : " I0 J0 K1\n");
    write("turns.ngc", turns + "M2\n");
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_.path()))
      names.push_back(entry.path().filename().string());
    std::ranges::sort(names);
    return names;
  }
  // Whether a temporary file of this name has content.
  bool is_written(const std::string& name) const {
    for (const auto& entry : fs::directory_iterator(folder_.path())) {
      std::error_code error;
      if (entry.path().filename().string().starts_with(name + ".part") &&
          entry.file_size(error) > 0 && !error)
        return true;
    }
    return false;
  }
  // Sends the signal when the process shows the phase; expects its exit status and no output file.
  void expect_stop(const std::vector<std::string>& words, const std::string& phase, int number,
                   int status, const std::string& message = "interrupted") const {
    const std::vector<std::string> before = files();
    Process process(folder_.path(), words);
    ASSERT_TRUE(process.wait_until([&](const std::string& shown) {
      return shown.find(phase) != std::string::npos;
    })) << process.shown();
    process.signal(number);
    EXPECT_EQ(process.end(), status) << process.shown();
    EXPECT_THAT(process.shown(), HasSubstr(message));
    EXPECT_EQ(files(), before);
  }

  test::TemporaryFolder folder_;
};

TEST_F(CarveStop, WhileAMeshStockIsDexelized) {
  // A box as a mesh, none of whose tiles is stored: long work without memory. The kernel cannot be
  // stopped.
  std::ofstream obj(folder_ / "box.obj");
  for (int n = 0; n < 8; ++n)
    obj << "v " << (n & 1) * 100 << ' ' << (n >> 1 & 1) * 100 << ' ' << (n >> 2) * 10 << '\n';
  obj << "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\n"
         "f 1 7 3\nf 2 4 8\nf 2 8 6\n";
  obj.close();
  write("mesh.json",
        R"({"stock": {"shape": "mesh", "file": "box.obj"}, "accuracy": {"pitch_mm": 0.0062},
            "tools": [{"id": 1, "shape": "ball", "diameter_mm": 4, "length_mm": 20}],
            "machine": {"kinematics": "tool-vector"}})");
  expect_stop({"--scene", "mesh.json", "--program", "cone.ngc", "--stl", "m.stl"},
              "preparing the stock", SIGINT, 130, "abandoned");
}

TEST_F(CarveStop, WhileCutting) {
  expect_stop({"--scene", "scene.json", "--program", "turns.ngc", "--pitch", "0.05", "--forces",
               "f.csv", "--threads", "1"},
              "carving", SIGTERM, 143);
}

TEST_F(CarveStop, WhileASurfaceIsSimplified) {
  expect_stop({"--scene", "scene.json", "--program", "cone.ngc", "--pitch", "0.05", "--stl",
               "m.stl", "--forces", "f.csv", "--triangles", "1000"},
              "measuring", SIGTERM, 143);
}

TEST_F(CarveStop, WhileModelsAreWritten) {
  for (const char* format : {"stl", "glb", "3mf", "ply", "obj"}) {
    const std::string name = std::string("m.") + format;
    const std::vector<std::string> before = files();
    Process process(folder_.path(), {"--scene", "scene.json", "--program", "cone.ngc", "--pitch",
                                     "0.05", std::string("--") + format, name, "--threads", "1"});
    ASSERT_TRUE(process.wait_until([&](const std::string&) { return is_written(name); }))
        << process.shown();
    process.signal(SIGINT);
    EXPECT_EQ(process.end(), 130) << format;
    EXPECT_EQ(files(), before) << format;
  }
}

TEST_F(CarveStop, TradeoffPrintsTheRowsThatItHas) {
  const std::vector<std::string> before = files();
  Process process(folder_.path(), {"tradeoff", "--scene", "scene.json", "--program", "turns.ngc",
                                   "--pitches", "2,0.1", "--rays", "dexel", "--motions", "tight",
                                   "--tolerances", "0.1", "--samples", "100", "--csv", "t.csv"});
  ASSERT_TRUE(process.wait_until([](const std::string& shown) {
    return shown.find("pitch 0.1") != std::string::npos;
  })) << process.shown();
  process.signal(SIGINT);
  EXPECT_EQ(process.end(), 130);
  EXPECT_THAT(process.shown(), HasSubstr("surface max"));
  EXPECT_THAT(process.shown(), HasSubstr("\n*  dexel     tight          2"));
  EXPECT_THAT(process.shown(), HasSubstr("pitch 0.1 tolerance 0.1: skipped, interrupted"));
  EXPECT_EQ(files(), before);
}

TEST_F(CarveStop, TradeoffStopsARowThatExceedsItsBudget) {
  Process process(folder_.path(),
                  {"tradeoff", "--scene", "scene.json", "--program", "turns.ngc", "--pitches",
                   "2,0.02", "--rays", "dexel", "--motions", "tight", "--tolerances", "0.1",
                   "--samples", "100", "--budget-seconds", "8"});
  EXPECT_EQ(process.end(), 0);
  EXPECT_THAT(process.shown(), HasSubstr("tolerance 0.1: stopped, --budget-seconds allows"));
}

}  // namespace
}  // namespace kerf::carve_stop_test
