// SPDX-License-Identifier: Apache-2.0
// After any number of server kills and lost connections, each motion of an agent is in the journal
// once, in order, at its position, under the same participant, and the solid is that of an
// uninterrupted run. The agents' Traffic and the server's AgentConversation run on a simulated
// network and clock, the journal on real files.
#include "haptic_agent/link/control_message.h"
#include "haptic_agent/link/traffic.h"
#include "server/conversation/agent_conversation.h"
#include "server/formats/pose_grid.h"
#include "server/platform/clock.h"
#include "server/store/journal_reader.h"
#include "tests/server/session_fixture.h"
#include "tests/server/store/faulty_disk.h"
#include "tests/support/test.h"

namespace kerf::agent::resume_property_test {
namespace {

/// The session to which the agents connect, while the server runs, and the simulated clock.
struct World {
  std::shared_ptr<Session> session;
  const SessionLimits& limits;
  net::Metrics& metrics;
  std::uint64_t now_us = 1'000'000;

  kerf::Clock::time_point time() const {
    return kerf::Clock::time_point(std::chrono::microseconds(now_us));
  }
};

struct MadeMotion {
  ToolId tool = 0;
  Vec3 from_mm, to_mm;
  std::uint64_t stroke = 0;  ///< stroke in the journal
};

/// The session rounds positions to 1e-6 mm.
bool is_same(const MadeMotion& a, const MadeMotion& b) {
  return a.tool == b.tool && length(a.from_mm - b.from_mm) < 1e-5 &&
         length(a.to_mm - b.to_mm) < 1e-5;
}

/// An agent that carves its own strip of the block, with its connection.
class Carver {
 public:
  Carver(World& world, int number, std::uint64_t seed)
      : world_(world), random_(seed), y_mm_(-12.0 + 6.0 * number) {
    hello_.name = "carver " + std::to_string(number);
    hello_.tool_id = 1;
  }

  bool is_connected() const { return server_ != nullptr; }
  /// Connects. If the server does not know that an earlier connection has ended, it keeps that one.
  void connect() {
    half_open_ = std::exchange(server_, nullptr);
    to_server_.clear();
    to_agent_.clear();
    server_ = std::make_unique<net::AgentConversation>(
        net::AgentConversation::Setup{.session = world_.session,
                                      .limits = world_.limits,
                                      .metrics = world_.metrics,
                                      .now = [this] { return world_.time(); },
                                      .wake = {},
                                      .open_udp = {}});
    const std::string hello = hello_text(hello_);
    server_->receive(std::as_bytes(std::span(hello)), true, world_.time());
    ASSERT_TRUE(server_->has_joined());
    net::OutFrame out;
    ASSERT_TRUE(server_->take(out));
    const auto message = test::value_of(
        parse_control({reinterpret_cast<const char*>(out.bytes.data()), out.bytes.size()}));
    const auto& welcome = std::get<Welcome>(message);
    ASSERT_TRUE(welcome.resume);
    EXPECT_EQ(welcome.resume->resumed, !hello_.resume.empty());
    EXPECT_EQ(welcome.text.find(welcome.resume->token), std::string::npos);
    if (participant_ != 0) {
      EXPECT_EQ(welcome.participant, participant_);
      repeated_ += welcome.resume->agent_sequence;
    }
    participant_ = welcome.participant;
    hello_.resume = welcome.resume->token;
    traffic_.begin(welcome.epoch, 1, world_.now_us, false, welcome.resume->agent_sequence);
    delay_us_ = random_() % 40'000;
  }
  /// The connection is lost, and the server knows.
  void disconnect() {
    if (server_) server_->end();
    server_.reset();
    half_open_.reset();
  }
  /// The server is gone.
  void lose_server() {
    server_.reset();
    half_open_.reset();
  }

  void step(int samples) {
    for (int i = 0; i < samples; ++i) make_sample();
    traffic_.collect();
    if (!server_) return;
    (void)traffic_.settle(world_.now_us);
    send();
    while (!to_server_.empty() && to_server_.front().first <= world_.now_us) {
      at_server(to_server_.front().second);
      to_server_.pop_front();
    }
    while (!to_agent_.empty() && to_agent_.front().first <= world_.now_us) {
      EXPECT_FALSE(traffic_.take_frame(to_agent_.front().second, world_.now_us));
      to_agent_.pop_front();
    }
    if (half_open_) {
      EXPECT_TRUE(half_open_->finishing());
    }
  }

  bool settled() const { return traffic_.settled(); }
  LinkReport report() const { return traffic_.report(); }
  ParticipantId participant() const { return participant_; }
  const std::vector<MadeMotion>& made() const { return motions_; }

 private:
  using Frame = std::vector<std::byte>;
  using Transit = std::deque<std::pair<std::uint64_t, Frame>>;

