// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "server/cluster/copies.h"
#include "tests/sim/world/hand.h"
#include "tests/sim/world/http_client.h"
#include "tests/sim/world/page.h"
#include "tests/sim/world/scene.h"
#include "tests/sim/world/server_machine.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::sim {

using Json = nlohmann::json;

/// Named servers, each with its own disk, and a NATS, in a running simulation that a test controls
/// step by step. Its faults are failures of the test.
class Cluster {
 public:
  using Change = std::function<void(net::ServerOptions&)>;
  explicit Cluster(std::filesystem::path folder);
  ~Cluster();
  Cluster(const Cluster&) = delete;
  Cluster& operator=(const Cluster&) = delete;

  /// Starts a server; the second time with the disk that it had. By default it copies its journals
  /// and shares its sessions.
  void start(const std::string& name, const Change& change = {});
  /// Ends it as SIGTERM does, or as SIGKILL does.
  void stop(const std::string& name) { at(name).stop(); }
  void kill(const std::string& name) { at(name).kill(false); }
  ServerMachine& at(const std::string& name) { return *servers_.at(name); }
  /// A file of a session in the data folder of a server.
  std::filesystem::path file(const std::string& name, const std::string& leaf = "block.kerf") {
    return at(name).disk().folder() / "data" / leaf;
  }
  /// "http://HOST:PORT" of a server.
  std::string address(const std::string& name);

  HttpAnswer ask(const std::string& name, const std::string& method, const std::string& target,
                 const std::string& body = {}, const std::string& fields = {});
  /// Null if the server does not answer with the session.
  Json info(const std::string& name, const std::string& session = "block",
            const std::string& fields = {});
  void create(const std::string& name, const std::string& session = "block");
  /// Waits until this holds, for half a minute of the simulation at most.
  bool until(const std::function<bool()>& holds);
  /// The server that may change the session, once there is one.
  std::string wait_for_owner(const std::string& session = "block");
  /// The servers that may change it now.
  std::vector<std::string> owners(const std::string& session = "block");
  /// Waits until all that the session has is copied.
  void wait_for_copy(const std::string& name, const std::string& session = "block",
                     const std::string& fields = {});
  /// Writes the copy of a session to a file.
  static FetchedCopy fetch(const std::filesystem::path& file);
  /// A file on the disk of a server for that, in no folder of it.
  std::filesystem::path beside(const std::string& name) {
    return at(name).disk().folder() / "fetched.kerf";
  }
  /// Whether the copy has the records of a server's journal, and no others.
  bool is_copied_as_it_is(const std::string& name);
  /// Motions and hash of the block that a server shows; null: it shows none.
  Json block(const std::string& name) { return block_of(info(name)); }

  /// Somebody carves at a server for a while, to the end.
  void carve(const std::string& name, Time length = kSecond);
  /// Begins to carve; finish_carving() waits until all is durable.
  void begin_carving(const std::string& name, Time length);
  void finish_carving();
  /// Each motion of all that has been carved is in the journal of a server once.
  void check_journal(const std::string& name);

 private:
  static Json block_of(const Json& info);
  std::filesystem::path folder_;
  std::map<std::string, std::unique_ptr<ServerMachine>> servers_;
  std::vector<std::unique_ptr<Hand>> hands_;
};

/// The rows of a journal's records: the first record and the bytes of each.
std::vector<std::pair<std::int64_t, std::vector<std::byte>>> batches(
    const std::filesystem::path& file);

class ClusterTest : public testing::Test {
 protected:
  /// Plays a script in a simulation of its own, under a few seeds; returns what failed.
  std::string faults_of(const std::function<void(Cluster&)>& script, std::uint64_t seeds = 2) const;

 private:
  const test::TemporaryFolder folder_;
};

}  // namespace kerf::sim
