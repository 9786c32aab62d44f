// SPDX-License-Identifier: Apache-2.0
#include "server/session/session.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <ranges>
#include <utility>

#include "server/convert/sample_pose.h"

namespace kerf {
namespace {

/// What tools look like unless their owners choose: eight hues that stay apart for colour-blind
/// eyes.
constexpr std::array<const char*, 8> kColors = {"#d9541e", "#0072b2", "#009e73", "#cc79a7",
                                                "#e69f00", "#56b4e9", "#8c6d31", "#6f4fa0"};
/// A tool whose owner sends nothing is shown without force after this time.
constexpr std::chrono::milliseconds kForceShown{150};
/// Shortest time between two state hashes, and how many times their cost at least.
constexpr std::chrono::microseconds kHashInterval{500'000};
constexpr int kHashCostShare = 20;

bool is_color(const std::string& text) {
  return text.size() == 7 && text.front() == '#' &&
         std::all_of(text.begin() + 1, text.end(),
                     [](unsigned char c) { return std::isxdigit(c) != 0; });
}

Rejection journal_rejection(const JournalError& error) {
  return {wire::ErrorCode::kBusy, "the journal takes no more: " + error.reason};
}

}  // namespace

Session::Session(std::string id, Replayed replayed, JournalWriter journal, SessionLimits limits,
                 std::shared_ptr<Executor> executor, Executor& workers)
    : executor_(std::move(executor)),
      id_(std::move(id)),
      scene_(std::move(replayed.scene)),
      sculpture_(std::move(replayed.sculpture)),
      journal_(std::move(journal)),
      limits_(limits),
      workers_(workers),
      last_participant_(replayed.last_participant),
      changed_sequence_(replayed.last_sequence),
      hash_(replayed.hash) {}

std::expected<Participant, Rejection> Session::join(const JoinRequest& request) {
  using enum wire::ErrorCode;
  if (closed_) return std::unexpected(Rejection{kUnknownSession, "the session is closed"});
  const auto count = static_cast<std::size_t>(std::ranges::count_if(
      seats_ | std::views::values, [&](auto& seat) { return seat.who.kind == request.kind; }));
  const std::size_t most = request.kind == ParticipantKind::kViewer  ? limits_.viewers_max
                           : request.kind == ParticipantKind::kAgent ? limits_.agents_max
                                                                     : limits_.programs_max;
  if (count >= most) {
    return std::unexpected(Rejection{
        kBusy, std::string("the session has as many participants of kind ") +
                   to_string(request.kind) + " as it admits (" + std::to_string(most) + ")"});
  }
  if (request.name.size() > wire::kMaxNameBytes) {
    return std::unexpected(Rejection{
        kTooLarge, "name is longer than " + std::to_string(wire::kMaxNameBytes) + " bytes"});
  }
  if (!request.color.empty() && !is_color(request.color)) {
    return std::unexpected(Rejection{kBadMessage, "color is not of the form #rrggbb"});
  }
  Seat seat;
  seat.who = {++last_participant_, request.kind, request.name, request.color, 0};
  if (request.kind != ParticipantKind::kViewer) {
    seat.who.tool = request.tool != 0 ? request.tool : scene_.tools.begin()->first;
    if (sculpture_.tool(seat.who.tool) == nullptr) {
      return std::unexpected(
          Rejection{kUnknownTool, "the session has no tool " + std::to_string(seat.who.tool)});
    }
  }
  if (seat.who.name.empty()) {
    seat.who.name = std::string(to_string(request.kind)) + " " + std::to_string(seat.who.id);
  }
  if (seat.who.color.empty()) seat.who.color = kColors[(seat.who.id - 1) % kColors.size()];
  seat.feel = request.feel;
  seat.feel_of = request.feel_of;
  if (request.stock) seat.stock.emplace();
  seat.samples = RateLimit(limits_.samples_per_s, limits_.samples_burst);
  // Viewers come and go and leave no trace in the block: the journal names only those who may
  // carve.
  if (request.kind != ParticipantKind::kViewer) {
    journal_.append(
        JournalPerson{seat.who.id, seat.who.name, seat.who.color, to_string(request.kind)});
  }
  const Participant who = seats_.emplace(seat.who.id, std::move(seat)).first->second.who;
  tell({});
  return who;
}

void Session::leave(ParticipantId id) {
  if (seats_.erase(id) > 0) tell({});
}

std::expected<void, Rejection> Session::choose_tool(ParticipantId id, ToolId tool) {
  const auto seat = seats_.find(id);
  if (seat == seats_.end() || sculpture_.tool(tool) == nullptr) {
    return std::unexpected(Rejection{wire::ErrorCode::kUnknownTool,
                                     "the session has no tool " + std::to_string(tool)});
  }
  if (seat->second.who.tool == tool) return {};
  seat->second.who.tool = tool;
  seat->second.track.lift();  // the new tool starts where its next sample puts it
  tell({});
  return {};
}

std::expected<MotionResult, Rejection> Session::carve(ParticipantId who, const MoveTool& move) {
  if (closed_)
    return std::unexpected(Rejection{wire::ErrorCode::kUnknownSession, "the session is closed"});
  const Command command = move;
  if (auto ok = sculpture_.check(command); !ok) return std::unexpected(to_rejection(ok.error()));
  if (auto ok = journal_.append(who, command); !ok)
    return std::unexpected(journal_rejection(ok.error()));
  auto result = sculpture_.apply(command);
  if (!result) return std::unexpected(to_rejection(result.error()));
  motions_applied_.fetch_add(1, std::memory_order_relaxed);
  changed_.insert(result->changed_tiles.begin(), result->changed_tiles.end());
  for (auto& [id, seat] : seats_) {
    if (id != who && seat.stock) seat.stock->note_cut(result->cut_tiles);
  }
  // Rays along X and Y may lose something where those along Z, which viewers see, do not.
  if (result->removed_mm3 > 0) {
    changed_sequence_ = sequence();
    hash_soon();
  }
  return *std::move(result);
}

std::optional<Rejection> Session::take_sample(Seat& seat, const wire::MotionSample& sample,
                                              BatchSum& sum) {
  if (sample.agent_sequence <= seat.last_sequence) return std::nullopt;  // a repetition
  seat.last_sequence = sample.agent_sequence;
  seat.newest_us = sample.time_us;
  const auto name = [&] { return "sample " + std::to_string(sample.agent_sequence) + ": "; };
  if (!seat.samples.allow(Clock::now())) {
    seat.track.lift();  // what was rejected leaves a gap: a chord across it would gouge the block
    return Rejection{wire::ErrorCode::kTooFast,
                     name() + "more samples per second than the session admits"};
  }
  auto step = seat.track.take(sample, sculpture_, limits_.speed_mm_per_s);
  if (!step) return step.error();
  seat.state.tool_id = sample.tool_id;
  if (const auto* touch = std::get_if<ToolTrack::Touch>(&*step); touch != nullptr && seat.feel) {
    add_touch(sum, sculpture_, *touch);
  }
  if (auto* move = std::get_if<MoveTool>(&*step)) {
    move->feel = seat.feel;
    const auto result = carve(seat.who.id, *move);
    if (!result) return Rejection{result.error().code, name() + result.error().reason};
    add_motion(sum, sculpture_, *move, *result);
  }
  return std::nullopt;
}

MotionAnswer Session::move(ParticipantId id, std::span<const wire::MotionSample> samples) {
  MotionAnswer answer;
  const auto found = seats_.find(id);
  if (found == seats_.end() || closed_) {
    answer.rejections.push_back(
        {wire::ErrorCode::kUnknownSession, "not a participant of the session"});
    return answer;
  }
  Seat& seat = found->second;
  BatchSum sum;
  for (const wire::MotionSample& sample : samples) {
    if (auto rejection = take_sample(seat, sample, sum)) answer.rejections.push_back(*rejection);
  }
  // Whoever keeps a copy has cut there what was rejected here.
  if (!answer.rejections.empty() && seat.stock) {
    seat.stock->restart();
  }
  wire::Result& result = answer.result;
  result.agent_sequence = seat.last_sequence;
  result.agent_time_us = samples.empty() ? seat.track.time_us() : samples.back().time_us;
  result.motions_applied = sculpture_.motions();
  sum.write(result);
  if (!answer.rejections.empty()) result.status |= wire::kStatusRejected;
  show(seat, result, sum);
  answer.felt = felt_by(seat);
  return answer;
}

std::optional<wire::ToolState> Session::felt_by(const Seat& seat) const {
  const auto other = seats_.find(seat.feel_of);
  if (other == seats_.end() || other->second.who.id == seat.who.id) return std::nullopt;
  wire::ToolState state = other->second.state;
  if (!other->second.track.pose() || Clock::now() - other->second.state_at > kForceShown) {
    state.force_n = state.torque_nmm = {};
  }
  return state;
}

void Session::show(Seat& seat, const wire::Result& result, const BatchSum& sum) {
  if (const auto& pose = seat.track.pose()) {
    seat.state.tip_mm = pose->tip_mm;
    seat.state.axis = Vec3f(pose->axis);
  }
  seat.state.participant = seat.who.id;
  seat.state.status = result.status;
  seat.state.force_n = result.force_n;
  seat.state.torque_nmm = result.torque_nmm;
  seat.state.removed_rate_mm3_per_s =
      sum.duration_s() > 0 ? static_cast<float>(sum.removed_mm3() / sum.duration_s()) : 0.0F;
  seat.state_at = Clock::now();
}

SessionFrame Session::frame(bool with_snapshot) {
  SessionFrame frame;
  frame.sequence = sequence();
  frame.motions = sculpture_.motions();
  frame.removed_mm3 = sculpture_.removed_volume_mm3();
  frame.changed_sequence = changed_sequence_;
  frame.hash = hash_;
  frame.hash_is_current = current_hash().has_value();
  const auto now = Clock::now();
  for (const auto& seat : seats_ | std::views::values) {
    if (!seat.track.pose() || frame.tools.tools.size() == wire::kMaxToolStates) continue;
    wire::ToolState state = seat.state;
    if (now - seat.state_at > kForceShown) {
      state.status = 0;
      state.force_n = state.torque_nmm = {};
      state.removed_rate_mm3_per_s = 0;
    }
    frame.tools.tools.push_back(state);
  }
  frame.changed.assign(changed_.begin(), changed_.end());
  if (!changed_.empty() || with_snapshot) frame.snapshot = sculpture_.solid();
  changed_.clear();
  return frame;
}

SessionInfo Session::info() const {
  SessionInfo info;
  info.id = id_;
  info.sequence = journal_.last_sequence();
  info.motions = sculpture_.motions();
  info.sub_motions = sculpture_.sub_motions();
  info.stock_mm3 = sculpture_.stock_volume_mm3();
  info.removed_mm3 = sculpture_.removed_volume_mm3();
  info.journal_lag = journal_.lag();
  info.epoch = journal_.epoch();
  info.participants = participants();
  return info;
}

std::vector<Participant> Session::participants() const {
  std::vector<Participant> list;
  for (const auto& seat : seats_ | std::views::values) list.push_back(seat.who);
  return list;
}

void Session::hash_soon() {
  if (hash_scheduled_) return;
  hash_scheduled_ = true;
  const auto delay = std::max(kHashInterval, kHashCostShare * hash_cost_);
  executor_->post_after(delay, [weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->start_hash();
  });
}

void Session::start_hash() {
  hash_scheduled_ = false;
  if (closed_ || current_hash()) return;
  workers_.post([self = shared_from_this(), solid = sculpture_.solid(), at = sequence()] {
    const auto start = Clock::now();
    const std::uint64_t hash = solid.hash();
    const auto cost = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start);
    self->executor_->post([self, at, hash, cost] {
      self->hash_cost_ = cost;
      self->note_hash({at, hash});
    });
  });
}

std::optional<StateHash> Session::current_hash() const {
  // Records after the last one that took anything away left the solid as it was.
  if (!hash_ || hash_->sequence < changed_sequence_) return std::nullopt;
  return StateHash{sequence(), hash_->hash};
}

void Session::note_hash(StateHash state) {
  if (hash_ && hash_->sequence >= state.sequence) return;
  hash_ = state;
  if (!closed_) journal_.append(state);
}

int Session::listen(SessionListener listener) {
  listeners_.emplace(++last_listener_, std::move(listener));
  return last_listener_;
}
void Session::unlisten(int listener) { listeners_.erase(listener); }

void Session::tell(const SessionEvent& event) {
  // A listener may unlisten itself or another one while it is called.
  const std::map<int, SessionListener> listeners = listeners_;
  for (const auto& [id, listener] : listeners) {
    if (listeners_.contains(id)) listener(event);
  }
}

void Session::close(const std::string& reason) {
  if (closed_) return;
  programs_.cancel_all();
  closed_ = true;
  tell({reason.empty() ? "the session is closed" : reason});
  listeners_.clear();
}

}  // namespace kerf
