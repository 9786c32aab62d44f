// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>

#include <csignal>

#include "haptic_agent/device/path_cursor.h"
#include "haptic_agent/guides/guide_model.h"
#include "haptic_agent/record/feel_session.h"
#include "haptic_agent/record/mcap_writer.h"
#include "haptic_agent/record/recorded_device.h"
#include "haptic_agent/record/recorder.h"
#include "haptic_agent/record/recording.h"
#include "haptic_agent/record/tick_message.h"
#include "server/store/zstd_pack.h"
#include "server/wire/types.h"
#include "tests/support/eventually.h"
#include "tests/support/test.h"

namespace kerf::agent::record_test {
namespace {

/// A file in a folder for this test.
class RecordTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  std::string file(const char* name = "stroke.mcap") const { return (folder_ / name).string(); }

  std::filesystem::path folder_;
};

/// A stroke along x at 20 mm/s, with all fields different from each other and from zero.
TickRecord tick_at(std::uint64_t n) {
  const auto i = static_cast<double>(n);
  const Wrench felt{{-1, 0.25, 0.5}, {15, 60, 0.125}};
  return {.time_us = 5'000'000 + n * 1000,
          .pose_us = 4'999'700 + n * 1000,
          .answer_age_us = 400 + n,
          .tip_mm = {0.02 * i, 3, -2},
          .axis = {0.6, 0, 0.8},
          .computed = felt * 1.25,
          .requested = felt * 1.125,
          .felt = felt,
          .energy_mj = 17.5,
          .felt_share = 0.8,
          .buttons = wire::kButtonCutting | wire::kButtonDeadman,
          .tool_id = 7,
          .lost = 2,
          .phase = ServoPhase::kActive,
          .trip = TripCode::kSpeed,
          .mode = ForceMode::kPaper,
          .has_pose = true};
}

bool same(const TickRecord& a, const TickRecord& b) {
  return a.time_us == b.time_us && a.pose_us == b.pose_us && a.answer_age_us == b.answer_age_us &&
         a.tip_mm == b.tip_mm && a.axis == b.axis && a.computed == b.computed &&
         a.requested == b.requested && a.felt == b.felt && a.energy_mj == b.energy_mj &&
         a.felt_share == b.felt_share && a.buttons == b.buttons && a.tool_id == b.tool_id &&
         a.lost == b.lost && a.phase == b.phase && a.trip == b.trip && a.mode == b.mode &&
         a.has_pose == b.has_pose;
}

std::expected<Recording, std::string> parse(const std::string& bytes) {
  return parse_recording(std::as_bytes(std::span(bytes)));
}

/// Records ticks as the servo does, and finishes the file.
RecordReport record(const std::string& path, std::uint64_t ticks) {
  auto recorder = Recorder::start(path, {{"session", "demo"}}, "{}");
  EXPECT_TRUE(recorder) << recorder.error();
  for (std::uint64_t n = 0; n < ticks; ++n) (*recorder)->tape().push(tick_at(n));
  return (*recorder)->finish({{"trips", "0"}});
}

TEST(TickMessage, RoundTripsEveryField) {
  mcap::Bytes bytes;
  append_tick(bytes, tick_at(3));
  EXPECT_EQ(bytes.size(), 252U);
  EXPECT_TRUE(same(test::value_of(tick_of(bytes)), tick_at(3)));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(tick_of(std::span(bytes).first(size))) << size;
  }
}

TEST(TickMessage, RejectsUnknownStates) {
  mcap::Bytes bytes;
  append_tick(bytes, tick_at(0));
  for (const std::size_t from_end : {4U, 3U, 2U}) {
    mcap::Bytes changed = bytes;
    changed[changed.size() - from_end] = std::byte{200};
    EXPECT_FALSE(tick_of(changed)) << from_end;
  }
}

TEST_F(RecordTest, ContainsEveryTickAndTheMetadata) {
  constexpr std::uint64_t kTicks = 4321;
  const RecordReport report = record(file(), kTicks);
  EXPECT_EQ(report.ticks, kTicks);
  EXPECT_EQ(report.lost, 0U);
  EXPECT_EQ(report.error, "");
  EXPECT_EQ(report.bytes, std::filesystem::file_size(file()));
  const auto recording = test::value_of(read_recording(file()));
  EXPECT_FALSE(recording.cut_off);
  ASSERT_EQ(recording.ticks.size(), kTicks);
  for (std::uint64_t n = 0; n < kTicks; ++n) {
    ASSERT_TRUE(same(recording.ticks[n], tick_at(n)));
    ASSERT_EQ(recording.ticks[n].number, n + 1);
  }
  EXPECT_EQ(recording.about.at("session"), "demo");
  EXPECT_EQ(recording.end.at("ticks"), "4321");
  EXPECT_EQ(recording.end.at("lost"), "0");
}

