// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/container/flat_map.hpp>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/conversation/viewer_conversation.h"
#include "server/feed/tile_feed.h"
#include "server/platform/clock.h"
#include "server/socket/past_viewer.h"
#include "server/socket/peer_context.h"

namespace kerf::net {

/// The viewers of one session. While it has viewers it reads the session's state about thirty times
/// a second, has changed tiles meshed on the meshing thread and distributes the frames. Runs on the
/// viewers' thread. Agents never wait for it. Readings go directly from the session's thread to the
/// meshing thread, so a viewers' thread that sends to a crowd does not delay them.
class ViewerHub : public std::enable_shared_from_this<ViewerHub> {
 public:
  ViewerHub(std::shared_ptr<Session> session, PeerContext& context);
  ~ViewerHub();

  /// `viewer` must stay valid until remove(). If its first look follows, its first snapshot starts
  /// with that look, or after kLookWait without it.
  void add(ParticipantId id, ViewerConversation* viewer, const FirstLook& first);
  void remove(ParticipantId id);
  void acknowledge(ParticipantId id, std::uint64_t sequence);
  /// Sets the viewpoint of a viewer. Only the newest counts.
  void look(ParticipantId id, const ViewerLook& look);
  /// Sets a viewer's budget, bytes of mesh frames per second (0: unlimited).
  void set_budget(ParticipantId id, std::uint32_t bytes_per_s);
  /// Shows a viewer the past, or the present again.
  void seek(ParticipantId id, const SeekMessage& seek);
  /// Shows the viewer's camera to the other viewers, or hides it. Only the newest counts.
  void show_camera(ParticipantId id, const CameraMessage& message);
  static constexpr std::chrono::seconds kLookWait{1};
  /// Viewers of one session who show their cameras.
  static constexpr std::size_t kCamerasMax = 8;
  /// Minimum interval between two messages with cameras; longer for a crowd.
  static constexpr std::chrono::milliseconds kCameraInterval{60}, kCrowdCameraInterval{500};
  /// Viewers of the past per session. Each has a copy of the block.
  static constexpr std::size_t kPastViewersMax = 4;
  /// With more viewers the hub reads the session 20 times a second instead of 30, and sends tool
  /// poses with the tiles.
  static constexpr std::size_t kCrowd = 50;
  const std::shared_ptr<Session>& session() const { return session_; }
  /// Waits until the session's thread has finished the hub's work. The viewers' thread adds none
  /// afterwards, because this is its last turn.
  void finish_reading();

 private:
  /// Thirty times a second: viewers interpolate poses in between, and a permanently changing tile
  /// is meshed at most this often. The second value is for a crowd.
  static constexpr std::chrono::milliseconds kTick{33}, kCrowdTick{50};
  /// Ordered by id, contiguous in memory, because a crowd is visited several times per reading.
  template <class T>
  using ById = boost::container::flat_map<ParticipantId, T>;
  /// Belongs to the meshing thread while a job runs there.
  struct FeedSide {
    std::unique_ptr<TileFeed> feed;
    struct Member {
      ViewerId id = 0;
      std::uint64_t stay = 0;  ///< Viewer::stay
    };
    ById<Member> ids;
    std::set<ParticipantId> waiting;  ///< for their budgets
    TileFeed::Stats counted;          ///< already reported to the metrics
  };
  struct Viewer {
    ViewerConversation* conversation = nullptr;
    /// Distinguishes frames of the present from before and after a look at the past.
    std::uint64_t stay = 0;
    std::shared_ptr<PastViewer> past;  ///< null: it looks at the present
    bool is_past() const { return past && past->is_shown(); }
    std::optional<ViewerLook> look;             ///< the last one
    std::optional<Clock::time_point> look_due;  ///< the first snapshot awaits a look until then
    bool has_tools = false;                     ///< has been sent `tools_` already
    bool has_programs = false;                  ///< has been sent `programs_` already
    std::map<std::size_t, SharedText> matters_sent;  ///< those of `matters_` that it has
    bool has_cameras = false;                        ///< has been sent `cameras_` already
    std::optional<std::uint64_t> sent;  ///< every tile of this revision of the feed was sent
  };
  /// The block when the feed is created.
  struct Surface {
    SolidSnapshot snapshot;
    std::uint64_t revision = 0;
  };
  /// Requests since the last job.
  struct Job {
    bool is_for_all = false;       ///< the surface has changed: every viewer needs a frame
    bool is_for_waiting = false;   ///< time has passed for viewers that wait for their budgets
    std::optional<Surface> first;  ///< creates the feed; later changes go to it directly
    struct Joined {
      ParticipantId id = 0;
      std::uint64_t stay = 0;
      std::optional<ViewerLook> look;
      TileNodes nodes = TileNodes::kSingle;
      std::uint32_t budget = 0;
    };
    std::vector<ParticipantId> left;  ///< before those who join
    std::vector<Joined> joined;
    std::vector<std::pair<ParticipantId, std::uint64_t>> acks;
    std::map<ParticipantId, ViewerLook> looks;
    std::map<ParticipantId, std::uint32_t> budgets;
    bool empty() const {
      return !is_for_all && !is_for_waiting && !first && joined.empty() && left.empty() &&
             acks.empty() && looks.empty() && budgets.empty();
    }
  };
  struct JobResult {
    struct Frame {
      ParticipantId id = 0;
      std::uint64_t stay = 0;
      FeedFrame frame;
    };
    std::vector<Frame> frames;  ///< those of a viewer are contiguous
    std::vector<ParticipantId> bad_acks;
    struct Sent {
      ParticipantId id = 0;
      std::uint64_t stay = 0, revision = 0;
    };
    std::vector<Sent> sent;
    std::uint64_t tiles = 0, bytes = 0;
    bool has_waiting = false;  ///< viewers wait for their budgets
  };

