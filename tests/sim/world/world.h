// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tests/sim/world/active_faults.h"
#include "tests/sim/world/clerk.h"
#include "tests/sim/world/hand.h"
#include "tests/sim/world/intruder.h"
#include "tests/sim/world/page.h"
#include "tests/sim/world/plan.h"
#include "tests/sim/world/server_machine.h"

namespace kerf::sim {

/// What a world has shown.
struct Outcome {
  std::vector<std::string> faults;  ///< a sentence for each promise that was broken; empty: none
  std::uint64_t motions = 0, promises = 0, requests = 0;
  Time length = 0;  ///< that has passed in it
  std::uint64_t trace = 0, turns = 0;
};

/// Servers, hands, clerks and NATS in this process, in a simulation that has begun: carries out a
/// plan, heals everything, and checks that every promise was kept.
class World {
 public:
  /// `folder` is empty.
  World(Plan plan, std::filesystem::path folder);
  Outcome run();

 private:
  void start_servers();
  void create_session();
  void work();
  void heal();
  void populate(Time end);
  void check_owners();
  void check_answers();
  void check_journal();
  void check_motions(const std::filesystem::path& journal);
  void check_promises();
  void check_followers();
  void check_programs();
  void check_branches();
  void check_files();
  void check_pages();
  bool loses_messages() const;
  std::shared_ptr<Session> accepted(ServerMachine& server) const;
  ServerMachine* owner();
  void fail(const std::string& sentence) { outcome_.faults.push_back(sentence); }

  Plan plan_;
  std::filesystem::path folder_;
  bool has_two_owners_ = false;
  std::vector<std::unique_ptr<ServerMachine>> servers_;
  std::vector<std::unique_ptr<Hand>> hands_;
  std::vector<std::unique_ptr<Clerk>> clerks_;
  std::vector<std::unique_ptr<Page>> pages_;
  std::unique_ptr<Intruder> intruder_;
  ActiveFaults faults_{servers_};
  Outcome outcome_;
};

}  // namespace kerf::sim
