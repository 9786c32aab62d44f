// SPDX-License-Identifier: Apache-2.0
// ChaCha20-Poly1305 (RFC 8439): runs in constant time and needs no special instructions.
#include "server/datagram/cipher.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>

#include "server/wire/bytes.h"

namespace kerf::datagram {
namespace {

constexpr std::size_t kNonceBytes = 12;

/// Four zero bytes and the counter. Each direction has its own key, so no nonce repeats under a
/// key.
std::array<std::byte, kNonceBytes> nonce_of(std::uint64_t counter) noexcept {
  std::array<std::byte, kNonceBytes> nonce{};
  wire::ByteWriter out(nonce);
  out.reserved();
  out.field(counter);
  return nonce;
}

const unsigned char* chars(std::span<const std::byte> bytes) noexcept {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}
unsigned char* chars(std::span<std::byte> bytes) noexcept {
  return reinterpret_cast<unsigned char*>(bytes.data());
}
int size_of(std::span<const std::byte> bytes) noexcept { return static_cast<int>(bytes.size()); }

}  // namespace

std::array<std::byte, kHeaderBytes> encode(const Header& header) noexcept {
  std::array<std::byte, kHeaderBytes> bytes{};
  wire::ByteWriter out(bytes);
  out.field(kMagic);
  out.field(header.connection);
  out.field(header.counter);
  return bytes;
}

std::expected<Header, Fault> read_header(std::span<const std::byte> datagram) noexcept {
  if (datagram.size() <= kHeaderBytes + kTagBytes) return std::unexpected(Fault::kTooShort);
  if (datagram.size() > kMaxBytes) return std::unexpected(Fault::kTooLong);
  wire::ByteReader in(datagram, 0);
  std::uint32_t magic = 0;
  Header header;
  in.field(magic);
  in.field(header.connection);
  in.field(header.counter);
  if (magic != kMagic) return std::unexpected(Fault::kBadMagic);
  return header;
}

void CipherEnd::operator()(evp_cipher_ctx_st* context) const noexcept {
  EVP_CIPHER_CTX_free(context);  // also wipes the key
}

Sealer::Sealer(std::uint32_t connection, const Key& key, std::uint64_t first_counter)
    : context_(EVP_CIPHER_CTX_new()), next_{connection, first_counter} {
  EVP_EncryptInit_ex(context_.get(), EVP_chacha20_poly1305(), nullptr, chars(key), nullptr);
}

std::size_t Sealer::seal(std::span<const std::byte> frame, std::span<std::byte> out) noexcept {
  if (frame.empty() || frame.size() > kMaxFrameBytes) return 0;
  const auto head = encode(next_);
  const auto nonce = nonce_of(next_.counter++);
  std::ranges::copy(head, out.begin());
  const auto sealed = out.subspan(kHeaderBytes, frame.size());
  const auto tag = out.subspan(kHeaderBytes + frame.size(), kTagBytes);
  EVP_CIPHER_CTX* context = context_.get();
  int written = 0;
  const bool done =
      EVP_EncryptInit_ex(context, nullptr, nullptr, nullptr, chars(nonce)) == 1 &&
      EVP_EncryptUpdate(context, nullptr, &written, chars(head), size_of(head)) == 1 &&
      EVP_EncryptUpdate(context, chars(sealed), &written, chars(frame), size_of(frame)) == 1 &&
      EVP_EncryptFinal_ex(context, nullptr, &written) == 1 &&
      EVP_CIPHER_CTX_ctrl(context, EVP_CTRL_AEAD_GET_TAG, size_of(tag), tag.data()) == 1;
  return done ? kHeaderBytes + frame.size() + kTagBytes : 0;
}

Opener::Opener(std::uint32_t connection, const Key& key)
    : connection_(connection), context_(EVP_CIPHER_CTX_new()) {
  EVP_DecryptInit_ex(context_.get(), EVP_chacha20_poly1305(), nullptr, chars(key), nullptr);
}

std::expected<Opened, Fault> Opener::open(std::span<const std::byte> datagram,
                                          std::span<std::byte> frame) noexcept {
  const auto header = read_header(datagram);
  if (!header) return std::unexpected(header.error());
  if (header->connection != connection_) return std::unexpected(Fault::kOtherConnection);
  if (!window_.admits(header->counter)) return std::unexpected(Fault::kReplayed);
  const auto nonce = nonce_of(header->counter);
  const auto head = datagram.first(kHeaderBytes);
  const auto sealed = datagram.subspan(kHeaderBytes, datagram.size() - kHeaderBytes - kTagBytes);
  std::array<std::byte, kTagBytes> tag{};
  std::ranges::copy(datagram.last(kTagBytes), tag.begin());
  EVP_CIPHER_CTX* context = context_.get();
  int written = 0;
  const bool authentic =
      EVP_DecryptInit_ex(context, nullptr, nullptr, nullptr, chars(nonce)) == 1 &&
      EVP_CIPHER_CTX_ctrl(context, EVP_CTRL_AEAD_SET_TAG, size_of(tag), tag.data()) == 1 &&
      EVP_DecryptUpdate(context, nullptr, &written, chars(head), size_of(head)) == 1 &&
      EVP_DecryptUpdate(context, chars(frame), &written, chars(sealed), size_of(sealed)) == 1 &&
      EVP_DecryptFinal_ex(context, nullptr, &written) == 1;
  if (!authentic) return std::unexpected(Fault::kNotAuthentic);
  ++opened_;
  return Opened{sealed.size(), window_.take(header->counter)};
}

}  // namespace kerf::datagram