TEST_F(RecordTest, FullTapeCountsDroppedTicks) {
  TickTape tape;
  for (std::uint64_t n = 0; n < TickTape::kTicks + 5; ++n) tape.push(tick_at(n));
  EXPECT_EQ(tape.lost(), 5U);
  TickRecord tick;
  ASSERT_TRUE(tape.pop(tick));
  EXPECT_TRUE(same(tick, tick_at(0))) << "the oldest stay";
  EXPECT_EQ(tick.number, 1U);
  tape.push(tick_at(TickTape::kTicks + 5));
  while (tape.pop(tick)) {
  }
  EXPECT_EQ(tick.number, TickTape::kTicks + 6) << "the dropped ones count";
}

TEST_F(RecordTest, NeverOverwritesAFile) {
  record(file(), 10);
  const std::string before = test::content_of(file());
  const auto error = test::error_of(Recorder::start(file(), {}, "{}"));
  EXPECT_EQ(error, file() + " exists; choose another name");
  EXPECT_EQ(test::content_of(file()), before);
}

TEST_F(RecordTest, ReportsWhyAFileCannotBeCreated) {
  const auto error = test::error_of(Recorder::start("/nonexistent/a.mcap", {}, "{}"));
  EXPECT_EQ(error, "cannot create /nonexistent/a.mcap: No such file or directory");
}