  void make_sample() {
    ++made_;
    const std::uint32_t before = tool_;
    if (random_() % 100 == 0) tool_ = 3 - tool_;
    // No three samples are collinear, so none may be omitted. Each position occurs once.
    const double along = 0.03 * static_cast<double>(made_);
    const Vec3 tip{-18 + std::fmod(along, 36.0), y_mm_ + 0.01 * along,
                   -0.5 - 0.004 * along - (made_ % 2 == 0 ? 0.2 : 0.0)};
    last_time_us_ = std::max(last_time_us_ + 1, world_.now_us);
    ASSERT_TRUE(ring_.push({.time_us = last_time_us_,
                            .tip_mm = tip,
                            .tool_id = tool_,
                            .buttons = wire::kButtonCutting}));
    if (made_ > 1 && tool_ == before) motions_.push_back({tool_, last_tip_, tip, 0});
    last_tip_ = tip;
  }

  void post(Transit& transit, std::span<const std::byte> frame) {
    transit.emplace_back(world_.now_us + delay_us_, Frame(frame.begin(), frame.end()));
  }
  void send() {
    std::array<std::byte, wire::kMaxClientFrameBytes> frame;
    for (;;) {
      if (const std::string text = traffic_.take_control(world_.now_us); !text.empty()) {
        post(to_server_, std::as_bytes(std::span(text)));
        continue;
      }
      const std::size_t bytes = traffic_.fill(world_.now_us, frame);
      if (bytes == 0) return;
      post(to_server_, std::span(frame).first(bytes));
    }
  }
  void at_server(const Frame& frame) {
    server_->receive(frame, frame.front() == std::byte{'{'}, world_.time());
    net::OutFrame out;
    while (server_->take(out)) {
      if (!out.is_text()) post(to_agent_, out.bytes);
    }
    server_->refresh();
  }

  World& world_;
  std::mt19937_64 random_;
  double y_mm_;
  Hello hello_;
  SampleRing ring_;
  LatestValue<ServerWrench> wrenches_;
  Traffic traffic_{ring_, wrenches_};
  std::unique_ptr<net::AgentConversation> server_, half_open_;
  Transit to_server_, to_agent_;
  ParticipantId participant_ = 0;
  std::uint64_t made_ = 0, last_time_us_ = 0, delay_us_ = 0, repeated_ = 0;
  std::uint32_t tool_ = 1;
  Vec3 last_tip_;
  std::vector<MadeMotion> motions_;
};

class ResumeProperty : public SessionTest {
 protected:
  void SetUp() override {
    // The session limits rates by the real clock, which is slower than the simulated one.
    limits.samples_per_s = limits.samples_burst = limits.speed_mm_per_s = 1e12;
    limits.carver_joins_per_s = limits.carver_joins_burst = 1e12;
    snapshots = {.writer = &writer, .limits = {.replay_time = {}, .age = {}, .pause = {}}};
    SessionTest::SetUp();
  }
  void TearDown() override {
    writer = {};
    registry.reset();  // closes the journals before the disk goes
  }

  /// Ends the server like SIGKILL: the files stay as they are at this moment.
  void kill(World& world, const std::string& id) {
    const auto file = folder.path() / (id + kJournalExtension);
    const auto copy = folder.path() / "killed";
    disk.hold([&] {
      for (const char* suffix : {"", "-wal", "-snapshot"}) {
        std::error_code ignored;
        std::filesystem::copy_file(file.string() + suffix, copy.string() + suffix,
                                   std::filesystem::copy_options::overwrite_existing, ignored);
      }
    });
    writer = {};  // its work holds the session
    world.session.reset();
    restart();
    remove_journal(file);
    for (const char* suffix : {"", "-wal", "-snapshot"}) {
      std::error_code ignored;
      std::filesystem::rename(copy.string() + suffix, file.string() + suffix, ignored);
    }
    const LoadReport report = registry->load_all();
    ASSERT_TRUE(report.failures.empty()) << describe(report.failures.front());
    ASSERT_TRUE(report.ignored.empty()) << report.ignored.front().reason;
    restored += std::filesystem::exists(file.string() + "-snapshot") ? 1 : 0;
    world.session = registry->find(id);
  }

  static std::map<ParticipantId, std::vector<MadeMotion>> journaled(Session& session) {
    std::map<ParticipantId, std::vector<MadeMotion>> motions;
    EXPECT_TRUE(session.flush());
    auto reader = JournalReader::open(session.journal_file());
    EXPECT_TRUE(reader);
    for (auto record = reader->next(); record && *record; record = reader->next()) {
      const auto* move = std::get_if<MoveTool>(&(*record)->command);
      if (move == nullptr) continue;
      motions[(*record)->participant].push_back(
          {move->tool, move->from.tip_mm, move->to.tip_mm, (*record)->stroke});
    }
    return motions;
  }

