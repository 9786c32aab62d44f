// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <memory>
#include <string>

#include "server/metrics/metrics.h"
#include "server/tls/tls_context.h"

namespace kerf {

/// Reads the server's certificate and key, or null if `certificate` is empty, for a server without
/// TLS. Logs a certificate that clients reject because it has expired or is not valid yet. The
/// error is one sentence.
std::expected<std::unique_ptr<net::TlsCertificate>, std::string> load_certificate(
    const std::filesystem::path& certificate, const std::filesystem::path& key);

/// Sets the expiry shown in /metrics, or null without a certificate.
void show_expiry(const net::TlsCertificate* certificate, net::Metrics& metrics);

}  // namespace kerf
