// SPDX-License-Identifier: Apache-2.0
// Frames of an agent and a viewer of one session, in any order.
#include <optional>

#include "server/conversation/agent_conversation.h"
#include "server/conversation/viewer_conversation.h"
#include "server/platform/clock.h"
#include "tests/fuzz/targets.h"
#include "tests/server/manual_executor.h"
#include "tests/support/temporary_folder.h"

namespace kerf::fuzz {
namespace {

constexpr const char* kScene = R"({"name": "fuzz",
  "stock": {"shape": "box", "min_mm": [-8, -8, -8], "max_mm": [8, 8, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "ball", "diameter_mm": 4, "length_mm": 20},
            {"id": 2, "shape": "flat", "diameter_mm": 3, "length_mm": 20}]})";
/// Inputs per session, because creating one takes longer than running them.
constexpr int kInputsPerSession = 500;

class Rig {
 public:
  void run(Bytes input) {
    if (inputs_++ % kInputsPerSession == 0) restart();
    net::AgentConversation agent({.session = session_,
                                  .limits = limits_,
                                  .metrics = metrics_,
                                  .now = [this] { return now_; },
                                  .wake = [] {},
                                  .open_udp = [] { return std::nullopt; }});
    net::ViewerConversation viewer(session_, metrics_, [this] { return now_; }, [] {});
    // Each step has a byte that states the receiver and the kind, two for the length, and the
    // frame.
    while (input.size() >= 3) {
      const auto kind = std::to_integer<unsigned>(input[0]);
      const std::size_t length =
          std::min(input.size() - 3, std::to_integer<std::size_t>(input[1]) |
                                         std::to_integer<std::size_t>(input[2]) << 8U);
      step(agent, viewer, kind, input.subspan(3, length));
      input = input.subspan(3 + length);
    }
    agent.end();
    viewer.end();
    if (viewer.id() != 0) session_->leave(viewer.id());
    executor_->run();
  }

 private:
  void restart() {
    session_.reset();
    registry_.reset();
    folder_.emplace();
    registry_.emplace(
        RegistryOptions{folder_->path(), 4, limits_},
        [this](const std::string&) { return executor_; }, workers_);
    session_ = registry_->create("fuzz", kScene, SceneSource{}).value();
  }
  void step(net::AgentConversation& agent, net::ViewerConversation& viewer, unsigned kind,
            Bytes frame) {
    now_ += std::chrono::milliseconds(kind >> 2U);
    net::Conversation& to = (kind & 1U) != 0 ? static_cast<net::Conversation&>(viewer) : agent;
    to.receive(frame, (kind & 2U) != 0, now_);
    for (int n = 0; n < 1000 && agent.has_action(); ++n) agent.work();
    while (const auto action = viewer.take_action()) {
      const auto* request = std::get_if<JoinRequest>(&*action);
      if (request != nullptr) viewer.joined(session_->join(*request), session_->roster());
    }
    to.refresh();
    drain(agent);
    drain(viewer);
    executor_->run();
  }
  static void drain(net::Conversation& conversation) {
    net::OutFrame frame;
    for (int frames = 0; conversation.take(frame); ++frames) {
      require(frames < 1000, "a frame is answered by few");
      conversation.sent(frame);
    }
  }

  Clock::time_point now_{std::chrono::hours(1)};
  SessionLimits limits_;
  net::Metrics metrics_;
  std::optional<test::TemporaryFolder> folder_;
  std::shared_ptr<test::ManualExecutor> executor_ = std::make_shared<test::ManualExecutor>();
  test::ManualExecutor workers_;
  std::optional<SessionRegistry> registry_;
  std::shared_ptr<Session> session_;
  int inputs_ = 0;
};

}  // namespace

void converse(Bytes input) {
  static Rig rig;
  rig.run(input);
}

}  // namespace kerf::fuzz
