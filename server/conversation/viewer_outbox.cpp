// SPDX-License-Identifier: Apache-2.0
#include "server/conversation/viewer_outbox.h"

#include <utility>

namespace kerf::net {
namespace {

/// Moves `text` into `out`. Returns false if it is null.
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
  matters_.clear();
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
      take_shared(programs_, OutFrame::Kind::kPrograms, out)) {
    return true;
  }
  if (const auto first = matters_.begin(); first != matters_.end()) {
    take_shared(first->second, OutFrame::Kind::kMatter, out);
    matters_.erase(first);
    return true;
  }
  if (take_shared(cameras_, OutFrame::Kind::kCameras, out)) return true;
  if (!mesh_.empty()) {
    auto [mesh, is_summed] = std::move(mesh_.front());
    mesh_.pop_front();
    mesh_sent_ = mesh.sequence;
    const wire::FrameStamp its_stamp{stamp.epoch, mesh.sequence, stamp.time_us};
    const std::size_t bytes = mesh.glb->size();
    out = {.kind = OutFrame::Kind::kMesh, .shared = std::move(mesh.glb)};
    if (is_summed) {
      const auto header = wire::summed_mesh_header(its_stamp, mesh.flags, bytes, mesh.sum);
      out.bytes.assign(header.begin(), header.end());
    } else {
      const auto header = wire::mesh_header(its_stamp, mesh.flags, bytes);
      out.bytes.assign(header.begin(), header.end());
    }
    return true;
  }
  return take_text(state_, OutFrame::Kind::kState, out);
}

}  // namespace kerf::net
