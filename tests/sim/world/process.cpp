// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/process.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

#include "server/log/log.h"

namespace kerf::sim {
namespace {

/// A world that takes longer does not come to its end.
constexpr rlim_t kCpuSeconds = 300;

void tell(const std::filesystem::path& folder, const Outcome& outcome) {
  std::ofstream faults(folder / "faults");
  for (const std::string& fault : outcome.faults) faults << fault << '\n';
  std::ofstream(folder / "figures")
      << outcome.motions << ' ' << outcome.promises << ' ' << outcome.requests << ' '
      << outcome.trace << ' ' << outcome.turns << ' ' << outcome.length;
}

[[noreturn]] void live(const TurnOptions& turns, const std::filesystem::path& folder,
                       const std::function<Outcome()>& life) {
  const rlimit limit{kCpuSeconds, kCpuSeconds};
  setrlimit(RLIMIT_CPU, &limit);
  const std::string log = folder / "log";
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  dup2(file, STDERR_FILENO);
  dup2(file, STDOUT_FILENO);
  log::open();
  const auto stuck = [&](const std::string& reason) {
    Outcome outcome;
    outcome.faults.push_back(reason);
    tell(folder, outcome);
  };
  begin_turns(turns, stuck);
  tell(folder, life());
  std::fflush(nullptr);
  _exit(0);
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

Report run_apart(const TurnOptions& turns, const std::filesystem::path& folder,
                 const std::function<Outcome()>& life) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) live(turns, folder, life);
  int status = 0;
  rusage use{};
  wait4(child, &status, 0, &use);
  Report report{.cpu_s = seconds(use.ru_utime) + seconds(use.ru_stime)};
  std::ifstream figures(folder / "figures"), faults(folder / "faults");
  report.is_whole =
      static_cast<bool>(figures >> report.motions >> report.promises >> report.requests >>
                        report.trace >> report.turns >> report.length);
  report.faults.assign(std::istreambuf_iterator<char>(faults), {});
  if (report.is_whole) return report;
  report.faults = WIFSIGNALED(status)
                      ? std::string("ended by signal: ") + strsignal(WTERMSIG(status)) + "\n"
                      : "ended with status " + std::to_string(WEXITSTATUS(status)) + "\n";
  return report;
}

Report run_world(const Plan& plan, const std::filesystem::path& folder) {
  return run_apart({.seed = plan.seed, .switch_chance = plan.switch_chance}, folder,
                   [&] { return World(plan, folder / "world").run(); });
}

}  // namespace kerf::sim