  /// Expects the motions of an agent in the journal, and carves them again. A stroke ends where the
  /// tool was lifted, and at each of the `kills`.
  static void expect_all_cut(const Carver& carver, const std::vector<MadeMotion>& journaled,
                             std::uint64_t kills, Sculpture& uninterrupted) {
    const auto differs = std::ranges::mismatch(journaled, carver.made(), is_same);
    ASSERT_TRUE(differs.in1 == journaled.end() && differs.in2 == carver.made().end())
        << "motion " << differs.in1 - journaled.begin() << " of " << journaled.size()
        << "; made were " << carver.made().size();
    std::uint64_t ended_by_kills = 0;
    for (std::size_t i = 1; i < journaled.size(); ++i) {
      const bool continues = journaled[i].from_mm == journaled[i - 1].to_mm;
      const bool same_stroke = journaled[i].stroke == journaled[i - 1].stroke;
      EXPECT_TRUE(continues || !same_stroke) << i;
      ended_by_kills += continues && !same_stroke ? 1 : 0;
    }
    EXPECT_LE(ended_by_kills, kills);
    for (const MadeMotion& motion : carver.made()) {
      const ToolPose from = admit_pose({motion.from_mm, {0, 0, 1}});
      const ToolPose to = admit_pose({motion.to_mm, {0, 0, 1}});
      ASSERT_TRUE(uninterrupted.apply(MoveTool{motion.tool, from, to, 0.001, false}));
    }
  }

  test::FaultyDisk disk;
  net::Metrics metrics;
  test::ManualExecutor writer;
  int restored = 0;  ///< number of sessions restored from a snapshot
};

TEST_F(ResumeProperty, EachSampleIsCutOnceThroughAnyNumberOfServerKills) {
  std::mt19937_64 random(7);
  std::uint64_t kills = 0, resent = 0, resumed = 0, lost = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::uint64_t kills_before = kills;
    restart();
    const std::string id = "s" + std::to_string(seed);
    World world{*registry->create(id, kScene, SceneSource{}), limits, metrics};
    std::deque<Carver> carvers;
    for (int n = 0; n < 3; ++n) {
      carvers.emplace_back(world, n, 10 * seed + static_cast<std::uint64_t>(n));
      carvers.back().connect();
    }
    ASSERT_TRUE(world.session->flush());  // a kill before it would lose the participants
    bool settled = false;
    for (int ms = 0; ms < 30'000 && !settled; ++ms) {
      const bool moves = ms < 700;
      if (random() % 100 == 0) {
        writer.run();  // writes the due snapshot
        executor->run();
      }
      world.now_us += 1000;
      // The disk commits at random moments; time passes faster than the disk works.
      if (random() % 60 == 0) {
        ASSERT_TRUE(world.session->flush());
      }
      if (moves && random() % 150 == 0) {
        const std::uint64_t before = world.session->sequence();
        kill(world, id);
        lost += before - world.session->sequence();
        for (Carver& carver : carvers) carver.lose_server();
        ++kills;
      }
      settled = !moves;
      for (Carver& carver : carvers) {
        const auto event = moves ? random() % 400 : 2;
        if (event == 0) carver.disconnect();
        if (event == 1) carver.connect();
        // Agents reconnect in any order.
        if (!carver.is_connected() && random() % 30 == 0) carver.connect();
        carver.step(moves ? 1 : 0);
        settled = settled && carver.is_connected() && carver.settled();
      }
    }
    ASSERT_TRUE(settled);
    const auto applied = journaled(*world.session);
    Sculpture uninterrupted = Sculpture::create(world.session->scene()->settings).value();
    for (const auto& [tool_id, tool] : world.session->scene()->tools) {
      ASSERT_TRUE(uninterrupted.apply(DefineTool{tool_id, tool.tool}));
    }
    for (const Carver& carver : carvers) {
      const LinkReport report = carver.report();
      EXPECT_EQ(report.merged_cuts + report.merged_air + report.forgotten + report.given_up, 0U);
      EXPECT_EQ(report.not_durable, 0U);
      resent += report.resent;
      resumed += report.connections - 1;
      expect_all_cut(carver, applied.at(carver.participant()), kills - kills_before, uninterrupted);
    }
    EXPECT_EQ(world.session->solid().hash(), uninterrupted.state_hash());
    for (Carver& carver : carvers) carver.disconnect();
  }
  // All of these cases have occurred.
  EXPECT_GT(kills, 10U);
  EXPECT_GT(restored, 3);
  EXPECT_GT(lost, 200U) << "motions that were not on the disk when the server was killed";
  EXPECT_GT(resent, 300U);
  EXPECT_GT(resumed, 40U);
}

}  // namespace
}  // namespace kerf::agent::resume_property_test
