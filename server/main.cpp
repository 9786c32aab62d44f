// SPDX-License-Identifier: Apache-2.0
// kerf-server: sessions in which several people carve one block, over HTTP and WebSockets.
#include <kerf/version.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/http/static_files.h"
#include "server/log/log.h"
#include "server/maintenance.h"
#include "server/rights/admin_token.h"
#include "server/server.h"
#include "server/store/journal_file.h"
#include "server/wire/control.h"

namespace {

using kerf::net::Server;
using kerf::net::ServerOptions;

struct CommandLine {
  std::string listen = "127.0.0.1:8080";
  std::string udp;
  std::vector<std::string> scenes, proxies;
  std::string admin_token_file;
  double snapshot_s = 1;
  ServerOptions server;
};

bool parse_port(std::string_view text, std::uint16_t& port) {
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, port);
  return parsed.ec == std::errc() && parsed.ptr == end;
}

/// Splits ADDR:PORT; an IPv6 address is in brackets.
bool parse_listen(const std::string& text, std::string& address, std::uint16_t& port) {
  const auto colon = text.rfind(':');
  if (colon == std::string::npos) return false;
  address = text.substr(0, colon);
  if (address.size() > 2 && address.front() == '[' && address.back() == ']') {
    address = address.substr(1, address.size() - 2);
  }
  return !address.empty() && parse_port(std::string_view(text).substr(colon + 1), port);
}

/// Parses [ADDR:]PORT or off; an empty text keeps the default.
bool parse_udp(const std::string& text, kerf::net::UdpOptions& udp) {
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

/// Creates the session of a scene file unless it exists or is being loaded, e.g. from before a
/// restart. Returns the error text of an invalid scene, empty otherwise. A journal that cannot be
/// read or written is logged: it does not stop the other sessions.
std::string open_scene(kerf::SessionRegistry& sessions, const std::string& file) {
  const auto scene = kerf::load_scene(file);
  if (!scene) return to_string(scene.error());
  const std::string id = kerf::id_from_name(scene->name);
  if (sessions.is_loading(id) || sessions.find(id)) return {};
  if (const auto error = sessions.unreadable(id)) {
    kerf::log::error("session " + id + " of " + file +
                     " is not open, its journal stays as it is: " + describe(*error));
    return {};
  }
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  kerf::SceneSource source;
  source.name = file;
  source.base_folder = std::filesystem::path(file).parent_path();
  const auto created = sessions.create(id, text, source);
  if (created && scene->accuracy) {
    kerf::log::info("session " + id + ": " + scene->accuracy->reason);
  }
  if (!created && created.error().code == kerf::RegistryErrorCode::kJournal) {
    kerf::log::error("session " + id + " of " + file +
                     " cannot be created: " + created.error().reason);
    return {};
  }
  return created ? "" : created.error().reason;
}

std::string version_text() {
  return std::string("kerf-server ") + kerf::kVersion + " (" +
         std::string(kerf::wire::kAgentProtocol) + ", " + std::string(kerf::wire::kViewProtocol) +
         ", journal format " + std::to_string(kerf::kJournalVersion) + ", kernel " +
         std::to_string(kerf::kKernelVersion) + ")";
}

/// The names by which a local network knows this machine: its host name, and the one of mDNS.
std::vector<std::string> own_names() {
  std::array<char, HOST_NAME_MAX + 1> name{};
  if (gethostname(name.data(), name.size()) != 0 || name[0] == 0) return {};
  const std::string host(name.data());
  return {host, host + ".local"};
}

/// Allows as many open files as the system permits: each peer needs one.
void raise_file_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == limit.rlim_max) return;
  limit.rlim_cur = limit.rlim_max;
  if (setrlimit(RLIMIT_NOFILE, &limit) != 0) {
    kerf::log::warn("the limit of open files cannot be raised to " +
                    std::to_string(limit.rlim_max));
  }
}

