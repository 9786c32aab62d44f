// SPDX-License-Identifier: Apache-2.0
#include "server/metrics/metrics.h"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "server/platform/clock.h"

namespace kerf::net {
namespace {

/// 20 us to 50 ms, closely spaced around the target of 1 ms.
const prometheus::Histogram::BucketBoundaries kTurnaroundS = {
    20e-6, 50e-6, 100e-6, 150e-6, 200e-6, 300e-6, 500e-6, 750e-6, 1e-3, 2e-3, 5e-3, 10e-3, 50e-3};

constexpr std::array<const char*, 5> kDropNames = {"malformed", "unknown_connection",
                                                   "not_authentic", "replayed", "too_many"};

}  // namespace

struct Metrics::Impl {
  prometheus::Registry registry;
  prometheus::Family<prometheus::Counter>& counter(const char* name, const char* help) {
    return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
  }
  prometheus::Family<prometheus::Counter>& rejections =
      counter("kerf_refused_total", "Rejected requests of peers by code.");
  prometheus::Family<prometheus::Counter>& http =
      counter("kerf_http_responses_total", "HTTP responses by status.");
  prometheus::Counter& mesh_frames =
      counter("kerf_mesh_frames_sent_total", "Mesh frames sent.").Add({});
  prometheus::Counter& mesh_bytes =
      counter("kerf_mesh_bytes_sent_total", "Bytes of mesh frames sent.").Add({});
  prometheus::Counter& tiles = counter("kerf_mesh_tiles_made_total", "Tiles meshed.").Add({});
  prometheus::Counter& composed_bytes =
      counter("kerf_mesh_bytes_composed_total",
              "Bytes of mesh frames composed, before they are shared among viewers.")
          .Add({});
  prometheus::Counter& datagrams_received =
      counter("kerf_datagrams_received_total", "Authentic datagrams received from agents.").Add({});
  prometheus::Counter& datagrams_sent =
      counter("kerf_datagrams_sent_total", "Datagrams sent to agents.").Add({});
  prometheus::Family<prometheus::Counter>& drops =
      counter("kerf_datagrams_dropped_total", "Datagrams dropped, by reason.");
  std::array<prometheus::Counter*, kDropNames.size()> dropped = [this] {
    std::array<prometheus::Counter*, kDropNames.size()> counters{};
    for (std::size_t i = 0; i < counters.size(); ++i) {
      counters[i] = &drops.Add({{"reason", kDropNames[i]}});
    }
    return counters;
  }();
  prometheus::Counter& gaps =
      counter("kerf_motion_gaps_total",
              "Datagrams not applied because samples before them are missing.")
          .Add({});
  prometheus::Histogram& turnaround =
      prometheus::BuildHistogram()
          .Name("kerf_turnaround_seconds")
          .Help("Time from a motion frame read to its result handed to the socket.")
          .Register(registry)
          .Add({}, kTurnaroundS);
};

namespace {

/// Adds the remaining validity of the certificate, if there is one.
void add_certificate(prometheus::Registry& now, const Metrics& metrics) {
  const std::int64_t expires_s = metrics.certificate_expires_s;
  if (expires_s == 0) return;
  const std::chrono::duration<double, std::ratio<86'400>> left =
      std::chrono::seconds(expires_s) - Clock::wall().time_since_epoch();
  prometheus::BuildGauge()
      .Name("kerf_certificate_days_left")
      .Help("Days until the certificate expires; below 0: since it has.")
      .Register(now)
      .Add({})
      .Set(left.count());
}

void add_damaged(prometheus::Registry& now, const std::vector<std::shared_ptr<Session>>& sessions) {
  const auto damaged = std::ranges::count_if(
      sessions, [](const auto& session) { return session->health().damage().has_value(); });
  prometheus::BuildGauge()
      .Name("kerf_journal_damaged_sessions")
      .Help("Open sessions whose journals are damaged.")
      .Register(now)
      .Add({})
      .Set(static_cast<double>(damaged));
}

/// Adds the gauges of sessions. They are rebuilt on every scrape, so a closed session leaves no
/// line.
void add_gauges(prometheus::Registry& now, const Metrics& metrics,
                const SessionRegistry& registry) {
  const auto family = [&](const char* name, const char* help) -> auto& {
    return prometheus::BuildGauge().Name(name).Help(help).Register(now);
  };
  const auto counter = [&](const char* name, const char* help) -> auto& {
    return prometheus::BuildCounter().Name(name).Help(help).Register(now);
  };
  const auto sessions = registry.list();
  family("kerf_sessions", "Sessions that are open.")
      .Add({})
      .Set(static_cast<double>(sessions.size()));
  family("kerf_sessions_followed", "Sessions of other servers whose blocks are kept here.")
      .Add({})
      .Set(static_cast<double>(registry.followed().size()));
  family("kerf_sessions_loading", "Sessions that are not loaded yet.")
      .Add({})
      .Set(static_cast<double>(registry.loading().size()));
  add_damaged(now, sessions);
  const DiskUse disk = registry.disk_use();
  family("kerf_data_bytes", "Size of all files of the data folder.")
      .Add({})
      .Set(static_cast<double>(disk.folder));
  family("kerf_disk_free_bytes", "Free space of the file system of the data folder.")
      .Add({})
      .Set(static_cast<double>(disk.free));
  add_certificate(now, metrics);
  auto& connections = family("kerf_connections", "Open connections by kind.");
  connections.Add({{"kind", "agent"}}).Set(static_cast<double>(metrics.agents.load()));
  connections.Add({{"kind", "viewer"}}).Set(static_cast<double>(metrics.viewers.load()));
  connections.Add({{"kind", "http"}}).Set(static_cast<double>(metrics.connections.load()));
  auto& lag = family("kerf_journal_lag_records", "Records not yet committed to disk.");
  auto& paused = family("kerf_journal_paused", "1 while a session is paused: its disk fails.");
  auto& failed = family("kerf_journal_failed_commits", "Failed commits since the start.");
  auto& commits = counter("kerf_journal_commits_total", "Commits since the start.");
  auto& commit_s =
      counter("kerf_journal_commit_seconds_total", "Duration of all commits since the start.");
  auto& pending = family("kerf_journal_oldest_pending_seconds",
                         "Age of the oldest record that is not committed.");
  auto& bytes = family("kerf_session_bytes", "Size of the journal and the snapshot on the disk.");
  auto& cpu = counter("kerf_participant_cpu_seconds_total",
                      "CPU time that the motions of a participant took on the session's thread.");
  auto& copied = family("kerf_copied_record", "Last record whose copy NATS has acknowledged.");
  auto& uncopied =
      family("kerf_copy_lag_records", "Records on the disk whose copy NATS has not acknowledged.");
  auto& snapshot = family("kerf_copied_snapshot_record",
                          "Last record of the newest snapshot that NATS has; 0: it has none.");
  auto& motions = family("kerf_session_motions", "Motions applied since the start.");
  for (const auto& session : sessions) {
    const prometheus::Labels labels = {{"session", session->id()}};
    lag.Add(labels).Set(static_cast<double>(session->journal_lag()));
    paused.Add(labels).Set(session->pause() ? 1 : 0);
    const JournalFigures journal = session->journal_figures();
    failed.Add(labels).Set(static_cast<double>(journal.failed_commits));
    commits.Add(labels).Increment(static_cast<double>(journal.commits));
    commit_s.Add(labels).Increment(journal.commit_s);
    pending.Add(labels).Set(journal.oldest_pending_s);
    bytes.Add(labels).Set(static_cast<double>(session->disk_bytes()));
    for (const auto& [id, seconds] : session->cpu_costs()) {
      cpu.Add({{"session", session->id()}, {"participant", std::to_string(id)}}).Increment(seconds);
    }
    if (const auto copy = session->copy().get()) {
      const std::uint64_t committed = session->committed();
      copied.Add(labels).Set(static_cast<double>(copy->record));
      snapshot.Add(labels).Set(static_cast<double>(session->copy().snapshot()));
      uncopied.Add(labels).Set(static_cast<double>(committed - std::min(copy->record, committed)));
    }
    motions.Add(labels).Set(static_cast<double>(session->motions_applied()));
  }
}

}  // namespace

Metrics::Metrics() : impl_(std::make_unique<Impl>()) {}
Metrics::~Metrics() = default;

void Metrics::motion_answered(double turnaround_s) { impl_->turnaround.Observe(turnaround_s); }
void Metrics::rejected(std::string_view code) {
  impl_->rejections.Add({{"code", std::string(code)}}).Increment();
}
void Metrics::mesh_sent(std::size_t bytes) {
  impl_->mesh_frames.Increment();
  impl_->mesh_bytes.Increment(static_cast<double>(bytes));
}
void Metrics::mesh_made(std::uint64_t tiles, std::uint64_t bytes) {
  impl_->tiles.Increment(static_cast<double>(tiles));
  impl_->composed_bytes.Increment(static_cast<double>(bytes));
}
void Metrics::http_answered(unsigned status) {
  impl_->http.Add({{"status", std::to_string(status)}}).Increment();
}

void Metrics::datagram_received() { impl_->datagrams_received.Increment(); }
void Metrics::datagram_sent() { impl_->datagrams_sent.Increment(); }
void Metrics::datagram_dropped(DatagramDrop why) {
  impl_->dropped[static_cast<std::size_t>(why)]->Increment();
}
void Metrics::motion_gap() { impl_->gaps.Increment(); }

std::string Metrics::text(const SessionRegistry& registry) const {
  prometheus::Registry now;
  add_gauges(now, *this, registry);
  const prometheus::TextSerializer serializer;
  return serializer.Serialize(now.Collect()) + serializer.Serialize(impl_->registry.Collect());
}

}  // namespace kerf::net
