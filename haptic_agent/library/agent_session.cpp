// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/library/agent_session.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "haptic_agent/device/plugin/c_structs.h"
#include "haptic_agent/library/mapping_struct.h"
#include "haptic_agent/realtime/clock.h"
#include "haptic_agent/realtime/realtime_thread.h"
#include "haptic_agent/servo/watchdog.h"
#include "server/wire/types.h"

namespace kerf::agent {
namespace {

static_assert(static_cast<int>(ServoPhase::kReady) == KERF_AGENT_PHASE_READY);
static_assert(static_cast<int>(ServoPhase::kArmed) == KERF_AGENT_PHASE_ARMED);
static_assert(static_cast<int>(ServoPhase::kRamp) == KERF_AGENT_PHASE_RAMP);
static_assert(static_cast<int>(ServoPhase::kActive) == KERF_AGENT_PHASE_ACTIVE);
static_assert(static_cast<int>(ServoPhase::kDegraded) == KERF_AGENT_PHASE_DEGRADED);
static_assert(static_cast<int>(ServoPhase::kSafe) == KERF_AGENT_PHASE_SAFE);
static_assert(KERF_AGENT_CUT == wire::kButtonCutting && KERF_AGENT_DEADMAN == wire::kButtonDeadman);

/// The text of an enumerator: a string literal, so it is null-terminated.
template <class Enum>
const char* text_of(Enum value) noexcept {
  const std::string_view text = to_string(value);
  return text.data();
}

void set(double (&to)[3], Vec3 from) noexcept {
  to[0] = from.x;
  to[1] = from.y;
  to[2] = from.z;
}

/// The loop of kerf_agent_run: reads the device, runs the session's tick, writes the device.
class DeviceLoop final : public ServoTask {
 public:
  DeviceLoop(AgentSession& session, const kerf_agent_device& device, void* context,
             const std::atomic<bool>& stopping) noexcept
      : session_(session), device_(device), context_(context), stopping_(stopping) {}

  bool tick(std::uint64_t now_us) noexcept override {
    kerf_agent_pose pose{};
    pose.struct_size = sizeof pose;
    device_.read_pose(context_, now_us, &pose);
    const bool last = pose.state == KERF_AGENT_FINISHED || stopping_.load() || session_.lost();
    const Wrench wrench = session_.step(pose, now_us);
    write(last ? Wrench{} : wrench);
    return !last;
  }
  void write(const Wrench& wrench) const noexcept {
    if (device_.write_wrench == nullptr) return;
    const kerf_agent_wrench output = wrench_of(wrench);
    device_.write_wrench(context_, &output);
  }
  void stop() const noexcept {
    if (device_.stop != nullptr) return device_.stop(context_);
    write({});
  }

