// SPDX-License-Identifier: Apache-2.0
#include "tests/agent/stability/test_bed.h"

#include <array>
#include <chrono>
#include <future>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "haptic_agent/link/control_message.h"

namespace kerf::agent {
namespace {

/// The link sends acknowledgements and pings at least this often.
constexpr std::uint64_t kHousekeepingUs = 10'000;

}  // namespace

TestBed::TestBed(const std::string& scene, HapticDevice& device, ServoSettings settings,
                 const LineQuality& quality, bool copy, std::uint32_t seed, bool intent)
    : up_(quality, 2 * seed), down_(quality, 2 * seed + 1), another_up_(quality, ~seed) {
  // Virtual time runs faster than the session's rate limits permit.
  SessionLimits limits;
  limits.samples_per_s = limits.samples_burst = 1e12;
  registry_.emplace(
      RegistryOptions{folder_.path(), 4, limits}, [this](const std::string&) { return executor_; },
      workers_);
  auto created = registry_->create("bed", scene, SceneSource{});
  if (!created) throw std::runtime_error(created.error().reason);
  session_ = *created;
  join(limits, copy, intent);
  traffic_ = std::make_unique<Traffic>(samples_, wrenches_,
                                       TrafficOptions{.copy = copy ? &copy_ : nullptr});
  const auto control = parse_control(welcome_);
  if (!control) throw std::runtime_error(control.error().reason);
  const auto& welcome = std::get<Welcome>(*control);
  settings.model.law = welcome.law;
  settings.pivot_mm = welcome.pivot_mm;
  settings = settings_for(device.capabilities(), settings);
  const auto guides = guides_of(welcome_);
  if (!guides) throw std::runtime_error(guides.error());
  if (!guides->empty()) guidance_.emplace(*guides, settings, 1.0);
  servo_ =
      std::make_unique<ServoCycle>(device, samples_, wrenches_, listener_, settings,
                                   copy ? &exchange_ : nullptr, guidance_ ? &*guidance_ : nullptr);
  traffic_->begin(session_->epoch(), 0, now_us_);
}

/// Sends the hello and creates the replica from the welcome.
void TestBed::join(const SessionLimits& limits, bool copy, bool intent) {
  conversation_ = std::make_unique<net::AgentConversation>(
      net::AgentConversation::Setup{.session = session_,
                                    .limits = limits,
                                    .metrics = metrics_,
                                    .now = [this] { return time(); },
                                    .wake = {},
                                    .open_udp = {}});
  const std::string hello = std::string(R"({"type":"hello","name":"hand","stock":)") +
                            (copy ? "true" : "false") + R"(,"intent":)" +
                            (copy && intent ? "true" : "false") + R"(,"returned":)" +
                            (copy ? "true}" : "false}");
  conversation_->receive(std::as_bytes(std::span(hello)), true, time());
  net::OutFrame welcome;
  if (!conversation_->take(welcome)) throw std::runtime_error("the server sends no welcome");
  welcome_.assign(reinterpret_cast<const char*>(welcome.bytes.data()), welcome.bytes.size());
  if (!copy) return;
  auto source = BlockSource::read(welcome_);
  if (!source) throw std::runtime_error(source.error());
  copy_.replica.emplace(*std::move(source));
}

void TestBed::Copy::take_stock(std::span<const std::byte> frame) {
  const auto message = wire::decode(frame);
  if (const auto* intents = std::get_if<wire::Intents>(&message->body)) {
    return replica->take(*intents);
  }
  if (!replica->take(std::get<wire::StockPatch>(message->body))) {
    throw std::runtime_error("the replica rejects a patch of the server");
  }
}

void TestBed::Copy::answer(ReplicaExchange& servo, std::uint64_t now_us) {
  if (!servo.is_woken()) return;
  servo.wait();
  wire::MotionSample sample;
  while (servo.pop(sample)) {
    if (const auto mine = replica->move(sample)) servo.write(answer_of(*mine, now_us));
  }
}

void TestBed::serve(std::span<const std::byte> frame) {
  const bool is_text = !frame.empty() && frame.front() == std::byte{'{'};
  conversation_->receive(frame, is_text, time());
  while (conversation_->has_action()) conversation_->work();
  send_answers();
  conversation_->refresh();
  send_answers();
}

void TestBed::send_answers() {
  net::OutFrame out;
  while (conversation_->take(out)) {
    if (out.is_text()) {
      const std::string_view text(reinterpret_cast<const char*>(out.bytes.data()),
                                  out.bytes.size());
      // The link would report these: the participants, and that stock is around the tool.
      const bool is_notice = !text.contains("\"error\"") || text.contains("\"in_stock\"");
      if (!is_notice) throw std::runtime_error(std::string(text));
      continue;
    }
    if (out.kind == net::OutFrame::Kind::kResult) {
      const auto message = wire::decode(out.bytes);
      newest_ = std::get<wire::Result>(message->body);
    }
    down_.send(out.bytes, now_us_);
  }
}

void TestBed::another_cuts_to(Vec3 tip_mm) {
  wire::MotionBatch batch{.count = 1};
  wire::MotionSample& sample = batch.samples[0];
  sample.agent_sequence = ++another_sequence_;
  sample.time_us = now_us_;
  sample.tip_mm = tip_mm;
  sample.tool_id = session_->scene()->tools.begin()->first;
  sample.buttons = wire::kButtonCutting;
  std::vector<std::byte> bytes;
  wire::append(bytes, {}, batch);
  another_up_.send(bytes, now_us_);
}

void TestBed::another_arrives(std::span<const std::byte> bytes) {
  if (another_ == 0) {
    another_ = session_->join({.kind = ParticipantKind::kAgent, .name = "another", .color = ""})
                   .value()
                   .id;
  }
  session_->move(another_, std::get<wire::MotionBatch>(wire::decode(bytes)->body).view());
}

void TestBed::tick(bool runs) {
  now_us_ += 1000;
  if (runs) servo_->tick(now_us_);
  if (copy_.replica) copy_.answer(exchange_, now_us_);
  if (std::exchange(listener_.is_woken, false) || now_us_ % kHousekeepingUs == 0) send();
  another_up_.receive(now_us_,
                      [this](std::span<const std::byte> bytes) { another_arrives(bytes); });
  up_.receive(now_us_, [this](std::span<const std::byte> bytes) { serve(bytes); });
  down_.receive(now_us_,
                [this](std::span<const std::byte> bytes) { traffic_->take_frame(bytes, now_us_); });
  run_session();
}

/// Runs posted work. Background work waits for the session's thread, which is this one, so it needs
/// another thread.
void TestBed::run_session() {
  executor_->run();
  if (workers_.waiting() == 0) return;
  constexpr std::chrono::microseconds kPause{50};
  const auto done = std::async(std::launch::async, [this] { workers_.run(); });
  while (done.wait_for(kPause) != std::future_status::ready) executor_->run();
  executor_->run();
}

/// Does the work of the link thread after a wake-up.
void TestBed::send() {
  traffic_->collect();
  std::array<std::byte, wire::kMaxClientFrameBytes> frame;
  for (;;) {
    if (const std::string text = traffic_->take_control(now_us_); !text.empty()) {
      up_.send(std::as_bytes(std::span(text)), now_us_);
      continue;
    }
    const std::size_t bytes = traffic_->fill(now_us_, frame);
    if (bytes == 0) break;
    up_.send(std::span(frame).first(bytes), now_us_);
  }
}

}  // namespace kerf::agent
