// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/reference/report.h"

#include "tests/support/test.h"

namespace kerf::agent::reference::report_test {
namespace {

const StateReport kState{.sequence = 0xFFFE,
                         .time_us = 0x12345678,
                         .status = kHomedMask | kMotorsOnBit,
                         .buttons = kCutButton,
                         .angles_urad = {1, -2, 3'000'000, -3'000'000, 5, -6},
                         .accepted = 9,
                         .rejected = 1,
                         .temperature_dc = -15};

TEST(ReferenceReport, ChecksumMatchesTheStandard) {
  const std::array<std::uint8_t, 9> digits = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(crc32(digits), 0xCBF43926U);
}

TEST(ReferenceReport, LayoutMatchesTheSpecification) {
  const auto bytes = encode(kState);
  const std::vector<std::uint8_t> head(bytes.begin(), bytes.begin() + 16);
  EXPECT_EQ(head, (std::vector<std::uint8_t>{0x4B, 1, 0xFE, 0xFF, 0x78, 0x56, 0x34, 0x12, 0xBF, 0,
                                             1, 0, 1, 0, 0, 0}));
  EXPECT_EQ(bytes[36], 9);
  const auto command = encode(CommandReport{
      .sequence = 0x0102, .command = kEnableMotors, .torques_dnmm = {1, -1, 0, 0, 0, 0x1234}});
  const std::vector<std::uint8_t> begin(command.begin(), command.begin() + 18);
  EXPECT_EQ(begin, (std::vector<std::uint8_t>{0x43, 1, 2, 1, 1, 0, 1, 0, 0xFF, 0xFF, 0, 0, 0, 0, 0,
                                              0, 0x34, 0x12}));
}

TEST(ReferenceReport, DecodeInvertsEncode) {
  EXPECT_EQ(decode_state(encode(kState)), kState);
  const CommandReport command{.sequence = 7, .command = 3, .torques_dnmm = {-32768, 32767}};
  EXPECT_EQ(decode_command(encode(command)), command);
  const Identity identity{.firmware = 3,
                          .serial = 99,
                          .pen = standard_pen(),
                          .torque_max_nmm = {1, 2, 3, 4, 5, 6.5},
                          .period_us = 1000,
                          .watchdog_ms = 20};
  const auto decoded = test::value_of(decode_identity(encode(identity)));
  EXPECT_EQ(decoded.pen, identity.pen);
  EXPECT_EQ(decoded.torque_max_nmm, identity.torque_max_nmm);
  EXPECT_EQ(decoded.watchdog_ms, 20);
}

TEST(ReferenceReport, EveryBitErrorIsDetected) {
  const auto good = encode(kState);
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    auto bad = good;
    bad[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_FALSE(decode_state(bad)) << bit;
  }
}

TEST(ReferenceReport, RandomBytesAreRejected) {
  std::mt19937 engine{1};
  for (int i = 0; i < 20'000; ++i) {
    std::vector<std::uint8_t> bytes(engine() % 100);
    std::ranges::generate(bytes, [&] { return static_cast<std::uint8_t>(engine()); });
    EXPECT_FALSE(decode_state(bytes));
    EXPECT_FALSE(decode_command(bytes));
    EXPECT_FALSE(decode_identity(bytes));
  }
}

}  // namespace
}  // namespace kerf::agent::reference::report_test
