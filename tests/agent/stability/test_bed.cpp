// SPDX-License-Identifier: Apache-2.0
#include "tests/agent/stability/test_bed.h"

#include <array>
#include <stdexcept>

namespace kerf::agent {

TestBed::TestBed(const std::string& scene, HapticDevice& device, ServoSettings settings,
                 const LineQuality& quality, bool copy, std::uint32_t seed)
    : up_(quality, 2 * seed), down_(quality, 2 * seed + 1) {
  // Virtual time runs faster than the session's rate limits permit.
  SessionLimits limits;
  limits.samples_per_s = limits.samples_burst = 1e12;
  registry_.emplace(
      RegistryOptions{folder_.path(), 4, limits}, [this](const std::string&) { return executor_; },
      workers_);
  auto created = registry_->create("bed", scene, SceneSource{});
  if (!created) throw std::runtime_error(created.error().reason);
  session_ = *created;
  self_ =
      session_->join({.kind = ParticipantKind::kAgent, .name = "hand", .color = "", .stock = copy})
          .value()
          .id;
  if (copy) make_replica();
  traffic_ = std::make_unique<Traffic>(samples_, wrenches_,
                                       TrafficOptions{.copy = copy ? &copy_ : nullptr});
  const ForceSettings& force = session_->scene().settings.force;
  settings.model.law =
      force.law == ForceLaw::kDexelRemovalRate ? CutLaw::kRemovalRate : CutLaw::kSpecificEnergy;
  settings.pivot_mm = force.pivot_mm;
  servo_ = std::make_unique<ServoCycle>(device, samples_, wrenches_, listener_,
                                        settings_for(device.capabilities(), settings),
                                        copy ? &exchange_ : nullptr);
  traffic_->begin(session_->epoch(), 0, now_us_);
}

/// Creates the replica from the fields of a welcome.
void TestBed::make_replica() {
  const Scene& scene = session_->scene();
  auto source = BlockSource::read(R"({"stock":)" + stock_json(scene) + R"(,"tools":)" +
                                  tools_json(scene) + R"(,"force":)" + force_json(scene) +
                                  R"(,"accuracy":)" + accuracy_json(scene) + "}");
  if (!source) throw std::runtime_error(source.error());
  copy_.replica.emplace(*std::move(source));
}

void TestBed::Copy::take_stock(std::span<const std::byte> frame) {
  const auto message = wire::decode(frame);
  if (!replica->take(std::get<wire::StockPatch>(message->body))) {
    throw std::runtime_error("the replica rejects a patch of the server");
  }
}

void TestBed::Copy::answer(ReplicaExchange& servo, std::uint64_t now_us) {
  wire::MotionSample sample;
  while (servo.pop(sample)) {
    if (const auto mine = replica->move(sample)) servo.write(answer_of(*mine, now_us));
  }
}

/// As the server: at most every 20 ms.
void TestBed::send_stock() {
  if (now_us_ < sent_us_ + 20'000) return;
  const auto update = session_->stock_update(self_);
  if (!update) return;
  sent_us_ = now_us_;
  std::vector<std::byte> frame;
  wire::append(frame, {session_->epoch(), update->sequence, now_us_}, update->patch());
  down_.send(frame, now_us_);
}

void TestBed::serve(std::span<const std::byte> frame) {
  const auto message = wire::decode(frame);
  if (!message) throw std::runtime_error("a frame of the agent is malformed");
  std::array<std::byte, wire::kHeaderBytes + wire::kMaxResultBytes> answer;
  std::size_t bytes = 0;
  if (const auto* batch = std::get_if<wire::MotionBatch>(&message->body)) {
    newest_ = session_->move(self_, batch->view()).result;
    bytes = wire::encode({session_->epoch(), ++results_, now_us_}, newest_, answer);
    send_stock();
  } else if (std::holds_alternative<wire::Ack>(message->body)) {
    session_->ack_stock(self_, message->header.stamp.sequence).value();
    return;
  } else if (const auto* ping = std::get_if<wire::Ping>(&message->body)) {
    bytes =
        wire::encode({session_->epoch(), 1, now_us_}, wire::Pong{ping->time_us, now_us_}, answer);
  }
  down_.send(std::span(answer).first(bytes), now_us_);
}

void TestBed::another_cuts_to(Vec3 tip_mm) {
  if (another_ == 0) {
    another_ = session_->join({.kind = ParticipantKind::kAgent, .name = "another", .color = ""})
                   .value()
                   .id;
  }
  wire::MotionSample sample;
  sample.agent_sequence = ++another_sequence_;
  sample.time_us = now_us_;
  sample.tip_mm = tip_mm;
  sample.tool_id = session_->scene().tools.begin()->first;
  sample.buttons = wire::kButtonCutting;
  session_->move(another_, {&sample, 1});
}

void TestBed::tick() {
  now_us_ += 1000;
  servo_->tick(now_us_);
  if (copy_.replica) copy_.answer(exchange_, now_us_);
  traffic_->collect();
  traffic_->take_control();
  std::array<std::byte, wire::kMaxClientFrameBytes> frame;
  while (const std::size_t bytes = traffic_->fill(now_us_, frame)) {
    up_.send(std::span(frame).first(bytes), now_us_);
  }
  up_.receive(now_us_, [this](std::span<const std::byte> bytes) { serve(bytes); });
  down_.receive(now_us_,
                [this](std::span<const std::byte> bytes) { traffic_->take_frame(bytes, now_us_); });
  executor_->run();
}

}  // namespace kerf::agent
