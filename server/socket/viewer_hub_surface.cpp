// SPDX-License-Identifier: Apache-2.0
// The part of ViewerHub that has the surface meshed and sends it.
#include <utility>

#include "server/metrics/metrics.h"
#include "server/socket/viewer_hub.h"

namespace kerf::net {

void ViewerHub::start_job() {
  if (job_runs_) {
    job_is_due_ = true;
    return;
  }
  if (!has_feed_) return;  // the session has not been read yet
  job_runs_ = true;
  mesh(std::exchange(next_job_, {}));
}

/// On the viewers' or the session's thread.
void ViewerHub::mesh(Job job) {
  context_.meshing.post([self = shared_from_this(), side = side_, job = std::move(job)]() mutable {
    auto result = run_job(*side, job);
    auto& viewers = self->context_.viewers;
    viewers.post(
        [self, result = std::move(result)]() mutable { self->deliver(std::move(result)); });
  });
}

ViewerHub::JobResult ViewerHub::run_job(FeedSide& side, Job& job) {
  JobResult result;
  if (job.first) {
    auto [snapshot, revision] = *std::exchange(job.first, std::nullopt);
    side.feed = std::make_unique<TileFeed>(std::move(snapshot), revision);
    job.is_for_all = true;
  }
  // Otherwise, on a busy machine, the block would change during the job, each viewer would get its
  // own frames, and the job would take even longer.
  const TileFeed::Round round(*side.feed);
  for (const ParticipantId id : job.left) {
    const auto found = side.ids.find(id);
    if (found == side.ids.end()) continue;
    side.feed->remove_viewer(found->second.id);
    side.ids.erase(found);
    side.waiting.erase(id);
  }
  for (const auto& [id, stay, look, nodes, budget] : job.joined) {
    side.ids[id] = {side.feed->add_viewer(look, nodes, budget), stay};
  }
  for (const auto& [id, sequence] : job.acks) {
    const auto found = side.ids.find(id);
    if (found != side.ids.end() && !side.feed->ack(found->second.id, sequence)) {
      result.bad_acks.push_back(id);
    }
  }
  for (const auto& [id, look] : job.looks) {
    const auto found = side.ids.find(id);
    if (found != side.ids.end()) side.feed->look(found->second.id, look);
  }
  for (const auto& [id, budget] : job.budgets) {
    const auto found = side.ids.find(id);
    if (found != side.ids.end()) side.feed->set_budget(found->second.id, budget);
  }
  if (job.is_for_all) {
    for (const auto& [id, viewer] : side.ids) serve(side, id, result);
  } else {
    for (const auto& joined : job.joined) serve(side, joined.id, result);
    for (const auto& [id, sequence] : job.acks) serve(side, id, result);
    for (const auto& [id, look] : job.looks) serve(side, id, result);
    for (const auto& [id, budget] : job.budgets) serve(side, id, result);
    if (job.is_for_waiting) {
      for (const ParticipantId id : std::set(side.waiting)) serve(side, id, result);
    }
  }
  const auto stats = side.feed->stats();
  result.tiles = stats.tiles_meshed - side.counted.tiles_meshed;
  result.bytes = stats.bytes_composed - side.counted.bytes_composed;
  side.counted = stats;
  result.has_waiting = !side.waiting.empty();
  return result;
}

/// Adds the frames that a viewer may be sent.
void ViewerHub::serve(FeedSide& side, ParticipantId id, JobResult& result) {
  const auto found = side.ids.find(id);
  if (found == side.ids.end()) return;
  const auto [viewer, stay] = found->second;
  const auto now = Clock::now();
  while (auto frame = side.feed->next_frame(viewer, now)) {
    result.frames.push_back({id, stay, *frame});
  }
  const auto state = side.feed->viewer_state(viewer);
  if (state && state->waits_for_budget) {
    side.waiting.insert(id);
  } else {
    side.waiting.erase(id);
  }
  if (state && state->sent) result.sent.push_back({id, stay, state->revision});
}

void ViewerHub::deliver(JobResult result) {
  job_runs_ = false;
  has_feed_ = true;
  has_waiting_ = result.has_waiting;
  context_.metrics.mesh_made(result.tiles, result.bytes);
  if (reads_after_job_) {
    next_reading_ = Clock::now() + kCrowdTick;
    read_session();  // and has it meshed while these frames leave
  }
  // Poses leave before tiles, and in one piece with them if a viewer gets both.
  ParticipantId previous = 0;
  for (auto& [id, stay, frame] : result.frames) {
    const bool is_first = std::exchange(previous, id) != id;
    Viewer* viewer = find(id);
    if (viewer == nullptr || viewer->is_past() || viewer->stay != stay) continue;
    viewer->conversation->send_mesh(std::move(frame), is_first ? tools_ : nullptr);
    viewer->has_tools = viewer->has_tools || tools_;
  }
  send_tools();
  for (const auto& [id, stay, revision] : result.sent) {
    Viewer* viewer = find(id);
    if (viewer != nullptr && viewer->stay == stay) viewer->sent = revision;
  }
  for (const ParticipantId id : result.bad_acks) {
    Viewer* viewer = find(id);
    if (viewer != nullptr && !viewer->is_past()) viewer->conversation->reject_ack();
  }
  send_states();
  if (std::exchange(job_is_due_, false) && !next_job_.empty()) start_job();
}

}  // namespace kerf::net
