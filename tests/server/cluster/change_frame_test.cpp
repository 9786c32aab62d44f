// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/change_frame.h"

#include "server/cluster/copies.h"
#include "tests/support/test.h"

namespace kerf::change_frame_test {
namespace {

std::vector<std::byte> rows(std::size_t count, unsigned value) {
  return std::vector<std::byte>(count, static_cast<std::byte>(value));
}

FrameHead head(std::uint32_t epoch, std::uint64_t change, std::uint32_t part = 0,
               std::uint32_t parts = 1) {
  return {.epoch = epoch,
          .writer = 7,
          .change = change,
          .part = part,
          .parts = parts,
          .is_whole = true,
          .before = {change, 2, 3, 4},
          .after = {change + 1, 6, 7, 8}};
}

TEST(ChangeFrame, RoundTrips) {
  FrameHead written = head(3, 9, 1, 4);
  written.is_whole = false;
  const auto bytes = encode_frame(written, rows(5, 42));
  const auto frame = test::value_of(decode_frame(bytes));
  EXPECT_EQ(frame.head.epoch, 3U);
  EXPECT_EQ(frame.head.writer, 7U);
  EXPECT_EQ(frame.head.change, 9U);
  EXPECT_EQ(frame.head.part, 1U);
  EXPECT_EQ(frame.head.parts, 4U);
  EXPECT_FALSE(frame.head.is_whole);
  EXPECT_EQ(frame.head.before, written.before);
  EXPECT_EQ(frame.head.after, written.after);
  EXPECT_TRUE(std::ranges::equal(frame.rows, rows(5, 42)));
}

TEST(ChangeFrame, RejectsEveryFlippedBitAndEveryTruncation) {
  const auto good = encode_frame(head(1, 1), rows(20, 5));
  for (std::size_t n = 0; n < 8 * good.size(); ++n) {
    auto bytes = good;
    bytes[n / 8] ^= std::byte{1} << (n % 8);
    EXPECT_FALSE(decode_frame(bytes)) << "bit " << n;
  }
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(decode_frame(std::span(good).first(size))) << size << " bytes";
  }
}

TEST(FrameJoiner, JoinsTheParts) {
  FrameJoiner joiner;
  EXPECT_FALSE(*joiner.add(encode_frame(head(1, 1, 0, 2), rows(3, 1))));
  const auto change = joiner.add(encode_frame(head(1, 1, 1, 2), rows(2, 2)));
  ASSERT_TRUE(change && *change);
  EXPECT_EQ((*change)->rows.size(), 5U);
  EXPECT_EQ((*change)->after.record, 2U);
}

TEST(FrameJoiner, DropsAnUnfinishedChange) {
  FrameJoiner joiner;
  EXPECT_FALSE(*joiner.add(encode_frame(head(1, 1, 0, 3), rows(3, 1))));
  const auto change = joiner.add(encode_frame(head(2, 1), rows(2, 2)));
  ASSERT_TRUE(change && *change);
  EXPECT_EQ((*change)->rows, rows(2, 2));
}

TEST(FrameJoiner, RejectsAnEarlierEpoch) {
  FrameJoiner joiner;
  ASSERT_TRUE(joiner.add(encode_frame(head(4, 1), rows(3, 1))));
  ASSERT_TRUE(joiner.add(encode_frame(head(4, 2), rows(3, 1))));
  EXPECT_FALSE(joiner.add(encode_frame(head(3, 3), rows(3, 1))));
}

TEST(FrameJoiner, RejectsAMissingPart) {
  FrameJoiner joiner;
  ASSERT_TRUE(joiner.add(encode_frame(head(1, 1, 0, 3), rows(3, 1))));
  EXPECT_FALSE(joiner.add(encode_frame(head(1, 1, 2, 3), rows(3, 1))));
  EXPECT_FALSE(joiner.add(encode_frame(head(1, 2, 1, 3), rows(3, 1))));
}

TEST(CopyStream, NamesTheSession) {
  EXPECT_EQ(session_of_stream(copy_stream("my-block_2")), "my-block_2");
  EXPECT_FALSE(session_of_stream("ORDERS"));
}

}  // namespace
}  // namespace kerf::change_frame_test
