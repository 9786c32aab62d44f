// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "tests/sim/os/scheduler.h"
#include "tests/sim/world/http_client.h"
#include "tests/sim/world/promises.h"

namespace kerf::sim {

/// An administrator who uses the HTTP interface of a session at random: sets and removes pins,
/// names and deletes versions, undoes and redoes strokes, runs programs, downloads, makes branches,
/// closes and reopens them, and remembers what the answers promise.
class Clerk {
 public:
  /// `ports` of the servers; it asks one, and where that leads it.
  Clerk(std::string session, std::vector<int> ports, std::uint64_t seed);

  void start(Time end, Time pause_max);
  void join() { thread_.join(); }

  // ---- after join() ----
  const Promises& promises() const { return promises_; }
  /// Answers that no request may have, e.g. 500: a line for each.
  const std::vector<std::string>& wrong_answers() const { return wrong_; }
  std::uint64_t requests() const { return requests_; }
  /// Strokes of requests to undo or redo.
  std::uint64_t stroke_changes() const { return stroke_changes_; }

  /// Reads the pins, versions, undone strokes and this clerk's branches from a server; false: it
  /// does not answer.
  bool read(std::map<std::string, bool>& present, Time patience);

 private:
  std::uint64_t draw_own(std::uint64_t below);
  HttpAnswer request(const std::string& method, const std::string& rest, Time patience,
                     const std::string& body = {});
  /// `target`: from "/v1/" on.
  HttpAnswer request_at(const std::string& method, const std::string& target, Time patience,
                        const std::string& body = {});
  void act();
  void set_pin();
  void remove_pin();
  void name_version();
  void remove_version();
  void change_strokes();
  void run_program();
  void download();
  void make_branch();
  void close_branch();
  void reopen_branch();

  std::string session_, branch_prefix_;
  std::vector<int> ports_;
  std::size_t place_ = 0;  ///< the port that has answered last
  std::uint64_t random_;
  std::thread thread_;
  std::uint64_t requests_ = 0, made_ = 0, stroke_changes_ = 0;
  std::vector<std::string> names_;
  std::vector<std::uint32_t> pins_;
  std::vector<std::string> branches_;  ///< ids of those that were answered, open or closed
  Promises promises_;
  std::vector<std::string> wrong_;
};

}  // namespace kerf::sim
