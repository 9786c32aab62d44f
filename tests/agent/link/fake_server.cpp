// SPDX-License-Identifier: Apache-2.0
#include "tests/agent/link/fake_server.h"

#include <sys/socket.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <mutex>
#include <thread>

#include "server/wire/codec.h"

namespace kerf::agent {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

class Peer final : public FakePeer {
 public:
  explicit Peer(tcp::socket socket) : socket_(std::move(socket)) {}

  bool accept(const FakeServer::Behaviour& behaviour, std::string& target) {
    error_code failed;
    beast::flat_buffer buffer;
    http::request<http::string_body> request;
    http::read(socket_.next_layer(), buffer, request, failed);
    if (failed) return false;
    target = std::string(request.target());
    if (behaviour.decline_status != 0) {
      http::response<http::string_body> response(
          static_cast<http::status>(behaviour.decline_status), request.version(),
          "no such block\n");
      response.prepare_payload();
      http::write(socket_.next_layer(), response, failed);
      return false;
    }
    socket_.set_option(websocket::stream_base::decorator([&](websocket::response_type& response) {
      response.set(http::field::sec_websocket_protocol, behaviour.protocol);
    }));
    socket_.accept(request, failed);
    return !failed;
  }

  std::optional<std::string> read_text() override {
    if (!texts.empty()) {
      std::string text = texts.front();
      texts.erase(texts.begin());
      return text;
    }
    while (read_frame()) {
      if (socket_.got_text()) return beast::buffers_to_string(frame_.data());
    }
    return std::nullopt;
  }

  std::optional<wire::MotionBatch> read_motion() override {
    while (read_frame()) {
      if (socket_.got_text()) {
        texts.push_back(beast::buffers_to_string(frame_.data()));
        continue;
      }
      const auto message =
          wire::decode({static_cast<const std::byte*>(frame_.data().data()), frame_.size()},
                       wire::kMaxClientFrameBytes);
      if (!message) return std::nullopt;
      if (const auto* batch = std::get_if<wire::MotionBatch>(&message->body)) return *batch;
      if (const auto* ping = std::get_if<wire::Ping>(&message->body)) answer(*ping);
    }
    return std::nullopt;
  }

  bool send_text(const std::string& text) override {
    error_code failed;
    socket_.text(true);
    socket_.write(asio::buffer(text), failed);
    return !failed;
  }

  bool send_result(const wire::Result& result, std::uint32_t epoch) override {
    std::vector<std::byte> bytes;
    wire::append(bytes, {.epoch = epoch, .sequence = ++sequence_, .time_us = 1}, result);
    return send_bytes(bytes);
  }

  bool send_bytes(const std::vector<std::byte>& bytes) override {
    error_code failed;
    socket_.binary(true);
    socket_.write(asio::buffer(bytes), failed);
    return !failed;
  }

  void cut() override {
    error_code ignored;
    socket_.next_layer().shutdown(tcp::socket::shutdown_both, ignored);
    socket_.next_layer().close(ignored);
  }

  int handle() { return socket_.next_layer().native_handle(); }

 private:
  bool read_frame() {
    error_code failed;
    frame_.clear();
    socket_.read(frame_, failed);
    return !failed;
  }

  void answer(const wire::Ping& ping) {
    ++pings;
    std::vector<std::byte> bytes;
    wire::append(bytes, {.epoch = 1, .sequence = 1, .time_us = 1},
                 wire::Pong{.ping_time_us = ping.time_us, .time_us = ping.time_us + 5'000'000});
    send_bytes(bytes);
  }

  websocket::stream<tcp::socket> socket_;
  beast::flat_buffer frame_;
  std::uint64_t sequence_ = 0;
};

}  // namespace

class FakeServer::Impl {
 public:
  Impl(Serve serve, Behaviour behaviour)
      : serve_(std::move(serve)),
        behaviour_(std::move(behaviour)),
        acceptor_(io_, tcp::endpoint(asio::ip::make_address("127.0.0.1"), 0)),
        port_(acceptor_.local_endpoint().port()),
        thread_([this] { run(); }) {}

  ~Impl() {
    stopping_ = true;
    {
      // Unblocks a read that a failed test may have left pending.
      const std::scoped_lock lock(mutex_);
      if (handle_ >= 0) ::shutdown(handle_, SHUT_RDWR);
    }
    ::shutdown(acceptor_.native_handle(), SHUT_RDWR);
    thread_.join();
  }

  std::uint16_t port() const { return port_; }
  std::string target() const {
    const std::scoped_lock lock(mutex_);
    return target_;
  }

 private:
  void run() {
    for (int connection = 0; !stopping_;) {
      error_code failed;
      tcp::socket socket(io_);
      acceptor_.accept(socket, failed);
      if (failed || stopping_) return;
      Peer peer(std::move(socket));
      std::string target;
      const bool accepted = peer.accept(behaviour_, target);
      {
        const std::scoped_lock lock(mutex_);
        target_ = target;
        handle_ = peer.handle();
      }
      if (accepted) serve_(peer, connection++);
      const std::scoped_lock lock(mutex_);
      handle_ = -1;
    }
  }

  Serve serve_;
  Behaviour behaviour_;
  asio::io_context io_;
  tcp::acceptor acceptor_;
  std::uint16_t port_;
  std::atomic<bool> stopping_{false};
  mutable std::mutex mutex_;
  std::string target_;
  int handle_ = -1;
  std::thread thread_;
};

FakeServer::FakeServer(Serve serve, Behaviour behaviour)
    : impl_(std::make_unique<Impl>(std::move(serve), std::move(behaviour))) {}
FakeServer::~FakeServer() = default;
std::uint16_t FakeServer::port() const { return impl_->port(); }
std::string FakeServer::target() const { return impl_->target(); }

std::string welcome_text(std::uint32_t epoch) {
  return R"({"type":"welcome","session":"demo","participant":3,"epoch":)" + std::to_string(epoch) +
         R"(,"color":"#d9541e","rate_hz":1000,"pitch_mm":0.25,"pivot_mm":60,)"
         R"("stock":{"shape":"box","min_mm":[-50,-50,-50],"max_mm":[50,50,0]},)"
         R"("tools":[{"id":1,"shape":"ball"},{"id":2,"shape":"flat"}],"new":true,)"
         R"("limits":{"samples_per_message":16}})";
}

}  // namespace kerf::agent
