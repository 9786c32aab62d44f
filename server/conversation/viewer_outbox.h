// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <string>

#include "server/conversation/control_queue.h"
#include "server/feed/tile_feed.h"

namespace kerf::net {

/// Outgoing frames for one viewer, in order of priority: control messages, tool poses, the
/// participants, the programs, the matters, the cameras, mesh frames, the state message. Except for
/// control messages and mesh frames, newer ones replace older ones that have not left. Mesh frames
/// keep their order (TileFeed bounds their number).
class ViewerOutbox {
 public:
  /// Returns false if the viewer reads so little that the control queue is full.
  bool put_text(std::string_view text) { return closed_ || control_.put_text(text); }
  void put_pong(const wire::FrameStamp& stamp, const wire::Pong& pong) {
    if (!closed_) control_.put_pong(stamp, pong);
  }
  void put_tools(SharedBytes frame) {
    if (!closed_) tools_ = std::move(frame);
  }
  void put_participants(SharedText text) {
    if (!closed_) participants_ = std::move(text);
  }
  void put_programs(SharedText text) {
    if (!closed_) programs_ = std::move(text);
  }
  /// `matter`: its index (MatterMessage).
  void put_matter(std::size_t matter, SharedText text) {
    if (!closed_) matters_.insert_or_assign(matter, std::move(text));
  }
  void put_cameras(SharedText text) {
    if (!closed_) cameras_ = std::move(text);
  }
  /// Whether a message about the participants is queued.
  bool has_participants() const { return participants_ != nullptr; }
  /// Whether a mesh frame is queued.
  bool has_mesh() const { return !mesh_.empty(); }
  /// `is_summed`: send it with its checksum.
  void put_mesh(FeedFrame frame, bool is_summed = false) {
    if (!closed_) mesh_.push_back({std::move(frame), is_summed});
  }
  /// The sequence of the last mesh frame that has left, or 0 before the first.
  std::uint64_t mesh_sent() const { return mesh_sent_; }
  void put_state(std::string text) {
    if (!closed_) state_ = std::move(text);
  }

  /// Discards the tiles, the tools and the state.
  void drop_surface();
  /// Discards everything except control messages, and ignores later additions.
  void close();
  /// Moves the next frame to send into `out`. Returns false if there is none. `stamp` supplies
  /// epoch and time of a mesh frame, whose header is written when it leaves.
  bool take(const wire::FrameStamp& stamp, OutFrame& out);

 private:
  ControlQueue control_;
  SharedBytes tools_;
  SharedText participants_, programs_, cameras_;
  std::map<std::size_t, SharedText> matters_;  ///< by index
  struct Mesh {
    FeedFrame frame;
    bool is_summed = false;
  };
  std::deque<Mesh> mesh_;
  std::uint64_t mesh_sent_ = 0;
  std::string state_;
  bool closed_ = false;
};

}  // namespace kerf::net
