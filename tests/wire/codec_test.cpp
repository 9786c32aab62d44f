// SPDX-License-Identifier: Apache-2.0
#include "server/wire/codec.h"

#include "tests/support/test.h"

namespace kerf::wire::codec_test {
namespace {

MotionBatch motion_batch(std::uint32_t count, std::uint64_t first) {
  MotionBatch batch{.count = count};
  for (std::uint32_t i = 0; i < count; ++i) {
    batch.samples[i] = {.agent_sequence = first + i,
                        .time_us = 1000 * (first + i),
                        .tip_mm = {0.1 * i, -3.0, 1e-7},
                        .axis = {0.6F, 0.0F, 0.8F},
                        .tool_id = 2,
                        .buttons = kButtonCutting};
  }
  return batch;
}

template <typename Body>
std::vector<std::byte> frame_of(const Body& body) {
  std::vector<std::byte> frame;
  append(frame, {.epoch = 1, .sequence = 2, .time_us = 3}, body);
  return frame;
}

TEST(WireCodec, EncodeWritesOnlyTheFrame) {
  std::array<std::byte, kMaxClientFrameBytes> buffer;
  buffer.fill(std::byte{0x5A});
  const MotionBatch batch = motion_batch(3, 10);
  const std::size_t bytes = encode({}, batch, buffer);
  EXPECT_EQ(bytes, 32U + 8U + 3U * 64U);
  EXPECT_EQ(bytes, encoded_bytes(batch));
  EXPECT_TRUE(std::all_of(buffer.begin() + static_cast<std::ptrdiff_t>(bytes), buffer.end(),
                          [](std::byte b) { return b == std::byte{0x5A}; }));
  const auto back = test::value_of(decode(std::span(buffer).first(bytes), kMaxClientFrameBytes));
  EXPECT_EQ(std::get<MotionBatch>(back.body), batch);
}

TEST(WireCodec, AppendKeepsExistingBytes) {
  std::vector<std::byte> two;
  append(two, {.epoch = 1, .sequence = 1, .time_us = 1}, Ping{77});
  const std::size_t first = two.size();
  append(two, {.epoch = 1, .sequence = 2, .time_us = 1}, Pong{77, 88});
  const auto pong = test::value_of(decode(std::span(two).subspan(first)));
  EXPECT_EQ(std::get<Pong>(pong.body), (Pong{77, 88}));
  EXPECT_EQ(pong.header.stamp.sequence, 2U);
}

TEST(WireCodec, MeshHeaderEqualsTheHeaderOfTheFrame) {
  const std::vector<std::byte> glb(1000, std::byte{9});
  const FrameStamp stamp{.epoch = 4, .sequence = 5, .time_us = 6};
  std::vector<std::byte> frame;
  append(frame, stamp, MeshView{glb}, kMeshSnapshot);
  const auto header = mesh_header(stamp, kMeshSnapshot, glb.size());
  EXPECT_TRUE(std::ranges::equal(header, std::span(frame).first(kHeaderBytes)));
  EXPECT_TRUE(std::ranges::equal(std::get<MeshView>(test::value_of(decode(frame)).body).glb, glb));
}

TEST(WireCodec, FrameAboveTheSizeLimitIsRejected) {
  const auto frame = frame_of(motion_batch(16, 1));
  const auto error = test::error_of(decode(frame, frame.size() - 1));
  EXPECT_EQ(error.code, DecodeErrorCode::kTooLong);
  EXPECT_EQ(protocol_error(error.code), ErrorCode::kTooLarge);
  EXPECT_TRUE(decode(frame, frame.size()));
}

TEST(WireCodec, SampleNumbersMustNotWrapAround) {
  MotionBatch batch = motion_batch(2, std::numeric_limits<std::uint64_t>::max());
  const auto error = test::error_of(decode(frame_of(batch)));
  EXPECT_EQ(error.code, DecodeErrorCode::kBadSequence);
  EXPECT_EQ(protocol_error(error.code), ErrorCode::kBadSequence);
}

TEST(WireCodec, PoseErrorsAreReportedAsBadPose) {
  EXPECT_EQ(protocol_error(DecodeErrorCode::kNotFinite), ErrorCode::kBadPose);
  EXPECT_EQ(protocol_error(DecodeErrorCode::kAxisNotUnit), ErrorCode::kBadPose);
  EXPECT_EQ(protocol_error(DecodeErrorCode::kBadMagic), ErrorCode::kBadFrame);
}

TEST(WireCodec, AxisLengthWithinToleranceIsAccepted) {
  MotionBatch batch = motion_batch(1, 1);
  batch.samples[0].axis = {0.0F, 0.0F, 1.0009F};
  EXPECT_TRUE(decode(frame_of(batch)));
  batch.samples[0].axis = {0.0F, 0.0F, 0.9985F};
  EXPECT_FALSE(decode(frame_of(batch)));
}

TEST(WireCodec, EveryPrefixOfAFrameIsRejected) {
  ToolStates tools;
  tools.tools.resize(3);
  const std::array columns{std::byte{5}, std::byte{0}};
  for (const auto& frame : {frame_of(motion_batch(4, 9)), frame_of(Result{}), frame_of(tools),
                            frame_of(Ping{1}), frame_of(Pong{1, 2}), frame_of(Ack{}),
                            frame_of(StockPatch{false, false, 0, {{2, 1, 1, columns}}})}) {
    ASSERT_TRUE(decode(frame));
    for (std::size_t bytes = 0; bytes < frame.size(); ++bytes) {
      // In a copy of exactly this size the address sanitizer detects reads beyond its end.
      const std::vector<std::byte> cut(frame.begin(),
                                       frame.begin() + static_cast<std::ptrdiff_t>(bytes));
      EXPECT_FALSE(decode(cut)) << bytes;
    }
  }
}

TEST(WireControl, ErrorNamesRoundTrip) {
  for (std::size_t i = 0; i < kErrorNames.size(); ++i) {
    EXPECT_EQ(parse_error_code(kErrorNames[i]), static_cast<ErrorCode>(i));
  }
  EXPECT_FALSE(parse_error_code("bad"));
}

std::vector<std::vector<std::byte>> golden_frames() {
  std::vector<std::vector<std::byte>> frames;
  const auto folder = std::filesystem::path(KERF_SOURCE_DIR) / "tests/wire/golden";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".bin") continue;
    const std::string text = test::content_of(entry.path());
    const auto bytes = std::as_bytes(std::span(text));
    frames.emplace_back(bytes.begin(), bytes.end());
  }
  return frames;
}