  void listen();
  void on_event(const SessionEvent& event, Roster roster);
  boost::asio::awaitable<void> run();
  void read_session();
  void take_frame(SessionFrame frame, bool has_surface);
  void start_overdue_snapshots();
  /// Adds a viewer to the feed of the present, or removes it.
  void join_feed(ParticipantId id, const std::optional<ViewerLook>& look);
  void leave_feed(ParticipantId id);
  void show_past(ParticipantId id, Viewer& viewer, const SeekMessage& seek);
  void leave_present(ParticipantId id, bool reached);
  void show_present(ParticipantId id, Viewer& viewer);
  void encode_tools();
  void send_tools();
  void take_lists(const SessionFrame& frame);
  void send_lists();
  void encode_cameras();
  void send_states();
  bool is_crowd() const { return viewers_.size() > kCrowd; }
  void start_job();
  void mesh(Job job);
  static JobResult run_job(FeedSide& side, Job& job);
  static void serve(FeedSide& side, ParticipantId id, JobResult& result);
  void deliver(JobResult result);
  Viewer* find(ParticipantId id);

  std::shared_ptr<Session> session_;
  PeerContext& context_;
  boost::asio::steady_timer tick_;
  ById<Viewer> viewers_;
  Roster roster_;  ///< as last sent to the viewers
  std::shared_ptr<FeedSide> side_;
  Job next_job_;
  bool job_runs_ = false, job_is_due_ = false, running_ = false, listening_ = false;
  bool has_feed_ = false;         ///< a job has made the feed
  bool has_waiting_ = false;      ///< viewers wait for their budgets
  bool is_reading_ = false;       ///< the session's thread has been asked for its state
  bool reads_after_job_ = false;  ///< a crowd's reading waits for the running job
  Clock::time_point next_reading_{};
  std::vector<std::byte> last_tools_;  ///< encoded without sequence and time, to detect changes
  SharedBytes tools_;                  ///< tool poses not passed on yet
  std::uint64_t tools_sent_ = 0;
  SharedText programs_;  ///< the newest message about the programs; null without any
  SharedText cameras_;   ///< the same
  std::map<std::size_t, SharedText> matters_;  ///< the newest message of each
  std::map<ParticipantId, ShownCamera> shown_;
  bool cameras_are_new_ = false;
  Clock::time_point cameras_sent_at_{};
  SessionFrame newest_;  ///< of the session, without its snapshot
  bool has_newest_ = false;
  std::uint64_t revision_ = 0;  ///< newest one of the feed: the motions that its tiles include
};

/// The hubs of the sessions that have viewers. Viewers' thread only.
class HubDirectory {
 public:
  std::shared_ptr<ViewerHub> get(const std::shared_ptr<Session>& session, PeerContext& context);
  /// In the last turn of the viewers' thread: waits until no session's thread works for a hub.
  void finish_reading();

 private:
  std::map<std::string, std::weak_ptr<ViewerHub>> hubs_;
};

}  // namespace kerf::net