TEST_F(RecordTest, FailedWriteIsReportedAndItsTicksAreCounted) {
  // A limit of the file's size simulates a full disk: the write fails likewise.
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{.rlim_cur = 60'000, .rlim_max = before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  const RecordReport report = record(file(), 5000);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(report.error, "cannot write " + file() + ": File too large");
  EXPECT_GT(report.lost, 0U);
  EXPECT_EQ(report.ticks + report.lost, 5000U);
  EXPECT_EQ(test::value_of(read_recording(file())).ticks.size(), report.ticks);
}

TEST_F(RecordTest, KilledProgramLeavesCompleteChunks) {
  {
    auto recorder = test::value_of(Recorder::start(file(), {{"session", "demo"}}, "{}"));
    for (std::uint64_t n = 0; n < 2500; ++n) recorder->tape().push(tick_at(n));
    // Its thread wakes 10 times per second. The destructor writes no more data.
    ASSERT_TRUE(test::eventually([this] { return std::filesystem::file_size(file()) >= 20'000; }));
  }
  const auto recording = test::value_of(read_recording(file()));
  EXPECT_TRUE(recording.cut_off);
  EXPECT_EQ(recording.ticks.size() % 1000, 0U) << "chunks of a second";
  EXPECT_GE(recording.ticks.size(), 1000U);
}

TEST_F(RecordTest, TruncatedFileIsReadUpToItsLastChunk) {
  record(file(), 3000);
  const std::string whole = test::content_of(file());
  std::size_t most = 0;
  for (std::size_t size = 0; size < whole.size(); size += 997) {
    const auto recording = parse(whole.substr(0, size));
    if (!recording) {
      EXPECT_EQ(most, 0U) << recording.error();
      continue;
    }
    EXPECT_TRUE(recording->cut_off) << size;
    EXPECT_GE(recording->ticks.size(), most);
    EXPECT_EQ(recording->ticks.size() % 1000, 0U);
    most = recording->ticks.size();
  }
  EXPECT_EQ(most, 3000U);
}

TEST_F(RecordTest, DamagedBytesAreRejectedOrHarmless) {
  record(file(), 1500);
  const std::string whole = test::content_of(file());
  std::size_t rejected = 0;
  for (std::size_t at = 0; at < whole.size(); at += 211) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    const auto recording = parse(damaged);
    if (!recording) {
      ++rejected;
      continue;
    }
    // Accepted ticks equal the recorded ones, because chunks have a CRC.
    for (std::size_t n = 0; n < recording->ticks.size(); ++n) {
      const std::uint64_t first = (recording->ticks[n].time_us - 5'000'000) / 1000;
      ASSERT_TRUE(same(recording->ticks[n], tick_at(first))) << at;
    }
  }
  EXPECT_GT(rejected, 10U);
}

TEST_F(RecordTest, ChunksOfOtherWritersNeedNotStateTheirSizeInTheFrame) {
  // A frame of Zstandard with one raw block. Its header has no size of the content.
  constexpr std::string_view kFrame("\x28\xB5\x2F\xFD\0\0\x19\0\0abc", 12);
  ZstdPack pack;
  const auto text = test::value_of(pack.unpack(std::as_bytes(std::span(kFrame)), 3));
  EXPECT_TRUE(std::ranges::equal(text, std::as_bytes(std::span(std::string_view("abc")))));
  EXPECT_FALSE(pack.unpack(std::as_bytes(std::span(kFrame)), 2));
  EXPECT_FALSE(pack.unpack(std::as_bytes(std::span(kFrame)), 4));
}

TEST_F(RecordTest, OtherFilesAreRejectedWithTheReason) {
  EXPECT_EQ(parse("no recording").error(), "is no MCAP file");
  EXPECT_EQ(parse(std::string(mcap::kMagic)).error(),
            "has no complete chunk of kerf_msgs/msg/HapticTick messages");
  EXPECT_EQ(read_recording("/nonexistent.mcap").error(),
            "/nonexistent.mcap cannot be read: No such file or directory");
}

TEST_F(RecordTest, ReplaysItsPathExactly) {
  record(file(), 500);
  const auto choice = test::value_of(choose_device_or_recording("replay:" + file()));
  EXPECT_EQ(choice.kind, DeviceKind::kReplay);
  ASSERT_TRUE(choice.script);
  PathCursor path(*choice.script, false);
  for (std::uint64_t n = 0; n < 499; ++n) {
    const PathPoint point = path.at(static_cast<double>(n) * 1e-3);
    EXPECT_NEAR(length(point.tip_mm - tick_at(n).tip_mm), 0, 1e-12);
    EXPECT_EQ(point.tool_id, 7U);
    EXPECT_TRUE(n == 0 || point.cutting);
  }
  EXPECT_EQ(choose_device_or_recording("sim:" + file())->kind, DeviceKind::kSimulated);
  EXPECT_FALSE(choose_device_or_recording("replay:/nonexistent.mcap"));
  EXPECT_TRUE(choose_device_or_recording("sim")) << "other devices as before";
}

TEST_F(RecordTest, TableIsAlsoAPoseList) {
  record(file(), 50);
  std::ostringstream table;
  write_csv(table, *read_recording(file()));
  const auto script = test::value_of(parse_csv_script("table.csv", table.str()));
  ASSERT_EQ(script.size(), 50U);
  EXPECT_EQ(script.back().tip_mm, tick_at(49).tip_mm) << "numbers keep every digit";
  EXPECT_EQ(script.back().tool_id, 7U);
  const std::string text = table.str();
  EXPECT_NE(text.find(",felt_fx_n,"), std::string::npos);
  EXPECT_NE(text.find(",active,tip_too_fast,paper,1\n"), std::string::npos);
  const std::string header = text.substr(0, text.find('\n'));
  const std::string row =
      text.substr(header.size() + 1, text.find('\n', header.size() + 1) - header.size() - 1);
  EXPECT_EQ(std::ranges::count(header, ','), std::ranges::count(row, ','));
}

TEST_F(RecordTest, StrokesHoldTheMeanForceBetweenTheirPoses) {
  Recording recording;
  for (std::uint64_t n = 0; n < 1000; ++n) {
    TickRecord tick = tick_at(n);
    // Two strokes: the tool is lifted between them, and disarmed at the end.
    if (n >= 400 && n < 500) tick.buttons = wire::kButtonDeadman;
    if (n >= 900) tick.phase = ServoPhase::kReady;
    tick.felt = tick.felt * (n % 2 == 0 ? 0.5 : 1.5);
    recording.ticks.push_back(tick);
  }
  const auto stroke = test::value_of(stroke_of(recording));
  const auto& path = std::get<PathGuide>(stroke.shape);
  EXPECT_TRUE(path.stroke);
  ASSERT_EQ(path.paths.size(), 2U);
  EXPECT_EQ(path.paths[0].front().tip_mm, tick_at(0).tip_mm);
  EXPECT_EQ(path.paths[1].front().tip_mm, tick_at(500).tip_mm);
  EXPECT_NEAR(path.paths[1].back().tip_mm.x, tick_at(899).tip_mm.x, kStrokeStepMm);
  Wrench sum;
  for (const GuidePose& pose : path.paths[0]) sum = sum + pose.felt;
  const double mean = sum.force_n.x / static_cast<double>(path.paths[0].size());
  EXPECT_NEAR(mean, -1, 0.05);
  for (std::size_t i = 1; i < path.paths[0].size(); ++i) {
    const double step = length(path.paths[0][i].tip_mm - path.paths[0][i - 1].tip_mm);
    EXPECT_GE(step, kStrokeStepMm - 1e-9);
  }
  for (TickRecord& tick : recording.ticks) tick.phase = ServoPhase::kSafe;
  EXPECT_FALSE(stroke_of(recording));
}

/// A user who holds the device and follows the recorded line at another speed.
class FollowingHand final : public HapticDevice {
 public:
  explicit FollowingHand(double mm_per_s) : mm_per_s_(mm_per_s) {}
  DeviceCapabilities capabilities() const override {
    return {.name = "hand",
            .sensed_dof = 5,
            .actuated_dof = 5,
            .max_force_n = 20,
            .max_torque_nmm = 500,
            .has_deadman = true};
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    const double s = std::max(0.0, static_cast<double>(now_us) * 1e-6 - kRestS);
    const TickRecord start = tick_at(0);
    tip_mm = start.tip_mm + Vec3{mm_per_s_ * s, 0, 0};
    return {.tip_mm = tip_mm,
            .axis = start.axis,
            .buttons = wire::kButtonDeadman,
            .time_us = now_us,
            .valid = true,
            .phase = DevicePhase::kReady};
  }
  void write(const Wrench& wrench) noexcept override { newest = wrench; }
  void stop() noexcept override {}

  static constexpr double kRestS = 1;
  Wrench newest{};
  Vec3 tip_mm{};

 private:
  double mm_per_s_;
};

TEST_F(RecordTest, FollowingAStrokeGivesItsForceAtAnySpeed) {
  Recording recording;
  for (std::uint64_t n = 0; n < 2000; ++n) recording.ticks.push_back(tick_at(n));
  recording.about = {
      {"stock_min_mm", "-30 -30 -20"}, {"stock_max_mm", "30 30 0"}, {"pivot_mm", "60"}};
  const auto place = test::value_of(place_of(recording));
  EXPECT_EQ(place.stock.max_mm, (Vec3{30, 30, 0}));
  for (const double mm_per_s : {10.0, 20.0, 40.0}) {
    FollowingHand hand(mm_per_s);
    const ServoSettings settings =
        settings_for(hand.capabilities(), {.mode = ForceMode::kSilent, .pivot_mm = place.pivot_mm});
    const auto stroke = test::value_of(stroke_of(recording));
    GuideModel guides({stroke}, settings, 1);
    SampleRing samples;
    LatestValue<ServerWrench> wrenches;
    NoSession session(samples, wrenches);
    ServoCycle cycle(hand, samples, wrenches, session, settings, nullptr, &guides);
    int compared = 0;
    for (std::uint64_t now_us = 1000; hand.tip_mm.x < 38; now_us += 1000) {
      cycle.tick(now_us);
      if (hand.tip_mm.x < 8) continue;
      // The guide's damper along the path adds 0.004 N s/mm at most.
      EXPECT_NEAR(length(hand.newest.force_n - tick_at(0).felt.force_n), 0, 0.2) << mm_per_s;
      ++compared;
    }
    EXPECT_GT(compared, 500);
    EXPECT_EQ(cycle.supervisor().trips(), 0U);
    EXPECT_LE(cycle.passivity().account().most_returned_mj(), 1);
  }
}

TEST_F(RecordTest, RecordingWithoutStockAndPivotIsNotPlayed) {
  Recording recording;
  recording.ticks.push_back(tick_at(0));
  recording.about = {{"stock_min_mm", "-30 -30"}, {"stock_max_mm", "30 30 0"}, {"pivot_mm", "60"}};
  EXPECT_FALSE(place_of(recording));
  recording.about["stock_min_mm"] = "-30 -30 nan";
  EXPECT_FALSE(place_of(recording));
}

}  // namespace
}  // namespace kerf::agent::record_test
