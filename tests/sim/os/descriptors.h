// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "tests/sim/os/scheduler.h"

namespace kerf::sim {

/// A file descriptor that the simulation has made.
struct Descriptor {
  enum class Kind : std::uint8_t { kSocket, kTimer };
  Kind kind = Kind::kSocket;
  Machine* machine = nullptr;
  int port = 0, peer = 0;  ///< of a socket; 0: none yet
  Time expires = kNever;   ///< of a timer
};

/// The descriptors of all machines.
class Descriptors {
 public:
  static Descriptors& instance();
  Descriptor& add(int file, Descriptor::Kind kind);
  void remove(int file) { known_.erase(file); }
  /// Null: it is no such descriptor.
  Descriptor* find(int file, Descriptor::Kind kind);
  int next_port() { return ++last_port_; }
  /// Closes the sockets and timers of a machine, as the operating system does for a process that
  /// is gone.
  void close_those_of(const Machine& machine);
  /// Cuts the connections of a machine; it still listens.
  void cut_those_of(const Machine& machine);
  /// The time at which the next timer expires.
  Time next_expiry() const;
  /// Makes timers readable that have expired; whether there were any.
  bool expire(Time now);

 private:
  std::map<int, Descriptor> known_;
  int last_port_ = 20'000;
};

}  // namespace kerf::sim
