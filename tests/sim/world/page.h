// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tests/sim/os/scheduler.h"

namespace kerf::sim {

/// A page that watches a session over its WebSocket: it acknowledges surfaces, goes away now and
/// then, and comes again.
class Page {
 public:
  /// `token`: what it shows to servers; empty: nothing.
  Page(std::string session, std::vector<int> ports, std::uint64_t seed, std::string token = {});

  void start();
  /// Stays from now on. Whether it shows the block with this hash within `patience`.
  bool shows(std::uint64_t hash, Time patience);
  void stop();

  // ---- after stop() ----
  /// Frames that no page may get: a line for each.
  const std::vector<std::string>& wrong_frames() const { return wrong_; }
  /// The reasons with which servers have sent it away.
  const std::vector<std::string>& byes() const { return byes_; }
  /// The reasons of errors that servers have stated.
  const std::vector<std::string>& errors() const { return errors_; }

 private:
  struct Visit;
  void run();
  void visit(int port);
  void take_text(const std::string& text);

  std::string session_, token_;
  std::vector<int> ports_;
  std::uint64_t random_;
  std::thread thread_;
  std::atomic<bool> stays_ = false, ends_ = false;
  std::atomic<std::uint64_t> shown_ = 0;  ///< hash of the surface that it has whole; 0: none
  std::vector<std::string> wrong_, byes_, errors_;
};

}  // namespace kerf::sim
