// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/options.h"

#include <nlohmann/json.hpp>

#include "haptic_agent/run_agent.h"
#include "haptic_agent/summary.h"
#include "haptic_agent/wrapped_help.h"
#include "tests/support/test.h"

namespace kerf::agent::options_test {
namespace {

std::expected<Options, EarlyExit> read(std::vector<const char*> words) {
  words.insert(words.begin(), "kerf-agent");
  return read_options(static_cast<int>(words.size()), words.data());
}

TEST(Options, ParsesACompleteCommandLine) {
  const auto options =
      test::value_of(read({"--server", "http://127.0.0.1:9", "--session", "demo", "--device", "sim",
                           "--name", "Ada", "--color", "#a0B1c2", "--tool", "2", "--duration",
                           "1.5", "--loop", "--force-max", "3", "--udp"}));
  EXPECT_EQ(options.link.server, (ServerUrl{"127.0.0.1", "9"}));
  EXPECT_EQ(options.link.hello.tool_id, 2U);
  EXPECT_EQ(options.limits.force_n, 3.0);
  EXPECT_TRUE(options.device_options.loop);
  EXPECT_TRUE(options.link.hello.udp);
}

TEST(Options, SoundHasADeviceIfRequested) {
  const auto sound = [](std::vector<const char*> words) {
    words.insert(words.begin(), {"--session", "demo", "--device", "sim"});
    const auto options = read(std::move(words));
    return options ? options->sound : "rejected";
  };
  EXPECT_EQ(sound({}), "");
  EXPECT_EQ(sound({"--sound"}), "default");
  EXPECT_EQ(sound({"--sound", "--view"}), "default");
  EXPECT_EQ(sound({"--sound", "hw:0"}), "hw:0");
}

TEST(Options, HelpIsNotAnError) { EXPECT_EQ(test::error_of(read({"--help"})).code, 0); }

TEST(Options, HelpListsTheModesByTheirNames) {
  testing::internal::CaptureStdout();
  ASSERT_FALSE(read({"--help"}));
  const std::string help = testing::internal::GetCapturedStdout();
  EXPECT_NE(help.find("{model,interpolated,hold,paper}"), std::string::npos) << help;
  EXPECT_EQ(help.find("->"), std::string::npos) << "no numbers of an enumeration\n" << help;
  EXPECT_EQ(help.find("model,interpolated,hold,paper} OR"), std::string::npos) << help;
  for (const char* part : {"UINT", "FLOAT", "INT in", "{false}", "e+0"}) {
    EXPECT_EQ(help.find(part), std::string::npos) << part << " is no word for a user\n" << help;
  }
  EXPECT_NE(help.find("kerf-agent doctor --help"), std::string::npos);
  EXPECT_NE(help.find("sim: a simulated hand that carves a figure;\n"), std::string::npos) << help;
}

TEST(Options, HelpFitsATerminalOf80Columns) {
  testing::internal::CaptureStdout();
  ASSERT_FALSE(read({"--help"}));
  std::istringstream help(testing::internal::GetCapturedStdout());
  for (std::string line; std::getline(help, line);) {
    const auto columns =
        std::ranges::count_if(line, [](unsigned char c) { return (c & 0xC0) != 0x80; });
    EXPECT_LE(columns, 80) << line;
  }
}

TEST(Options, ModeIsOneOfTheFourNames) {
  const auto mode = [](const char* name) {
    const auto options = read({"--session", "demo", "--device", "sim", "--mode", name});
    return options ? std::optional(options->mode) : std::nullopt;
  };
  EXPECT_EQ(read({"--session", "demo", "--device", "sim"})->mode, ForceMode::kModel);
  EXPECT_EQ(mode("model"), ForceMode::kModel);
  EXPECT_EQ(mode("interpolated"), ForceMode::kInterpolated);
  EXPECT_EQ(mode("hold"), ForceMode::kHold);
  EXPECT_EQ(mode("paper"), ForceMode::kPaper);
  EXPECT_EQ(mode("silent"), std::nullopt);
  EXPECT_EQ(mode("2"), std::nullopt) << "a number of the enumeration is no name";
}

TEST(Options, ReplicaIsKeptUnlessDeclined) {
  EXPECT_TRUE(read({"--session", "demo", "--device", "sim"})->keep_copy);
  EXPECT_TRUE(read({"--session", "demo", "--device", "sim", "--copy"})->keep_copy);
  EXPECT_FALSE(read({"--session", "demo", "--device", "sim", "--no-copy"})->keep_copy);
  EXPECT_FALSE(read({"--session", "demo", "--device", "sim"})->always_cut);
  EXPECT_TRUE(read({"--session", "demo", "--device", "sim", "--always-cut"})->always_cut);
}

TEST(Options, LatencyIsInMilliseconds) {
  const auto options =
      test::value_of(read({"--session", "demo", "--device", "usb", "--latency", "4.5"}));
  EXPECT_EQ(options.latency_us, 4500U);
  EXPECT_FALSE(read({"--session", "demo", "--device", "usb", "--latency", "21"}));
}

TEST(Options, InvalidInputExitsWithTwo) {
  const std::vector<std::vector<const char*>> lines = {
      {},
      {"--session", "demo"},
      {"--session", "demo", "--device", "usb:zz"},
      {"--session", "a/b", "--device", "sim"},
      {"--session", "demo", "--device", "sim", "--color", "red"},
      {"--session", "demo", "--device", "sim", "--tool", "0"},
      {"--session", "demo", "--device", "sim", "--tool", "1.5"},
      {"--session", "demo", "--device", "sim", "--cpu", "-1"},
      {"--session", "demo", "--device", "sim", "--mode", "fast"},
      {"--session", "demo", "--device", "sim", "--force-max", "-1"},
      {"--session", "demo", "--device", "sim", "--force-max", "nan"},
      {"--session", "demo", "--device", "sim", "--duration", "nan"},
      {"--session", "demo", "--device", "sim", "--server", "ftp://x"},
      {"--session", "demo", "--device", "replay:/no/such/file.apt"},
      {"--session", "demo", "--device", "sim", "--nonsense"}};
  for (const auto& line : lines) {
    EXPECT_EQ(test::error_of(read(line)).code, 2);
  }
}

TEST(Options, ErrorsSuggestTheCorrectInput) {
  const auto complaint = [](std::vector<const char*> words) {
    testing::internal::CaptureStderr();
    EXPECT_FALSE(read(std::move(words)));
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(complaint({}),
            "kerf-agent: --session is required; kerf-agent --help lists the options\n");
  EXPECT_EQ(complaint({"--session", "a", "--device", "sim", "--mode", "fast"}),
            "kerf-agent: --mode: must be model, interpolated, hold or paper\n");
  EXPECT_EQ(complaint({"--session", "a", "--device", "sim", "--tool", "0"}),
            "kerf-agent: --tool: must be a whole number from 1 to 1000000000\n");
  EXPECT_EQ(complaint({"--session", "a", "--device", "sim", "--cpu", "1.5"}),
            "kerf-agent: --cpu: must be a whole number from 0 to 1023\n");
}

TEST(Options, StudyRejectsIncompatibleOptions) {
  const auto complaint = [](std::vector<const char*> words) {
    words.insert(words.begin(), {"--session", "a", "--device", "sim", "--study", "s.csv"});
    testing::internal::CaptureStderr();
    const auto options = read(std::move(words));
    const std::string said = testing::internal::GetCapturedStderr();
    return options ? "accepted" : said;
  };
  EXPECT_EQ(complaint({"--mode", "hold"}),
            "kerf-agent: --study: it compares the modes paper and model; leave --mode hold out\n");
  EXPECT_EQ(complaint({"--mode", "interpolated"}),
            "kerf-agent: --study: it compares the modes paper and model; leave --mode interpolated "
            "out\n");
  EXPECT_EQ(complaint({"--no-copy"}),
            "kerf-agent: --study: both of its modes need the replica of the block; leave --no-copy "
            "out\n");
  EXPECT_EQ(complaint({"--view"}),
            "kerf-agent: --study: it uses the terminal for its questions; leave --view out\n");
  EXPECT_EQ(complaint({"--device", "usb"}),
            "kerf-agent: --study: it is for one device; name a single --device\n");
  EXPECT_EQ(complaint({"--mode", "paper"}), "accepted");
  EXPECT_EQ(complaint({}), "accepted");
}

TEST(Options, ProfileRequiresASingleDevice) {
  const std::string file = std::filesystem::path(testing::TempDir()) / "one_device.profile";
  ASSERT_TRUE(write_profile(file, {.device = "pen", .latency_us = 1500}));
  const auto read_with = [&file](std::vector<const char*> words) {
    words.insert(words.begin(), {"--session", "a", "--device", "sim", "--profile", file.c_str()});
    return read(std::move(words));
  };
  const auto one = test::value_of(read_with({}));
  EXPECT_EQ(one.profile->device, "pen");
  testing::internal::CaptureStderr();
  EXPECT_FALSE(read_with({"--device", "usb"}));
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "kerf-agent: --profile: it describes one device, and several are named; start one "
            "kerf-agent for each device, with its own profile\n");
}

TEST(RunAgent, ExitsWithOneWhenTheServerCannotBeReached) {
  auto options = test::value_of(read({"--server", "http://127.0.0.1:1", "--session", "demo",
                                      "--device", "sim", "--patience", "0"}));
  EXPECT_EQ(run_agent(options), 1);
}

TEST(WrappedHelp, BreaksBetweenWordsAndKeepsTheLinesOfAList) {
  const std::string word(kHelpTextColumns - 4, 'x');
  EXPECT_EQ(wrapped("a " + word + " bcd"), "a " + word + "\nbcd");
  EXPECT_EQ(wrapped("one:\ntwo three\nfour"), "one:\ntwo three\nfour");
  EXPECT_EQ(wrapped(""), "");
}

TEST(Summary, JsonHasTheFieldsUsedByTests) {
  Summary summary{.welcome = {.session = "demo"}, .cycles = {.ticks = 10, .lost = 2}};
  summary.link.complaints["too_fast"] = {.count = 3, .first_reason = "why"};
  const auto json = nlohmann::json::parse(summary_json(summary));
  EXPECT_EQ(json["servo"]["due"], 12);
  EXPECT_EQ(json["link"]["errors"]["too_fast"]["count"], 3);
  for (const char* field : {"results", "unanswered", "answer_us", "ping_us"}) {
    EXPECT_TRUE(json["link"].contains(field)) << field;
  }
  EXPECT_TRUE(json["force"].contains("max_n"));
  EXPECT_EQ(json["force"]["felt"]["ticks"], 0);
  EXPECT_EQ(json["link"]["udp"]["carries"], false);
}

TEST(Summary, FailsWithTheLinkTheRecordingOrTheStudy) {
  Summary summary;
  EXPECT_TRUE(succeeded(summary));
  summary.study.file = "s.csv";
  summary.study.error = "cannot write s.csv";
  EXPECT_FALSE(succeeded(summary));
  EXPECT_EQ(nlohmann::json::parse(summary_json(summary))["study"]["error"], "cannot write s.csv");
  std::ostringstream out;
  print_summary(out, summary);
  EXPECT_NE(out.str().find("0 named Kerf's loop: cannot write s.csv\n"), std::string::npos)
      << out.str();
  summary.study = {};
  summary.record.error = "cannot write r.mcap";
  EXPECT_FALSE(succeeded(summary));
  summary.record = {};
  summary.link.failure = "lost";
  EXPECT_FALSE(succeeded(summary));
}

TEST(Summary, ComparesFeltAndComputedForceAndTorque) {
  Summary summary;
  for (int i = 0; i < 2; ++i) {
    summary.servo.felt.add({{0, 0, 3}, {0, 15, 0}}, {{0, 0, 12}, {0, 60, 0}}, 0.25);
  }
  std::ostringstream out;
  print_summary(out, summary);
  for (const char* part : {"force 3.00 of 12.00 N in the mean, 3.00 of 12.00 N at most",
                           "torque 15.00 of 60.00 N·mm in the mean", "differs by 75.00 % rms",
                           "reduced in 2 of 2 ticks"}) {
    EXPECT_NE(out.str().find(part), std::string::npos) << part << " in\n" << out.str();
  }
  const auto json = nlohmann::json::parse(summary_json(summary))["force"]["felt"];
  EXPECT_EQ(json["force_n"]["computed_mean"], 12);
  EXPECT_EQ(json["torque_nmm"]["felt_max"], 15);
  EXPECT_NEAR(json["torque_nmm"]["rms_error"].get<double>(), 0.75, 1e-12);
}

TEST(Summary, ReportsCutsSoftenedBecauseTheyShookTheTool) {
  const auto printed = [](const ServoReport& servo) {
    Summary summary{.servo = servo};
    std::ostringstream out;
    print_summary(out, summary);
    return out.str();
  };
  EXPECT_EQ(printed({}).find("shook"), std::string::npos);
  const std::string text = printed({.soft_ticks = 40, .softest_mm_per_n = 7.34});
  EXPECT_NE(text.find("in 40 ticks the cut shook the tool"), std::string::npos) << text;
  EXPECT_NE(text.find("over up to 7.3 mm per N"), std::string::npos) << text;
}

TEST(Summary, PrintsUdpCountersIfUdpWasRequested) {
  const auto printed = [](const UdpReport& udp) {
    Summary summary{.link = {.udp = udp}};
    std::ostringstream out;
    print_summary(out, summary);
    return out.str();
  };
  EXPECT_EQ(printed({}).find("udp"), std::string::npos);
  EXPECT_NE(printed({.asked = true}).find("the server has no UDP transport"), std::string::npos);
  const std::string text =
      printed({.asked = true, .offered = true, .carries = true, .taken_over = 2, .lost = 7});
  EXPECT_NE(text.find("switched to UDP 2 times"), std::string::npos) << text;
  EXPECT_NE(text.find("7 lost"), std::string::npos) << text;
}

}  // namespace
}  // namespace kerf::agent::options_test
