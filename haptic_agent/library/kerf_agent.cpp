// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/library/kerf_agent.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <new>
#include <string_view>

#include "haptic_agent/device/plugin/c_structs.h"
#include "haptic_agent/device/ranges.h"
#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/library/agent_session.h"
#include "haptic_agent/link/token.h"
#include "haptic_agent/realtime/clock.h"
#include "server/wire/limits.h"

struct kerf_agent {
  std::unique_ptr<kerf::agent::AgentSession> session;
  bool realtime = true;
};

namespace kerf::agent {
namespace {

constexpr double kMaxPatienceS = 1e6, kMaxDrainS = 60;
constexpr std::uint32_t kKnownFlags = KERF_AGENT_NO_COPY | KERF_AGENT_UDP | KERF_AGENT_NO_REALTIME;

/// Error of the calling thread. Its length is fixed, because kerf_agent_step writes it and may not
/// allocate.
constinit thread_local std::array<char, 512> last_error{};

kerf_agent_result fail(kerf_agent_result result, std::string_view reason) noexcept {
  reason = shortened(reason, last_error.size() - 1);
  std::memcpy(last_error.data(), reason.data(), reason.size());
  last_error[reason.size()] = '\0';
  return result;
}

/// Runs a call of the interface and converts an exception to a result.
template <typename Call>
kerf_agent_result guarded(const Call& call) noexcept {
  try {
    return call();
  } catch (const std::bad_alloc&) {
    return fail(KERF_AGENT_OUT_OF_MEMORY, "out of memory");
  } catch (const std::exception& error) {
    return fail(KERF_AGENT_INTERNAL, error.what());
  } catch (...) {
    return fail(KERF_AGENT_INTERNAL, "unknown failure");
  }
}

bool is_color(std::string_view text) {
  return text.size() == 7 && text.front() == '#' &&
         std::ranges::all_of(text.substr(1), [](unsigned char c) { return std::isxdigit(c) != 0; });
}

bool in_range(double value, double most) { return value >= 0 && value <= most; }

/// Returns the first field that is out of range, or null if there is none.
const char* fault_of(const kerf_agent_options& given) {
  if (given.session == nullptr) return "session is required";
  if (!is_session_id(given.session)) {
    return "session must be letters, digits, '.', '_' or '-', at most 64";
  }
  if (given.name != nullptr && std::strlen(given.name) > wire::kMaxNameBytes) {
    return "name must be at most 64 bytes long";
  }
  if (given.color != nullptr && !is_color(given.color)) return "color must have the form #rrggbb";
  if (given.token != nullptr && !is_token(given.token)) return "token is not a token";
  if (!in_range(given.patience_s, kMaxPatienceS)) return "patience_s must be 0 to 1e6";
  if (!in_range(given.max_force_n, kForceLimitMaxN)) return "max_force_n must be 0 to 50";
  if (!in_range(given.max_torque_nmm, kTorqueLimitMaxNmm)) {
    return "max_torque_nmm must be 0 to 2000";
  }
  if ((given.flags & ~kKnownFlags) != 0) return "unknown bits in flags";
  return nullptr;
}

std::expected<SessionOptions, SessionFailure> options_of(const kerf_agent_options& given) {
  const auto invalid = [](std::string reason) {
    return std::unexpected(SessionFailure{KERF_AGENT_INVALID, std::move(reason)});
  };
  if (const char* fault = fault_of(given)) return invalid(fault);
  SessionOptions options;
  auto server = parse_server_url(given.server != nullptr ? given.server : "http://localhost:8080");
  if (!server) return invalid("server: " + server.error());
  options.link.server = *std::move(server);
  options.link.session = given.session;
  if (given.token != nullptr) options.link.token = given.token;
  if (given.ca_file != nullptr) options.link.authorities = given.ca_file;
  options.link.hello = {.name = given.name != nullptr ? given.name : "",
                        .color = given.color != nullptr ? given.color : "",
                        .tool_id = given.tool_id,
                        .feel_of = given.feel_of,
                        .udp = (given.flags & KERF_AGENT_UDP) != 0};
  if (given.patience_s > 0) options.link.patience_s = given.patience_s;
  if (given.max_force_n > 0) options.limits.force_n = given.max_force_n;
  if (given.max_torque_nmm > 0) options.limits.torque_nmm = given.max_torque_nmm;
  options.keep_copy = (given.flags & KERF_AGENT_NO_COPY) == 0;
  if (given.notice != nullptr) {
    options.link.notice = [notice = given.notice, context = given.context](
                              const std::string& line) { notice(context, line.c_str()); };
  }
  kerf_agent_capabilities device{};
  if (given.device != nullptr && !read_struct(given.device, device)) {
    return std::unexpected(
        SessionFailure{KERF_AGENT_UNSUPPORTED, "device: struct_size of another version"});
  }
  auto capabilities = capabilities_of(device);
  if (!capabilities) return invalid("device: " + capabilities.error());
  options.device = *std::move(capabilities);
  return options;
}

kerf_agent_result connect(const kerf_agent_options* given, kerf_agent** agent) {
  if (agent == nullptr) return fail(KERF_AGENT_INVALID, "agent is null");
  *agent = nullptr;
  if (given == nullptr) return fail(KERF_AGENT_INVALID, "options is null");
  kerf_agent_options known{};
  if (!read_struct(given, known)) {
    return fail(KERF_AGENT_UNSUPPORTED, "options: struct_size of another version");
  }
  auto options = options_of(known);
  if (!options) return fail(options.error().result, options.error().reason);
  auto created = std::make_unique<kerf_agent>();
  auto session = AgentSession::connect(*std::move(options));
  if (!session) return fail(session.error().result, session.error().reason);
  created->session = *std::move(session);
  created->realtime = (known.flags & KERF_AGENT_NO_REALTIME) == 0;
  *agent = created.release();
  return KERF_AGENT_OK;
}

/// Returns the agent's session, or null with the error set.
AgentSession* session_of(kerf_agent* agent) noexcept {
  if (agent == nullptr) fail(KERF_AGENT_INVALID, "agent is null");
  return agent != nullptr ? agent->session.get() : nullptr;
}

kerf_agent_result ask(kerf_agent* agent, bool undone) noexcept {
  AgentSession* session = session_of(agent);
  if (session == nullptr) return KERF_AGENT_INVALID;
  if (!session->connected()) return fail(KERF_AGENT_LOST, "there is no connection to the server");
  session->ask(undone);
  return KERF_AGENT_OK;
}

/// `wrench` was set to zero before and stays zero on failure.
kerf_agent_result step(AgentSession& session, const kerf_agent_pose& pose,
                       kerf_agent_wrench* wrench) noexcept {
  if (!session.enter()) return fail(KERF_AGENT_BUSY, "another thread runs this agent's loop");
  const Wrench output = session.step(pose, monotonic_us());
  session.leave();
  if (!is_pose(pose)) {
    return fail(KERF_AGENT_INVALID, "the pose is not finite or its axis not of length 1");
  }
  if (session.lost()) return fail(KERF_AGENT_LOST, "the connection to the server is lost");
  write_struct(wrench_of(output), wrench);
  return KERF_AGENT_OK;
}

kerf_agent_result run(kerf_agent& agent, const kerf_agent_device* given, void* context) {
  kerf_agent_device device{};
  if (given == nullptr) return fail(KERF_AGENT_INVALID, "device is null");
  if (!read_struct(given, device) || device.abi != KERF_AGENT_ABI) {
    return fail(KERF_AGENT_UNSUPPORTED, "device: struct_size or abi of another version");
  }
  if (device.read_pose == nullptr) return fail(KERF_AGENT_INVALID, "device: read_pose is null");
  AgentSession& session = *agent.session;
  if (!session.enter()) return fail(KERF_AGENT_BUSY, "another thread runs this agent's loop");
  const auto result = guarded([&] {
    session.run(device, context, agent.realtime);
    return KERF_AGENT_OK;
  });
  session.leave();
  if (result != KERF_AGENT_OK) return result;
  if (session.lost()) return fail(KERF_AGENT_LOST, "the connection to the server is lost");
  return KERF_AGENT_OK;
}

kerf_agent_session session_info(const AgentSession& session) {
  const Welcome& welcome = session.welcome();
  const Vec3 least = welcome.stock.min_mm, most = welcome.stock.max_mm;
  return {.struct_size = sizeof(kerf_agent_session),
          .participant = welcome.participant,
          .name = welcome.session.c_str(),
          .tool_ids = welcome.tool_ids.data(),
          .tool_count = static_cast<std::uint32_t>(welcome.tool_ids.size()),
          .tool_id = session.tool(),
          .pivot_mm = welcome.pivot_mm,
          .stock_min_mm = {least.x, least.y, least.z},
          .stock_max_mm = {most.x, most.y, most.z}};
}

template <typename T>
kerf_agent_result answer(const T& from, T* to) noexcept {
  if (write_struct(from, to)) return KERF_AGENT_OK;
  return fail(KERF_AGENT_INVALID, "the structure to fill in is null or states no struct_size");
}

}  // namespace
}  // namespace kerf::agent

