// SPDX-License-Identifier: Apache-2.0
// Options of kerf-server: from the command line, a file and the environment.
#include "server/command_line.h"

#include <unistd.h>

#include "server/log/log.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::command_line_test {
namespace {

using testing::ElementsAre;
using Words = std::vector<std::string>;

class CommandLineTest : public testing::Test {
 protected:
  struct Outcome {
    std::optional<CommandLine> line;
    int status = 0;  ///< exit status if the program ends without a message
    std::string said;
    std::string address() const { return line ? line->server.address : ""; }
  };
  void TearDown() override { log::open(); }

  /// Parses command-line words and, if `text` is not empty, a file of options.
  Outcome read(Words words, const std::string& text = "",
               const std::map<std::string, std::string>& environment = {}) {
    words.insert(words.begin(), "kerf-server");
    if (!text.empty()) {
      std::ofstream(config()) << text;
      words.insert(words.end(), {"--config", config().string()});
    }
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
    testing::internal::CaptureStderr();
    auto line = read_command_line(static_cast<int>(arguments.size()), arguments.data());
    Outcome outcome{.said = testing::internal::GetCapturedStderr()};
    for (const auto& [name, value] : environment) unsetenv(name.c_str());
    if (line) {
      outcome.line = *std::move(line);
    } else {
      outcome.status = line.error();
    }
    return outcome;
  }
  std::filesystem::path config() const { return folder_ / "kerf.toml"; }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(CommandLineTest, OptionsComeFromFileAndEnvironment) {
  const auto file =
      read({}, "listen = \"127.0.0.2:0\"\nlog-format = \"json\"\nallow-host = [\"a.example\"]\n");
  ASSERT_TRUE(file.line) << file.said;
  EXPECT_EQ(file.address(), "127.0.0.2");
  EXPECT_EQ(file.line->server.http.allow_hosts.front(), "a.example");
  EXPECT_EQ(read({}, "", {{"KERF_LISTEN", "127.0.0.3:0"}}).address(), "127.0.0.3");
}

TEST_F(CommandLineTest, CommandLineOverridesFileOverridesEnvironment) {
  const std::string text = "listen = \"127.0.0.2:0\"\n";
  const std::map<std::string, std::string> environment = {{"KERF_LISTEN", "127.0.0.3:0"}};
  EXPECT_EQ(read({}, text, environment).address(), "127.0.0.2");
  EXPECT_EQ(read({"--listen", "127.0.0.4:0"}, text, environment).address(), "127.0.0.4");
}

TEST_F(CommandLineTest, EnvironmentListsAreSeparatedByCommasOrSpaces) {
  const std::map<std::string, std::string> environment = {{"KERF_SCENE", "one, two  three"}};
  EXPECT_THAT(read({}, "", environment).line.value().scenes, ElementsAre("one", "two", "three"));
  EXPECT_THAT(read({"--scene", "four"}, "", environment).line.value().scenes, ElementsAre("four"));
}

TEST_F(CommandLineTest, IneffectiveOptionsAreErrors) {
  const std::pair<const char*, const char*> wrong[] = {{"--allow-origin", "kerf.example"},
                                                       {"--allow-origin", "https://kerf.example/"},
                                                       {"--allow-origin", "null"},
                                                       {"--allow-host", "https://kerf.example"},
                                                       {"--allow-host", "a b"},
                                                       {"--disk-reserve", "nan"},
                                                       {"--disk-total", "-1"},
                                                       {"--disk-total", "many"},
                                                       {"--snapshot-after", "inf"},
                                                       {"--viewer-budget", "24"},
                                                       {"--viewer-budget", "nan"},
                                                       {"--web", "/does/not/exist"},
                                                       {"--listen", "here"},
                                                       {"--udp", "here"},
                                                       {"--trust-proxy", "here"},
                                                       {"--drain-to", "here"},
                                                       {"--lisen", "127.0.0.2:0"}};
  for (const auto& [option, value] : wrong) {
    const auto outcome = read({option, value});
    EXPECT_FALSE(outcome.line) << option << " " << value;
    EXPECT_EQ(outcome.status, 2) << option << " " << value;
    EXPECT_TRUE(outcome.said.starts_with("kerf-server: ")) << outcome.said;
    EXPECT_TRUE(outcome.said.contains(option)) << outcome.said;
  }
  const std::pair<const char*, const char*> right[] = {{"--allow-host", "kerf.example"},
                                                       {"--allow-host", "kerf.example:8443"},
                                                       {"--allow-origin", "https://k.example:8443"},
                                                       {"--disk-reserve", "1e3"},
                                                       {"--viewer-budget", "0"},
                                                       {"--viewer-budget", "62.5"}};
  for (const auto& [option, value] : right) {
    EXPECT_TRUE(read({option, value}).line) << option << " " << value;
  }
  EXPECT_EQ(read({"--viewer-budget", "62.5"}).line.value().server.viewer_budget, 62'500U);
  EXPECT_EQ(read({"--disk-reserve", "1e3"}).line.value().server.disk.reserve, 1'000'000'000U);
}

TEST_F(CommandLineTest, UnknownOptionErrorNamesTheRemedy) {
  EXPECT_TRUE(read({"--lisen", "127.0.0.2:0"}).said.ends_with("--help lists the options\n"));
  const auto outcome = read({}, "lisen = \"127.0.0.2:0\"\n");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(outcome.said.contains("--config: there is no option 'lisen'")) << outcome.said;
}

TEST_F(CommandLineTest, EachValueOfTheFileHasTheTypeOfItsOption) {
  const std::pair<const char*, const char*> wrong[] = {
      {"open = \"yes\"", "open must be true or false, without quotes"},
      {"open = 1", "open must be true or false"},
      {"open", "open has no value"},
      {"disk-total = \"5\"", "disk-total must be a number, without quotes"},
      {"disk-total = true", "disk-total must be a number"},
      {"log-format = json", "log-format must be a text in quotes"},
      {"udp = 9000", "udp must be a text in quotes"},
      {"allow-host = true", "allow-host must be a list of texts in quotes"},
      {"allow-host = [1, 2]", "allow-host must be a list of texts"},
      {"allow-host = [\"a\"", "allow-host has a list that is not closed"},
      {"log-format = \"json", "log-format has quotes that are not closed"}};
  for (const auto& [text, why] : wrong) {
    const auto outcome = read({}, std::string("listen = \"127.0.0.1:0\"\n# one\n") + text + "\n");
    EXPECT_EQ(outcome.status, 2) << text;
    EXPECT_TRUE(
        outcome.said.starts_with("kerf-server: --config: " + config().string() + ":3: " + why))
        << outcome.said;
    EXPECT_TRUE(outcome.said.ends_with("--help lists the options\n")) << outcome.said;
  }
  const auto right = read({},
                          "listen = \"127.0.0.1:0\" # one\nopen = true\ndisk-total = 5.5\n"
                          "log-format = 'json'\nallow-host = [\"a.example\",\n  \"b.example\"]\n"
                          "allow-origin = \"https://c.example\"\nviewer-budget = 500\n"
                          "lease-ms = 5000\n");
  ASSERT_TRUE(right.line) << right.said;
  EXPECT_TRUE(right.line->server.open);
  EXPECT_EQ(right.line->server.disk.folder, 5'500'000U);
  EXPECT_EQ(right.line->server.http.allow_hosts.at(1), "b.example");
}

TEST_F(CommandLineTest, TheNamesOfThisMachineAreAllowedAsHosts) {
  std::array<char, HOST_NAME_MAX + 1> name{};
  ASSERT_EQ(gethostname(name.data(), name.size()), 0);
  const std::string own = name.data();
  EXPECT_THAT(read({}).line.value().server.http.allow_hosts, ElementsAre(own, own + ".local"));
}

TEST_F(CommandLineTest, AdministratorsTokenIsRemovedFromTheEnvironment) {
  const std::string token(32, 'x');
  EXPECT_EQ(read({}, "", {{"KERF_ADMIN_TOKEN", token}}).line.value().server.admin_token, token);
  EXPECT_EQ(read({}).line.value().server.admin_token, "");
}

}  // namespace
}  // namespace kerf::command_line_test
