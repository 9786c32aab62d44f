// SPDX-License-Identifier: Apache-2.0
#include "server/socket/viewer_hub.h"

#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>

#include "server/conversation/control_json.h"
#include "server/socket/websocket.h"
#include "server/threads/run_on.h"
#include "server/wire/codec.h"

namespace kerf::net {
namespace {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;

/// Thirty visits a second: viewers interpolate poses in between, and a tile that is cut all the
/// time is meshed at most so often.
constexpr std::chrono::milliseconds kTick{33};
constexpr std::chrono::milliseconds kStateInterval{250};

}  // namespace

ViewerHub::ViewerHub(std::shared_ptr<Session> session, PeerContext& context)
    : session_(std::move(session)),
      context_(context),
      tick_(context.viewers.context()),
      side_(std::make_shared<FeedSide>()) {}
ViewerHub::~ViewerHub() = default;

void ViewerHub::add(ParticipantId id, ViewerSink* sink) {
  viewers_[id].sink = sink;
  next_job_.joined.push_back(id);
  if (running_) return pump();
  running_ = true;
  watch();
  auto loop = [self = shared_from_this()] { return self->run(); };
  asio::co_spawn(context_.viewers.context(), std::move(loop), asio::detached);
}

void ViewerHub::remove(ParticipantId id) {
  if (viewers_.erase(id) == 0) return;
  next_job_.left.push_back(id);
  if (viewers_.empty()) {
    tick_.cancel();  // nobody looks any more: the loop ends now
  } else {
    pump();
  }
}

void ViewerHub::acked(ParticipantId id, std::uint64_t sequence) {
  next_job_.acks.emplace_back(id, sequence);
  pump();
}

void ViewerHub::looks(ParticipantId id, const ViewerLook& look) {
  next_job_.looks[id] = look;
  pump();
}

void ViewerHub::watch() {
  if (std::exchange(watching_, true)) return;
  IoThreads& thread = threads_of(*session_);
  std::weak_ptr<ViewerHub> weak = weak_from_this();
  auto& viewers = context_.viewers;
  thread.post([session = session_, weak, &viewers] {
    // The listener outlives the hub harmlessly: it holds no hub and ends with the session.
    auto listener = std::make_shared<int>(0);
    *listener = session->listen(
        [session = session.get(), weak, &viewers, listener](const SessionEvent& event) {
          if (weak.expired()) return session->unlisten(*listener);
          viewers.post([weak, event, people = session->participants()]() mutable {
            if (const auto hub = weak.lock()) hub->on_event(event, std::move(people));
          });
        });
    // What happened between the viewer's welcome and now was told to nobody here.
    viewers.post([weak, people = session->participants()]() mutable {
      if (const auto hub = weak.lock()) hub->on_event({}, std::move(people));
    });
  });
}

void ViewerHub::on_event(const SessionEvent& event, std::vector<Participant> participants) {
  const auto viewers = viewers_;  // a sink that ends removes itself
  const std::string text = event.closing.empty() ? participants_message(participants) : "";
  for (const auto& [id, viewer] : viewers) {
    if (event.closing.empty()) {
      viewer.sink->send_control(text);
    } else {
      viewer.sink->end(event.closing);
    }
  }
}

asio::awaitable<void> ViewerHub::run() {
  const auto self = shared_from_this();
  bool first = side_->feed == nullptr;
  while (!viewers_.empty()) {
    auto look = [session = session_, first] { return session->frame(first); };
    SessionFrame frame = co_await run_on(threads_of(*session_), std::move(look));
    first = false;
    take(std::move(frame));
    pump();
    tick_.expires_after(kTick);
    boost::system::error_code ignored;
    co_await tick_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
  }
  running_ = false;
}

void ViewerHub::take(SessionFrame frame) {
  if (frame.snapshot) {
    if (!side_->feed) {
      side_->feed = std::make_unique<TileFeed>(*frame.snapshot, frame.changed_sequence);
    } else {
      side_->feed->note_change(*frame.snapshot, frame.changed, frame.changed_sequence);
    }
    frame.snapshot
        .reset();  // the feed has it; holding it here would make the kernel copy more tiles
  }
  newest_ = std::move(frame);
  has_newest_ = true;
  std::vector<std::byte> body(wire::encoded_bytes(newest_.tools));
  wire::encode({session_->epoch(), 0, 0}, newest_.tools, body);
  if (body != last_tools_) {
    last_tools_ = body;
    wire::encode({session_->epoch(), ++tools_sent_, clock_us()}, newest_.tools, body);
    tools_ = std::make_shared<const std::vector<std::byte>>(std::move(body));
    for (auto& [id, viewer] : viewers_) viewer.sink->send_tools(tools_);
  }
  tell_states();
}

void ViewerHub::tell_states() {
  if (!has_newest_ || !newest_.hash) return;
  const auto now = Clock::now();
  for (auto& [id, viewer] : viewers_) {
    const bool settled =
        newest_.hash_is_current && viewer.shown_sequence >= newest_.changed_sequence;
    const bool news = viewer.told_sequence != newest_.sequence ||
                      viewer.told_hash != newest_.hash->hash || viewer.told_settled != settled;
    if (!news || (!settled && now - viewer.told_at < kStateInterval)) continue;
    viewer.told_sequence = newest_.sequence;
    viewer.told_hash = newest_.hash->hash;
    viewer.told_settled = settled;
    viewer.told_at = now;
    viewer.sink->send_state(
        state_message(newest_.motions, newest_.removed_mm3, newest_.hash->hash, settled));
  }
}

void ViewerHub::pump() {
  if (pumping_) {
    again_ = true;
    return;
  }
  if (!side_->feed) return;  // the first visit to the session is under way
  pumping_ = true;
  context_.meshing.post(
      [self = shared_from_this(), side = side_, job = std::exchange(next_job_, {})] {
        auto result = work(*side, job);
        auto& viewers = self->context_.viewers;
        viewers.post(
            [self, result = std::move(result)]() mutable { self->deliver(std::move(result)); });
      });
}

ViewerHub::JobResult ViewerHub::work(FeedSide& side, const Job& job) {
  JobResult result;
  for (const ParticipantId id : job.joined) side.ids[id] = side.feed->add_viewer();
  for (const ParticipantId id : job.left) {
    const auto found = side.ids.find(id);
    if (found == side.ids.end()) continue;
    side.feed->remove_viewer(found->second);
    side.ids.erase(found);
  }
  for (const auto& [id, sequence] : job.acks) {
    const auto found = side.ids.find(id);
    if (found != side.ids.end() && !side.feed->ack(found->second, sequence)) {
      result.bad_acks.push_back(id);
    }
  }
  for (const auto& [id, look] : job.looks) {
    const auto found = side.ids.find(id);
    if (found != side.ids.end()) side.feed->look(found->second, look);
  }
  for (const auto& [id, viewer] : side.ids) {
    while (auto frame = side.feed->next_frame(viewer)) result.frames.emplace_back(id, *frame);
    const auto state = side.feed->viewer_state(viewer);
    if (state && state->sent) result.shown.emplace_back(id, state->revision);
  }
  const auto stats = side.feed->stats();
  result.tiles = stats.tiles_meshed - side.counted.tiles_meshed;
  result.bytes = stats.bytes_composed - side.counted.bytes_composed;
  side.counted = stats;
  return result;
}

void ViewerHub::deliver(JobResult result) {
  pumping_ = false;
  context_.metrics.mesh_made(result.tiles, result.bytes);
  const auto find = [&](ParticipantId id) {
    const auto found = viewers_.find(id);
    return found == viewers_.end() ? nullptr : &found->second;
  };
  for (auto& [id, frame] : result.frames) {
    if (auto* viewer = find(id)) viewer->sink->send_mesh(std::move(frame));
  }
  for (const auto& [id, sequence] : result.shown) {
    auto* viewer = find(id);
    if (viewer != nullptr) viewer->shown_sequence = std::max(viewer->shown_sequence, sequence);
  }
  for (const ParticipantId id : result.bad_acks) {
    if (auto* viewer = find(id)) viewer->sink->bad_ack();
  }
  tell_states();
  if (std::exchange(again_, false)) pump();
}

std::shared_ptr<ViewerHub> HubDirectory::get(const std::shared_ptr<Session>& session,
                                             PeerContext& context) {
  std::erase_if(hubs_, [](const auto& entry) { return entry.second.expired(); });
  auto& slot = hubs_[session->id()];
  auto hub = slot.lock();
  // A session of the same name may have been closed and created anew.
  if (!hub || hub->session() != session) {
    hub = std::make_shared<ViewerHub>(session, context);
    slot = hub;
  }
  return hub;
}

}  // namespace kerf::net
