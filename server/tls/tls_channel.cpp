// SPDX-License-Identifier: Apache-2.0
#include "server/tls/tls_channel.h"

#include <arpa/inet.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509_vfy.h>
#include <openssl/x509v3.h>
#include <sys/socket.h>

#include <cerrno>
#include <new>
#include <system_error>
#include <utility>

namespace kerf::net {
namespace {

// OpenSSL's own socket BIO raises SIGPIPE when the peer is gone, which would end a program that
// only uses a haptic device. `BIO_get_data` holds the socket.

int socket_of(BIO* bio) {
  return static_cast<int>(reinterpret_cast<std::intptr_t>(BIO_get_data(bio)));
}

bool may_retry() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

int write_socket(BIO* bio, const char* bytes, int count) {
  BIO_clear_retry_flags(bio);
  const auto sent =
      send(socket_of(bio), bytes, static_cast<std::size_t>(count), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent < 0 && may_retry()) BIO_set_retry_write(bio);
  return static_cast<int>(sent);
}

int read_socket(BIO* bio, char* bytes, int count) {
  BIO_clear_retry_flags(bio);
  errno = 0;
  const auto got = recv(socket_of(bio), bytes, static_cast<std::size_t>(count), MSG_DONTWAIT);
  if (got < 0 && may_retry()) BIO_set_retry_read(bio);
  return static_cast<int>(got);
}

long control_socket(BIO*, int command, long, void*) { return command == BIO_CTRL_FLUSH ? 1 : 0; }

const BIO_METHOD* socket_method() {
  static const BIO_METHOD* const kMethod = [] {
    BIO_METHOD* method = BIO_meth_new(BIO_get_new_index() | BIO_TYPE_SOURCE_SINK, "kerf socket");
    BIO_meth_set_write(method, write_socket);
    BIO_meth_set_read(method, read_socket);
    BIO_meth_set_ctrl(method, control_socket);
    return method;
  }();
  return kMethod;
}

bool is_address(const std::string& host) {
  in6_addr address{};
  return inet_pton(AF_INET, host.c_str(), &address) == 1 ||
         inet_pton(AF_INET6, host.c_str(), &address) == 1;
}

/// Describes why the certificate of a server is not accepted.
std::string describe_certificate(long fault, const std::string& host) {
  const std::string subject = "the certificate of " + host;
  switch (fault) {
    case X509_V_ERR_CERT_HAS_EXPIRED:
      return subject + " has expired";
    case X509_V_ERR_CERT_NOT_YET_VALID:
      return subject + " is not valid yet; is the clock of this machine right?";
    case X509_V_ERR_HOSTNAME_MISMATCH:
    case X509_V_ERR_IP_ADDRESS_MISMATCH:
      return "the server's certificate is not for " + host;
    case X509_V_ERR_DEPTH_ZERO_SELF_SIGNED_CERT:
    case X509_V_ERR_SELF_SIGNED_CERT_IN_CHAIN:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT_LOCALLY:
    case X509_V_ERR_UNABLE_TO_VERIFY_LEAF_SIGNATURE:
      return subject + " comes from an unknown authority; name its file with --ca";
    default:
      return subject + " is not accepted: " + X509_verify_cert_error_string(fault);
  }
}

/// Whether the next attempt would fail for the same reason: the certificate is not accepted, or the
/// peer does not support this TLS. Any other failure, such as an alert of an overloaded or
/// restarting server, may pass.
bool is_lasting(int reason) {
  switch (reason) {
    case SSL_R_CERTIFICATE_VERIFY_FAILED:
    case SSL_R_HTTP_REQUEST:
    case SSL_R_WRONG_VERSION_NUMBER:
    case SSL_R_UNSUPPORTED_PROTOCOL:
    case SSL_R_TLSV1_ALERT_PROTOCOL_VERSION:
      return true;
    default:
      return false;
  }
}

}  // namespace

struct TlsChannel::Native {
  Native(const TlsContext& context, int socket) : ssl(SSL_new(context.native()), SSL_free) {
    BIO* bio = ssl ? BIO_new(socket_method()) : nullptr;
    if (bio == nullptr) throw std::bad_alloc();
    BIO_set_data(bio, reinterpret_cast<void*>(static_cast<std::intptr_t>(socket)));
    BIO_set_init(bio, 1);
    SSL_set_bio(ssl.get(), bio, bio);
  }
  std::unique_ptr<SSL, decltype(&SSL_free)> ssl;
};

TlsChannel::TlsChannel(const TlsContext& context, int socket)
    : native_(std::make_unique<Native>(context, socket)) {
  SSL_set_accept_state(native_->ssl.get());
}

TlsChannel::TlsChannel(const TlsContext& context, int socket, std::string host)
    : host_(std::move(host)), native_(std::make_unique<Native>(context, socket)) {
  SSL* ssl = native_->ssl.get();
  SSL_set_connect_state(ssl);
  // A host that cannot be set would stay unverified, so it must not connect.
  bool is_set = false;
  if (is_address(host_)) {
    is_set = X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(ssl), host_.c_str()) == 1;
  } else {
    SSL_set_hostflags(ssl, X509_CHECK_FLAG_NO_PARTIAL_WILDCARDS);
    is_set =
        SSL_set1_host(ssl, host_.c_str()) == 1 && SSL_set_tlsext_host_name(ssl, host_.c_str()) == 1;
  }
  if (!is_set) failure_ = "TLS cannot verify the name " + host_;
}