using namespace kerf::agent;

uint32_t kerf_agent_version(void) { return KERF_AGENT_VERSION; }

const char* kerf_agent_last_error(void) { return last_error.data(); }

const char* kerf_agent_result_text(kerf_agent_result result) {
  switch (result) {
    case KERF_AGENT_OK:
      return "no error";
    case KERF_AGENT_INVALID:
      return "an argument is null, not finite or out of range";
    case KERF_AGENT_UNREACHABLE:
      return "the server did not answer";
    case KERF_AGENT_REJECTED:
      return "the session was rejected";
    case KERF_AGENT_NO_TOOL:
      return "the session does not have this tool";
    case KERF_AGENT_LOST:
      return "the connection to the server is lost";
    case KERF_AGENT_BUSY:
      return "another thread runs this agent's loop";
    case KERF_AGENT_UNSUPPORTED:
      return "a structure or plugin of another version";
    case KERF_AGENT_DEVICE:
      return "the device reports a failure";
    case KERF_AGENT_OUT_OF_MEMORY:
      return "out of memory";
    case KERF_AGENT_INTERNAL:
      return "a fault of the library";
    default:
      return "unknown result";
  }
}

kerf_agent_result kerf_agent_connect(const kerf_agent_options* options, kerf_agent** agent) {
  return guarded([&] { return connect(options, agent); });
}