void mutate(std::vector<std::byte>& frame, std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  switch (below(5)) {
    case 0:
      frame.resize(below(frame.size() + 40), std::byte{0xFF});
      break;
    case 1:
      frame.insert(frame.begin() + static_cast<std::ptrdiff_t>(below(frame.size() + 1)),
                   static_cast<std::byte>(random()));
      break;
    default:
      for (std::size_t i = 0, n = 1 + below(4); i < n && !frame.empty(); ++i) {
        frame[below(frame.size())] = static_cast<std::byte>(random());
      }
  }
}

// Checks that a message re-encodes to a frame that decodes and encodes to the same bytes: the
// decoder loses no information of the frames that it accepts.
void expect_stable(const Message& message) {
  std::visit(
      [&]<typename Body>(const Body& body) {
        if constexpr (!std::is_same_v<Body, MeshView> && !std::is_same_v<Body, UnknownBody>) {
          std::vector<std::byte> once;
          append(once, message.header.stamp, body);
          const auto back = test::value_of(decode(once));
          std::vector<std::byte> twice;
          append(twice, back.header.stamp, std::get<Body>(back.body));
          EXPECT_EQ(once, twice);
        }
      },
      message.body);
}

TEST(WireFuzz, MutatedFramesAreRejectedOrRoundTrip) {
  const auto corpus = golden_frames();
  ASSERT_GE(corpus.size(), 30U);
  constexpr std::uint64_t kSeed = 20041125;
  std::mt19937_64 random(kSeed);
  std::size_t accepted = 0;
  constexpr int kRounds = 100000;
  for (int round = 0; round < kRounds; ++round) {
    auto frame = corpus[random() % corpus.size()];
    for (std::size_t i = 0, n = 1 + random() % 3; i < n; ++i) mutate(frame, random);
    const auto exact = std::make_unique<std::byte[]>(frame.size());
    std::ranges::copy(frame, exact.get());
    const auto message = decode(std::span(exact.get(), frame.size()), kMaxClientFrameBytes);
    if (message) {
      ++accepted;
      expect_stable(*message);
    } else {
      ASSERT_LE(message.error().offset, std::max(frame.size(), kMaxClientFrameBytes));
      ASSERT_FALSE(message.error().reason.empty());
    }
  }
  EXPECT_GT(accepted, static_cast<std::size_t>(kRounds / 100))
      << "most mutations are rejected: use smaller ones";
}

}  // namespace
}  // namespace kerf::wire::codec_test
