// SPDX-License-Identifier: Apache-2.0
// kerf-server: sessions in which several people carve one block, over HTTP and WebSockets.
#include <fcntl.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iterator>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/command_line.h"
#include "server/log/log.h"
#include "server/server.h"

namespace {

using kerf::net::Server;

/// Creates the session of a scene file unless it exists or is being loaded, e.g. after a restart.
/// Returns the error text of an invalid scene, empty otherwise. A journal that cannot be read or
/// written is logged and does not stop the other sessions.
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
  using enum kerf::RegistryErrorCode;
  // In a cluster: it is at another server, or is about to be loaded from the data folder.
  if (!created && sessions.places() != nullptr && created.error().code == kExists) return {};
  const auto is_of_machine = [](kerf::RegistryErrorCode code) {
    return code == kJournal || code == kDiskFails || code == kNoLease;
  };
  if (!created && is_of_machine(created.error().code)) {
    kerf::log::error("session " + id + " of " + file +
                     " cannot be created: " + created.error().reason);
    return {};
  }
  return created ? "" : created.error().reason;
}

/// Returns false after printing an error.
bool open_scenes(Server& server, const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    const std::string error = open_scene(server.sessions(), file);
    if (error.empty()) continue;
    std::fprintf(stderr, "kerf-server: %s\n", error.c_str());
    return false;
  }
  return true;
}

/// Opens standard streams that were closed at the start of the program. Otherwise the first files
/// would get their numbers, and the address and the log would be written into them.
void open_standard_streams() {
  for (int number = STDIN_FILENO; number <= STDERR_FILENO; ++number) {
    if (fcntl(number, F_GETFD) == -1 && open("/dev/null", O_RDWR) != number) std::abort();
  }
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
    kerf::log::error("SIGHUP: nothing is changed: " + done.error());
  } else {
    kerf::log::info("SIGHUP: new connections get the certificate that was read now");
  }
}

/// Time for the rest of the server after its sessions are closed.
constexpr std::chrono::seconds kEndTime{1};

/// Ends the process if the server has not ended in time. Nothing is lost: its journals are closed,
/// and requests in progress have no peer to answer.
void end_in_time(const std::stop_token& ended) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock guard(mutex);
  wake.wait_for(guard, ended, kEndTime, [] { return false; });
  if (!ended.stop_requested()) std::_Exit(0);
}

int serve(kerf::CommandLine line) {
  raise_file_limit();
  // Only this thread waits for signals: block them before other threads start.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file size limit is handled like a full disk

  // Without a certificate and at a terminal SIGHUP ends the process, as when the terminal closes.
  const bool is_service = isatty(STDIN_FILENO) == 0;
  if (is_service || !line.server.tls_certificate.empty()) sigaddset(&signals, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);

  auto server = Server::create(std::move(line.server));
  if (!server) {
    std::fprintf(stderr, "kerf-server: %s\n", server.error().c_str());
    return 1;
  }
  // In a cluster creating a session requires the other servers, which learn this one's address
  // first.
  const bool asks = (*server)->sessions().places() != nullptr;
  if (!asks && !open_scenes(**server, line.scenes)) return 2;
  if (auto ok = (*server)->listen(); !ok) {
    std::fprintf(stderr, "kerf-server: %s\n", ok.error().c_str());
    return 1;
  }
  if (asks && !open_scenes(**server, line.scenes)) return 2;
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
  const std::jthread limit(end_in_time);
  server->reset();
  return 0;
}

int run(int argc, char** argv) {
  auto line = kerf::read_command_line(argc, argv);
  return line ? serve(*std::move(line)) : line.error();
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  umask(S_IRWXG | S_IRWXO);  // journals, rights and uploads are for this user only
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kerf-server: %s\n", error.what());
    return 1;
  }
}
