// SPDX-License-Identifier: Apache-2.0
// sim: runs simulated worlds by their seeds (README.md).
#include <fcntl.h>
#include <sys/personality.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "server/log/log.h"
#include "tests/sim/world/world.h"

namespace kerf::sim {
namespace {

struct Options {
  std::uint64_t first = 1, count = 1;
  std::vector<std::size_t> without;  ///< faults of the plan that are left out
  bool shrinks = false, keeps = false;
  bool is_twice = false;  ///< each world runs a second time, which must be equal
  std::filesystem::path folder;
};

/// What a world's process has told.
struct Report {
  bool is_whole = false;  ///< it has come to its end
  std::string text;       ///< sentences, one a line
  std::uint64_t motions = 0, promises = 0, requests = 0, trace = 0, turns = 0;
  Time length = 0;
  double cpu_s = 0;
  bool is_good() const { return is_whole && text.empty(); }
};

constexpr rlim_t kCpuSeconds = 300;

Plan plan_without(std::uint64_t seed, const std::vector<std::size_t>& without) {
  Plan plan = plan_of(seed);
  std::vector<PlannedFault> kept;
  for (std::size_t i = 0; i < plan.faults.size(); ++i) {
    if (std::find(without.begin(), without.end(), i) == without.end())
      kept.push_back(plan.faults[i]);
  }
  plan.faults = kept;
  return plan;
}

/// The process of one world.
[[noreturn]] void live(const Plan& plan, const std::filesystem::path& folder) {
  const rlimit limit{kCpuSeconds, kCpuSeconds};
  setrlimit(RLIMIT_CPU, &limit);
  const std::string log = folder / "log";
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  dup2(file, STDERR_FILENO);
  dup2(file, STDOUT_FILENO);
  log::open();
  const auto tell = [folder](const std::string& text, const std::string& figures) {
    std::ofstream(folder / "faults") << text;
    std::ofstream(folder / "figures") << figures;
  };
  begin_turns({.seed = plan.seed, .switch_chance = plan.switch_chance},
              [&](const std::string& reason) { tell(reason + "\n", "0 0 0 0 0 0"); });
  World world(plan, folder / "world");
  const Outcome outcome = world.run();
  std::string sentences;
  for (const std::string& fault : outcome.faults) sentences += fault + "\n";
  std::ostringstream figures;
  figures << outcome.motions << ' ' << outcome.promises << ' ' << outcome.requests << ' '
          << outcome.trace << ' ' << outcome.turns << ' ' << outcome.length;
  tell(sentences, figures.str());
  _exit(0);
}

Report run(const Plan& plan, const std::filesystem::path& folder) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) live(plan, folder);
  int status = 0;
  rusage use{};
  wait4(child, &status, 0, &use);
  Report report;
  report.cpu_s = static_cast<double>(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
                 1e-6 * static_cast<double>(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
  std::ifstream figures(folder / "figures"), sentences(folder / "faults");
  report.is_whole =
      static_cast<bool>(figures >> report.motions >> report.promises >> report.requests >>
                        report.trace >> report.turns >> report.length);
  report.text.assign(std::istreambuf_iterator<char>(sentences), {});
  if (!report.is_whole) {
    report.text = WIFSIGNALED(status)
                      ? std::string("ended by signal ") + strsignal(WTERMSIG(status)) + "\n"
                      : "ended with status " + std::to_string(WEXITSTATUS(status)) + "\n";
  }
  return report;
}

/// Leaves out faults one by one while the world still fails.
std::vector<std::size_t> shrink(std::uint64_t seed, const Options& options) {
  std::vector<std::size_t> without = options.without;
  const std::size_t count = plan_of(seed).faults.size();
  for (std::size_t i = 0; i < count; ++i) {
    auto less = without;
    less.push_back(i);
    if (!run(plan_without(seed, less), options.folder / "shrink").is_good()) without = less;
  }
  return without;
}

std::string list(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (const std::size_t n : numbers) text += (text.empty() ? "" : ",") + std::to_string(n);
  return text;
}

/// Runs all; the exit status.
int run_all(const Options& options) {
  std::uint64_t failed = 0, motions = 0, promises = 0, requests = 0;
  double cpu_s = 0, virtual_s = 0;
  for (std::uint64_t seed = options.first; seed < options.first + options.count; ++seed) {
    const Plan plan = plan_without(seed, options.without);
    const auto folder = options.folder / std::to_string(seed);
    Report report = run(plan, folder);
    if (options.is_twice && run(plan, folder).trace != report.trace) {
      report.text += "a second run of the world was another one\n";
    }
    motions += report.motions;
    promises += report.promises;
    requests += report.requests;
    cpu_s += report.cpu_s;
    virtual_s += static_cast<double>(report.length) / static_cast<double>(kSecond);
    if (options.count == 1) {
      std::printf(
          "%s\n%.1f s in %.2f s of CPU, %llu turns, trace %016llx, %llu motions, %llu promises\n",
          describe(plan).c_str(), static_cast<double>(report.length) / static_cast<double>(kSecond),
          report.cpu_s, static_cast<unsigned long long>(report.turns),
          static_cast<unsigned long long>(report.trace),
          static_cast<unsigned long long>(report.motions),
          static_cast<unsigned long long>(report.promises));
    }
    if (report.is_good()) {
      if (!options.keeps) std::filesystem::remove_all(folder);
      continue;
    }
    ++failed;
    if (options.count > 1) std::printf("%s\n", describe(plan).c_str());
    std::printf("%s", report.text.c_str());
    std::string again = "again: sim --seed " + std::to_string(seed);
    if (options.shrinks) {
      const auto without = shrink(seed, options);
      if (!without.empty()) again += " --without " + list(without);
    }
    std::printf("%s; log: %s\n", again.c_str(), (folder / "log").c_str());
    std::fflush(stdout);
  }
  std::printf(
      "%llu worlds, %llu failed: %.1f virtual hours in %.1f minutes of CPU (%.1f virtual "
      "hours per minute of CPU), %llu motions, %llu requests, %llu promises\n",
      static_cast<unsigned long long>(options.count), static_cast<unsigned long long>(failed),
      virtual_s / 3600, cpu_s / 60, virtual_s / 60 / (cpu_s > 0 ? cpu_s : 1),
      static_cast<unsigned long long>(motions), static_cast<unsigned long long>(requests),
      static_cast<unsigned long long>(promises));
  return failed == 0 ? 0 : 1;
}

[[noreturn]] void usage() {
  std::fprintf(
      stderr,
      "usage: sim [--seeds N] [--first SEED] [--seed SEED] [--without FAULT,...] [--shrink] "
      "[--twice] [--keep] [--folder DIR]\n");
  std::exit(2);
}

Options parse(int count, char** words) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--shrink") {
      options.shrinks = true;
      continue;
    }
    if (word == "--twice") {
      options.is_twice = true;
      continue;
    }
    if (word == "--keep") {
      options.keeps = true;
      continue;
    }
    if (i + 1 == count) usage();
    const std::string value = words[++i];
    if (word == "--seeds")
      options.count = std::strtoull(value.c_str(), nullptr, 10);
    else if (word == "--first")
      options.first = std::strtoull(value.c_str(), nullptr, 10);
    else if (word == "--seed")
      options.first = std::strtoull(value.c_str(), nullptr, 10);
    else if (word == "--folder")
      options.folder = value;
    else if (word == "--without") {
      std::istringstream numbers(value);
      for (std::string part; std::getline(numbers, part, ',');) {
        options.without.push_back(std::strtoull(part.c_str(), nullptr, 10));
      }
    } else
      usage();
  }
  if (options.folder.empty()) {
    options.folder =
        std::filesystem::temp_directory_path() / ("kerf-sim-" + std::to_string(getpid()));
  }
  return options;
}

}  // namespace
}  // namespace kerf::sim

int main(int count, char** words) {
  // Equal runs need equal addresses: containers are ordered by them here and there.
  const int persona = personality(0xffffffff);
  if ((persona & ADDR_NO_RANDOMIZE) == 0 && std::getenv("KERF_SIM_AGAIN") == nullptr) {
    setenv("KERF_SIM_AGAIN", "1", 1);
    personality(static_cast<unsigned long>(persona) | ADDR_NO_RANDOMIZE);
    execv("/proc/self/exe", words);
  }
  return kerf::sim::run_all(kerf::sim::parse(count, words));
}
