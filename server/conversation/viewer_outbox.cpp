// SPDX-License-Identifier: Apache-2.0
#include "server/conversation/viewer_outbox.h"

#include <utility>

namespace kerf::net {
namespace {

/// Moves `text` into `out`; returns false if it is null.
bool take_shared(SharedText& text, OutFrame::Kind kind, OutFrame& out) {
  if (!text) return false;
  const auto bytes = std::as_bytes(std::span(*text));
  out = {.kind = kind, .bytes = {bytes.begin(), bytes.end()}};
  text.reset();
  return true;
}

}  // namespace

void ViewerOutbox::close() {
  closed_ = true;
  drop_surface();
  participants_.reset();
  programs_.reset();
  pins_.reset();
  cameras_.reset();
}

void ViewerOutbox::drop_surface() {
  tools_.reset();
  mesh_.clear();
  state_.clear();
}

bool ViewerOutbox::take(const wire::FrameStamp& stamp, OutFrame& out) {
  out.shared.reset();
  if (control_.take(out)) return true;
  if (tools_) {
    out = {.kind = OutFrame::Kind::kTools, .shared = std::exchange(tools_, nullptr)};
    return true;
  }
  if (take_shared(participants_, OutFrame::Kind::kParticipants, out) ||
      take_shared(programs_, OutFrame::Kind::kPrograms, out) ||
      take_shared(pins_, OutFrame::Kind::kPins, out) ||
      take_shared(cameras_, OutFrame::Kind::kCameras, out)) {
    return true;
  }
  if (!mesh_.empty()) {
    FeedFrame mesh = std::move(mesh_.front());
    mesh_.pop_front();
    const auto header = wire::mesh_header({stamp.epoch, mesh.sequence, stamp.time_us}, mesh.flags,
                                          mesh.glb->size());
    out = {.kind = OutFrame::Kind::kMesh,
           .bytes = {header.begin(), header.end()},
           .shared = std::move(mesh.glb)};
    return true;
  }
  return take_text(state_, OutFrame::Kind::kState, out);
}

}  // namespace kerf::net
