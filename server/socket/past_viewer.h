// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/conversation/viewer_conversation.h"
#include "server/feed/tile_feed.h"
#include "server/platform/clock.h"
#include "server/session/past_block.h"
#include "server/socket/peer_context.h"

namespace kerf::net {

/// One viewer of the past: its own copy of the block and its own feed of tiles, which jobs on the
/// thread `past` bring to the requested record, one at a time. Everything else runs on the viewers'
/// thread.
class PastViewer : public std::enable_shared_from_this<PastViewer> {
 public:
  /// `viewer` must stay valid until end(). The viewer sees the present until the first record has
  /// been reached. Then `on_first` is called, with false if it could not be reached.
  PastViewer(std::shared_ptr<Session> session, ViewerConversation* viewer, PeerContext& context,
             std::optional<ViewerLook> look, std::function<void(bool)> on_first);

  /// Seeks a record, and plays from there at a rate. Cancels a seek in progress.
  void seek(const SeekMessage& seek);
  /// Whether the first record has been reached.
  bool is_shown() const { return is_shown_; }
  void acknowledge(std::uint64_t sequence);
  void look(const ViewerLook& look);
  /// Sets the viewer's budget, bytes of mesh frames per second (0: unlimited).
  void set_budget(std::uint32_t bytes_per_s);
  /// Continues playing, and sends frames that have waited for the budget. Call about thirty times a
  /// second.
  void tick();
  /// The viewer has left, or returns to the present.
  void end();

 private:
  /// Belongs to the thread `past` while a job runs there.
  struct Side {
    std::shared_ptr<Session> session;
    std::optional<PastBlock> block;
    std::unique_ptr<TileFeed> feed;
    ViewerId viewer = 0;
    std::optional<ViewerLook> first_look;
    std::uint32_t budget = 0;
    TileNodes nodes = TileNodes::kSingle;
    TileFeed::Stats counted;  ///< already reported to the metrics
  };
  struct Job {
    std::optional<std::uint64_t> record;   ///< to go to
    std::optional<std::int64_t> until_ms;  ///< to play to; ms since 1970
    bool with_hash = false;
    std::vector<std::uint64_t> acks;
    std::optional<ViewerLook> look;
    std::optional<std::uint32_t> budget;
    bool empty() const { return !record && !until_ms && acks.empty() && !look && !budget; }
  };
  struct Result {
    std::string error;        ///< empty if it succeeded
    bool is_damaged = false;  ///< the journal is, so that the error remains
    bool has_no_record = false, is_late = false, has_bad_ack = false, has_moved = false;
    bool waits_for_budget = false;
    std::int64_t next_ms = 0;
    std::uint64_t tiles = 0, bytes = 0;
    std::vector<FeedFrame> frames;
    wire::ToolStates tools;
    SurfaceState state;  ///< without `past`: no record has been reached
    bool with_hash = false;
  };

  void start_job();
  static Result run_job(Side& side, const Job& job, const std::stop_token& stop);
  static void go(Side& side, const Job& job, const std::stop_token& stop, Result& result);
  static void explain(const Session& session, const std::stop_token& stop, Result& result);
  static void serve(Side& side, const Job& job, Result& result);
  void deliver(Result result);
  void reject(const Result& result);
  void send(Result& result);
  /// The current time in the journal; ms since 1970.
  std::int64_t journal_clock() const;
  void set_clock(std::int64_t journal_ms);

  ViewerConversation* viewer_;  ///< null after end()
  PeerContext& context_;
  std::function<void(bool)> on_first_;
  std::shared_ptr<Side> side_;
  Job next_;
  bool job_runs_ = false, is_shown_ = false, waits_for_budget_ = false;
  std::stop_source stop_;        ///< of the running job
  double rate_ = 0;              ///< 0: it rests
  std::int64_t journal_ms_ = 0;  ///< the time in the journal at `since_`
  Clock::time_point since_, hashed_;
  std::uint64_t tools_sent_ = 0;
  SurfaceState state_;  ///< at the last hash
};

}  // namespace kerf::net
