// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/page.h"

#include <array>
#include <boost/asio/as_tuple.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <charconv>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "server/websocket/web_socket.h"
#include "server/wire/codec.h"
#include "server/wire/control.h"
#include "server/wire/limits.h"

namespace kerf::sim {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using Json = nlohmann::json;

constexpr net::WebSocketLimits kLimits{.handshake = std::chrono::seconds(8),
                                       .idle = std::chrono::seconds(6),
                                       .message_bytes = wire::kMaxServerFrameBytes};
constexpr auto kAwait = asio::as_tuple(asio::use_awaitable);

}  // namespace

/// One connection.
struct Page::Visit {
  Visit(Page& visitor, int to) : page(visitor), port(to), leaves(io) {}

  asio::awaitable<void> run();
  asio::awaitable<void> leave(std::chrono::milliseconds after);
  /// Takes what has come; false: the connection is of no use any more.
  asio::awaitable<bool> take();

  Page& page;
  int port;
  asio::io_context io;
  asio::steady_timer leaves;
  std::unique_ptr<net::WebSocket> socket;
  std::uint32_t epoch = 0;
  std::uint64_t meshes = 0;
};

Page::Page(std::string session, std::vector<int> ports, std::uint64_t seed, std::string token)
    : session_(std::move(session)),
      token_(std::move(token)),
      ports_(std::move(ports)),
      random_(seed | 1) {}

void Page::take_text(const std::string& text) {
  const Json message = Json::parse(text);
  if (message.at("type") == "error") errors_.push_back(message.at("reason"));
  if (message.at("type") != "state") return;
  const std::string hash = message.at("state_hash");
  std::uint64_t number = 0;
  std::from_chars(hash.data(), hash.data() + hash.size(), number, 16);
  shown_ = message.at("settled").get<bool>() ? number : 0;
}

asio::awaitable<bool> Page::Visit::take() {
  if (socket->is_text()) {
    const std::string text(socket->text());
    const Json message = Json::parse(text);
    if (message.at("type") == "welcome") epoch = message.at("epoch");
    if (message.at("type") == "bye") {
      page.byes_.push_back(message.at("reason"));
      co_return false;
    }
    page.take_text(text);
    co_return true;
  }
  const auto frame = wire::decode(socket->message());
  if (!frame) {
    page.wrong_.push_back("a frame that is none: " + std::string(frame.error().reason));
    co_return false;
  }
  if (!std::holds_alternative<wire::MeshView>(frame->body)) co_return true;
  if (frame->header.stamp.sequence != ++meshes) {
    page.wrong_.push_back("mesh frame " + std::to_string(frame->header.stamp.sequence) +
                          " came as the " + std::to_string(meshes) + "th");
  }
  std::array<std::byte, 64> bytes{};
  const wire::FrameStamp stamp{.epoch = epoch, .sequence = meshes, .time_us = 0};
  const std::size_t size = wire::encode(stamp, wire::Ack{}, bytes);
  co_return !co_await socket->write(false, asio::buffer(bytes.data(), size));
}

asio::awaitable<void> Page::Visit::leave(std::chrono::milliseconds after) {
  constexpr std::chrono::milliseconds kLook{50};
  for (auto left = after; (left.count() > 0 || page.stays_) && !page.ends_; left -= kLook) {
    leaves.expires_after(kLook);
    (void)co_await leaves.async_wait(kAwait);
  }
  if (socket) socket->cut();
}

asio::awaitable<void> Page::Visit::run() {
  tcp::socket tcp(io);
  const tcp::endpoint place(asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(port));
  const auto [unconnected] = co_await tcp.async_connect(place, kAwait);
  if (unconnected) co_return;
  socket = std::make_unique<net::WebSocket>(std::move(tcp), kLimits);
  const auto answer = co_await socket->shake_hands("127.0.0.1:" + std::to_string(port),
                                                   "/v1/sessions/" + page.session_ + "/view",
                                                   wire::kViewProtocol, page.token_);
  if (answer.error || answer.declined_status != 0) co_return;
  const std::string hello = R"({"type":"hello","name":"page","changes":true})";
  if (co_await socket->write(true, asio::buffer(hello))) co_return;
  while (!page.ends_) {
    if (co_await socket->read()) co_return;
    if (!co_await take()) co_return;
  }
}

void Page::visit(int port) {
  Visit visit(*this, port);
  random_ = random_ * 6364136223846793005 + 1442695040888963407;
  asio::co_spawn(visit.io, visit.leave(std::chrono::milliseconds((random_ >> 33) % 6000)),
                 asio::detached);
  asio::co_spawn(visit.io, visit.run(), [&](const std::exception_ptr&) { visit.io.stop(); });
  visit.io.run();
  shown_ = 0;
}

void Page::run() {
  for (std::size_t n = random_; !ends_; ++n) {
    visit(ports_[n % ports_.size()]);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
}

void Page::start() {
  thread_ = std::thread([this] { run(); });
}

bool Page::shows(std::uint64_t hash, Time patience) {
  stays_ = true;
  const Time end = now() + patience;
  while (shown_ != hash) {
    if (now() >= end) return false;
    sleep_until(now() + 20 * kMillisecond);
  }
  return true;
}

void Page::stop() {
  ends_ = true;
  thread_.join();
}

}  // namespace kerf::sim
