// SPDX-License-Identifier: Apache-2.0
// UDP of a whole server: its port, the keys of agents, and both transports together.
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/datagram/cipher.h"
#include "server/server.h"
#include "server/wire/codec.h"
#include "tests/bench/raster_agent.h"
#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::net::server_udp_test {
namespace {

/// Motions of its first tool take several turns of the session.
constexpr const char* kWide = R"({"name": "wide",
  "stock": {"shape": "box", "min_mm": [-120, -120, -20], "max_mm": [120, 120, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.2, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "flat", "diameter_mm": 200, "length_mm": 60},
            {"id": 2, "shape": "flat", "diameter_mm": 60, "length_mm": 60}]})";

wire::MotionBatch batch_of(const std::vector<wire::MotionSample>& samples) {
  wire::MotionBatch batch;
  for (const wire::MotionSample& sample : samples) batch.samples.at(batch.count++) = sample;
  return batch;
}

wire::MotionSample sample(std::uint64_t number, Vec3 tip_mm, std::uint32_t tool = 1) {
  return {.agent_sequence = number,
          .time_us = 1'000'000 + 1000 * number,
          .tip_mm = tip_mm,
          .tool_id = tool,
          .buttons = wire::kButtonCutting};
}

/// An agent that may use both transports.
class Agent {
 public:
  Agent(std::uint16_t port, const std::string& session, bool asks = true)
      : socket_(std::make_unique<bench::WebSocket>(port, "/v1/sessions/" + session + "/agent",
                                                   std::string(wire::kAgentProtocol))) {
    send_text(std::string(R"({"type":"hello","name":"Ada","tool":1,"udp":)") +
              (asks ? "true}" : "false}"));
    welcome_ = text();
  }
  ~Agent() {
    if (udp_ >= 0) close(udp_);
  }
  Agent(const Agent&) = delete;
  Agent& operator=(const Agent&) = delete;

  bool has_offer() const { return welcome_.contains("\"key_to_server\""); }
  std::string field(const char* name) const { return bench::json_field(welcome_, name); }
  void open_udp(std::uint16_t port) {
    const auto connection = static_cast<std::uint32_t>(std::stoul(field("connection")));
    sealer_.emplace(connection, *datagram::key_from_text(field("key_to_server")));
    opener_.emplace(connection, *datagram::key_from_text(field("key_to_agent")));
    udp_ = socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in server{};
    server.sin_family = AF_INET;
    server.sin_port = htons(port);
    server.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ASSERT_EQ(connect(udp_, reinterpret_cast<const sockaddr*>(&server), sizeof server), 0);
    const timeval limit{30, 0};
    setsockopt(udp_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  }

  template <typename Body>
  std::vector<std::byte> sealed(const Body& body) {
    std::vector<std::byte> frame, datagram(datagram::kMaxBytes);
    wire::append(frame, {bench::kNewEpoch, 1, 0}, body);
    datagram.resize(sealer_->seal(frame, datagram));
    return datagram;
  }
  void send_raw(const std::vector<std::byte>& datagram) const {
    (void)::send(udp_, datagram.data(), datagram.size(), 0);
  }
  template <typename Body>
  void send_datagram(const Body& body) {
    send_raw(sealed(body));
  }
  template <typename Body>
  void send_frame(const Body& body) {
    std::vector<std::byte> frame;
    wire::append(frame, {bench::kNewEpoch, 1, 0}, body);
    socket_->send(2, frame);
  }
  void send_text(const std::string& text) { socket_->send(1, std::as_bytes(std::span(text))); }

  /// Receives the next datagram. Its frame must have this type of body.
  template <typename Body>
  Body receive_datagram() {
    std::vector<std::byte> datagram(datagram::kMaxBytes), frame(datagram::kMaxFrameBytes);
    const auto count = recv(udp_, datagram.data(), datagram.size(), 0);
    EXPECT_GT(count, 0);
    if (count <= 0) return {};
    const auto opened =
        opener_->open(std::span(datagram).first(static_cast<std::size_t>(count)), frame);
    EXPECT_TRUE(opened);
    if (!opened) return {};
    return std::get<Body>(wire::decode(std::span(frame).first(opened->frame_bytes))->body);
  }
  /// Waits for the WebSocket result that answers a sample.
  void wait_for_result(std::uint64_t number) {
    std::string payload;
    for (;;) {
      if (socket_->receive(payload, bench::in_seconds(30)) != 2) continue;
      const auto message = wire::decode(std::as_bytes(std::span(payload)));
      const auto* result = message ? std::get_if<wire::Result>(&message->body) : nullptr;
      if (result != nullptr && result->agent_sequence >= number) return;
    }
  }
  void leave() { socket_.reset(); }

 private:
  std::string text() {
    std::string payload;
    while (socket_->receive(payload, bench::in_seconds(30)) != 1) continue;
    return payload;
  }

  std::unique_ptr<bench::WebSocket> socket_;
  std::string welcome_;
  std::optional<datagram::Sealer> sealer_;
  std::optional<datagram::Opener> opener_;
  int udp_ = -1;
};

class ServerUdp : public testing::Test {
 protected:
  std::expected<void, std::string> start(const UdpOptions& udp) {
    server_.reset();
    ServerOptions options{.port = 0, .http = {.data_folder = folder_.path()}, .udp = udp};
    auto made = Server::create(options);
    EXPECT_TRUE(made) << made.error();
    server_ = *std::move(made);
    return server_->listen();
  }
  void start_with_udp() { ASSERT_TRUE(start({.required = true, .address = {}, .port = 0})); }
  void create(const std::string& session) const {
    bench::post(server_->port(), "/v1/sessions?id=" + session, kWide);
  }
  std::string info(const std::string& session, const char* field) const {
    return bench::json_field(bench::get(server_->port(), "/v1/sessions/" + session), field);
  }
  double dropped(const std::string& reason) const {
    const std::string text = bench::get(server_->port(), "/metrics");
    const std::string line = "\nkerf_datagrams_dropped_total{reason=\"" + reason + "\"} ";
    const auto at = text.find(line);
    return at == text.npos ? -1 : std::stod(text.substr(at + line.size()));
  }

