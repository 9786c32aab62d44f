// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/session_registry.h"
#include "tests/server/manual_executor.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf {

inline constexpr const char* kScene = R"({
  "name": "Test block",
  "stock": {"shape": "box", "min_mm": [-20, -20, -20], "max_mm": [20, 20, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60},
            {"id": 2, "shape": "flat", "diameter_mm": 6, "length_mm": 60}],
  "machine": {"kinematics": "tool-vector"}})";

/// A registry with a temporary data folder. Its sessions run on `executor`, step by step.
class SessionTest : public testing::Test {
 protected:
  /// Discards the sessions and creates a registry of the same folder, like a restarted server.
  void restart() {
    registry.emplace(
        RegistryOptions{.data_folder = folder.path(),
                        .sessions_max = 4,
                        .session = limits,
                        .snapshots = snapshots,
                        .matters = matters},
        [this](const std::string&) { return executor; }, workers);
  }
  void SetUp() override { restart(); }
  std::shared_ptr<Session> start(const std::string& scene = kScene) {
    auto created = registry->create("block", scene, SceneSource{});
    EXPECT_TRUE(created) << created.error().reason;
    return *created;
  }
  ParticipantId join(Session& session, const std::string& name = "Ada") {
    const auto joined = session.join({ParticipantKind::kAgent, name, "", 1, true});
    EXPECT_TRUE(joined);
    return joined->id;
  }
  /// Returns a cutting sample one millisecond after the previous one of the test.
  wire::MotionSample next(double x_mm, double y_mm, double z_mm) {
    return wire::MotionSample{.agent_sequence = ++sequence,
                              .time_us = 1000 * sequence,
                              .tip_mm = {x_mm, y_mm, z_mm},
                              .tool_id = 1,
                              .buttons = wire::kButtonCutting};
  }
  MotionAnswer move(Session& session, ParticipantId id, double x_mm, double y_mm, double z_mm) {
    const wire::MotionSample sample = next(x_mm, y_mm, z_mm);
    return session.move(id, {&sample, 1});
  }
  void carve_circle(Session& session, ParticipantId id, int steps = 200) {
    for (int i = 0; i <= steps; ++i) {
      const double angle = 6.4 * i / steps;
      const auto answer =
          move(session, id, 10 * std::cos(angle), 10 * std::sin(angle), -1 - 0.01 * i);
      ASSERT_TRUE(answer.rejections.empty());
    }
  }

  test::TemporaryFolder folder;
  SessionLimits limits;
  SnapshotOptions snapshots;        ///< none by default
  std::vector<MakeMatter> matters;  ///< likewise
  std::shared_ptr<test::ManualExecutor> executor = std::make_shared<test::ManualExecutor>();
  test::ManualExecutor workers;
  std::optional<SessionRegistry> registry;
  std::uint64_t sequence = 0;
};

}  // namespace kerf
