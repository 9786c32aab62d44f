// SPDX-License-Identifier: Apache-2.0
#include "server/datagram/cipher.h"

#include "server/datagram/key.h"
#include "server/wire/codec.h"
#include "tests/support/test.h"

namespace kerf::datagram::cipher_test {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::uint32_t kConnection = 0xA1B2C3D4;

Key counting_key() {
  Key key{};
  for (std::size_t i = 0; i < key.size(); ++i) key[i] = static_cast<std::byte>(i);
  return key;
}

Bytes ping_frame() {
  Bytes frame;
  wire::append(frame, {.epoch = 3, .sequence = 7, .time_us = 123'456}, wire::Ping{123'456});
  return frame;
}

Bytes sealed(Sealer& sealer, const Bytes& frame) {
  Bytes datagram(kMaxBytes);
  datagram.resize(sealer.seal(frame, datagram));
  return datagram;
}

std::expected<Bytes, Fault> opened(Opener& opener, const Bytes& datagram) {
  Bytes frame(kMaxFrameBytes);
  const auto result = opener.open(datagram, frame);
  if (!result) return std::unexpected(result.error());
  frame.resize(result->frame_bytes);
  return frame;
}

std::string hex(const Bytes& bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    for (const unsigned digit :
         {std::to_integer<unsigned>(byte) >> 4U, std::to_integer<unsigned>(byte) & 15U}) {
      text += "0123456789abcdef"[digit];
    }
  }
  return text;
}

class CipherTest : public ::testing::Test {
 protected:
  Sealer sealer{kConnection, counting_key()};
  Opener opener{kConnection, counting_key()};
};

// The golden bytes are those of golden_bytes_test.py, which passes the test vector of RFC 8439,
// 2.8.2.
TEST(Cipher, SealsTheGoldenBytes) {
  Sealer sealer(kConnection, counting_key(), 0x0102030405060708);
  EXPECT_EQ(hex(sealed(sealer, ping_frame())),
            "4b524431d4c3b2a10807060504030201bb1bebd5ad39ca186cab2acc707861b8"
            "e706f2c48844459e17d7a65de902a7dd199e01bdd23209f96471333c77a5c1df"
            "91288c89ae08eda6");
}

TEST_F(CipherTest, SealedFramesOpenExactlyOnce) {
  for (std::size_t size = 1; size <= kMaxFrameBytes; ++size) {
    const Bytes frame(size, static_cast<std::byte>(size));
    const Bytes datagram = sealed(sealer, frame);
    ASSERT_EQ(datagram.size(), size + kHeaderBytes + kTagBytes);
    ASSERT_EQ(opened(opener, datagram), frame);
    ASSERT_EQ(opened(opener, datagram), std::unexpected(Fault::kReplayed));
  }
  EXPECT_EQ(opener.opened(), kMaxFrameBytes);
  EXPECT_EQ(opener.newest(), kMaxFrameBytes);
}

TEST_F(CipherTest, DoesNotSealEmptyOrOversizedFrames) {
  EXPECT_TRUE(sealed(sealer, Bytes(kMaxFrameBytes + 1)).empty());
  EXPECT_TRUE(sealed(sealer, {}).empty());
}

TEST_F(CipherTest, MarksTheNewestDatagram) {
  Bytes frame(kMaxFrameBytes);
  const Bytes first = sealed(sealer, ping_frame()), second = sealed(sealer, ping_frame());
  EXPECT_TRUE(opener.open(second, frame)->newest);
  EXPECT_FALSE(opener.open(first, frame)->newest);
}

TEST_F(CipherTest, EveryFlippedBitIsRejectedWithoutSideEffects) {
  const Bytes good = sealed(sealer, ping_frame());
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      Bytes bad = good;
      bad[at] ^= std::byte{1} << bit;
      ASSERT_FALSE(opened(opener, bad)) << "byte " << at << " bit " << bit;
    }
  }
  EXPECT_EQ(opener.newest(), 0U) << "a forged counter must not move the window";
  EXPECT_EQ(opened(opener, good), ping_frame());
}

TEST_F(CipherTest, EveryOtherLengthIsRejected) {
  const Bytes good = sealed(sealer, ping_frame());
  for (std::size_t size = 0; size <= kMaxBytes + 100; ++size) {
    Bytes bad = good;
    bad.resize(size);
    ASSERT_EQ(opened(opener, bad).has_value(), size == good.size()) << size;
  }
}

TEST_F(CipherTest, AnotherKeyOrConnectionIsRejected) {
  const Bytes good = sealed(sealer, ping_frame());
  Key other = counting_key();
  other.back() ^= std::byte{1};
  Opener other_key(kConnection, other), other_connection(kConnection + 1, counting_key());
  EXPECT_EQ(opened(other_key, good), std::unexpected(Fault::kNotAuthentic));
  EXPECT_EQ(opened(other_connection, good), std::unexpected(Fault::kOtherConnection));
}

TEST_F(CipherTest, RandomDatagramsAreRejectedWithoutSideEffects) {
  std::mt19937_64 random(11);
  const Bytes good = sealed(sealer, ping_frame());
  for (int round = 0; round < 200'000; ++round) {
    Bytes bad = good;
    // Half of the rounds keep a valid header, so that the later checks are reached.
    const std::size_t from = round % 2 == 0 ? 0 : kHeaderBytes;
    if (round % 3 == 0) bad.resize(random() % (kMaxBytes + 64));
    for (std::size_t i = std::min(from, bad.size()); i < bad.size(); ++i) {
      bad[i] = static_cast<std::byte>(random());
    }
    ASSERT_FALSE(opened(opener, bad));
  }
  EXPECT_EQ(opened(opener, good), ping_frame());
}

TEST(Key, TextRoundTrips) {
  const Key key = counting_key();
  EXPECT_EQ(to_text(key), "000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f");
  EXPECT_EQ(key_from_text(to_text(key)), key);
  for (const std::string& bad : {std::string(), std::string(63, '0'), std::string(65, '0'),
                                 std::string(64, 'g'), std::string(64, 'A')}) {
    EXPECT_FALSE(key_from_text(bad)) << bad;
  }
}

TEST(Key, OffersHaveDifferentKeys) {
  const auto a = random_offer(1), b = random_offer(1);
  ASSERT_TRUE(a && b);
  EXPECT_NE(a->to_server, b->to_server);
  EXPECT_NE(a->to_agent, b->to_agent);
  EXPECT_NE(a->to_server, a->to_agent);
}

}  // namespace
}  // namespace kerf::datagram::cipher_test
