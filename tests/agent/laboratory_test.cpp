// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/laboratory.h"

#include "haptic_agent/device/replay.h"
#include "haptic_agent/realtime/clock.h"
#include "haptic_agent/record/feel_session.h"
#include "tests/support/test.h"

namespace kerf::agent::laboratory_test {
namespace {

/// A cycle that does not run, and a folder for this test.
class LaboratoryTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    options_.record_file = (folder_ / "stroke.mcap").string();
    options_.study_file = (folder_ / "study.csv").string();
  }
  /// Returns the error. Empty on success.
  std::string start() {
    const auto laboratory =
        Laboratory::start(options_, {}, device_, {}, cycle_, loop_, [](const std::string&) {});
    return laboratory ? "" : laboratory.error();
  }

  std::filesystem::path folder_;
  Options options_;
  DeviceCapabilities device_{.name = "pen", .max_force_n = 6};
  Replay replay_{PathCursor(PoseScript{{.tip_mm = {}}}, false)};
  SampleRing samples_;
  LatestValue<ServerWrench> wrenches_;
  NoSession session_{samples_, wrenches_};
  ServoCycle cycle_{replay_, samples_, wrenches_, session_, {}};
  MonotonicClock clock_;
  ServoLoop loop_{clock_};
};

TEST_F(LaboratoryTest, FailedStudyLeavesNoRecording) {
  std::ofstream(options_.study_file) << "an earlier study";
  EXPECT_EQ(start(), "no study: " + options_.study_file + " exists; choose another name");
  EXPECT_FALSE(std::filesystem::exists(options_.record_file));
}

TEST_F(LaboratoryTest, FailedRecordingLeavesNoEmptyStudy) {
  std::ofstream(options_.record_file) << "an earlier recording";
  EXPECT_EQ(start(), "no recording: " + options_.record_file + " exists; choose another name");
  EXPECT_FALSE(std::filesystem::exists(options_.study_file));
}

TEST_F(LaboratoryTest, StudyNeedsADeviceWithMotors) {
  device_.max_force_n = 0;
  EXPECT_EQ(start(),
            "no study: the pen has no motors, so that both loops feel the same; choose a device "
            "that gives forces");
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

}  // namespace
}  // namespace kerf::agent::laboratory_test
