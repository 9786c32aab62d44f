// SPDX-License-Identifier: Apache-2.0
#include <set>

#include "server/session/replay.h"
#include "tests/server/session_fixture.h"

namespace kerf {
namespace {

/// Runs work at once, on the thread that posts it; never what is delayed.
class ImmediateExecutor final : public Executor {
 public:
  void post(Work work) override { work(); }
  void post_after(std::chrono::microseconds, Work) override {}
};

TEST_F(SessionTest, KeptJournalsOfOneNameDoNotOverwriteEachOther) {
  registry.emplace(
      RegistryOptions{folder.path(), 4, limits},
      [](const std::string&) { return std::make_shared<ImmediateExecutor>(); }, workers);
  std::set<std::uint64_t> sequences;
  for (int n = 0; n < 5; ++n) {
    const auto session = start();
    sequence = 0;
    carve_circle(*session, join(*session), 200 + n);
    sequences.insert(session->sequence());
    EXPECT_TRUE(registry->close("block", false));
  }
  std::set<std::uint64_t> kept;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "closed")) {
    const auto replayed = replay(entry.path());
    ASSERT_TRUE(replayed) << describe(replayed.error());
    kept.insert(replayed->last_sequence);
  }
  EXPECT_EQ(kept, sequences);
}

}  // namespace
}  // namespace kerf
