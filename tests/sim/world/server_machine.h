// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "server/server.h"
#include "tests/sim/os/disk.h"
#include "tests/sim/os/scheduler.h"

namespace kerf::sim {

/// A machine with a disk, on which kerf-server runs: the whole server, with its threads, files and
/// sockets, started again and again.
class ServerMachine {
 public:
  /// `options` without the folder, which is on the disk; `root` is a folder for it.
  ServerMachine(std::string name, net::ServerOptions options, std::filesystem::path root,
                double clock_rate);

  /// Starts the server, unless it runs.
  void start();
  /// Ends it as SIGTERM does, and waits for that.
  void stop();
  /// Ends it as SIGKILL does or, with `power_loss`, as a loss of power: what was not synchronized
  /// is lost. The disk is in order again.
  void kill(bool power_loss);
  /// Its threads stand still for a while, as after SIGSTOP.
  void stand_still(Time length);
  /// Cuts its connections.
  void cut_connections();
  /// Sets its wall clock forward or back.
  void set_clock(Time by);

  bool runs() const { return process_ != nullptr; }
  const std::string& name() const { return name_; }
  int port() const { return options_.port; }
  Machine& machine() { return *machine_; }
  Disk& disk() { return *disk_; }
  /// Null while it does not run, or has not listened yet. For a look without a wait.
  net::Server* server() const { return process_ == nullptr ? nullptr : process_->server; }
  /// The reason why the server could not start; empty: it could.
  std::string failure() const { return process_ == nullptr ? "" : process_->failure; }

 private:
  /// A run of the server. Of one that was killed it stays for ever, as its threads left it.
  struct Process {
    std::thread thread;
    net::Server* server = nullptr;
    std::string failure;
    std::mutex mutex;
    std::condition_variable changed;
    bool is_asked_to_stop = false;
  };
  void run(Process& process, net::ServerOptions options) const;

  std::string name_;
  net::ServerOptions options_;
  std::filesystem::path root_;
  double clock_rate_;
  Time wall_ns_;
  int starts_ = 0, disks_ = 0;
  std::unique_ptr<Machine> machine_;
  std::unique_ptr<Disk> disk_;
  std::unique_ptr<Process> process_;
};

}  // namespace kerf::sim
