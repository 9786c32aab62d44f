// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "server/feed/tile_feed.h"
#include "server/metrics/metrics.h"
#include "server/socket/peer_context.h"

namespace kerf::net {

/// A message that many viewers share.
using SharedBytes = std::shared_ptr<const std::vector<std::byte>>;

/// What the hub sends to; one viewer's socket.
class ViewerSink {
 public:
  virtual ~ViewerSink() = default;
  virtual void send_tools(SharedBytes frame) = 0;  ///< replaces one that has not left yet
  virtual void send_mesh(FeedFrame frame) = 0;     ///< kept in order; at most two are under way
  virtual void send_state(
      std::string text) = 0;  ///< replaces; leaves after the mesh frames before it
  virtual void send_control(std::string text) = 0;  ///< kept in order
  virtual void bad_ack() = 0;                       ///< it acknowledged what it never got
  virtual void end(const std::string& reason) = 0;  ///< says bye and closes
};

/// The viewers of one session: visits the session some thirty times a second while anybody looks,
/// has the news meshed on the meshing lane, and hands out frames. Runs on the viewer lane; nothing
/// here makes an agent wait.
class ViewerHub : public std::enable_shared_from_this<ViewerHub> {
 public:
  ViewerHub(std::shared_ptr<Session> session, PeerContext& context);
  ~ViewerHub();

  void add(ParticipantId id, ViewerSink* sink);
  void remove(ParticipantId id);
  void acked(ParticipantId id, std::uint64_t sequence);
  void looks(ParticipantId id, const ViewerLook& look);  ///< only the newest counts
  const std::shared_ptr<Session>& session() const { return session_; }

 private:
  /// What belongs to the meshing lane while a job is under way, and to nobody else.
  struct FeedSide {
    std::unique_ptr<TileFeed> feed;
    std::map<ParticipantId, ViewerId> ids;
    TileFeed::Stats counted;
  };
  struct Viewer {
    ViewerSink* sink = nullptr;
    std::uint64_t shown_sequence = 0;  ///< revision all of whose frames were sent
    std::uint64_t told_sequence = ~std::uint64_t{0};
    std::uint64_t told_hash = 0;
    bool told_settled = false;
    std::chrono::steady_clock::time_point told_at{};
  };
  struct Job {
    std::vector<ParticipantId> joined, left;
    std::vector<std::pair<ParticipantId, std::uint64_t>> acks;
    std::map<ParticipantId, ViewerLook> looks;
  };
  struct JobResult {
    std::vector<std::pair<ParticipantId, FeedFrame>> frames;
    std::vector<ParticipantId> bad_acks;
    std::vector<std::pair<ParticipantId, std::uint64_t>> shown;
    std::uint64_t tiles = 0, bytes = 0;
  };

  void watch();
  boost::asio::awaitable<void> run();
  void take(SessionFrame frame);
  void tell_states();
  void on_event(const SessionEvent& event, std::vector<Participant> participants);
  void pump();
  static JobResult work(FeedSide& side, const Job& job);
  void deliver(JobResult result);

  std::shared_ptr<Session> session_;
  PeerContext& context_;
  boost::asio::steady_timer tick_;
  std::map<ParticipantId, Viewer> viewers_;
  std::shared_ptr<FeedSide> side_;
  Job next_job_;
  bool pumping_ = false, again_ = false, running_ = false, watching_ = false;
  std::vector<std::byte> last_tools_;
  SharedBytes tools_;
  std::uint64_t tools_sent_ = 0;
  SessionFrame newest_;
  bool has_newest_ = false;
};

/// The hubs of the sessions that somebody looks at. Viewer lane only.
class HubDirectory {
 public:
  std::shared_ptr<ViewerHub> get(const std::shared_ptr<Session>& session, PeerContext& context);

 private:
  std::map<std::string, std::weak_ptr<ViewerHub>> hubs_;
};

}  // namespace kerf::net
