// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/nats_address.h"

#include <sstream>
#include <string_view>

namespace kerf {
namespace {

/// The length of `nats://` or `tls://` at the beginning of a URL, or 0 without either.
std::size_t scheme_length(const std::string& url) {
  for (const std::string_view scheme : {"nats://", "tls://"})
    if (url.starts_with(scheme)) return scheme.size();
  return 0;
}

}  // namespace

std::vector<std::string> nats_servers(const std::string& urls) {
  std::vector<std::string> servers;
  std::istringstream words(urls);
  for (std::string url; std::getline(words, url, ',');) {
    const std::size_t scheme = scheme_length(url);
    if (scheme == 0 || url.size() == scheme || url.ends_with('@')) return {};
    servers.push_back(url);
  }
  return servers;
}

std::string nats_fault(const std::string& urls) {
  if (!nats_servers(urls).empty()) return {};
  return "must be nats://HOST:PORT or tls://HOST:PORT, or several, separated by commas";
}

std::string without_credentials(const std::string& urls) {
  std::string shown;
  for (const std::string& url : nats_servers(urls)) {
    const std::size_t scheme = scheme_length(url), at = url.rfind('@');
    if (!shown.empty()) shown += ',';
    shown += url.substr(0, scheme) + url.substr(at == std::string::npos ? scheme : at + 1);
  }
  return shown;
}

}  // namespace kerf