TlsChannel::~TlsChannel() = default;

TlsStep TlsChannel::handshake() {
  if (!failure_.empty()) return TlsStep::kFailed;
  ERR_clear_error();
  const TlsStep step = judge(SSL_do_handshake(native_->ssl.get()));
  if (step != TlsStep::kClosed) return step;
  failure_ = "the connection was closed during the TLS handshake";
  return TlsStep::kFailed;
}

TlsStep TlsChannel::read(std::span<std::byte> to, std::size_t& count) {
  ERR_clear_error();
  count = 0;
  return judge(SSL_read_ex(native_->ssl.get(), to.data(), to.size(), &count));
}

TlsStep TlsChannel::write(std::span<const std::byte> from, std::size_t& count) {
  ERR_clear_error();
  count = 0;
  return judge(SSL_write_ex(native_->ssl.get(), from.data(), from.size(), &count));
}

void TlsChannel::say_end() {
  if (!failure_.empty() || SSL_in_init(native_->ssl.get()) != 0) return;
  ERR_clear_error();
  SSL_shutdown(native_->ssl.get());
}

bool TlsChannel::has_peer_ended() {
  ERR_clear_error();
  char next = 0;
  std::size_t count = 0;
  const TlsStep step = judge(SSL_peek_ex(native_->ssl.get(), &next, 1, &count));
  return step == TlsStep::kClosed || step == TlsStep::kFailed;
}

TlsStep TlsChannel::judge(int result) {
  if (result == 1) return TlsStep::kDone;
  switch (SSL_get_error(native_->ssl.get(), result)) {
    case SSL_ERROR_WANT_READ:
      return TlsStep::kWantsRead;
    case SSL_ERROR_WANT_WRITE:
      return TlsStep::kWantsWrite;
    case SSL_ERROR_ZERO_RETURN:
      return TlsStep::kClosed;
    case SSL_ERROR_SYSCALL:
      if (errno == 0) return TlsStep::kClosed;
      failure_ = std::generic_category().message(errno);
      return TlsStep::kFailed;
    default:
      failure_ = describe_failure(ERR_peek_error());
      is_final_ = is_lasting(ERR_GET_REASON(ERR_peek_error()));
      is_peer_plain_ = ERR_GET_REASON(ERR_peek_error()) == SSL_R_HTTP_REQUEST ||
                       ERR_GET_REASON(ERR_peek_error()) == SSL_R_WRONG_VERSION_NUMBER;
      return TlsStep::kFailed;
  }
}

std::string TlsChannel::describe_failure(unsigned long code) const {
  const long fault = SSL_get_verify_result(native_->ssl.get());
  switch (ERR_GET_REASON(code)) {
    case SSL_R_CERTIFICATE_VERIFY_FAILED:
      return describe_certificate(fault, host_);
    case SSL_R_HTTP_REQUEST:
    case SSL_R_WRONG_VERSION_NUMBER:
      return host_.empty() ? "the peer does not speak TLS"
                           : host_ + " does not speak TLS on this port; use http://";
    case SSL_R_UNSUPPORTED_PROTOCOL:
    case SSL_R_TLSV1_ALERT_PROTOCOL_VERSION:
      return (host_.empty() ? std::string("the peer") : host_) + " does not speak TLS 1.3";
    default: {
      const char* reason = ERR_reason_error_string(code);
      return std::string("TLS: ") + (reason == nullptr ? "unknown error" : reason);
    }
  }
}

}  // namespace kerf::net
