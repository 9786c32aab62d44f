// SPDX-License-Identifier: Apache-2.0
// One allocation fails during a request that reads the past of a session, or starts one. Then the
// request was rejected and has changed nothing, and can be repeated.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <new>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "server/session/past_block.h"
#include "server/session/session_export.h"
#include "server/session/session_past_source.h"
#include "tests/server/memory_fixture.h"

namespace kerf::memory_requests_test {
namespace {

using namespace std::chrono_literals;

class RequestWithoutMemory : public SessionWithoutMemory {
 protected:
  void carve_and_undo() {
    carve_three_strokes();
    undo({crossing_});
    middle_ = session_->sequence();
    stroke(ada_, {-15, -8, -2}, {15, -8, -3});
    redo({crossing_});
    live_ = hash();
    ASSERT_EQ(live_, never_happened());
  }
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_->path())) {
      names.insert(entry.path().filename().string());
    }
    return names;
  }
  /// Checks that the session continues as if nothing had happened.
  void expect_same_session() {
    EXPECT_FALSE(session_->is_between_records());
    EXPECT_EQ(hash(), live_);
  }

  std::uint64_t middle_ = 0, live_ = 0;
};

TEST_F(RequestWithoutMemory, ABlockOfThePastSeeksAndPlaysOn) {
  carve_and_undo();
  const std::uint64_t last = session_->sequence();
  auto block = PastBlock::create(past_of(session_)).value();
  const auto play = [&] { return block.play({.record = last}, 1h, {}); };
  const auto request = [&] {
    if (block.seek(middle_, {})) (void)play();
  };
  const auto check = [&] {
    // A seek that failed has left the block where it was, at the last record.
    const auto played = play();
    ASSERT_TRUE(played) << played.error();
    EXPECT_EQ(block.record(), last);
    EXPECT_EQ(block.solid().hash(), live_);
    expect_same_session();
  };
  ASSERT_TRUE(block.seek(last, {}));
  fail_each([] {}, request, check);
  ASSERT_TRUE(block.seek(middle_, {}));
  EXPECT_EQ(block.solid().hash(), never_happened(middle_));
}

TEST_F(RequestWithoutMemory, ExportsAreCompleteOrFail) {
  carve_and_undo();
  const auto journal = session_->journal_file();
  using Export = std::function<ExportResult(std::ostream&)>;
  const std::vector<Export> exports = {
      [&](std::ostream& out) { return export_program(journal, {}, out); },
      [&](std::ostream& out) { return export_forces(journal, {}, out); },
      [&](std::ostream& out) { return export_force_plot(journal, {}, out); }};
  for (const Export& write : exports) {
    const auto text = [&] {
      std::ostringstream out;
      return write(out) ? std::optional(out.str()) : std::nullopt;
    };
    const auto complete = text();
    ASSERT_TRUE(complete);
    std::optional<std::string> written;
    fail_each([&] { written.reset(); }, [&] { written = text(); },
              [&] {
                EXPECT_EQ(written.value_or(*complete), *complete);
                EXPECT_EQ(text(), complete);
                expect_same_session();
              });
  }
}

TEST_F(RequestWithoutMemory, SolidsOfThePastAreRightOrFail) {
  carve_and_undo();
  const std::uint64_t right = never_happened(middle_);
  SerialWorkers alone;
  std::optional<std::uint64_t> found;
  const auto look = [&] {
    found = session_->past().solid_at(middle_, alone).value().value().hash();
  };
  const auto check = [&] {
    EXPECT_EQ(found.value_or(right), right);
    look();
    EXPECT_EQ(*found, right);
    expect_same_session();
  };
  fail_each([&] { found.reset(); }, look, check);
}

TEST_F(RequestWithoutMemory, ABranchIsWholeOrLeavesNothing) {
  carve_and_undo();
  const std::uint64_t right = never_happened(middle_);
  const auto before = files();
  const auto branch = [&] { (void)registry_->branch("copy", *session_, middle_); };
  const auto check = [&] {
    if (!registry_->find("copy")) {
      EXPECT_EQ(files(), before);
      branch();
    }
    const auto copy = registry_->find("copy");
    ASSERT_TRUE(copy);
    EXPECT_EQ(copy->solid().hash(), right);
    expect_same_session();
    close("copy");
  };
  fail_each([] {}, branch, check);
}

TEST_F(RequestWithoutMemory, ANewSessionIsWholeOrLeavesNothing) {
  carve_and_undo();
  const auto before = files();
  const std::uint64_t untouched =
      Sculpture::create(session_->scene().settings).value().state_hash();
  const auto create_one = [&] { (void)registry_->create("new", kScene, SceneSource{}); };
  const auto check = [&] {
    if (!registry_->find("new")) {
      EXPECT_EQ(files(), before);
      create_one();
    }
    const auto created = registry_->find("new");
    ASSERT_TRUE(created);
    EXPECT_EQ(created->solid().hash(), untouched);
    expect_same_session();
    close("new");
  };
  fail_each([] {}, create_one, check);
}

TEST_F(RequestWithoutMemory, ARestartOpensTheSessionOrSaysWhyNot) {
  carve_and_undo();
  executor_->run();
  bool has_thrown = false;
  const auto prepare = [&] {
    session_.reset();
    restart();
    has_thrown = true;
  };
  const auto load = [&] {
    (void)registry_->load_all();
    has_thrown = false;
  };
  const auto check = [&] {
    session_ = registry_->find("block");
    if (!session_ && !has_thrown) {
      const auto error = registry_->unreadable("block");
      ASSERT_TRUE(error);
      EXPECT_EQ(error->code, JournalErrorCode::kNotLoaded) << error->reason;
      EXPECT_FALSE(registry_->is_loading("block"));
    }
    if (!session_) {
      restart();
      (void)registry_->load_all();
      session_ = registry_->find("block");
    }
    ASSERT_TRUE(session_);
    expect_same_session();
  };
  fail_each(prepare, load, check);
  ada_ = join("Ada");
  stroke(ada_, {-15, 10, -2}, {15, 10, -3});
  EXPECT_EQ(hash(), never_happened());
}

}  // namespace
}  // namespace kerf::memory_requests_test
