// SPDX-License-Identifier: Apache-2.0
#include "server/certificate.h"

#include "server/log/log.h"

namespace kerf {

std::expected<std::unique_ptr<net::TlsCertificate>, std::string> load_certificate(
    const std::filesystem::path& certificate, const std::filesystem::path& key) {
  if (certificate.empty()) return nullptr;
  auto loaded = net::TlsCertificate::load(certificate, key);
  if (!loaded) return loaded;
  // The server starts nevertheless: the clock of the machine may be wrong, and SIGHUP reads another
  // certificate without closing a connection.
  if (const auto fault = (*loaded)->fault()) {
    log::error(*fault + "; clients reject it until its files are replaced and SIGHUP is sent");
  }
  return loaded;
}

void show_expiry(const net::TlsCertificate* certificate, net::Metrics& metrics) {
  if (certificate != nullptr) metrics.certificate_expires_s = certificate->current().expires_s();
}

}  // namespace kerf
