// SPDX-License-Identifier: Apache-2.0
#include "server/socket/viewer_hub.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <utility>

#include "server/threads/run_and_wait.h"
#include "server/threads/run_on.h"
#include "server/wire/codec.h"

namespace kerf::net {

namespace asio = boost::asio;

ViewerHub::ViewerHub(std::shared_ptr<Session> session, PeerContext& context)
    : session_(std::move(session)),
      context_(context),
      tick_(context.viewers.context()),
      side_(std::make_shared<FeedSide>()) {}
ViewerHub::~ViewerHub() = default;

void ViewerHub::add(ParticipantId id, ViewerConversation* viewer, const FirstLook& first) {
  viewers_[id].conversation = viewer;
  if (first.follows) {
    viewers_[id].look_due = Clock::now() + kLookWait;
  } else {
    viewers_[id].look = first.look;
    join_feed(id, first.look);
  }
  if (running_) return start_job();
  running_ = true;
  next_reading_ = {};
  listen();
  auto loop = [self = shared_from_this()] { return self->run(); };
  asio::co_spawn(context_.viewers.context(), std::move(loop), asio::detached);
}

void ViewerHub::remove(ParticipantId id) {
  const Viewer* viewer = find(id);
  if (viewer == nullptr) return;
  if (viewer->past) viewer->past->end();
  viewers_.erase(id);
  if (shown_.erase(id) > 0) cameras_are_new_ = true;
  leave_feed(id);
  if (viewers_.empty()) {
    tick_.cancel();  // the loop ends now
    return;
  }
  // When the server ends, the meshing thread ends before the last connections.
  if (!context_.viewers.context().stopped()) start_job();
}

void ViewerHub::join_feed(ParticipantId id, const std::optional<ViewerLook>& look) {
  Viewer& viewer = viewers_[id];
  const TileNodes nodes = viewer.conversation->first_look().nodes;
  next_job_.joined.push_back({id, ++viewer.stay, look, nodes, viewer.conversation->budget()});
}

void ViewerHub::leave_feed(ParticipantId id) {
  std::erase_if(next_job_.joined, [&](const Job::Joined& joined) { return joined.id == id; });
  std::erase_if(next_job_.acks, [&](const auto& ack) { return ack.first == id; });
  next_job_.looks.erase(id);
  next_job_.budgets.erase(id);
  next_job_.left.push_back(id);
}

void ViewerHub::acknowledge(ParticipantId id, std::uint64_t sequence) {
  const Viewer* viewer = find(id);
  if (viewer != nullptr && viewer->is_past()) return viewer->past->acknowledge(sequence);
  next_job_.acks.emplace_back(id, sequence);
  // Unless the viewer has everything, a pending frame may leave now.
  const bool has_all = viewer != nullptr && viewer->sent && *viewer->sent >= revision_;
  if (!has_all) start_job();
}

void ViewerHub::look(ParticipantId id, const ViewerLook& look) {
  Viewer* viewer = find(id);
  if (viewer != nullptr) viewer->look = look;
  if (viewer != nullptr && viewer->past) viewer->past->look(look);
  if (viewer != nullptr && viewer->is_past()) return;
  if (viewer != nullptr) viewer->sent.reset();  // finer tiles may be due
  if (viewer != nullptr && std::exchange(viewer->look_due, std::nullopt)) {
    join_feed(id, look);
  } else {
    next_job_.looks[id] = look;
  }
  start_job();
}

void ViewerHub::set_budget(ParticipantId id, std::uint32_t bytes_per_s) {
  const Viewer* viewer = find(id);
  if (viewer == nullptr) return;
  if (viewer->past) viewer->past->set_budget(bytes_per_s);
  if (viewer->is_past()) return;
  next_job_.budgets[id] = bytes_per_s;
  start_job();
}

void ViewerHub::seek(ParticipantId id, const SeekMessage& seek) {
  Viewer* viewer = find(id);
  if (viewer == nullptr) return;
  if (seek.is_live) return show_present(id, *viewer);
  if (!viewer->past && !seek.record) {
    return viewer->conversation->reject_request(
        {wire::ErrorCode::kBadMessage, "field \"at\" is missing: the viewer is live"});
  }
  show_past(id, *viewer, seek);
}

void ViewerHub::show_past(ParticipantId id, Viewer& viewer, const SeekMessage& seek) {
  if (!viewer.past) {
    const auto others = std::ranges::count_if(
        viewers_, [](const auto& other) { return other.second.past != nullptr; });
    if (static_cast<std::size_t>(others) >= kPastViewersMax) {
      return viewer.conversation->reject_request(
          {wire::ErrorCode::kBusy, "other viewers look at the past; at most " +
                                       std::to_string(kPastViewersMax) + " of a session do"});
    }
    auto on_first = [this, id](bool reached) { leave_present(id, reached); };
    viewer.past = std::make_shared<PastViewer>(session_, viewer.conversation, context_, viewer.look,
                                               std::move(on_first));
  }
  viewer.past->seek(seek);
}

/// The first seek of a viewer has been completed, or has failed.
void ViewerHub::leave_present(ParticipantId id, bool reached) {
  Viewer* viewer = find(id);
  if (!reached) {
    viewer->past->end();
    return viewer->past.reset();
  }
  leave_feed(id);
  viewer->look_due.reset();
  viewer->conversation->begin_again(roster_);
  viewer->has_programs = viewer->has_cameras = false;
  viewer->matters_sent.clear();
  start_job();
}

void ViewerHub::show_present(ParticipantId id, Viewer& viewer) {
  if (!viewer.past) return;
  const bool was_shown = viewer.past->is_shown();
  viewer.past->end();
  viewer.past.reset();
  if (!was_shown) return;
  viewer.conversation->begin_again(roster_);
  viewer.sent.reset();
  viewer.has_tools = viewer.has_programs = viewer.has_cameras = false;
  viewer.matters_sent.clear();
  last_tools_.clear();  // its tools are sent again
  join_feed(id, viewer.look);
  start_job();
}

void ViewerHub::listen() {
  if (std::exchange(listening_, true)) return;
  std::weak_ptr<ViewerHub> weak = weak_from_this();
  auto& viewers = context_.viewers;
  threads_of(*session_).post([session = session_, weak, &viewers] {
    // The listener may outlive the hub, so it does not own it, and ends with the session.
    auto listener = std::make_shared<int>(0);
    *listener = session->listen(
        [session = session.get(), weak, &viewers, listener](const SessionEvent& event) {
          if (weak.expired()) return session->unlisten(*listener);
          viewers.post([weak, event, roster = session->roster()]() mutable {
            if (const auto hub = weak.lock()) hub->on_event(event, std::move(roster));
          });
        });
    // Covers the events between the viewer's welcome and now.
    viewers.post([weak, roster = session->roster()]() mutable {
      if (const auto hub = weak.lock()) hub->on_event({}, std::move(roster));
    });
  });
}

asio::awaitable<void> ViewerHub::run() {
  const auto self = shared_from_this();
  while (!viewers_.empty()) {
    const auto now = Clock::now();
    if (now >= next_reading_) {
      const auto period = is_crowd() ? kCrowdTick : kTick;
      next_reading_ = std::max(next_reading_ + period, now + period / 2);
      start_overdue_snapshots();
      for (auto& [id, viewer] : viewers_) {
        if (viewer.past) viewer.past->tick();
      }
      if (has_waiting_) next_job_.is_for_waiting = true;
      read_session();
      if (!next_job_.empty()) start_job();
    }
    tick_.expires_at(next_reading_);
    boost::system::error_code ignored;
    co_await tick_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
  }
  running_ = false;
}

/// Reads the session and has the changed surface meshed. While a job runs, a crowd's reading waits
/// once for its end, so that its data is newer when meshed, and poses leave with it.
void ViewerHub::read_session() {
  if (is_reading_ || (job_runs_ && !has_feed_)) return;
  if (job_runs_ && is_crowd() && !reads_after_job_) {
    reads_after_job_ = true;
    return;
  }
  reads_after_job_ = false;
  is_reading_ = true;
  const bool with_job = !std::exchange(job_runs_, true);
  Job job;
  if (with_job) std::swap(job, next_job_);
  auto read = [self = shared_from_this(), first = !has_feed_, with_job,
               job = std::move(job)]() mutable {
    SessionFrame frame = self->session_->frame(first);
    const bool has_surface = frame.snapshot.has_value();
    if (has_surface) {
      // The feed holds the snapshot. A second reference would make the kernel copy more tiles.
      SolidSnapshot snapshot = *std::exchange(frame.snapshot, std::nullopt);
      if (first) {
        job.first = {std::move(snapshot), frame.motions};
      } else {
        // On the session's thread, which keeps changes in order even if a job starts after the next
        // reading.
        self->side_->feed->note_change(std::move(snapshot), frame.changed, frame.motions);
        job.is_for_all = with_job;
      }
    }
    const bool is_idle = with_job && job.empty();
    const bool needs_job = has_surface && !with_job;
    self->context_.viewers.post(
        [self, frame = std::move(frame), has_surface, needs_job, is_idle]() mutable {
          if (is_idle) self->job_runs_ = false;
          if (needs_job) self->next_job_.is_for_all = true;
          self->take_frame(std::move(frame), has_surface);
        });
    if (with_job && !is_idle) self->mesh(std::move(job));
  };
  threads_of(*session_).post(std::move(read));
}

/// `has_surface`: the block has changed, and the feed has the change or a job creates it.
void ViewerHub::take_frame(SessionFrame frame, bool has_surface) {
  is_reading_ = false;
  if (has_surface) revision_ = frame.motions;
  take_lists(frame);
  newest_ = std::move(frame);
  has_newest_ = true;
  // The previous poses have waited for tiles long enough.
  send_tools();
  encode_tools();
  if (!is_crowd() || !has_surface) send_tools();
  send_lists();
  send_states();
  if (!next_job_.empty()) start_job();
}

void ViewerHub::start_overdue_snapshots() {
  const auto now = Clock::now();
  for (auto& [id, viewer] : viewers_) {
    if (!viewer.look_due || now < *viewer.look_due) continue;
    viewer.look_due.reset();
    join_feed(id, std::nullopt);
  }
}

void ViewerHub::encode_tools() {
  std::vector<std::byte> bytes(wire::encoded_bytes(newest_.tools));
  wire::encode({session_->epoch(), 0, 0}, newest_.tools, bytes);
  if (bytes == last_tools_) return;
  last_tools_ = bytes;
  const wire::FrameStamp stamp{session_->epoch(), ++tools_sent_, to_us(Clock::now())};
  wire::encode(stamp, newest_.tools, bytes);
  tools_ = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
}

void ViewerHub::send_tools() {
  const SharedBytes tools = std::exchange(tools_, nullptr);
  if (!tools) return;
  for (auto& [id, viewer] : viewers_) {
    if (viewer.is_past()) continue;
    if (!std::exchange(viewer.has_tools, false)) viewer.conversation->send_tools(tools);
  }
}

void ViewerHub::send_states() {
  if (!has_newest_ || !newest_.hash) return;
  SurfaceState state{newest_.sequence, newest_.motions, newest_.removed_mm3, newest_.hash->hash};
  state.paused = newest_.paused;
  for (auto& [id, viewer] : viewers_) {
    if (viewer.is_past()) continue;
    state.settled = newest_.hash_is_current && viewer.sent && *viewer.sent >= revision_;
    viewer.conversation->send_state(state);
  }
}

ViewerHub::Viewer* ViewerHub::find(ParticipantId id) {
  const auto found = viewers_.find(id);
  return found == viewers_.end() ? nullptr : &found->second;
}

void ViewerHub::finish_reading() {
  if (is_reading_) run_and_wait(threads_of(*session_), [] { return true; });
}

void HubDirectory::finish_reading() {
  for (const auto& [id, weak] : hubs_) {
    if (const auto hub = weak.lock()) hub->finish_reading();
  }
}

std::shared_ptr<ViewerHub> HubDirectory::get(const std::shared_ptr<Session>& session,
                                             PeerContext& context) {
  std::erase_if(hubs_, [](const auto& entry) { return entry.second.expired(); });
  auto& slot = hubs_[session->id()];
  auto hub = slot.lock();
  // A session of the same id may have been closed and created again.
  if (!hub || hub->session() != session) {
    hub = std::make_shared<ViewerHub>(session, context);
    slot = hub;
  }
  return hub;
}

}  // namespace kerf::net
