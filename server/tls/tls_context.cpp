// SPDX-License-Identifier: Apache-2.0
#include "server/tls/tls_context.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <array>
#include <ctime>
#include <system_error>
#include <utility>

#include "server/platform/clock.h"

namespace kerf::net {
namespace {

/// Takes the first error of this thread's queue and empties it.
std::string library_error() {
  const unsigned long code = ERR_peek_error();
  const char* reason = ERR_reason_error_string(code);
  ERR_clear_error();
  if (ERR_SYSTEM_ERROR(code)) return std::generic_category().message(ERR_GET_REASON(code));
  return reason == nullptr ? "unknown error" : reason;
}

std::shared_ptr<ssl_ctx_st> new_context(const SSL_METHOD* method) {
  std::shared_ptr<SSL_CTX> context(SSL_CTX_new(method), SSL_CTX_free);
  if (!context) return nullptr;
  SSL_CTX_set_min_proto_version(context.get(), TLS1_3_VERSION);
  // A peer may close TCP without closing TLS. Nothing here depends on it: HTTP bodies have a
  // length, WebSockets a close frame.
  SSL_CTX_set_options(context.get(), SSL_OP_IGNORE_UNEXPECTED_EOF | SSL_OP_NO_RENEGOTIATION);
  SSL_CTX_set_mode(context.get(), SSL_MODE_ENABLE_PARTIAL_WRITE |
                                      SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER |
                                      SSL_MODE_RELEASE_BUFFERS);
  // Tickets that a client has not read when it closes would reset the connection, and its last data
  // would be lost.
  SSL_CTX_set_num_tickets(context.get(), 0);
  SSL_CTX_set_session_cache_mode(context.get(), SSL_SESS_CACHE_OFF);
  return context;
}

std::int64_t to_seconds(const ASN1_TIME* time) {
  std::tm parts{};
  return ASN1_TIME_to_tm(time, &parts) == 1 ? timegm(&parts) : 0;
}

/// A time in UTC, e.g. "2026-11-22 14:03:00 UTC".
std::string date_text(std::int64_t seconds) {
  const std::time_t time = seconds;
  std::tm parts{};
  gmtime_r(&time, &parts);
  std::array<char, 40> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S UTC", &parts);
  return {text.data(), size};
}

std::optional<std::string> validity_fault(const std::filesystem::path& certificate,
                                          const TlsContext& context) {
  const std::int64_t now = Clock::wall_s();
  const bool has_begun = context.begins_s() <= now;
  if (has_begun && now < context.expires_s()) return std::nullopt;
  return "the certificate " + certificate.string() +
         (has_begun ? " has expired" : " is not valid yet") + ": it is valid from " +
         date_text(context.begins_s()) + " to " + date_text(context.expires_s()) +
         (has_begun ? "" : ", and this machine has " + date_text(now));
}

}  // namespace

std::expected<TlsContext, std::string> TlsContext::of_server(
    const std::filesystem::path& certificate, const std::filesystem::path& key) {
  ERR_clear_error();
  auto native = new_context(TLS_server_method());
  if (!native) return std::unexpected("TLS is not available: " + library_error());
  if (SSL_CTX_use_certificate_chain_file(native.get(), certificate.c_str()) != 1) {
    return std::unexpected("the certificate " + certificate.string() +
                           " cannot be used: " + library_error());
  }
  // A server has nobody to ask for the password of a key.
  bool is_encrypted = false;
  SSL_CTX_set_default_passwd_cb_userdata(native.get(), &is_encrypted);
  SSL_CTX_set_default_passwd_cb(native.get(), [](char*, int, int, void* asked) {
    *static_cast<bool*>(asked) = true;
    return -1;
  });
  if (SSL_CTX_use_PrivateKey_file(native.get(), key.c_str(), SSL_FILETYPE_PEM) != 1) {
    const std::string reason = library_error();
    return std::unexpected("the private key " + key.string() + " cannot be used: " +
                           (is_encrypted ? "it needs a password; store it without one" : reason));
  }
  SSL_CTX_set_default_passwd_cb_userdata(native.get(), nullptr);
  TlsContext context(std::move(native));
  const X509* own = SSL_CTX_get0_certificate(context.native());
  context.begins_s_ = to_seconds(X509_get0_notBefore(own));
  context.expires_s_ = to_seconds(X509_get0_notAfter(own));
  return context;
}

std::expected<TlsContext, std::string> TlsContext::of_client(
    const std::filesystem::path& authorities) {
  ERR_clear_error();
  auto native = new_context(TLS_client_method());
  if (!native) return std::unexpected("TLS is not available: " + library_error());
  SSL_CTX_set_verify(native.get(), SSL_VERIFY_PEER, nullptr);
  const bool is_own = !authorities.empty();
  const int loaded = is_own ? SSL_CTX_load_verify_file(native.get(), authorities.c_str())
                            : SSL_CTX_set_default_verify_paths(native.get());
  if (loaded != 1) {
    return std::unexpected((is_own ? "the authorities " + authorities.string()
                                   : std::string("the authorities of this system")) +
                           " cannot be read: " + library_error());
  }
  return TlsContext(std::move(native));
}

TlsCertificate::TlsCertificate(std::filesystem::path certificate, std::filesystem::path key,
                               TlsContext context)
    : certificate_(std::move(certificate)), key_(std::move(key)), current_(std::move(context)) {}

std::expected<std::unique_ptr<TlsCertificate>, std::string> TlsCertificate::load(
    std::filesystem::path certificate, std::filesystem::path key) {
  auto context = TlsContext::of_server(certificate, key);
  if (!context) return std::unexpected(context.error());
  return std::unique_ptr<TlsCertificate>(
      new TlsCertificate(std::move(certificate), std::move(key), *std::move(context)));
}

TlsContext TlsCertificate::current() const {
  const std::scoped_lock lock(mutex_);
  return current_;
}

std::optional<std::string> TlsCertificate::fault() const {
  return validity_fault(certificate_, current());
}

std::expected<void, std::string> TlsCertificate::reload() {
  auto context = TlsContext::of_server(certificate_, key_);
  if (!context) return std::unexpected(context.error());
  if (auto fault = validity_fault(certificate_, *context)) return std::unexpected(*fault);
  const std::scoped_lock lock(mutex_);
  current_ = *std::move(context);
  return {};
}

}  // namespace kerf::net
