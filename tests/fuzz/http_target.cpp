// SPDX-License-Identifier: Apache-2.0
// Targets and headers of HTTP requests: lines "target", "Range", "Host", "Origin".
#include <array>

#include "server/downloads/download_request.h"
#include "server/http/browser_rules.h"
#include "server/http/byte_range.h"
#include "server/http/routes.h"
#include "server/matters.h"
#include "tests/fuzz/targets.h"

namespace kerf::fuzz {

void read_request(Bytes input) {
  std::array<std::string_view, 4> lines;
  std::string_view rest = text_of(input);
  for (std::string_view& line : lines) {
    line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
  }
  const auto& [target, range, host, origin] = lines;
  if (const auto request = net::parse_target(target)) {
    static const net::RouteTable table(net::http_matters());
    for (const char* method : {"GET", "POST", "BREW"}) {
      const auto match = table.match(method, request->path);
      require(match.route == nullptr || !match.allow.empty(), "a route has methods");
    }
    if (request->path.size() > 3) (void)net::read_download_request(*request);
  }
  constexpr std::uint64_t kBytes = 1000;
  if (const auto bytes = net::parse_range(range, kBytes); bytes && *bytes) {
    require((*bytes)->count > 0 && (*bytes)->first + (*bytes)->count <= kBytes,
            "a range lies inside the file");
  }
  net::HttpOptions options{.allow_hosts = {"workshop"}, .allow_origins = {"https://kerf.example"}};
  (void)net::host_allowed(host, options);
  if (net::origin_allowed({host, origin}, options)) {
    require(origin.empty() || net::host_allowed(host, options) ||
                origin == options.allow_origins.front(),
            "a foreign origin is allowed only if it is listed");
  }
}

}  // namespace kerf::fuzz
