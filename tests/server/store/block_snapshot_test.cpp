// SPDX-License-Identifier: Apache-2.0
#include "server/store/block_snapshot.h"

#include <sys/resource.h>

#include <csignal>

#include "kernel/dexel/dexel_field.h"
#include "kernel/kernel_version.h"
#include "kernel/sculpture.h"
#include "server/store/chunk_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::block_snapshot_test {
namespace {

SculptureSettings settings_of(Rays rays, bool keep_normals) {
  return SculptureSettings{.stock = BoxStock{{-15, -15, -12}, {15, 15, 0}},
                           .rays = rays,
                           .pitch_mm = 0.5,
                           .tolerance_mm = 0.01,
                           .keep_normals = keep_normals};
}

Sculpture make(const SculptureSettings& settings) {
  Sculpture sculpture = Sculpture::create(settings).value();
  // The second tool leaves stock above its cut: columns of several elements.
  EXPECT_TRUE(
      sculpture.apply(DefineTool{1, make_tool(std::vector<ToolPiece>{BallPiece{2, 2}}).value()}));
  EXPECT_TRUE(
      sculpture.apply(DefineTool{2, make_tool(std::vector<ToolPiece>{BallPiece{1, 1}}).value()}));
  return sculpture;
}

/// Motions of three users, two of them with the same tool. Some begin where none has ended.
class Random {
 public:
  explicit Random(unsigned seed) : random_(seed) {}
  MoveTool motion() {
    const std::size_t user = random_() % at_.size();
    if (random_() % 8 == 0) at_[user] = pose();
    const ToolPose from = at_[user];
    ToolPose to = pose();
    to.tip_mm = from.tip_mm + (to.tip_mm - from.tip_mm) * 0.2;
    at_[user] = to;
    return {user == 0 ? 1U : 2U, from, to, 0.01, random_() % 2 == 0};
  }

 private:
  ToolPose pose() {
    std::uniform_real_distribution<double> side(-17, 17), depth(-11, 2), lean(-0.3, 0.3);
    const Vec3 tip{side(random_), side(random_), depth(random_)};
    return {tip, normalized({lean(random_), lean(random_), 1})};
  }
  std::mt19937 random_;
  std::array<ToolPose, 3> at_ = {pose(), pose(), pose()};
};

/// Expects the same columns, normals at their ends, and other state.
void expect_equal(Sculpture& found, Sculpture& expected) {
  const SculptureState a = found.state(), b = expected.state();
  ASSERT_EQ(a.solid.fields.size(), b.solid.fields.size());
  for (std::size_t n = 0; n < a.solid.fields.size(); ++n) {
    const DexelGrid& grid = b.solid.fields[n].grid();
    for (std::int32_t i = 0; i < grid.columns_x; ++i) {
      for (std::int32_t j = 0; j < grid.columns_y; ++j) {
        const ColumnView x = a.solid.fields[n].view(i, j), y = b.solid.fields[n].view(i, j);
        ASSERT_TRUE(x.topmost == y.topmost && std::ranges::equal(x.lower, y.lower));
        ASSERT_TRUE(std::ranges::equal(x.lower_codes, y.lower_codes));
        const bool is_empty = y.topmost.bottom == y.topmost.top;
        ASSERT_TRUE(is_empty || x.topmost_codes == y.topmost_codes);
      }
    }
  }
  EXPECT_EQ(a.tools, b.tools);
  EXPECT_EQ(a.last_poses, b.last_poses);
  EXPECT_TRUE(std::ranges::equal(a.users, b.users, [](const ToolUser& x, const ToolUser& y) {
    return x.tool == y.tool && x.at == y.at;
  }));
}

class BlockSnapshots : public testing::Test {
 protected:
  SnapshotHead head_of(Sculpture& sculpture) const {
    return {kKernelVersion, "block", 77, sculpture.state_hash(), 4242, 0};
  }
  Sculpture carved(const SculptureSettings& settings, int motions = 60) {
    Sculpture sculpture = make(settings);
    Random random(1);
    for (int n = 0; n < motions; ++n) EXPECT_TRUE(sculpture.apply(random.motion()));
    return sculpture;
  }
  std::string bytes() const { return test::content_of(file); }
  void put(const std::string& bytes) const { std::ofstream(file, std::ios::binary) << bytes; }