void reload(Server& server) {
  if (const auto done = server.reload_certificate(); !done) {
    kerf::log::error("SIGHUP: " + done.error() + "; the last certificate stays in use");
  } else {
    kerf::log::info("SIGHUP: new connections get the certificate that was read now");
  }
}

int serve(CommandLine line) {
  raise_file_limit();
  // Only this thread waits for signals: block them before other threads start.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a limit of the file size is like a full disk

  // Without a certificate SIGHUP ends the process, as when its terminal closes.
  if (!line.server.tls_certificate.empty()) sigaddset(&signals, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);

  auto server = Server::create(std::move(line.server));
  if (!server) {
    std::fprintf(stderr, "kerf-server: %s\n", server.error().c_str());
    return 1;
  }
  for (const std::string& file : line.scenes) {
    if (const std::string error = open_scene((*server)->sessions(), file); !error.empty()) {
      std::fprintf(stderr, "kerf-server: %s\n", error.c_str());
      return 2;
    }
  }
  if (auto ok = (*server)->listen(); !ok) {
    std::fprintf(stderr, "kerf-server: %s\n", ok.error().c_str());
    return 1;
  }
  std::printf("%s\n", (*server)->url().c_str());
  std::fflush(stdout);
  if (const auto port = (*server)->udp_port(); port != 0) {
    kerf::log::info("UDP: port " + std::to_string(port));
  }
  const std::string url = (*server)->url();
  for (const std::string& id : (*server)->sessions().ids()) {
    kerf::log::info(std::string("session ")
                        .append(id)
                        .append(": ")
                        .append(url)
                        .append("/?session=")
                        .append(id));
  }
  int signal = SIGHUP;
  for (sigwait(&signals, &signal); signal == SIGHUP; sigwait(&signals, &signal)) reload(**server);
  kerf::log::info("shutting down");
  (*server)->stop();
  return 0;
}

/// Lets each option be set in a file and in the environment too: `--allow-host` is `allow-host` in
/// the file and KERF_ALLOW_HOST in the environment. The command line counts before the file, and
/// the file before the environment. A key that is not an option is an error.
void accept_configuration(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const std::string name = option->get_single_name();
    if (name == "help" || name == "version") continue;
    std::string variable = "KERF_";
    for (const char c : name) {
      variable += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
    option->envname(variable);
  }
  app.set_config("--config", "",
                 "TOML file of options, e.g. listen = \"0.0.0.0:8080\"; the environment may set "
                 "them too, e.g. KERF_LISTEN");
  app.allow_config_extras(CLI::config_extras_mode::error);
}

/// The commands that verify or copy files instead of serving sessions.
struct Commands {
  std::string folder, journal, backup;

  void add(CLI::App& app) {
    app.add_subcommand("check",
                       "reads the journals and snapshots of a data folder; exits with 1 if "
                       "something is wrong, and says what to do")
        ->add_option("DATA", folder, "data folder, also of a running server")
        ->required();
    CLI::App* copy = app.add_subcommand(
        "backup",
        "copies the journals and the rights of a data folder into another folder, also while "
        "a server runs on it");
    copy->add_option("DATA", folder, "data folder")->required();
    copy->add_option("TO", backup, "folder of the copies, created if missing; no file is replaced")
        ->required();
    app.add_subcommand("replay",
                       "carves a journal from the start and compares it with its state hashes and "
                       "its snapshot; exits with 1 at the first difference")
        ->add_option("FILE", journal, "journal, DATA/SESSION.kerf")
        ->required();
  }
  /// The exit status of the command that was named; nullopt if none was.
  std::optional<int> run(const CLI::App& app) const {
    if (app.got_subcommand("check")) return kerf::check_data(folder);
    if (app.got_subcommand("backup")) return kerf::back_up(folder, backup);
    if (app.got_subcommand("replay")) return kerf::replay_journal(journal);
    return std::nullopt;
  }
};

