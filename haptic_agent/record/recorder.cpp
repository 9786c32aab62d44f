// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/record/recorder.h"

#include <chrono>
#include <ctime>
#include <sstream>
#include <utility>

#include "haptic_agent/plain_number.h"
#include "haptic_agent/realtime/clock.h"
#include "haptic_agent/record/tick_message.h"

namespace kerf::agent {
namespace {

constexpr std::uint64_t kNsPerUs = 1000;
/// Length of a chunk. A kill loses at most the ticks of one chunk and of one read of the tape.
constexpr std::uint64_t kChunkUs = 1'000'000;

std::uint64_t utc_ns() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * kNsPerS + static_cast<std::uint64_t>(now.tv_nsec);
}

}  // namespace

std::string record_text(const RecordReport& report) {
  constexpr double kMega = 1e6;
  constexpr int kDigits = 3;
  std::ostringstream out;
  out << "record   " << report.ticks << " ticks in " << report.file << " ("
      << plain_number(static_cast<double>(report.bytes) / kMega, kDigits) << " MB), " << report.lost
      << " lost";
  if (!report.error.empty()) out << ": " << report.error;
  return out.str();
}

std::expected<std::unique_ptr<Recorder>, std::string> Recorder::start(const std::string& file,
                                                                      const mcap::Texts& about,
                                                                      std::string_view welcome) {
  auto writer = mcap::McapWriter::create(file, tick_channel());
  if (!writer) return std::unexpected(writer.error());
  const std::uint64_t now_ns = utc_ns();
  const std::uint64_t offset_ns = now_ns - monotonic_ns();
  mcap::Texts texts = about;
  texts["utc_minus_monotonic_ns"] = std::to_string(offset_ns);
  const bool written = writer->metadata("kerf", texts) &&
                       writer->attachment("welcome.json", "application/json", now_ns, welcome);
  if (!written) return std::unexpected(writer->error());
  return std::unique_ptr<Recorder>(new Recorder(file, *std::move(writer), offset_ns));
}

Recorder::Recorder(std::string file, mcap::McapWriter writer, std::uint64_t utc_offset_ns)
    : file_(std::move(file)),
      writer_(std::move(writer)),
      utc_offset_ns_(utc_offset_ns),
      thread_([this](const std::stop_token& stop) {
        constexpr std::chrono::milliseconds kLookUp{100};
        while (!stop.stop_requested()) {
          drain();
          std::this_thread::sleep_for(kLookUp);
        }
      }) {}

Recorder::~Recorder() { end_thread(); }

void Recorder::end_thread() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void Recorder::drain() {
  for (TickRecord tick; tape_.pop(tick);) {
    ++taken_;
    if (!writer_.error().empty()) continue;
    if (writer_.waiting_bytes() > 0 && tick.time_us - chunk_start_us_ >= kChunkUs) {
      writer_.write_chunk();
    }
    if (writer_.waiting_bytes() == 0) chunk_start_us_ = tick.time_us;
    message_.clear();
    append_tick(message_, tick);
    writer_.message(static_cast<std::uint32_t>(tick.number),
                    tick.time_us * kNsPerUs + utc_offset_ns_, message_);
  }
}

RecordReport Recorder::finish(mcap::Texts result) {
  end_thread();
  drain();
  writer_.write_chunk();
  const std::uint64_t lost = tape_.lost() + taken_ - writer_.messages();
  result["ticks"] = std::to_string(writer_.messages());
  result["lost"] = std::to_string(lost);
  writer_.metadata("kerf_end", result);
  writer_.finish();
  return {.file = file_,
          .ticks = writer_.messages(),
          .lost = lost,
          .bytes = writer_.bytes(),
          .error = writer_.error()};
}

}  // namespace kerf::agent
