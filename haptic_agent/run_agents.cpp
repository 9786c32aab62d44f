// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/run_agents.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>

#include "haptic_agent/run_agent.h"

namespace kerf::agent {
namespace {

/// Returns the exit code of a process from its wait status.
int code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : kFailed; }

/// Waits until all children have ended. Forwards SIGINT and SIGTERM as SIGTERM, and SIGUSR1.
int supervise(std::vector<pid_t> children, const sigset_t& signals) {
  int worst = 0;
  while (!children.empty()) {
    const int signal = sigwaitinfo(&signals, nullptr);
    if (signal == SIGINT || signal == SIGTERM || signal == SIGUSR1) {
      for (const pid_t child : children) kill(child, signal == SIGUSR1 ? SIGUSR1 : SIGTERM);
    }
    int status = 0;
    for (pid_t ended = 0; (ended = waitpid(-1, &status, WNOHANG)) > 0;) {
      if (std::erase(children, ended) > 0) worst = std::max(worst, code_of(status));
    }
  }
  return worst;
}

}  // namespace

std::vector<Options> split_options(const Options& options) {
  std::vector<Options> all(1, options);
  all.front().more_devices.clear();
  for (std::size_t i = 0; i < options.more_devices.size(); ++i) {
    const std::string number = std::to_string(i + 2);
    Options one = all.front();
    one.device = options.more_devices[i];
    if (!one.link.hello.name.empty()) one.link.hello.name += " " + number;
    if (!one.status_json.empty() && one.status_json != "-") one.status_json += "." + number;
    if (!one.record_file.empty()) {
      const std::filesystem::path file(one.record_file);
      const std::string name = file.stem().string() + "." + number + file.extension().string();
      one.record_file = (file.parent_path() / name).string();
    }
    all.push_back(std::move(one));
  }
  return all;
}

int run_agents(Options options) {
  if (options.more_devices.empty()) return run_agent(std::move(options));
  sigset_t signals{}, before{};
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1, SIGCHLD}) sigaddset(&signals, signal);
  sigprocmask(SIG_BLOCK, &signals, &before);
  std::vector<pid_t> children;
  for (Options& one : split_options(options)) {
    const pid_t child = fork();
    if (child == 0) {
      // End the child when the parent dies.
      prctl(PR_SET_PDEATHSIG, SIGTERM);
      sigprocmask(SIG_SETMASK, &before, nullptr);
      const int code = run_agent(std::move(one));
      // _exit skips the parent's exit handlers, and does not flush.
      std::cout << std::flush;
      _exit(code);
    }
    if (child > 0) children.push_back(child);
  }
  return supervise(std::move(children), signals);
}

}  // namespace kerf::agent