  const test::TemporaryFolder folder_;
  std::unique_ptr<Server> server_;
};

TEST_F(ServerUdp, APortInUseIsAnErrorOnlyIfItWasNamed) {
  start_with_udp();
  create("block");
  const test::TemporaryFolder folder;
  ServerOptions second{.port = 0};
  second.udp = {.required = true, .address = {}, .port = server_->udp_port()};
  second.http.data_folder = folder.path();
  auto other = *Server::create(second);
  const auto error = test::error_of(other->listen());
  EXPECT_TRUE(error.starts_with("cannot listen for UDP on 127.0.0.1")) << error;
  other.reset();
  second.udp.required = false;
  other = *Server::create(second);
  ASSERT_TRUE(other->listen());
  EXPECT_EQ(other->udp_port(), 0);
  bench::post(other->port(), "/v1/sessions?id=block", kWide);
  EXPECT_FALSE(Agent(other->port(), "block").has_offer());
  EXPECT_TRUE(Agent(server_->port(), "block").has_offer());
}

TEST_F(ServerUdp, KeysBelongToOneAgentAndEndWithItsWebSocket) {
  start_with_udp();
  create("block");
  EXPECT_FALSE(Agent(server_->port(), "block", false).has_offer());
  std::set<std::string> different;
  for (int n = 0; n < 3; ++n) {
    const Agent agent(server_->port(), "block");
    EXPECT_EQ(agent.field("port"), std::to_string(server_->udp_port()));
    for (const char* name : {"connection", "key_to_server", "key_to_agent"}) {
      different.insert(agent.field(name));
    }
  }
  EXPECT_EQ(different.size(), 9U);
  Agent agent(server_->port(), "block");
  agent.open_udp(server_->udp_port());
  agent.send_datagram(wire::Ping{7});
  EXPECT_EQ(agent.receive_datagram<wire::Pong>().ping_time_us, 7U);
  const double before = dropped("unknown_connection");
  agent.leave();
  EXPECT_TRUE(test::eventually([&] {
    agent.send_datagram(wire::Ping{8});
    return dropped("unknown_connection") > before;
  }));
}

// A session cuts a wide motion in several turns and reads other agents' frames in between.
TEST_F(ServerUdp, BatchCutInTurnsKeepsItsOrder) {
  start_with_udp();
  const auto carve = [this](const std::string& session, bool udp) {
    create(session);
    Agent agent(server_->port(), session, udp);
    agent.send_frame(batch_of({sample(1, {-10, 0, -2})}));
    agent.wait_for_result(1);
    std::vector<wire::MotionSample> wide, narrow;
    for (std::uint64_t n = 2; n <= 5; ++n) {
      const auto x = static_cast<double>(n);
      wide.push_back(sample(n, {x - 10, 0, -2 - 0.1 * x}));
      narrow.push_back(sample(n + 4, {x + 4, 10, -6 - x}, 2));
    }
    if (udp) {
      agent.open_udp(server_->udp_port());
      agent.send_datagram(batch_of(wide));
      while (info(session, "motions") == "0") std::this_thread::yield();  // motions sent: four
    } else {
      agent.send_frame(batch_of(wide));
    }
    agent.send_text(R"({"type":"tool","tool":2})");
    agent.send_frame(batch_of(narrow));
    agent.wait_for_result(9);
    if (udp) {
      EXPECT_EQ(agent.receive_datagram<wire::Result>().agent_sequence, 5U);
    }
    return info(session, "motions") + " " + info(session, "state_hash");
  };
  const std::string plain = carve("plain", false);
  EXPECT_TRUE(plain.starts_with("7 ")) << plain;
  EXPECT_EQ(carve("udp", true), plain);
}

TEST_F(ServerUdp, FloodIsDroppedAndOtherAgentsAreAnswered) {
  start_with_udp();
  create("block");
  Agent flood(server_->port(), "block"), other(server_->port(), "block", false);
  flood.open_udp(server_->udp_port());
  for (std::uint64_t n = 0; n < 4000; ++n) {
    const auto datagram = flood.sealed(wire::Ping{n});
    flood.send_raw(datagram);
    flood.send_raw(datagram);
    if (n % 100 != 0) continue;
    other.send_frame(batch_of({sample(n / 100 + 1, {5 + 0.01 * static_cast<double>(n), 5, -1})}));
    other.wait_for_result(n / 100 + 1);
  }
  EXPECT_TRUE(test::eventually([this] { return dropped("replayed") > 0; }));
  EXPECT_EQ(info("block", "motions"), "39");
}

}  // namespace
}  // namespace kerf::net::server_udp_test