 private:
  AgentSession& session_;
  const kerf_agent_device& device_;
  void* context_;
  const std::atomic<bool>& stopping_;
};

}  // namespace

AgentSession::AgentSession(SessionOptions options)
    : options_(std::move(options)), reasons_(options_.device), device_(options_.device) {
  LinkSettings& link = options_.link;
  link.lead = &lead_;
  link.traffic.status = &link_status_;
  link.traffic.reach = &reach_;
  link.hello.reach = true;
  link.failed = [this] { lost_.store(true); };
  link.hello.stock = options_.keep_copy;
  link.traffic.copy = options_.keep_copy ? &replica_ : nullptr;
  link_ = std::make_unique<ServerLink>(link, samples_, wrenches_);
}

std::expected<std::unique_ptr<AgentSession>, SessionFailure> AgentSession::connect(
    SessionOptions options) {
  std::unique_ptr<AgentSession> session(new AgentSession(std::move(options)));
  if (auto failure = session->join()) return std::unexpected(*std::move(failure));
  return session;
}

std::optional<SessionFailure> AgentSession::join() {
  link_->start();
  auto welcome = link_->wait_welcome();
  if (!welcome) {
    return SessionFailure{link_->rejected() ? KERF_AGENT_REJECTED : KERF_AGENT_UNREACHABLE,
                          welcome.error()};
  }
  welcome_ = *std::move(welcome);
  if (welcome_.tool_ids.empty())
    return SessionFailure{KERF_AGENT_NO_TOOL, "the session has no tools"};
  const std::uint32_t wanted = options_.link.hello.tool_id;
  if (!choose_tool(wanted != 0 ? wanted : welcome_.tool_ids.front())) {
    return SessionFailure{KERF_AGENT_NO_TOOL, "the session has no tool " + std::to_string(wanted)};
  }
  lever_mm_ = std::max(1.0, welcome_.pivot_mm);
  const auto guides = guides_of(welcome_.text);
  if (!guides) return SessionFailure{KERF_AGENT_REJECTED, guides.error()};
  ReplicaExchange* replica = nullptr;
  if (options_.keep_copy) {
    auto block = BlockSource::read(welcome_.text);
    if (block) {
      replica_.start(*std::move(block));
      replica = &exchange_;
    } else {
      notice("no replica of the block: " + block.error());
      replica_.stop();
    }
  }
  const ServoSettings settings = settings_for(options_.device, {.limits = options_.limits,
                                                                .tool_id = tool(),
                                                                .model = {.law = welcome_.law},
                                                                .pivot_mm = welcome_.pivot_mm});
  if (!guides->empty()) guidance_.emplace(*guides, settings, 1.0);
  cycle_.emplace(device_, samples_, wrenches_, *link_, settings, replica,
                 guidance_ ? &*guidance_ : nullptr);
  cycle_->tell_reach(reach_);
  return std::nullopt;
}

void AgentSession::notice(const std::string& line) const {
  if (options_.link.notice) options_.link.notice(line);
}

bool AgentSession::choose_tool(std::uint32_t tool) noexcept {
  if (std::ranges::find(welcome_.tool_ids, tool) == welcome_.tool_ids.end()) return false;
  tool_.store(tool);
  return true;
}

std::expected<void, std::string> AgentSession::set_mapping(const kerf_agent_mapping& given) {
  const DeviceCapabilities& device = options_.device;
  auto request = mapping_request_of(given, {welcome_.stock.min_mm, welcome_.stock.max_mm},
                                    {device.workspace_min_mm, device.workspace_max_mm});
  if (!request) return std::unexpected(request.error());
  const std::scoped_lock lock(mapping_mutex_);
  mapping_ = *request;
  mapping_flags_ = given.flags;
  cycle_->mapping_requests().write(mapping_);
  return {};
}

kerf_agent_mapping AgentSession::mapping() {
  const std::scoped_lock lock(mapping_mutex_);
  return mapping_struct(mapping_.mapping, mapping_flags_);
}

Wrench AgentSession::step(const kerf_agent_pose& pose, std::uint64_t now_us) noexcept {
  DeviceState state = state_of(pose, options_.device.has_deadman, now_us);
  const bool repeated = last_us_ != 0 && now_us < last_us_ + kShortestUs;
  if (repeated && is_pose(pose)) return state.valid ? device_.taken() : Wrench{};
  last_us_ = now_us;
  if (state.tool_id == 0) state.tool_id = tool();
  state.finished = false;
  device_.give(state);
  cycle_->tick(now_us);
  ticks_.store(cycle_->report().samples, std::memory_order_relaxed);
  return device_.taken();
}

kerf_agent_status AgentSession::status() {
  const std::scoped_lock lock(status_mutex_);
  cycle_->status().read(servo_now_);
  link_status_.read(link_now_);
  const ServoStatus& servo = servo_now_;
  kerf_agent_status status{.struct_size = sizeof status,
                           .connected = link_->connected() ? 1U : 0U,
                           .phase = static_cast<std::uint32_t>(servo.phase),
                           .tripped = servo.phase == ServoPhase::kSafe ? 1U : 0U,
                           .phase_text = text_of(servo.phase),
                           .trip_text = text_of(servo.code),
                           .trips = servo.trips,
                           .ticks = ticks_.load(std::memory_order_relaxed),
                           .round_trip_us = link_now_.rtt_us,
                           .answer_age_us = servo.answer_age_us,
                           .felt_factor = servo.felt_share,
                           .felt_force_n = {},
                           .felt_torque_nmm = {},
                           .computed_force_n = {},
                           .computed_torque_nmm = {},
                           .energy_mj = servo.energy_mj,
                           .no_force_name = text_of(servo.no_force),
                           .no_force_text = reasons_.of(servo.no_force, servo.code).c_str()};
  set(status.felt_force_n, servo.output.force_n);
  set(status.felt_torque_nmm, servo.output.torque_nmm);
  set(status.computed_force_n, servo.computed.force_n);
  set(status.computed_torque_nmm, servo.computed.torque_nmm);
  return status;
}

void AgentSession::run(const kerf_agent_device& device, void* context, bool realtime) {
  MonotonicClock clock;
  ServoLoop loop(clock);
  DeviceLoop task(*this, device, context, stopping_);
  const MotorSwitch motors{.zero = [&task] { task.write({}); }, .stop = [&task] { task.stop(); }};
  run_watched(loop, task, motors, [&] {
    if (!realtime) return;
    const RealtimeReport report = make_realtime({});
    if (report.fifo) loop.announce(lead_);
    if (!report.warning.empty()) notice("warning: " + report.warning);
  });
  stopping_.store(false);
}

void AgentSession::close(double drain_s) {
  if (std::exchange(closed_, true)) return;
  replica_.stop();
  link_->stop(drain_s);
}

}  // namespace kerf::agent