void kerf_agent_close(kerf_agent* agent, double drain_s) {
  if (agent == nullptr) return;
  guarded([&] {
    agent->session->close(std::isfinite(drain_s) ? std::clamp(drain_s, 0.0, kMaxDrainS) : 0.0);
    return KERF_AGENT_OK;
  });
  delete agent;
}

kerf_agent_result kerf_agent_get_session(kerf_agent* agent, kerf_agent_session* session) {
  const AgentSession* joined = session_of(agent);
  return joined != nullptr ? answer(session_info(*joined), session) : KERF_AGENT_INVALID;
}

kerf_agent_result kerf_agent_get_status(kerf_agent* agent, kerf_agent_status* status) {
  AgentSession* joined = session_of(agent);
  if (joined == nullptr) return KERF_AGENT_INVALID;
  return guarded([&] { return answer(joined->status(), status); });
}

kerf_agent_result kerf_agent_choose_tool(kerf_agent* agent, uint32_t tool_id) {
  AgentSession* joined = session_of(agent);
  if (joined == nullptr) return KERF_AGENT_INVALID;
  if (joined->choose_tool(tool_id)) return KERF_AGENT_OK;
  return fail(KERF_AGENT_NO_TOOL, "the session does not have this tool");
}

kerf_agent_result kerf_agent_set_mapping(kerf_agent* agent, const kerf_agent_mapping* mapping) {
  AgentSession* joined = session_of(agent);
  if (joined == nullptr) return KERF_AGENT_INVALID;
  kerf_agent_mapping known{};
  if (mapping == nullptr) return fail(KERF_AGENT_INVALID, "mapping is null");
  if (!read_struct(mapping, known)) {
    return fail(KERF_AGENT_UNSUPPORTED, "mapping: struct_size of another version");
  }
  return guarded([&] {
    const auto set = joined->set_mapping(known);
    return set ? KERF_AGENT_OK : fail(KERF_AGENT_INVALID, "mapping: " + set.error());
  });
}

kerf_agent_result kerf_agent_get_mapping(kerf_agent* agent, kerf_agent_mapping* mapping) {
  AgentSession* joined = session_of(agent);
  if (joined == nullptr) return KERF_AGENT_INVALID;
  return guarded([&] { return answer(joined->mapping(), mapping); });
}

kerf_agent_result kerf_agent_rearm(kerf_agent* agent) {
  AgentSession* joined = session_of(agent);
  if (joined == nullptr) return KERF_AGENT_INVALID;
  return guarded([&] {
    joined->rearm();
    return KERF_AGENT_OK;
  });
}

kerf_agent_result kerf_agent_undo(kerf_agent* agent) { return ask(agent, true); }

kerf_agent_result kerf_agent_redo(kerf_agent* agent) { return ask(agent, false); }

kerf_agent_result kerf_agent_step(kerf_agent* agent, const kerf_agent_pose* pose,
                                  kerf_agent_wrench* wrench) {
  AgentSession* joined = session_of(agent);
  if (joined == nullptr) return KERF_AGENT_INVALID;
  if (!write_struct(wrench_of({}), wrench)) {
    return fail(KERF_AGENT_INVALID, "wrench is null or states no struct_size");
  }
  kerf_agent_pose known{};
  if (pose == nullptr) return fail(KERF_AGENT_INVALID, "pose is null");
  if (!read_struct(pose, known)) {
    return fail(KERF_AGENT_UNSUPPORTED, "pose: struct_size of another version");
  }
  return step(*joined, known, wrench);
}

kerf_agent_result kerf_agent_run(kerf_agent* agent, const kerf_agent_device* device,
                                 void* context) {
  if (session_of(agent) == nullptr) return KERF_AGENT_INVALID;
  return guarded([&] { return run(*agent, device, context); });
}

kerf_agent_result kerf_agent_stop(kerf_agent* agent) {
  AgentSession* joined = session_of(agent);
  if (joined == nullptr) return KERF_AGENT_INVALID;
  joined->stop_running();
  return KERF_AGENT_OK;
}
