// SPDX-License-Identifier: Apache-2.0
// The part of ViewerHub that sends viewers the participants, programs, matters and cameras.
#include <utility>

#include "server/socket/viewer_hub.h"

namespace kerf::net {

void ViewerHub::on_event(const SessionEvent& event, Roster roster) {
  if (event.removed != 0) {
    if (Viewer* viewer = find(event.removed)) viewer->conversation->remove(event.closing);
    return;
  }
  if (!event.closing.empty()) {
    for (auto& [id, viewer] : viewers_) {
      viewer.conversation->close(event.closing, event.redirect);
    }
    return;
  }
  if (is_same(roster_, roster)) return;
  // Encoded once for all viewers.
  const auto all = std::make_shared<const std::string>(participants_message(roster));
  const auto change =
      std::make_shared<const std::string>(change_message(difference(roster_, roster)));
  roster_ = std::move(roster);
  for (auto& [id, viewer] : viewers_) viewer.conversation->send_participants(all, change);
}

void ViewerHub::take_lists(const SessionFrame& frame) {
  if (frame.programs) {
    programs_ = std::make_shared<const std::string>(programs_message(*frame.programs));
    for (auto& [id, viewer] : viewers_) viewer.has_programs = false;
  }
  for (const MatterMessage& message : frame.matters) {
    matters_[message.matter] = std::make_shared<const std::string>(message.text);
  }
}

void ViewerHub::send_lists() {
  encode_cameras();
  for (auto& [id, viewer] : viewers_) {
    ViewerConversation& conversation = *viewer.conversation;
    if (programs_ && !std::exchange(viewer.has_programs, true))
      conversation.send_programs(programs_);
    for (const auto& [matter, text] : matters_) {
      if (std::exchange(viewer.matters_sent[matter], text) == text) continue;
      conversation.send_matter(matter, text);
    }
    if (cameras_ && !std::exchange(viewer.has_cameras, true)) conversation.send_cameras(cameras_);
  }
}

void ViewerHub::show_camera(ParticipantId id, const CameraMessage& message) {
  Viewer* viewer = find(id);
  if (viewer == nullptr) return;
  if (message.camera && !shown_.contains(id) && shown_.size() >= kCamerasMax) {
    return viewer->conversation->reject_request(
        {wire::ErrorCode::kBusy,
         "others show their cameras; at most " + std::to_string(kCamerasMax) + " of a session do"});
  }
  if (message.camera) {
    const Participant& self = viewer->conversation->self();
    shown_.insert_or_assign(id, ShownCamera{id, self.name, self.color, *message.camera});
  } else {
    shown_.erase(id);
  }
  cameras_are_new_ = true;
}

/// The newest cameras, at most every kCameraInterval.
void ViewerHub::encode_cameras() {
  const auto now = Clock::now();
  const auto interval = is_crowd() ? kCrowdCameraInterval : kCameraInterval;
  if (!cameras_are_new_ || now - cameras_sent_at_ < interval) return;
  cameras_are_new_ = false;
  cameras_sent_at_ = now;
  std::vector<ShownCamera> list;
  for (const auto& [id, camera] : shown_) list.push_back(camera);
  cameras_ = std::make_shared<const std::string>(cameras_message(list));
  for (auto& [id, viewer] : viewers_) viewer.has_cameras = false;
}

}  // namespace kerf::net
