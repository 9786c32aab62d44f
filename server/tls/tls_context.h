// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

struct ssl_ctx_st;

namespace kerf::net {

/// The rules of TLS connections, of a server or a client: version 1.3 only, no resumption. Copies
/// share them.
class TlsContext {
 public:
  /// A server with a certificate: PEM files of the chain, its own certificate first, and of the
  /// private key. The error is one sentence.
  static std::expected<TlsContext, std::string> of_server(const std::filesystem::path& certificate,
                                                          const std::filesystem::path& key);
  /// A client that accepts certificates of the authorities in a PEM file, or, if it is empty, of
  /// the system's. The error is one sentence.
  static std::expected<TlsContext, std::string> of_client(const std::filesystem::path& authorities);

  /// The validity of a server's certificate, seconds since 1970.
  std::int64_t begins_s() const { return begins_s_; }
  std::int64_t expires_s() const { return expires_s_; }
  ssl_ctx_st* native() const { return context_.get(); }

 private:
  explicit TlsContext(std::shared_ptr<ssl_ctx_st> context) : context_(std::move(context)) {}
  std::shared_ptr<ssl_ctx_st> context_;
  std::int64_t begins_s_ = 0, expires_s_ = 0;
};

/// The certificate of a server, which may be replaced while it runs. Thread-safe.
class TlsCertificate {
 public:
  /// Reads the files. The error is one sentence.
  static std::expected<std::unique_ptr<TlsCertificate>, std::string> load(
      std::filesystem::path certificate, std::filesystem::path key);

  /// For new connections.
  TlsContext current() const;
  /// Why clients reject the present certificate: it has expired, or is not valid yet. One sentence,
  /// with the dates, or nullopt if its dates are valid.
  std::optional<std::string> fault() const;
  /// Reads the files again. Existing connections continue with the previous certificate. If the
  /// files cannot be used, or the certificate is not valid now, the previous one stays, and the
  /// error says why.
  std::expected<void, std::string> reload();

 private:
  TlsCertificate(std::filesystem::path certificate, std::filesystem::path key, TlsContext context);
  std::filesystem::path certificate_, key_;
  mutable std::mutex mutex_;  ///< guards current_
  TlsContext current_;
};

}  // namespace kerf::net
