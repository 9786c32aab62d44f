// SPDX-License-Identifier: Apache-2.0
// Measures the picture of viewers with a budget of bytes per second: a real kerf-server as a child
// process, four hands that cut fresh stock at 1 kHz, and one viewer each with no budget, 400, 200
// and 100 kB/s in the same session.
//
//   budget_bench [--server PATH] [--seconds S]      S: time of cutting, default 20
//
// Prints for each viewer: the bytes that it received while the hands cut; the staleness of tiles,
// from the moment at which the viewer without a budget had a newer surface of the tile until this
// viewer has one; the share of the time in which tiles were at level 1, and in which their newest
// surface had not arrived; the error of its picture, as the distances of the vertices of the newest
// exact tiles from its own tiles, twenty times while the hands cut (for tiles whose newest surface
// had arrived, and for all); and the time from the last cut until it had every tile exactly. For
// the viewer without a budget it prints the staleness of frames as viewers_bench does.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/formats/model/mesh_distance.h"
#include "tests/bench/crowd_viewer.h"
#include "tests/bench/live_client.h"
#include "tests/bench/raster.h"
#include "tests/support/glb_reader.h"

namespace {

using namespace kerf;
using namespace kerf::bench;

/// kB/s, or 0 for no budget.
constexpr std::array<int, 4> kBudgets{0, 400, 200, 100};
constexpr int kAgents = 4, kSamples = 20;

double seconds_of(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

/// A mesh frame and its time of arrival.
struct Arrival {
  Clock::time_point at;
  test::DecodedFrame frame;
};

/// One viewer, on a thread of its own. It acknowledges each frame at once and reads it later, so
/// that all frames have times of one clock.
class Watcher {
 public:
  Watcher(std::uint16_t port, int budget_kb)
      : socket_(port, "/v1/sessions/bench/view", "kerf.view.v1") {
    std::string hello = R"({"type":"hello","name":"bench")";
    if (budget_kb > 0) hello += R"(,"budget":)" + std::to_string(budget_kb * 1000);
    hello += "}";
    socket_.send(1, std::as_bytes(std::span(hello)));
    thread_ = std::jthread([this](const std::stop_token& stop) { read(stop); });
  }
  /// Ends the viewer. The frames may be read afterwards.
  void end() {
    thread_.request_stop();
    thread_.join();
  }
  std::vector<Arrival> arrivals() const {
    std::vector<Arrival> list;
    for (const auto& [at, bytes] : frames_) list.push_back({at, test::read_mesh_glb(bytes)});
    return list;
  }
  /// Returns the bytes of all messages that arrived in between, without WebSocket headers.
  std::size_t bytes_between(Clock::time_point begin, Clock::time_point end) const {
    std::size_t bytes = 0;
    for (const auto& [at, count] : received_) bytes += at >= begin && at < end ? count : 0;
    return bytes;
  }

 private:
  void read(const std::stop_token& stop) {
    std::string payload;
    std::vector<std::byte> ack;
    while (!stop.stop_requested()) {
      const auto opcode = socket_.receive(payload, in_seconds(0.05));
      if (opcode == 0) continue;
      const auto now = Clock::now();
      received_.emplace_back(now, payload.size());
      if (opcode != 2) continue;
      const auto message = wire::decode(std::as_bytes(std::span(payload)));
      if (!message) fail("a frame of the server is malformed");
      const auto* mesh = std::get_if<wire::MeshView>(&message->body);
      if (mesh == nullptr) continue;
      frames_.emplace_back(now, std::vector(mesh->glb.begin(), mesh->glb.end()));
      ack.clear();
      wire::append(ack, {kNewEpoch, message->header.stamp.sequence, 0}, wire::Ack{});
      socket_.send(2, ack);
    }
  }

  WebSocket socket_;
  std::vector<std::pair<Clock::time_point, std::size_t>> received_;
  std::vector<std::pair<Clock::time_point, std::vector<std::byte>>> frames_;
  std::jthread thread_;
};

using Tiles = std::map<TileIndex, const test::DecodedTile*>;

/// A viewer's picture, which its arrivals advance.
class Picture {
 public:
  explicit Picture(const std::vector<Arrival>& arrivals) : arrivals_(arrivals) {}
  /// Applies the arrivals until then. Calls `on_tile` with the time, the tile and its predecessor.
  template <class OnTile>
  void advance(Clock::time_point until, const OnTile& on_tile) {
    for (; next_ < arrivals_.size() && arrivals_[next_].at <= until; ++next_) {
      for (const auto& [index, tile] : arrivals_[next_].frame.tiles) {
        const test::DecodedTile*& shown = tiles_[index];
        on_tile(arrivals_[next_].at, index, tile, shown);
        shown = &tile;
      }
    }
  }
  void advance(Clock::time_point until) {
    advance(until, [](auto...) {});
  }
  const Tiles& tiles() const { return tiles_; }

 private:
  const std::vector<Arrival>& arrivals_;
  std::size_t next_ = 0;
  Tiles tiles_;
};

IndexedMesh mesh_of(const test::DecodedTile& tile) {
  IndexedMesh mesh;
  for (const Vec3& p : tile.positions_mm) {
    mesh.positions_mm.push_back({float(p.x), float(p.y), float(p.z)});
  }
  for (std::size_t n = 0; n < tile.indices.size(); n += 3) {
    mesh.triangles.push_back({tile.indices[n], tile.indices[n + 1], tile.indices[n + 2]});
  }
  return mesh;
}

/// Appends the distances of the vertices of `exact` to `shown`, mm.
void add_distances(const test::DecodedTile& exact, const test::DecodedTile& shown,
                   std::vector<double>& off_mm) {
  if (exact.version == shown.version && shown.level == 0) {
    return void(off_mm.insert(off_mm.end(), exact.positions_mm.size(), 0.0));
  }
  const IndexedMesh mesh = mesh_of(shown);
  if (mesh.triangles.empty()) return;
  const MeshDistance distance(mesh);
  std::uint32_t near = 0;
  for (const Vec3& p : exact.positions_mm) off_mm.push_back(distance.distance_mm(p, near));
}

struct Cutting {
  Clock::time_point begin, end;
};

/// When the viewer without a budget received each version of a tile.
using Versions = std::map<TileIndex, std::map<std::uint64_t, Clock::time_point>>;

Versions versions_of(const std::vector<Arrival>& arrivals) {
  Versions versions;
  for (const auto& [at, frame] : arrivals) {
    for (const auto& [index, tile] : frame.tiles) versions[index].try_emplace(tile.version, at);
  }
  return versions;
}

/// Returns the staleness of tiles, ms.
std::vector<double> staleness(const std::vector<Arrival>& arrivals, const Versions& versions,
                              const Cutting& cutting) {
  std::vector<double> stale_ms;
  Picture picture(arrivals);
  picture.advance(Clock::time_point::max(),
                  [&](auto at, auto index, const auto& tile, auto* before) {
                    if (before == nullptr || tile.version == before->version || at < cutting.begin)
                      return;
                    const auto& known = versions.at(index);
                    const auto newer = known.upper_bound(before->version);
                    if (newer != known.end())
                      stale_ms.push_back(std::max(0.0, 1e3 * seconds_of(at - newer->second)));
                  });
  return stale_ms;
}

/// Returns the staleness of frames of the viewer without a budget, from the answer to their oldest
/// motion, ms.
std::vector<double> frame_staleness(const std::vector<Arrival>& arrivals,
                                    const AnswerTimes& answers) {
  std::vector<double> stale_ms;
  for (const auto& [at, frame] : arrivals) {
    const auto oldest = answers.of(frame.from + 1);
    if (frame.from > 0 && frame.to > frame.from && oldest)
      stale_ms.push_back(1e3 * seconds_of(at - *oldest));
  }
  return stale_ms;
}

/// A viewer's picture at `kSamples` moments while the hands cut.
struct Seen {
  int tiles = 0, coarse = 0, old = 0;
  /// For all tiles, and for those whose newest surface has arrived.
  std::vector<double> off_mm, off_new_mm;
};

Seen seen_by(const std::vector<Arrival>& arrivals, const std::vector<Arrival>& newest,
             const Cutting& cutting) {
  Seen seen;
  Picture picture(arrivals), exact(newest);
  for (int n = 1; n <= kSamples; ++n) {
    const auto at = cutting.begin + (cutting.end - cutting.begin) * n / kSamples;
    picture.advance(at);
    exact.advance(at);
    for (const auto& [index, tile] : exact.tiles()) {
      const auto shown = picture.tiles().find(index);
      if (shown == picture.tiles().end()) continue;
      // It may be ahead, by less than the time between two readings of the session.
      if (shown->second->version > tile->version) continue;
      const bool is_old = shown->second->version < tile->version;
      ++seen.tiles;
      seen.coarse += shown->second->level > 0 ? 1 : 0;
      seen.old += is_old ? 1 : 0;
      if (!is_old) add_distances(*tile, *shown->second, seen.off_new_mm);
      add_distances(*tile, *shown->second, seen.off_mm);
    }
  }
  return seen;
}

/// Returns when the viewer had every tile of the end exactly, s after the last cut; negative if
/// never.
double exact_after_s(const std::vector<Arrival>& arrivals, const std::vector<Arrival>& newest,
                     const Cutting& cutting) {
  Picture last(newest), all(arrivals);
  last.advance(Clock::time_point::max());
  all.advance(Clock::time_point::max());
  for (const auto& [index, tile] : last.tiles()) {
    const auto shown = all.tiles().find(index);
    if (shown == all.tiles().end() || shown->second->version < tile->version ||
        shown->second->level > 0) {
      return -1;
    }
  }
  return seconds_of(arrivals.back().at - cutting.end);
}

void print(int budget_kb, const Watcher& watcher, const std::vector<Arrival>& newest,
           const Cutting& cutting, const AnswerTimes& answers) {
  const auto arrivals = watcher.arrivals();
  auto stale = budget_kb == 0 ? frame_staleness(arrivals, answers)
                              : staleness(arrivals, versions_of(newest), cutting);
  Seen seen = seen_by(arrivals, newest, cutting);
  const double seconds = seconds_of(cutting.end - cutting.begin);
  std::printf(
      "%s: %.0f kB/s; %s stale p50 %.0f ms, p99 %.0f ms; tiles at level 1 %.0f %%, of an older "
      "surface %.0f %%; off by, of newest surfaces p99 %.3f, most %.3f mm, of all p99 %.2f, most "
      "%.2f mm; exact %.2f s after the last cut\n",
      budget_kb == 0 ? "no budget" : (std::to_string(budget_kb) + " kB/s").c_str(),
      double(watcher.bytes_between(cutting.begin, cutting.end)) / seconds / 1e3,
      budget_kb == 0 ? "frames" : "tiles", at_share(stale, 0.5), at_share(stale, 0.99),
      100.0 * seen.coarse / seen.tiles, 100.0 * seen.old / seen.tiles,
      at_share(seen.off_new_mm, 0.99), at_share(seen.off_new_mm, 1), at_share(seen.off_mm, 0.99),
      at_share(seen.off_mm, 1), exact_after_s(arrivals, newest, cutting));
}

}  // namespace

int main(int argc, char** argv) {
  std::string program = KERF_SERVER_PROGRAM;
  double seconds = 20;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view word = argv[i];
    if (word == "--server") program = argv[i + 1];
    if (word == "--seconds") seconds = std::atof(argv[i + 1]);
  }
  std::setvbuf(stdout, nullptr, _IOLBF, 4096);
  const ServerProcess server(program);
  post(server.port(), "/v1/sessions?id=bench", scene_for(seconds));
  AnswerTimes answers;
  Raster raster(server.port(), "bench", kAgents, &answers);
  std::vector<std::unique_ptr<Watcher>> watchers;
  for (const int budget : kBudgets) {
    watchers.push_back(std::make_unique<Watcher>(server.port(), budget));
  }
  std::this_thread::sleep_until(in_seconds(3));
  Cutting cutting{Clock::now(), {}};
  raster.cut(static_cast<std::uint64_t>(1000 * seconds));
  cutting.end = Clock::now();  // or earlier, because the agents have waited for answers
  std::this_thread::sleep_until(in_seconds(10));
  for (auto& watcher : watchers) watcher->end();
  const auto newest = watchers.front()->arrivals();
  cutting.end = answers.of(newest.back().frame.to).value_or(cutting.end);
  for (std::size_t n = 0; n < watchers.size(); ++n) {
    print(kBudgets.at(n), *watchers[n], newest, cutting, answers);
  }
  return 0;
}