kerf::SnapshotLimits snapshot_limits(double replay_s) {
  kerf::SnapshotLimits limits;
  limits.replay_time =
      std::chrono::round<std::chrono::microseconds>(std::chrono::duration<double>(replay_s));
  limits.pause = std::min(limits.pause, 2 * limits.replay_time);
  return limits;
}

void describe_tls(CLI::App& app, CommandLine& line) {
  CLI::Option* certificate =
      app.add_option("--tls-cert", line.server.tls_certificate,
                     "PEM file of the certificate chain: the server then speaks TLS 1.3 only. "
                     "SIGHUP reads it and the key again");
  CLI::Option* key =
      app.add_option("--tls-key", line.server.tls_key, "PEM file of its private key");
  certificate->needs(key);
  key->needs(certificate);
}

void describe_proxy(CLI::App& app, CommandLine& line) {
  app.add_option(
      "--trust-proxy", line.proxies,
      "IP address, or network (10.0.0.0/8), of a proxy whose X-Forwarded-For, -Proto and "
      "-Host count; may be repeated");
}

void describe_rights(CLI::App& app, CommandLine& line) {
  app.add_option("--admin-token-file", line.admin_token_file,
                 "file with the administrator's token; made with a random one if it does not "
                 "exist. Or the environment variable KERF_ADMIN_TOKEN. Then everybody needs a "
                 "token or an invitation");
  app.add_flag("--open", line.server.open,
               "for demonstrations: who has no token watches, and carves within limits");
}

int run(int argc, char** argv) {
  CommandLine line;
  line.server.http.web_folder = kerf::net::find_web_folder();
  CLI::App app{"kerf-server: sessions in which several people carve one block and feel its force"};
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
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app.add_option("--scene", line.scenes,
                 "scene file whose session is created unless it exists; may be repeated");
  app.add_option("--web", line.server.http.web_folder, "folder of the built viewer");
  app.add_option(
      "--allow-host", line.server.http.allow_hosts,
      "name of the server for its clients, besides IP addresses, localhost and this machine's "
      "host name");
  app.add_option("--allow-origin", line.server.http.allow_origins,
                 "origin of other web pages that may connect, e.g. https://kerf.example");
  describe_rights(app, line);
  describe_tls(app, line);
  describe_proxy(app, line);
  Commands commands;
  commands.add(app);
  std::string log_format = "text";
  app.add_option("--log-format", log_format, "text, or json: an object per line")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  accept_configuration(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ConfigError& error) {
    std::fprintf(stderr, "kerf-server: --config: %s; --help lists the options\n", error.what());
    return 2;
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  if (const auto status = commands.run(app)) return *status;
  line.server.snapshots = snapshot_limits(line.snapshot_s);
  for (std::string& name : own_names()) line.server.http.allow_hosts.push_back(std::move(name));
  kerf::log::open(log_format == "json" ? kerf::log::Format::kJson : kerf::log::Format::kText);
  if (!parse_listen(line.listen, line.server.address, line.server.port)) {
    std::fprintf(stderr, "kerf-server: --listen %s is not ADDR:PORT\n", line.listen.c_str());
    return 2;
  }
  if (!parse_udp(line.udp, line.server.udp)) {
    std::fprintf(stderr, "kerf-server: --udp %s is not [ADDR:]PORT or off\n", line.udp.c_str());
    return 2;
  }
  auto proxies = kerf::net::TrustedProxies::parse(line.proxies);
  if (!proxies) {
    std::fprintf(stderr, "kerf-server: --trust-proxy: %s\n", proxies.error().c_str());
    return 2;
  }
  line.server.http.proxies = *std::move(proxies);
  auto token = kerf::read_admin_token(line.admin_token_file);
  if (!token) {
    std::fprintf(stderr, "kerf-server: %s\n", token.error().c_str());
    return 1;
  }
  line.server.admin_token = *std::move(token);
  return serve(std::move(line));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kerf-server: %s\n", error.what());
    return 1;
  }
}
