// SPDX-License-Identifier: Apache-2.0
#include "server/command_line.h"

#include <kerf/version.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <chrono>
#include <climits>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "server/cluster_options.h"
#include "server/commands.h"
#include "server/configuration.h"
#include "server/http/browser_rules.h"
#include "server/http/number.h"
#include "server/http/static_files.h"
#include "server/log/log.h"
#include "server/rights/admin_token.h"
#include "server/store/journal_file.h"
#include "server/viewer_options.h"
#include "server/wire/control.h"

namespace kerf {
namespace {

/// The options as given.
struct Words {
  std::string listen = "127.0.0.1:8080";
  std::string udp;
  std::vector<std::string> scenes, proxies;
  std::string admin_token_file;
  double snapshot_s = 1;
  double session_mb = 0, total_mb = 0, reserve_mb = 256;
  std::string log_format = "text", durable;
  net::ServerOptions server;
};

std::unexpected<int> reject(const std::string& reason, int status = 2) {
  std::fprintf(stderr, "kerf-server: %s\n", reason.c_str());
  return std::unexpected(status);
}

bool parse_port(std::string_view text, std::uint16_t& port) {
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, port);
  return parsed.ec == std::errc() && parsed.ptr == end;
}

/// Splits ADDR:PORT. An IPv6 address is in brackets.
bool parse_listen(const std::string& text, std::string& address, std::uint16_t& port) {
  const auto colon = text.rfind(':');
  if (colon == std::string::npos) return false;
  address = text.substr(0, colon);
  if (address.size() > 2 && address.front() == '[' && address.back() == ']') {
    address = address.substr(1, address.size() - 2);
  }
  return !address.empty() && parse_port(std::string_view(text).substr(colon + 1), port);
}

/// Parses [ADDR:]PORT or off. An empty text keeps the default.
bool parse_udp(const std::string& text, net::UdpOptions& udp) {
  if (text.empty()) return true;
  udp.on = text != "off";
  if (!udp.on) return true;
  udp.required = true;
  std::uint16_t port = 0;
  const bool good =
      text.contains(':') ? parse_listen(text, udp.address, port) : parse_port(text, port);
  udp.port = port;
  return good;
}

std::string version_text() {
  return std::string("kerf-server ") + kVersion + " (" + std::string(wire::kAgentProtocol) + ", " +
         std::string(wire::kViewProtocol) + ", journal format " + std::to_string(kJournalVersion) +
         ", kernel " + std::to_string(kKernelVersion) + ")";
}

/// The names of this machine in a local network: its host name, and that of mDNS.
std::vector<std::string> own_names() {
  std::array<char, HOST_NAME_MAX + 1> name{};
  if (gethostname(name.data(), name.size()) != 0 || name[0] == 0) return {};
  const std::string host(name.data());
  return {host, host + ".local"};
}

SnapshotLimits snapshot_limits(double replay_s) {
  SnapshotLimits limits;
  limits.replay_time =
      std::chrono::round<std::chrono::microseconds>(std::chrono::duration<double>(replay_s));
  limits.pause = std::min(limits.pause, 2 * limits.replay_time);
  return limits;
}

/// A number from 0 to `most`. CLI::Range would accept "nan".
CLI::Validator up_to(double most) {
  const auto check = [most](const std::string& text) {
    const auto number = net::parse_number<double>(text);
    return number && *number >= 0 && *number <= most
               ? std::string()
               : text + " is not a number from 0 to " + std::to_string(std::llround(most));
  };
  return CLI::Validator(check, "");
}

void describe_disk(CLI::App& app, Words& line) {
  const CLI::Validator megabytes = up_to(1e9);
  app.add_option("--disk-per-session", line.session_mb,
                 "MB that the journal and the snapshots of a session may have; then it is paused. "
                 "0: no limit")
      ->check(megabytes)
      ->capture_default_str();
  app.add_option("--disk-total", line.total_mb,
                 "MB that the files of the data folder may have, closed sessions included; then "
                 "all sessions are paused. 0: no limit")
      ->check(megabytes)
      ->capture_default_str();
  app.add_option("--disk-reserve", line.reserve_mb,
                 "MB that stay free on the file system of the data folder: with less, all sessions "
                 "are paused")
      ->check(megabytes)
      ->capture_default_str();
}

DiskLimits disk_limits(const Words& line) {
  const auto bytes = [](double mb) { return static_cast<std::uintmax_t>(mb * 1e6); };
  return {bytes(line.session_mb), bytes(line.total_mb), bytes(line.reserve_mb)};
}

void describe_tls(CLI::App& app, Words& line) {
  CLI::Option* certificate =
      app.add_option("--tls-cert", line.server.tls_certificate,
                     "PEM file of the certificate chain: the server then speaks TLS 1.3 only. "
                     "SIGHUP reads it and the key again");
  CLI::Option* key =
      app.add_option("--tls-key", line.server.tls_key, "PEM file of its private key");
  certificate->needs(key);
  key->needs(certificate);
}

void describe_drain(CLI::App& app, Words& line) {
  const auto check = [](const std::string& address) -> std::string {
    return net::is_server_address(address) ? "" : "must be http:// or https://, a host and a port";
  };
  app.add_option("--drain-to", line.server.drain_to,
                 "address of the server that continues on the data folder: on SIGTERM, agents are "
                 "sent there")
      ->check(CLI::Validator(check, ""));
}

void describe_proxy(CLI::App& app, Words& line) {
  app.add_option(
      "--trust-proxy", line.proxies,
      "IP address, or network (10.0.0.0/8), of a proxy whose X-Forwarded-For, -Proto and "
      "-Host count; may be repeated");
}

void describe_sites(CLI::App& app, Words& line) {
  const auto check = [](const std::string& origin) {
    return net::is_server_address(origin) ? std::string()
                                          : origin + " is not http[s]://HOST[:PORT]";
  };
  app.add_option("--allow-origin", line.server.http.allow_origins,
                 "origin of other web pages that may connect, e.g. https://kerf.example")
      ->check(CLI::Validator(check, ""));
  app.add_option("--embed-origin", line.server.http.embed_origins,
                 "origin of a site that may show the page /?session=ID&embed, and no other, in a "
                 "frame, e.g. https://wiki.example; default: none")
      ->check(CLI::Validator(check, ""));
}

void describe_rights(CLI::App& app, Words& line) {
  app.add_option("--admin-token-file", line.admin_token_file,
                 "file with the administrator's token; made with a random one if it does not "
                 "exist. Or the environment variable KERF_ADMIN_TOKEN. Then everybody needs a "
                 "token or an invitation");
  app.add_flag("--open", line.server.open,
               "for demonstrations: who has no token watches, and carves within limits");
}

void describe_server(CLI::App& app, Words& line) {
  app.set_version_flag("--version", version_text());
  app.add_option("--listen", line.listen, "ADDR:PORT; with port 0 the system picks one")
      ->capture_default_str();
  app.add_option(
      "--udp", line.udp,
      "[ADDR:]PORT on which agents may use UDP, or off; default: the address and port of "
      "--listen");
  app.add_option("--data", line.server.http.data_folder, "folder of the sessions' journals")
      ->capture_default_str();
  app.add_option("--snapshot-after", line.snapshot_s,
                 "s of replay at the next start after which a snapshot of a block is written")
      ->check(up_to(1e6))
      ->capture_default_str();
  app.add_option("--scene", line.scenes,
                 "scene file whose session is created unless it exists; may be repeated");
  app.add_option("--web", line.server.http.web_folder, "folder of the built viewer");
  app.add_option(
         "--allow-host", line.server.http.allow_hosts,
         "name of the server for its clients, besides IP addresses, localhost and this machine's "
         "host name")
      ->check(CLI::Validator(
          [](const std::string& host) {
            return net::is_server_address("http://" + host)
                       ? std::string()
                       : host + " is not the name of a host, e.g. kerf.example";
          },
          ""));
  describe_sites(app, line);
  describe_disk(app, line);
  describe_viewers(app, line.server);
  describe_rights(app, line);
  describe_tls(app, line);
  describe_proxy(app, line);
  describe_drain(app, line);
  describe_cluster(app, line.server, line.durable);
  app.add_option("--log-format", line.log_format, "text, or json: an object per line")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
}

/// Converts the words of a valid command line to options.
std::expected<CommandLine, int> understand(Words line) {
  line.server.snapshots = snapshot_limits(line.snapshot_s);
  if (!line.server.copies.url.empty()) line.server.snapshots.age = kCopiedSnapshotAge;
  line.server.disk = disk_limits(line);
  for (std::string& name : own_names()) line.server.http.allow_hosts.push_back(std::move(name));
  log::open(line.log_format == "json" ? log::Format::kJson : log::Format::kText);
  if (!parse_listen(line.listen, line.server.address, line.server.port)) {
    return reject("--listen " + line.listen + " is not ADDR:PORT");
  }
  if (!parse_udp(line.udp, line.server.udp)) {
    return reject("--udp " + line.udp + " is not [ADDR:]PORT or off");
  }
  if (const auto fault = cluster_fault(line.server, line.durable); !fault.empty())
    return reject(fault);
  line.server.needs_copy =
      line.durable.empty() ? !line.server.cluster.node.empty() : line.durable == "copied";
  auto proxies = net::TrustedProxies::parse(line.proxies);
  if (!proxies) return reject("--trust-proxy: " + proxies.error());
  line.server.http.proxies = *std::move(proxies);
  const auto& web = line.server.http.web_folder;
  if (!web.empty() && !std::filesystem::is_directory(web)) {
    return reject("--web " + web.string() + " is not a folder");
  }
  auto token = read_admin_token(line.admin_token_file);
  if (!token) return reject(token.error(), 1);
  line.server.admin_token = *std::move(token);
  line.server.http.request_stop = [] { kill(getpid(), SIGTERM); };
  return CommandLine{std::move(line.scenes), std::move(line.server)};
}

}  // namespace

std::expected<CommandLine, int> read_command_line(int argc, char** argv) {
  Words line;
  line.server.http.web_folder = net::find_web_folder();
  CLI::App app{"kerf-server: sessions in which several people carve one block and feel its force"};
  describe_server(app, line);
  Commands commands;
  commands.add(app);
  accept_configuration(app);
  try {
    app.parse(argc, argv);
    take_environment_lists(app);
  } catch (const CLI::ConfigError& error) {
    return reject("--config: " + config_fault(error.what()) + "; --help lists the options");
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return std::unexpected(app.exit(error));
    return reject(error.what() + std::string("; --help lists the options"));
  }
  if (const auto status = commands.run(app, line.server.copies.url))
    return std::unexpected(*status);
  return understand(std::move(line));
}

}  // namespace kerf