  test::TemporaryFolder folder;
  std::filesystem::path file = folder / "block.kerf-snapshot";
};

TEST_F(BlockSnapshots, RestoredBlockContinuesIdentically) {
  for (const auto& [rays, keep_normals] :
       {std::pair(Rays::kDexel, true), std::pair(Rays::kDexel, false),
        std::pair(Rays::kTriDexel, true)}) {
    const SculptureSettings settings = settings_of(rays, keep_normals);
    Sculpture saved = make(settings);
    Random random(rays == Rays::kDexel ? 2 : 3);
    for (int n = 0; n < 200; ++n) ASSERT_TRUE(saved.apply(random.motion()));
    ASSERT_TRUE(write_snapshot(file, head_of(saved), saved.state()));
    Sculpture restored = Sculpture::create(settings).value();
    const auto snapshot = test::value_of(read_snapshot(file, restored));
    ASSERT_TRUE(restored.restore(snapshot.state));
    EXPECT_EQ(snapshot.head.session, "block");
    EXPECT_EQ(snapshot.head.sequence, 77U);
    EXPECT_EQ(snapshot.head.mark, 4242U);
    EXPECT_EQ(read_snapshot_head(file)->motions, 200U);
    expect_equal(restored, saved);
    for (int n = 0; n < 100; ++n) {
      MoveTool motion = random.motion();
      motion.feel = false;  // pending force is not saved
      const auto expected = saved.apply(motion), found = restored.apply(motion);
      ASSERT_TRUE(expected && found);
      EXPECT_EQ(found->removed_mm3, expected->removed_mm3);
      EXPECT_EQ(found->imprint_mm3, expected->imprint_mm3);
      EXPECT_EQ(found->sub_motions, expected->sub_motions);
    }
    expect_equal(restored, saved);
    EXPECT_EQ(restored.state_hash(), saved.state_hash());
    EXPECT_EQ(restored.removed_volume_mm3(), saved.removed_volume_mm3());
    EXPECT_EQ(restored.imprint_volume_mm3(), saved.imprint_volume_mm3());
    EXPECT_GT(restored.imprint_volume_mm3(), 0);
    EXPECT_EQ(restored.motions(), saved.motions());
    EXPECT_EQ(restored.sub_motions(), saved.sub_motions());
  }
}

TEST_F(BlockSnapshots, AStateDoesNotChangeWhileItsBlockDoes) {
  const SculptureSettings settings = settings_of(Rays::kTriDexel, true);
  Sculpture sculpture = carved(settings);
  const std::uint64_t hash = sculpture.state_hash();
  const SculptureState state = sculpture.state();
  Random random(9);
  for (int n = 0; n < 60; ++n) ASSERT_TRUE(sculpture.apply(random.motion()));
  EXPECT_NE(sculpture.state_hash(), hash);
  EXPECT_EQ(state.solid.hash(), hash);
  ASSERT_TRUE(write_snapshot(file, {kKernelVersion, "block", 1, hash, 1, 0}, state));
  EXPECT_TRUE(read_snapshot(file, Sculpture::create(settings).value()));
}

TEST_F(BlockSnapshots, EveryTruncationAndEveryFlippedByteIsFound) {
  const SculptureSettings settings = settings_of(Rays::kDexel, true);
  Sculpture sculpture = carved(settings, 10);
  ASSERT_TRUE(write_snapshot(file, head_of(sculpture), sculpture.state()));
  const std::string whole = bytes();
  const Sculpture like = Sculpture::create(settings).value();
  const std::size_t step = whole.size() / 150 + 1;
  for (std::size_t at = 0; at < whole.size(); at += at < 200 ? 1 : step) {
    put(whole.substr(0, at));
    EXPECT_FALSE(read_snapshot(file, like)) << "cut to " << at;
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    put(flipped);
    EXPECT_FALSE(read_snapshot(file, like)) << "flipped at " << at;
  }
  put(whole + "x");
  EXPECT_EQ(read_snapshot(file, like).error().reason, "bytes follow its end");
  put(whole);
  EXPECT_TRUE(read_snapshot(file, like));
}

TEST_F(BlockSnapshots, ForgedHeadIsRejectedOrHarmless) {
  const SculptureSettings settings = settings_of(Rays::kDexel, false);
  Sculpture sculpture = carved(settings, 10);
  ASSERT_TRUE(write_snapshot(file, head_of(sculpture), sculpture.state()));
  std::vector<std::vector<std::byte>> chunks;
  for (ChunkReader in(file, kSnapshotVersion); chunks.empty() || !in.at_end();) {
    const auto chunk = test::value_of(in.next());
    chunks.emplace_back(chunk.begin(), chunk.end());
  }
  const Sculpture like = Sculpture::create(settings).value();
  int rejected = 0, accepted = 0;
  for (std::size_t at = 0; at < chunks[0].size(); ++at) {
    for (const auto flip : {std::byte{1}, std::byte{0x7F}, std::byte{0xFF}}) {
      chunks[0][at] ^= flip;
      {
        ChunkWriter out(file, kSnapshotVersion);
        for (const auto& chunk : chunks) out.write(chunk);
        ASSERT_TRUE(out.finish());
      }
      chunks[0][at] ^= flip;
      const auto read = read_snapshot(file, like);
      ++(read ? accepted : rejected);
      if (!read) continue;
      Sculpture restored = Sculpture::create(settings).value();
      ASSERT_TRUE(restored.restore(read->state));
      EXPECT_EQ(restored.state_hash(), sculpture.state_hash()) << at;
      // A pose or a volume may be wrong, but a motion must still be carved or rejected.
      (void)restored.apply(Random(4).motion());
    }
  }
  EXPECT_GT(rejected, 200);
  EXPECT_GT(accepted, 200);
}

TEST_F(BlockSnapshots, ForeignAndNewerFilesAreNamed) {
  const SculptureSettings settings = settings_of(Rays::kDexel, true);
  const Sculpture like = Sculpture::create(settings).value();
  EXPECT_TRUE(read_snapshot(file, like).error().is_missing);
  EXPECT_TRUE(read_snapshot_head(file).error().is_missing);
  put(std::string(500, 'x'));
  EXPECT_EQ(read_snapshot(file, like).error().reason, "it is not a snapshot of Kerf");
  Sculpture sculpture = carved(settings, 5);
  ASSERT_TRUE(write_snapshot(file, head_of(sculpture), sculpture.state()));
  std::string newer = bytes();
  newer[8] = 9;
  put(newer);
  EXPECT_EQ(read_snapshot(file, like).error().reason, "it is of version 9 of its format");
  SnapshotHead wrong = head_of(sculpture);
  wrong.hash ^= 1;
  ASSERT_TRUE(write_snapshot(file, wrong, sculpture.state()));
  EXPECT_EQ(read_snapshot(file, like).error().reason,
            "its columns do not have the hash that it states");
  // Another pitch, other rays, normals or not.
  for (SculptureSettings other :
       {settings_of(Rays::kTriDexel, true), settings_of(Rays::kDexel, false), settings}) {
    if (other.rays == Rays::kDexel && other.keep_normals) other.pitch_mm = 1;
    Sculpture block = carved(other, 5);
    ASSERT_TRUE(write_snapshot(file, head_of(block), block.state()));
    EXPECT_FALSE(read_snapshot(file, like));
  }
}

TEST_F(BlockSnapshots, FailingDiskKeepsThePreviousSnapshot) {
  const SculptureSettings settings = settings_of(Rays::kDexel, true);
  Sculpture sculpture = carved(settings);
  ASSERT_TRUE(write_snapshot(file, head_of(sculpture), sculpture.state()));
  const std::string before = bytes();
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit full = limit;
  full.rlim_cur = before.size() / 2;
  setrlimit(RLIMIT_FSIZE, &full);
  const auto written = write_snapshot(file, head_of(sculpture), sculpture.state());
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().reason.find("cannot be written"), std::string::npos);
  EXPECT_EQ(bytes(), before);
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".tmp"));
  EXPECT_FALSE(write_snapshot(folder / "none" / "x", head_of(sculpture), sculpture.state()));
}

}  // namespace
}  // namespace kerf::block_snapshot_test
