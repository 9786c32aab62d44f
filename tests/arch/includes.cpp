// SPDX-License-Identifier: Apache-2.0
#include "tests/arch/includes.h"

#include <algorithm>
#include <optional>
#include <string_view>

namespace kerf::arch {
namespace {

struct Module {
  std::string_view path;                  ///< a folder, or one file
  std::vector<std::string_view> may_use;  ///< folders or files besides the module itself
};

const std::vector<Module>& agent_modules() {
  static const std::vector<Module> kModules = {
      // Used by every thread of the agent: lock-free exchange, clock, thread priority, histogram.
      {"haptic_agent/realtime", {}},
      {"haptic_agent/device",
       {"kernel/math/vec3.h", "kernel/math/wrench.h", "server/wire", "haptic_agent/realtime",
        "haptic_agent/library/kerf_agent.h"}},
      {"haptic_agent/servo",
       {"kernel/math/vec3.h", "kernel/math/wrench.h", "server/wire", "haptic_agent/realtime",
        "haptic_agent/device"}},
      {"haptic_agent/link",
       {"kernel/math/vec3.h", "kernel/math/wrench.h", "server/wire", "server/datagram",
        "server/tls", "server/websocket", "haptic_agent/realtime", "haptic_agent/device",
        "haptic_agent/servo"}},
      // The only module of the agent that depends on the rest of the kernel.
      {"haptic_agent/replica",
       {"kernel", "server/wire", "server/convert", "server/formats/scene.h",
        "haptic_agent/realtime", "haptic_agent/device", "haptic_agent/servo",
        "haptic_agent/link/stock_listener.h"}},
      // The C interface for other programs.
      {"haptic_agent/guides",
       {"kernel/math/vec3.h", "kernel/math/wrench.h", "server/formats/guide.h",
        "server/formats/guide_reader.h", "haptic_agent/device", "haptic_agent/servo"}},
      // Recordings of the loop and their playback.
      {"haptic_agent/record",
       {"kernel/math/vec3.h", "kernel/math/wrench.h", "server/wire", "server/store/crc32.h",
        "server/store/zstd_pack.h", "server/formats/guide.h", "haptic_agent/realtime",
        "haptic_agent/device", "haptic_agent/servo", "haptic_agent/new_file.h",
        "haptic_agent/plain_number.h"}},
      {"haptic_agent/study",
       {"haptic_agent/realtime", "haptic_agent/device/units.h", "haptic_agent/servo",
        "haptic_agent/new_file.h", "haptic_agent/plain_number.h"}},
      {"haptic_agent/sound", {"haptic_agent/realtime", "haptic_agent/servo/heard_cut.h"}},
      {"haptic_agent/library",
       {"kernel/math/vec3.h", "kernel/math/wrench.h", "server/wire", "haptic_agent/realtime",
        "haptic_agent/device", "haptic_agent/servo", "haptic_agent/link", "haptic_agent/replica",
        "haptic_agent/guides", "haptic_agent/force_reason.h"}},
      {"haptic_agent/doctor",
       {"haptic_agent/realtime", "haptic_agent/device", "haptic_agent/servo",
        "haptic_agent/link/server_url.h", "haptic_agent/force_notice.h", "haptic_agent/z_width.h",
        "haptic_agent/act_on_signal.h", "haptic_agent/number_in.h", "haptic_agent/wrapped_help.h",
        "server/tls"}},
      {"haptic_agent/demo", {"kernel/math"}},
      {"haptic_agent/examples", {"kernel/math", "haptic_agent"}},
      {"haptic_agent",
       {"kernel/math/vec3.h", "kernel/math/wrench.h", "kernel/kernel_version.h", "server/wire"}},
  };
  return kModules;
}

/// The parts of the kernel.
const std::vector<Module>& kernel_modules() {
  static const std::vector<Module> kModules = {
      {"kernel/math", {}},
      {"kernel/piece", {"kernel/math"}},
      {"kernel/intersect", {"kernel/math", "kernel/piece"}},
      {"kernel/dexel", {"kernel/math"}},
      {"kernel/tool", {"kernel/math", "kernel/piece"}},
      {"kernel/sweep",
       {"kernel/math", "kernel/piece", "kernel/intersect", "kernel/dexel", "kernel/tool"}},
      {"kernel/cut",
       {"kernel/math", "kernel/piece", "kernel/intersect", "kernel/dexel", "kernel/tool",
        "kernel/sweep"}},
      {"kernel/force",
       {"kernel/math", "kernel/piece", "kernel/intersect", "kernel/dexel", "kernel/tool",
        "kernel/sweep", "kernel/cut"}},
      {"kernel/surface", {"kernel/math", "kernel/dexel"}},
  };
  return kModules;
}

const std::vector<Module>& other_modules() {
  static const std::vector<Module> kModules = {
      {"kernel", {}},
      // Time and random numbers. Depends on nothing; any module that needs either may use it.
      {"server/platform", {}},
      {"server/wire", {"kernel/math/vec3.h"}},
      {"server/datagram", {"server/platform", "server/wire"}},
      {"server/tls", {"server/platform"}},
      {"server/websocket", {"server/tls"}},
      {"server/log", {}},
      {"server/formats", {"kernel"}},
      // Not even the session's header: threads know nothing about the work they run.
      {"server/threads", {"kernel/cut/workers.h", "server/log", "server/platform"}},
      {"server/verify", {"kernel", "server/formats", "server/platform"}},
      {"server/picture", {"kernel"}},
      {"server/carve",
       {"kernel", "server/formats", "server/picture", "server/platform", "server/verify",
        "server/threads/thread_pool.h"}},
      {"server/convert", {"kernel", "server/wire", "server/formats"}},
      {"server/store", {"kernel", "server/formats", "server/platform"}},
      {"server/history", {"kernel", "server/store"}},
      {"server/rights",
       {"kernel/math/vec3.h", "server/error.h", "server/platform", "server/store/attachment.h",
        "server/store/byte_code.h", "server/store/resume_token.h", "server/store/sqlite.h",
        "server/wire/limits.h"}},
      {"server/feed", {"kernel", "server/wire", "server/convert", "server/formats"}},
      {"server/session",
       {"kernel", "server/error.h", "server/wire", "server/convert", "server/formats",
        "server/platform", "server/verify", "server/store", "server/history", "server/feed",
        "server/rights", "server/threads/executor.h", "server/threads/run_and_wait.h",
        "server/threads/timed_mutex.h"}},
      {"server/cluster",
       {"server/platform", "server/store", "server/history", "server/session", "server/threads",
        "server/log"}},
      {"server/metrics", {"server/platform", "server/session"}},
      // The protocols of agents and viewers as state machines: no socket, no thread, no Boost.
      {"server/conversation",
       {"kernel", "server/wire", "server/convert", "server/datagram", "server/formats",
        "server/feed", "server/platform", "server/session", "server/metrics", "server/rights"}},
      {"server/udp",
       {"server/datagram", "server/platform", "server/session", "server/metrics",
        "server/threads/executor.h"}},
      {"server/socket",
       {"server/wire", "server/datagram", "server/feed", "server/platform", "server/session",
        "server/metrics", "server/conversation", "server/rights", "server/tls", "server/udp",
        "server/websocket", "server/threads"}},
      {"server/http",
       {"kernel", "server/error.h", "server/wire", "server/convert/rejection.h", "server/formats",
        "server/platform", "server/verify", "server/store", "server/session", "server/metrics",
        "server/rights", "server/socket", "server/tls", "server/websocket", "server/threads"}},
      {"server", {"kernel"}},
      // Programs, scenes, models and journals for a page that carves without a server.
      {"web/wasm/files",
       {"kernel", "server/formats", "server/verify", "server/store", "server/history",
        "server/wire", "server/convert", "server/feed/column_digest.h",
        "server/session/past_block.h", "server/session/session_id.h", "web/wasm/stop_token.h"}},
      // The replica of an agent, for pages.
      {"web/wasm",
       {"kernel", "server/wire", "server/convert", "server/formats", "haptic_agent/replica"}},
      {"tests", {"kernel", "server", "haptic_agent", "web/wasm"}},
  };
  return kModules;
}

/// The matters of a session; the folders of other_modules() do not know them.
const std::vector<Module>& matter_modules() {
  static const std::vector<Module> kModules = {
      {"server/downloads",
       {"kernel", "server/error.h", "server/formats", "server/http", "server/session",
        "server/store"}},
      {"server/merge",
       {"server/history", "server/http", "server/platform", "server/session", "server/store"}},
      {"server/people",
       {"server/http", "server/rights", "server/session", "server/store",
        "server/threads/run_and_wait.h"}},
      {"server/pictures", {"server/http", "server/picture", "server/platform", "server/session"}},
      {"server/pins",
       {"kernel/math/vec3.h", "server/platform", "server/rights", "server/store", "server/session",
        "server/http", "server/threads/run_and_wait.h", "server/wire/limits.h"}},
      {"server/probe",
       {"server/history", "server/http", "server/session", "server/threads/run_and_wait.h"}},
      {"server/programs",
       {"server/error.h", "server/formats", "server/http", "server/rights", "server/session",
        "server/targets", "server/threads/run_and_wait.h", "server/wire/limits.h"}},
      {"server/strokes", {"server/http", "server/session"}},
      {"server/targets",
       {"kernel", "server/error.h", "server/formats", "server/http", "server/rights",
        "server/session", "server/store", "server/verify"}},
      {"server/tools",
       {"server/http", "server/rights", "server/session", "server/store/plain_text.h",
        "server/threads/run_and_wait.h", "server/wire/limits.h"}},
      {"server/versions",
       {"server/platform", "server/rights", "server/store", "server/session", "server/http",
        "server/threads/run_and_wait.h"}},
  };
  return kModules;
}

struct Library {
  std::vector<std::string_view> headers;  ///< prefixes of the name between < and >
  bool in_headers;                        ///< whether a header of the project may include it
  std::vector<std::string_view> modules;  ///< besides tests
  std::string_view reason;
};

const std::vector<Library>& libraries() {
  static const std::vector<Library> kLibraries = {
      {{"boost/"},
       true,
       {"server/threads", "server/websocket", "server/socket", "server/http", "server/server.cpp",
        "haptic_agent/link"},
       "a file that includes Boost takes 4 to 16 s to compile"},
      {{"nlohmann/"},
       false,
       {"server/formats",   "server/verify",   "server/carve",        "server/store",
        "server/session",   "server/feed",     "server/conversation", "server/http",
        "server/downloads", "server/merge",    "server/people",       "server/pins",
        "server/probe",     "server/programs", "server/strokes",      "server/targets",
        "server/tools",     "server/versions", "server/cluster",      "haptic_agent",
        "web/wasm/files"},
       "JSON stays inside the .cpp files that read and write it"},
      {{"tiny_gltf.h", "tinygltf/"}, false, {"server/formats"}, "glTF is a file format"},
      {{"expat.h"}, false, {"server/formats"}, "3MF is a file format"},
      {{"minizip/", "zlib.h"},
       false,
       {"server/formats"},
       "compression belongs to the file formats"},
      {{"meshoptimizer.h"},
       false,
       {"server/formats", "server/feed"},
       "meshes are compressed where they are encoded"},
      {{"png.h"}, false, {"server/picture"}, "pictures are written in one place"},
      {{"sqlite3.h"}, false, {"server/store"}, "only the store knows the database"},
      {{"zstd.h"}, false, {"server/store"}, "only files that are stored are compressed with it"},
      {{"openssl/"},
       false,
       {"server/store", "server/datagram", "server/tls"},
       "cryptography belongs to the network and the journal"},
      {{"spdlog/", "fmt/"}, false, {"server/log"}, "a file with spdlog takes seconds to compile"},
      {{"prometheus/"}, false, {"server/metrics"}, "one class counts for the whole server"},
      {{"CLI/"},
       false,
       {"server/command_line.cpp", "server/commands.cpp", "server/configuration.cpp",
        "server/cluster_options.cpp", "server/viewer_options.cpp", "server/carve",
        "haptic_agent/main.cpp", "haptic_agent/number_in.cpp", "haptic_agent/options.cpp",
        "haptic_agent/recording_commands.cpp", "haptic_agent/wrapped_help.cpp",
        "haptic_agent/doctor"},
       "the command line belongs to the programs"},
      {{"nats/"}, false, {"server/cluster"}, "one class speaks to NATS"},
      {{"libusb"}, false, {"haptic_agent/device"}, "USB belongs to the devices"},
      {{"wasm_simd128.h"},
       true,
       {"kernel/math/lane_mask_wasm.h", "kernel/math/int_mask_wasm.h"},
       "instructions of one machine belong to the lanes"},
  };
  return kLibraries;
}

// Headers of I/O, clocks and threads, which the kernel does not use.
constexpr std::string_view kSystemHeaders[] = {"thread",  "future",     "chrono",
                                               "fstream", "iostream",   "filesystem",
                                               "ctime",   "stop_token", "condition_variable",
                                               "random",  "locale"};

bool is_within(std::string_view path, std::string_view place) {
  return path == place || (path.starts_with(place) && path.substr(place.size()).starts_with('/'));
}

bool is_within_any(std::string_view path, const std::vector<std::string_view>& places) {
  return std::ranges::any_of(places, [&](auto place) { return is_within(path, place); });
}

// The first module that contains a file decides. A file outside every module is a violation.
const Module* module_of(std::string_view path) {
  for (const auto* modules :
       {&agent_modules(), &kernel_modules(), &matter_modules(), &other_modules()}) {
    const auto found =
        std::ranges::find_if(*modules, [&](const Module& m) { return is_within(path, m.path); });
    if (found != modules->end()) return &*found;
  }
  return nullptr;
}

std::optional<std::string> fault_of_project_include(const Source& source, std::string_view target,
                                                    const std::set<std::string>& paths) {
  if (!paths.contains(std::string(target))) {
    return "include paths start at the repository root; there is no " + std::string(target);
  }
  const Module* module = module_of(source.path);
  if (!module) return "this folder is missing from the dependency table (tests/arch/includes.cpp)";
  if (is_within(target, module->path) || is_within_any(target, module->may_use)) return {};
  return std::string(module->path) + " must not depend on " + std::string(target);
}

std::optional<std::string> fault_of_system_include(const Source& source, std::string_view target) {
  // Examples are programs of the library's users: they may include anything public.
  if (is_within(source.path, "tests") || is_within(source.path, "kernel/examples") ||
      is_within(source.path, "haptic_agent/examples"))
    return {};
  for (const Library& library : libraries()) {
    const bool named = std::ranges::any_of(
        library.headers, [&](auto beginning) { return target.starts_with(beginning); });
    if (!named) continue;
    if (!is_within_any(source.path, library.modules)) {
      return "<" + std::string(target) + "> outside its modules: " + std::string(library.reason);
    }
    if (is_header(source.path) && !library.in_headers) {
      return "<" + std::string(target) + "> in a header: " + std::string(library.reason);
    }
    return {};
  }
  const bool kernel = is_within(source.path, "kernel");
  if (!kernel && !is_within(source.path, "server/wire")) return {};
  if (target.find_first_of("/.") != target.npos) {
    return "kernel and wire use the standard library only, not <" + std::string(target) + ">";
  }
  if (kernel && std::ranges::find(kSystemHeaders, target) != std::end(kSystemHeaders)) {
    return "the kernel has no I/O, clock or thread of its own: <" + std::string(target) + ">";
  }
  return {};
}

// The viewer's codec mirrors server/wire and, like it, depends on nothing.
std::vector<Violation> check_viewer_wire(const Source& source) {
  std::vector<Violation> violations;
  std::size_t number = 0;
  for (std::string_view line : lines_of(source.text)) {
    ++number;
    const std::size_t from = line.find(" from '");
    if (from == line.npos || line.substr(from + 7).starts_with("./")) continue;
    violations.push_back({source.path, number, "web/src/wire imports nothing but its own files"});
  }
  return violations;
}

}  // namespace

std::vector<Violation> check_includes(const Source& source, const std::set<std::string>& paths) {
  if (is_within(source.path, "web/src/wire")) return check_viewer_wire(source);
  std::vector<Violation> violations;
  if (!is_cpp(source.path)) return violations;
  std::size_t number = 0;
  for (std::string_view line : lines_of(source.text)) {
    ++number;
    if (!line.starts_with("#include ") || line.size() < 12) continue;
    const char open = line[9];
    const std::size_t end = line.find(open == '<' ? '>' : '"', 10);
    if (end == line.npos) continue;
    const std::string_view target = line.substr(10, end - 10);
    const auto fault = open == '"' ? fault_of_project_include(source, target, paths)
                                   : fault_of_system_include(source, target);
    if (fault) violations.push_back({source.path, number, *fault});
  }
  if (is_header(source.path) &&
      !source.text.starts_with("// SPDX-License-Identifier: Apache-2.0\n#pragma once")) {
    violations.push_back({source.path, 1, "a header begins with the SPDX line and #pragma once"});
  }
  return violations;
}

}  // namespace kerf::arch
