// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "server/conversation/control_json.h"
#include "server/conversation/conversation.h"
#include "server/conversation/viewer_outbox.h"
#include "server/feed/tile_detail.h"
#include "server/platform/clock.h"

namespace kerf::net {

/// The surface that a viewer displays, as reported by the state message.
struct SurfaceState {
  std::uint64_t sequence = 0;  ///< of the last record of the session
  std::uint64_t motions = 0;
  double removed_mm3 = 0;
  std::uint64_t hash = 0;
  bool settled = false;     ///< every mesh frame of the state with this hash has been sent
  std::string paused = {};  ///< SessionFrame::paused: no motion is carved
  std::optional<PastPlace> past = std::nullopt;  ///< of a viewer that looks at the past
};

/// The viewer has applied every mesh frame up to this one.
struct MeshAck {
  std::uint64_t sequence = 0;
};

/// The viewer's budget has changed: bytes of mesh frames per second (0: unlimited).
struct ViewerBudget {
  std::uint32_t bytes_per_s = 0;
};

/// Start of a viewer's first snapshot: at its first look if that is known or follows at once,
/// otherwise with exact tiles. Tiles sent before a look would be sent twice.
struct FirstLook {
  bool follows = false;
  std::optional<ViewerLook> look;
  TileNodes nodes = TileNodes::kSingle;  ///< node types that the viewer understands
};

/// A task for the owner of a viewer's conversation: join the session on the session's executor and
/// pass the result to joined(), forward a view, a budget or an ack to the TileFeed, seek, or show
/// its camera.
using ViewerAction =
    std::variant<JoinRequest, ViewerLook, ViewerBudget, MeshAck, SeekMessage, CameraMessage>;

/// The server's side of one viewer's protocol. It belongs to the viewers' thread, not to the
/// session's executor, so a hello becomes an action and the answer waits for joined().
class ViewerConversation final : public Conversation {
 public:
  /// A look message may cause the server to mesh the block again. Viewers send one when their
  /// camera comes to rest.
  static constexpr double kLooksPerS = 5;
  static constexpr double kLooksBurst = 20;
  /// A seek cancels the previous one. A page that scrubs sends one per displayed frame.
  static constexpr double kSeeksPerS = 20;
  static constexpr double kSeeksBurst = 40;
  /// Limits of a viewer's camera messages.
  static constexpr double kCamerasPerS = 20;
  static constexpr double kCamerasBurst = 40;
  /// Minimum interval of state messages, except when the surface has settled.
  static constexpr std::chrono::milliseconds kStateInterval{250};

  /// `budget_max`: upper limit of every viewer's budget, bytes of mesh frames per second (0:
  /// unlimited).
  ViewerConversation(std::shared_ptr<Session> session, Metrics& metrics, Now now,
                     std::function<void()> wake, Caller caller = Caller::local(),
                     std::uint32_t budget_max = 0);

  /// The next action, in the order of the frames that caused them, or nullopt. Until the result of
  /// a JoinRequest is known, no further frame may be passed to receive().
  std::optional<ViewerAction> take_action();
  bool has_action() const override { return !actions_.empty(); }
  /// The result of a JoinRequest, with the participants of the session at that moment.
  void joined(const std::expected<Participant, Rejection>& self, const Roster& roster);
  /// 0 before the viewer has joined.
  ParticipantId id() const { return self_ ? self_->id : 0; }
  /// Valid once the viewer has joined.
  const Participant& self() const { return *self_; }
  /// As stated in the hello.
  const FirstLook& first_look() const { return first_look_; }
  /// Bytes of mesh frames per second that the viewer may be sent: its own budget, limited by the
  /// common maximum (0: unlimited).
  std::uint32_t budget() const { return budget_; }

  /// From now on the viewer is sent the surface of another block, past or present. Tiles and frames
  /// of the previous block are dropped, and a welcome makes the viewer start over. The frames of
  /// the new one count from 1 in send_mesh() and MeshAck.
  void begin_again(const Roster& roster);

  void send_tools(SharedBytes frame);  ///< replaces one that has not left
  /// `tools`, unless null, leaves before it, as with send_tools.
  void send_mesh(FeedFrame frame, SharedBytes tools = nullptr);
  void send_state(const SurfaceState& state);  ///< leaves after the mesh frames before it
  /// The participants have changed. `all` is the complete list, `change` the difference to the list
  /// of the previous call for any viewer of the session, which suffices if the viewer understands
  /// it and has been sent that list.
  void send_participants(const SharedText& all, const SharedText& change);
  void send_programs(SharedText programs);                ///< replaces a message that has not left
  void send_matter(std::size_t matter, SharedText text);  ///< likewise, by matter
  void send_cameras(SharedText cameras);                  ///< likewise
  /// The viewer has acknowledged a frame that was never sent.
  void reject_ack();
  /// Rejects a seek, or a camera, of the viewer.
  void reject_request(const Rejection& rejection);
  /// An owner has removed the viewer.
  void remove(const std::string& reason);
  /// The session ends, and continues at the server `redirect` unless that is empty: sends bye and
  /// finishes.
  void close(const std::string& reason, const std::string& redirect = {});

  bool take(OutFrame& out) override;
  bool has_more() const override { return out_.has_mesh(); }
  void end() override {}

 private:
  void set_budget(std::uint32_t stated);
  /// Whether the viewer verifies mesh frames.
  bool verifies() const { return first_look_.nodes == TileNodes::kVerified; }
  void say_welcome(const Roster& roster);
  void on_hello(const HelloMessage& hello) override;
  void on_control(const ControlMessage& message) override;
  void on_message(const wire::Message& message, Clock::time_point arrived) override;
  bool queue_text(std::string_view text) override { return out_.put_text(text); }
  void queue_pong(const wire::FrameStamp& stamp, const wire::Pong& pong) override;
  void discard_updates() override { out_.close(); }

  RateLimit looks_{kLooksPerS, kLooksBurst}, seeks_{kSeeksPerS, kSeeksBurst};
  RateLimit cameras_{kCamerasPerS, kCamerasBurst};
  ViewerOutbox out_;
  std::deque<ViewerAction> actions_;
  FirstLook first_look_;
  const std::uint32_t budget_max_;
  std::uint32_t budget_;
  bool takes_changes_ = false;     ///< understands participants_changed
  bool has_participants_ = false;  ///< a list or a change has been sent since the welcome
  /// Mesh frames of the previous blocks, and of all blocks. A viewer sees one numbering.
  std::uint64_t meshes_before_ = 0, meshes_ = 0;
  std::optional<SurfaceState> sent_state_;
  Clock::time_point state_sent_at_;
};

}  // namespace kerf::net
