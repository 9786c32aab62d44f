// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/server.h"
#include "tests/server/whole/peer.h"
#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::test {

inline const Json kBlock = Json::parse(R"({
  "name": "block",
  "stock": {"shape": "box", "min_mm": [-20, -20, -20], "max_mm": [20, 20, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60},
            {"id": 2, "shape": "flat", "diameter_mm": 6, "length_mm": 60}],
  "force": {"law": "specific_energy", "specific_force_n_per_mm2": 0.5},
  "machine": {"kinematics": "tool-vector"}})");

/// The scene of the block with some fields of its own.
inline Json scene_with(const Json& fields) {
  Json scene = kBlock;
  scene.update(fields);
  return scene;
}

/// A whole server in this process, with real sockets and a session "block". Tests wait for the
/// server's messages.
class WholeServer : public testing::Test {
 protected:
  void SetUp() override {
    start();
    create("block");
  }

  /// Starts the server with `options` and waits until it has loaded its sessions.
  void start() {
    server = make(data());
    ASSERT_TRUE(server);
    port = server->port();
    ASSERT_TRUE(eventually([&] {
      const Answer ready = ask("GET", "/readyz");
      return ready.json().at("status") != "loading";
    }));
  }
  /// Makes a server with `options` on another folder.
  std::unique_ptr<net::Server> make(const std::filesystem::path& folder_of_data) {
    options.port = 0;
    options.udp.on = false;
    options.http.data_folder = folder_of_data;
    options.admin_token = admin;
    auto made = net::Server::create(options);
    EXPECT_TRUE(made) << made.error();
    if (!made) return nullptr;
    const auto listening = (*made)->listen();
    EXPECT_TRUE(listening) << listening.error();
    return *std::move(made);
  }
  /// Ends the server and starts the next one on its folder.
  void restart() {
    server.reset();
    start();
  }

  std::filesystem::path data() const { return folder / "data"; }
  std::filesystem::path journal(const std::string& session = "block") const {
    return data() / (session + ".kerf");
  }
  Answer ask(const std::string& method, const std::string& target, const std::string& body = {},
             Headers headers = {}) const {
    if (!admin.empty() && headers.empty()) headers = bearer(admin);
    return test::ask(port, method, target, body, headers);
  }
  /// The JSON of a request that succeeds.
  Json made(const std::string& method, const std::string& target, const std::string& body = {}) {
    const Answer answer = ask(method, target, body);
    EXPECT_TRUE(answer.status >= 200 && answer.status < 300)
        << method << " " << target << ": " << answer.status << " " << answer.body;
    return answer.json();
  }
  /// "STATUS CODE" of a request that fails.
  std::string error(const std::string& method, const std::string& target,
                    const std::string& body = {}, const Headers& headers = {}) {
    const Answer answer = ask(method, target, body, headers);
    EXPECT_FALSE(answer.json().at("error").at("reason").get<std::string>().empty());
    return std::to_string(answer.status) + " " + answer.code();
  }
  void create(const std::string& session, const Json& scene = kBlock) {
    made("POST", "/v1/sessions?id=" + session, scene.dump());
  }
  Json info(const std::string& session = "block") { return made("GET", "/v1/sessions/" + session); }
  std::string hash(const std::string& session = "block") { return info(session).at("state_hash"); }
  /// Waits until all that was accepted is in the journal.
  void wait_for_the_journal(const std::string& session = "block") {
    EXPECT_TRUE(eventually([&] { return info(session).at("journal_lag") == 0; }));
  }

  /// Uploads a program; returns its status.
  Json upload(const std::string& text, const std::string& query,
              const std::string& session = "block") {
    return made("POST", "/v1/sessions/" + session + "/programs?" + query, text);
  }
  /// The status of a program once it is in a state.
  Json wait_for(const Json& program, const std::string& state) {
    Json status;
    EXPECT_TRUE(eventually([&] {
      status = made("GET", program.at("url"));
      return status.at("state") == state;
    })) << status;
    return status;
  }

  const TemporaryFolder folder;
  net::ServerOptions options;
  std::string admin;  ///< the administrator's token; empty: all may do everything
  std::unique_ptr<net::Server> server;
  std::uint16_t port = 0;
};

}  // namespace kerf::test
