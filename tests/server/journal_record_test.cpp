// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_record.h"

#include "server/store/crc32.h"
#include "tests/support/test.h"

namespace kerf::journal_record_test {
namespace {

MoveTool some_move() {
  return MoveTool{.tool = 7,
                  .from = {{1.5, -2.25, 1e-300}, {0, 0, 1}},
                  .to = {{0.1, 0.2, 0.30000000000000004}, {0.6, 0, 0.8}},
                  .duration_s = 0.001,
                  .feel = false};
}

DefineTool some_tool() {
  auto tool = make_tool(std::vector<ToolPiece>{BallPiece{5, 5}, FrustumPiece{5, 5, 60, 5}});
  return {3, tool.value()};
}

TEST(Crc32, MatchesTheStandardCheckValue) {
  const std::string text = "123456789";
  EXPECT_EQ(crc32(std::as_bytes(std::span(text))), 0xCBF43926U);
  const auto head = crc32(std::as_bytes(std::span(text).first(4)));
  EXPECT_EQ(crc32(std::as_bytes(std::span(text).subspan(4)), head), 0xCBF43926U);
}

TEST(JournalRecord, MoveRoundTripsExactly) {
  const auto decoded = test::value_of(decode_command(encode_command(some_move())));
  const auto& move = std::get<MoveTool>(decoded);
  EXPECT_EQ(move.tool, 7U);
  EXPECT_EQ(move.from, some_move().from);
  EXPECT_EQ(move.to, some_move().to);
  EXPECT_EQ(move.duration_s, 0.001);
  EXPECT_FALSE(move.feel);
}

TEST(JournalRecord, ToolRoundTripsWithAllPieces) {
  const auto decoded = test::value_of(decode_command(encode_command(some_tool())));
  const auto& define = std::get<DefineTool>(decoded);
  EXPECT_EQ(define.id, 3U);
  EXPECT_EQ(define.tool, some_tool().tool);
}

DefineTool some_tool_with_holder() {
  auto tool = make_tool({ArcPiece{3, 2, 2, 0, 2}, FrustumPiece{2, 5, 20, 5}},
                        {FrustumPiece{20, 4, 40, 4}, ArcPiece{-3, 50, 20, 41, 59}});
  return {4, tool.value()};
}

TEST(JournalRecord, ArcsAndNonCuttingPiecesRoundTrip) {
  const auto decoded = test::value_of(decode_command(encode_command(some_tool_with_holder())));
  EXPECT_EQ(std::get<DefineTool>(decoded).tool, some_tool_with_holder().tool);
}

TEST(JournalRecord, Layout1IsRead) {
  // Layout 1, from before arcs and holders, has the same bytes without the list of non-cutting
  // pieces.
  auto bytes = encode_command(some_tool());
  bytes[0] = std::byte{1};
  bytes.resize(bytes.size() - 4);
  EXPECT_EQ(std::get<DefineTool>(test::value_of(decode_command(bytes))).tool, some_tool().tool);
}

TEST(JournalRecord, ChangesOfStrokesRoundTrip) {
  for (const bool undone : {true, false}) {
    const auto decoded =
        test::value_of(decode_command(encode_command(StrokeChange{1ULL << 40U, undone})));
    EXPECT_EQ(std::get<StrokeChange>(decoded).stroke, 1ULL << 40U);
    EXPECT_EQ(std::get<StrokeChange>(decoded).undone, undone);
    EXPECT_FALSE(kernel_command(decoded));
  }
}

TEST(JournalRecord, EveryTruncationIsAnError) {
  for (const RecordedCommand& command :
       {RecordedCommand(some_move()), RecordedCommand(some_tool()),
        RecordedCommand(some_tool_with_holder()), RecordedCommand(StrokeChange{7, true})}) {
    const auto bytes = encode_command(command);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_FALSE(decode_command(std::span(bytes).first(size))) << size;
    }
  }
}

TEST(JournalRecord, TrailingBytesAndUnknownLayoutsAreErrors) {
  auto bytes = encode_command(some_move());
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(decode_command(bytes));
  bytes = encode_command(some_move());
  bytes[0] = std::byte{99};
  EXPECT_NE(test::error_of(decode_command(bytes)).find("layout 99"), std::string::npos);
}

TEST(JournalRecord, ToolRejectedByTheKernelIsAnError) {
  auto bytes = encode_command(some_tool_with_holder());
  for (std::size_t i = bytes.size() - 8; i < bytes.size(); ++i) bytes[i] = std::byte{0xFF};  // NaN
  EXPECT_FALSE(decode_command(bytes));
}

TEST(JournalRecord, ChecksumCoversSequenceAndParticipant) {
  const auto bytes = encode_command(some_move());
  const auto sum = record_checksum(1, 2, bytes);
  EXPECT_NE(sum, record_checksum(2, 2, bytes));
  EXPECT_NE(sum, record_checksum(1, 3, bytes));
  EXPECT_NE(sum, record_checksum(1, 2, std::span(bytes).first(bytes.size() - 1)));
}

}  // namespace
}  // namespace kerf::journal_record_test
