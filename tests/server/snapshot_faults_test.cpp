// SPDX-License-Identifier: Apache-2.0
// Unusable snapshot files, and snapshots that could not be written.
#include <sys/resource.h>

#include <array>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "server/session/replay.h"
#include "server/store/block_snapshot.h"
#include "server/store/byte_code.h"
#include "server/store/chunk_file.h"
#include "server/store/crc32.h"
#include "tests/server/session_fixture.h"

// g++ defines macros for its sanitizers, clang knows features.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define KERF_TEST_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define KERF_TEST_SANITIZED 1
#endif
#endif

namespace kerf::snapshot_faults_test {
namespace {

class SnapshotFaults : public SessionTest {
 protected:
  void SetUp() override {
    snapshots.writer = &writer;
    snapshots.limits = {.replay_time = {}, .age = std::chrono::hours(1), .pause = {}};
    SessionTest::SetUp();
  }
  std::filesystem::path journal() const { return folder / "block.kerf"; }
  /// Leaves a closed journal of some motions, without a snapshot.
  void leave() {
    const auto session = start();
    carve_circle(*session, join(*session), 50);
    ASSERT_TRUE(session->flush());
    registry.reset();
    writer = {};
  }

  test::ManualExecutor writer;
};

TEST_F(SnapshotFaults, ShortFileWithALongChunkAllocatesNothing) {
  leave();
  // A Zstandard frame of one repeated byte: 4,294,967,295 bytes according to its header.
  const std::array<unsigned char, 13> packed = {0x28, 0xB5, 0x2F, 0xFD, 0xA0, 0xFF, 0xFF,
                                                0xFF, 0xFF, 0x0B, 0x00, 0x00, 0x00};
  const std::span<const std::byte> frame = std::as_bytes(std::span(packed));
  const std::uint32_t size = 0xFFFFFFFF;
  ByteWriter checked;
  checked.put(std::uint64_t{0});
  checked.put(size);
  ByteWriter out;
  out.put(std::as_bytes(std::span("KERFSNAP", 8)));
  out.put(kSnapshotVersion);
  out.put(size);
  out.put(static_cast<std::uint32_t>(frame.size()));
  out.put(crc32(frame, crc32(checked.take())));
  out.put(frame);
  const auto bytes = out.take();
  ASSERT_EQ(bytes.size(), 37U);
  std::ofstream(snapshot_file(journal()), std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
  const auto restored = restore(journal());
  ASSERT_TRUE(restored);
  EXPECT_EQ(restored->snapshot_fault, "it states a chunk that is too long");
  EXPECT_EQ(restored->hash.hash, replay(journal())->hash.hash);
}

TEST_F(SnapshotFaults, SnapshotThatExceedsMemoryIsIgnored) {
#ifdef KERF_TEST_SANITIZED
  GTEST_SKIP() << "sanitizers do not let an allocation fail";
#endif
  leave();
  {
    ChunkWriter out(snapshot_file(journal()), kSnapshotVersion);
    out.write(std::vector<std::byte>(kChunkBytesMax));
    ASSERT_TRUE(out.finish());
  }
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  rlimit low = limit;
  low.rlim_cur = pages * 4096 + kChunkBytesMax / 2;
  setrlimit(RLIMIT_AS, &low);
  const auto restored = restore(journal());
  setrlimit(RLIMIT_AS, &limit);
  ASSERT_TRUE(restored);
  EXPECT_EQ(restored->snapshot_fault, "it cannot be used: std::bad_alloc");
  EXPECT_EQ(restored->hash.hash, replay(journal())->hash.hash);
}

TEST_F(SnapshotFaults, UnfinishedSnapshotIsRemoved) {
  const auto unfinished = unfinished_file(snapshot_file(journal()));
  leave();
  std::ofstream(unfinished) << "half";
  restart();
  registry->load_all();
  EXPECT_FALSE(std::filesystem::exists(unfinished));
  registry.reset();
  std::ofstream(unfinished) << "half";
  remove_journal(journal());
  EXPECT_FALSE(std::filesystem::exists(unfinished));
}

TEST_F(SnapshotFaults, ExceptionDoesNotPreventTheNextSnapshot) {
  snapshots.on_failure = [](const std::string&, const std::string& reason) {
    throw std::runtime_error(reason);
  };
  restart();
  const auto session = start();
  const auto id = join(*session);
  const auto unfinished = unfinished_file(snapshot_file(journal()));
  std::filesystem::create_directory(unfinished);
  move(*session, id, 0, 0, -1);
  move(*session, id, 1, 0, -1);
  EXPECT_THROW(writer.run(), std::runtime_error);
  executor->run();
  std::filesystem::remove(unfinished);
  // Due after ten times the duration of the failed attempt.
  for (int n = 0; n < 1000 && !std::filesystem::exists(snapshot_file(journal())); ++n) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    move(*session, id, 1 + 0.01 * n, 0, -1);
    writer.run();
    executor->run();
  }
  EXPECT_TRUE(std::filesystem::exists(snapshot_file(journal())));
}

}  // namespace
}  // namespace kerf::snapshot_faults_test
