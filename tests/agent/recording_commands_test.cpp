// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/recording_commands.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "haptic_agent/record/recorder.h"
#include "haptic_agent/recording_about.h"
#include "server/wire/types.h"
#include "tests/support/test.h"

namespace kerf::agent::recording_commands_test {
namespace {

/// A recording of a stroke of 2 s in a folder for this test.
class RecordingCommands : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    auto recorder = test::value_of(Recorder::start(
        file("stroke.mcap"),
        {{"stock_min_mm", "-30 -30 -20"}, {"stock_max_mm", "30 30 0"}, {"pivot_mm", "60"}}, "{}"));
    for (std::uint64_t n = 0; n < 2000; ++n) {
      recorder->tape().push({.time_us = 1'000'000 + n * 1000,
                             .tip_mm = {0.02 * static_cast<double>(n), 0, -2},
                             .felt = {{-1, 0, 0}, {}},
                             .buttons = wire::kButtonCutting | wire::kButtonDeadman,
                             .tool_id = 1,
                             .phase = ServoPhase::kActive,
                             .has_pose = true});
    }
    recorder->finish({});
  }
  std::string file(const char* name) const { return (folder_ / name).string(); }
  int feel(std::vector<std::string> words) const {
    words.insert(words.begin(), {"feel", file("stroke.mcap"), "--device", "sim"});
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    std::ostringstream out;
    return run_feel(static_cast<int>(argv.size()), argv.data(), out);
  }

  std::filesystem::path folder_;
};

TEST_F(RecordingCommands, InvalidNumbersAreRejected) {
  const auto complaint = [this](const char* option, const char* value) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(feel({option, value}), 2) << option << ' ' << value;
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(complaint("--force-max", "nan"),
            "kerf-agent feel: --force-max: must be a number from 0 to 50\n");
  EXPECT_EQ(complaint("--torque-max", "inf"),
            "kerf-agent feel: --torque-max: must be a number from 0 to 2000\n");
  EXPECT_EQ(complaint("--latency", "21"),
            "kerf-agent feel: --latency: must be a number from 0 to 20\n");
  EXPECT_EQ(complaint("--within", "nan"),
            "kerf-agent feel: --within: must be a number from 0.01 to 100\n");
  EXPECT_EQ(complaint("--stiffness", "-nan"),
            "kerf-agent feel: --stiffness: must be a number from 0.01 to 20\n");
  EXPECT_EQ(complaint("--duration", "nan"),
            "kerf-agent feel: --duration: must be a number from 0.001 to 1000000\n");
}

TEST_F(RecordingCommands, FeelContinuesAfterSigusr1AndEndsAfterSigint) {
  int said[2] = {};
  ASSERT_EQ(::pipe(said), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(said[1], STDERR_FILENO);
    ::close(said[0]);
    // The bound only ends a failed test.
    ::_exit(feel({"--duration", "20"}));
  }
  ::close(said[1]);
  const auto read_until = [&said](const std::string& part) {
    std::string text;
    for (char letter = 0; ::read(said[0], &letter, 1) == 1;) {
      text += letter;
      if (text.ends_with(part)) return true;
    }
    return false;
  };
  ASSERT_TRUE(read_until("press Ctrl-C to leave")) << "signals are handled from here on";
  ::kill(child, SIGUSR1);
  ::kill(child, SIGINT);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ::close(said[0]);
  EXPECT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(RecordingCommands, ExportDoesNotOverwriteATable) {
  std::ofstream(file("table.csv")) << "precious";
  const std::string recording = file("stroke.mcap"), table = file("table.csv");
  const char* words[] = {"export", recording.c_str(), table.c_str()};
  std::ostringstream out;
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_export(3, words, out), 2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "kerf-agent export: " + table + " exists; choose another name\n");
  std::string kept;
  std::ifstream(table) >> kept;
  EXPECT_EQ(kept, "precious");
}

TEST(RecordingAbout, PlayingStatesItsOwnDeviceAndTheRecordedSession) {
  const DeviceCapabilities recorded{.name = "Omega", .max_force_n = 12, .latency_us = 500};
  const DeviceCapabilities own{.name = "Touch", .max_force_n = 3.3, .latency_us = 1000};
  Welcome welcome{.session = "demo", .participant = 4, .stock = {{-1, -2, -3}, {4, 5, 6}}};
  const auto before =
      about_session("Ada", welcome, recorded, settings_for(recorded, {.mode = ForceMode::kPaper}));
  EXPECT_EQ(before.at("device"), "Omega");
  EXPECT_EQ(before.at("name"), "Ada");
  const auto about =
      about_playing(before, "stroke.mcap", own, settings_for(own, {.mode = ForceMode::kSilent}));
  EXPECT_EQ(about.at("device"), "Touch");
  EXPECT_EQ(about.at("device_max_force_n"), "3.3");
  EXPECT_EQ(about.at("device_latency_us"), "1000");
  EXPECT_EQ(about.at("mode"), "silent");
  EXPECT_EQ(about.at("feel_of"), "stroke.mcap");
  EXPECT_EQ(about.at("session"), "demo");
  EXPECT_EQ(about.at("stock_max_mm"), "4 5 6") << "it can be felt again";
  EXPECT_FALSE(about.contains("participant")) << "it has none";
  EXPECT_FALSE(about.contains("name"));
}

}  // namespace
}  // namespace kerf::agent::recording_commands_test
