// SPDX-License-Identifier: Apache-2.0
// sim: runs simulated worlds by their seeds (README.md).
#include <sys/personality.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/sim/world/process.h"

namespace kerf::sim {
namespace {

struct Options {
  std::uint64_t first = 1, count = 1;
  std::vector<std::size_t> without;  ///< faults of the plan that are left out
  bool shrinks = false, keeps = false;
  bool is_twice = false;  ///< each world runs a second time, which must be equal
  std::filesystem::path folder;
};

Plan plan_without(std::uint64_t seed, const std::vector<std::size_t>& without) {
  Plan plan = plan_of(seed);
  std::vector<PlannedFault> kept;
  for (std::size_t i = 0; i < plan.faults.size(); ++i) {
    if (std::ranges::find(without, i) == without.end()) kept.push_back(plan.faults[i]);
  }
  plan.faults = kept;
  return plan;
}

/// Leaves out faults one by one while the world still fails.
std::vector<std::size_t> shrink(std::uint64_t seed, const Options& options) {
  std::vector<std::size_t> without = options.without;
  const std::size_t count = plan_of(seed).faults.size();
  for (std::size_t i = 0; i < count; ++i) {
    auto less = without;
    less.push_back(i);
    if (!run_world(plan_without(seed, less), options.folder / "shrink").is_good()) without = less;
  }
  return without;
}

std::string list(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (const std::size_t n : numbers) text += (text.empty() ? "" : ",") + std::to_string(n);
  return text;
}

double seconds(Time time) { return static_cast<double>(time) / static_cast<double>(kSecond); }

void print_one(const Plan& plan, const Report& report) {
  std::printf("%s\n%.1f s in %.2f s of CPU, %llu turns, trace %016llx\n", describe(plan).c_str(),
              seconds(report.length), report.cpu_s, static_cast<unsigned long long>(report.turns),
              static_cast<unsigned long long>(report.trace));
}

void print_failure(std::uint64_t seed, const Report& report, const Options& options) {
  std::printf("%sagain: sim --seed %llu", report.faults.c_str(),
              static_cast<unsigned long long>(seed));
  const auto without = options.shrinks ? shrink(seed, options) : options.without;
  if (!without.empty()) std::printf(" --without %s", list(without).c_str());
  std::printf("; log: %s\n", (options.folder / std::to_string(seed) / "log").c_str());
  std::fflush(stdout);
}

/// The sums of all worlds.
struct Sums {
  std::uint64_t worlds = 0, failed = 0, motions = 0, requests = 0, promises = 0;
  double cpu_s = 0, virtual_s = 0;

  void add(const Report& report) {
    ++worlds;
    failed += report.is_good() ? 0 : 1;
    motions += report.motions;
    requests += report.requests;
    promises += report.promises;
    cpu_s += report.cpu_s;
    virtual_s += seconds(report.length);
  }
  void print() const {
    std::printf(
        "%llu worlds, %llu failed: %.2f virtual hours in %.1f minutes of CPU, %.3f virtual hours "
        "per minute; %llu motions, %llu requests, %llu promises\n",
        static_cast<unsigned long long>(worlds), static_cast<unsigned long long>(failed),
        virtual_s / 3600, cpu_s / 60, virtual_s / 60 / std::max(cpu_s, 0.01),
        static_cast<unsigned long long>(motions), static_cast<unsigned long long>(requests),
        static_cast<unsigned long long>(promises));
  }
};

/// Runs all; the exit status.
int run_all(const Options& options) {
  Sums sums;
  for (std::uint64_t seed = options.first; seed < options.first + options.count; ++seed) {
    const Plan plan = plan_without(seed, options.without);
    const auto folder = options.folder / std::to_string(seed);
    Report report = run_world(plan, folder);
    if (options.is_twice && run_world(plan, folder).trace != report.trace) {
      report.faults += "a second run of the world was another one\n";
    }
    sums.add(report);
    if (options.count == 1 || !report.is_good()) print_one(plan, report);
    if (!report.is_good()) print_failure(seed, report, options);
    if (report.is_good() && !options.keeps) std::filesystem::remove_all(folder);
  }
  sums.print();
  if (sums.failed == 0 && !options.keeps) std::filesystem::remove_all(options.folder);
  return sums.failed == 0 ? 0 : 1;
}

[[noreturn]] void usage() {
  std::fprintf(stderr,
               "usage: sim [--first SEED] [--seeds N] [--seed SEED] [--without FAULT,...] "
               "[--shrink] [--twice] [--keep] [--folder DIR]\n");
  std::exit(2);
}

std::vector<std::size_t> numbers_of(const std::string& text) {
  std::vector<std::size_t> numbers;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    numbers.push_back(std::strtoull(part.c_str(), nullptr, 10));
  }
  return numbers;
}

Options parse(int count, char** words) {
  Options options;
  options.folder =
      std::filesystem::temp_directory_path() / ("kerf-sim-" + std::to_string(getpid()));
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    bool* const flag = word == "--shrink"  ? &options.shrinks
                       : word == "--twice" ? &options.is_twice
                       : word == "--keep"  ? &options.keeps
                                           : nullptr;
    if (flag != nullptr) {
      *flag = true;
      continue;
    }
    if (++i == count) usage();
    const std::string value = words[i];
    if (word == "--seeds") {
      options.count = std::strtoull(value.c_str(), nullptr, 10);
    } else if (word == "--first" || word == "--seed") {
      options.first = std::strtoull(value.c_str(), nullptr, 10);
    } else if (word == "--without") {
      options.without = numbers_of(value);
    } else if (word == "--folder") {
      options.folder = value;
    } else {
      usage();
    }
  }
  return options;
}

}  // namespace
}  // namespace kerf::sim

int main(int count, char** words) {
  // Equal runs need equal addresses: some containers are ordered by them.
  const int persona = personality(0xffffffff);
  if ((persona & ADDR_NO_RANDOMIZE) == 0 && std::getenv("KERF_SIM_AGAIN") == nullptr) {
    setenv("KERF_SIM_AGAIN", "1", 1);
    personality(static_cast<unsigned long>(persona) | ADDR_NO_RANDOMIZE);
    execv("/proc/self/exe", words);
  }
  return kerf::sim::run_all(kerf::sim::parse(count, words));
}
