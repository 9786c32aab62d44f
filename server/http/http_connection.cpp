// SPDX-License-Identifier: Apache-2.0
#include "server/http/http_connection.h"

#include <array>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "server/http/beast_head.h"
#include "server/http/proxies.h"
#include "server/http/request_head.h"
#include "server/http/response_head.h"
#include "server/http/responses.h"
#include "server/metrics/metrics.h"
#include "server/platform/clock.h"
#include "server/socket/serve_peer.h"
#include "server/threads/run_in_turn.h"
#include "server/threads/run_on.h"
#include "server/wire/limits.h"

namespace kerf::net {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using boost::system::error_code;
using Parser = http::request_parser<http::string_body>;

constexpr std::uint32_t kHeaderBytesMax = 8 * 1024;
constexpr std::chrono::seconds kHandshakeTime{5}, kHeaderTime{10}, kIdleTime{60}, kChunkTime{30};
constexpr std::chrono::seconds kLingerTime{2};
/// How long a request waits for a session that is being loaded.
constexpr std::chrono::seconds kLoadTime{wire::kLoadWaitS};
constexpr std::chrono::milliseconds kLoadPoll{5};
constexpr std::size_t kLingerBytes = std::size_t{4} << 20, kLingerChunk = std::size_t{16} * 1024;
constexpr std::size_t kFileChunk = std::size_t{256} * 1024;

std::string address_of(const asio::ip::tcp::socket& socket) {
  error_code error;
  const auto peer = socket.remote_endpoint(error);
  return error ? std::string() : peer.address().to_string();
}

class Connection {
 public:
  Connection(ByteStream stream, HttpContext& context)
      : stream_(std::move(stream)),
        is_secure_(stream_.tls() != nullptr),
        address_(address_of(stream_.socket())),
        deadline_(stream_.get_executor()),
        context_(context),
        place_(context.open.enter(network_of(address_), [this] { stream_.close(); })) {
    ++context_.metrics.connections;
  }
  ~Connection() { --context_.metrics.connections; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  asio::awaitable<void> run();

 private:
  /// Performs the TLS handshake, if any. Returns false if the connection is unusable.
  asio::awaitable<bool> secure();
  asio::awaitable<bool> serve_one();
  /// Extracts the head of a request, including its sender.
  RequestHead understand(const BeastRequest& request) const;
  /// Closes the connection after this time unless called again before.
  void expires_after(std::chrono::seconds time);
  void end_deadline();
  asio::awaitable<bool> read_body(Parser& parser, std::size_t bytes_max);
  asio::awaitable<bool> answer(const RequestHead& head, ApiResponse& response, bool keep_alive);
  asio::awaitable<void> wait_until_loaded(const ApiRequest& target, bool only_looks);
  asio::awaitable<ApiResponse> handle(ApiRequest& request, Runs runs, const Caller& caller);
  void watch(const JobStops::Source& gone);
  asio::awaitable<bool> reject_malformed();
  asio::awaitable<void> send(std::string_view first, std::string_view second);
  asio::awaitable<void> send_text(std::string_view text);
  asio::awaitable<void> send_file(const OpenFile& file, const ByteRange& part);
  asio::awaitable<bool> reject(const RequestHead& head, unsigned status, std::string_view code,
                               std::string_view reason);
  asio::awaitable<void> linger();
  asio::awaitable<void> upgrade(const BeastRequest& request, const RequestHead& head,
                                const ApiRequest& target);

  ByteStream stream_;
  bool is_secure_;
  std::string address_;  ///< of the peer
  asio::steady_timer deadline_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
  beast::flat_buffer buffer_;
  HttpContext& context_;
  OpenConnections::Place place_;
  bool first_ = true;
  error_code error_;
  UploadBudget::Share upload_;  ///< for the body being read or handled
};

asio::awaitable<ApiResponse> Connection::handle(ApiRequest& request, Runs runs,
                                                const Caller& caller) {
  FairQueue* const queue = context_.turns_of(runs);
  JobStops::Source gone;
  if (queue != nullptr) {
    // A request that closes a session must not be stopped by that.
    const bool is_of_session = runs != Runs::kWork && is_below_session(request.path);
    gone = context_.api.begin_job(is_of_session ? request.path[2] : std::string());
    request.stop = gone->get_token();
  }
  auto work = [&api = context_.api, request = std::move(request)] {
    try {
      return api.handle(request);
    } catch (const std::exception& error) {
      return exception_response(error);
    }
  };
  end_deadline();
  if (queue == nullptr) co_return co_await run_on(context_.immediate, std::move(work));
  if (runs == Runs::kRead || runs == Runs::kExport) watch(gone);
  std::string client = caller.client();
  std::stop_token stop = gone->get_token();
  auto done = co_await run_in_turn(*queue, std::move(client), std::move(stop), std::move(work));
  co_return done ? *std::move(done) : stopped();
}

/// Requests a stop if the client closes the connection while its request is being handled.
void Connection::watch(const JobStops::Source& gone) {
  auto readable = [this, job = std::weak_ptr(gone),
                   alive = std::weak_ptr(alive_)](error_code error) {
    const auto source = job.lock();
    if (!source || alive.expired()) return;  // the request has been handled
    if (error || stream_.has_peer_ended()) source->request_stop();
  };
  stream_.socket().async_wait(asio::ip::tcp::socket::wait_read, std::move(readable));
}

/// Do not use cancel(): a handler already queued would close the connection.
void Connection::end_deadline() { deadline_.expires_at(Clock::time_point::max()); }

void Connection::expires_after(std::chrono::seconds time) {
  deadline_.expires_after(time);
  deadline_.async_wait([this, alive = std::weak_ptr(alive_)](error_code error) {
    // Ignore a wait that ended before the deadline was moved.
    if (error || alive.expired() || deadline_.expiry() > Clock::now()) return;
    stream_.close();
  });
}

asio::awaitable<bool> Connection::secure() {
  expires_after(kHandshakeTime);
  error_ = co_await stream_.shake_hands();
  if (!error_) co_return true;
  context_.metrics.rejected("tls");
  if (stream_.tls() == nullptr || !stream_.tls()->is_peer_plain()) co_return false;
  stream_.release_tls();
  const RequestHead unknown;
  co_return co_await reject(unknown, 400, "tls_required", "this port speaks TLS: use https://");
}

RequestHead Connection::understand(const BeastRequest& request) const {
  RequestHead head = head_of(request);
  head.is_secure = is_secure_;
  head.address = address_;
  apply_forwarding(head, context_.options.proxies);
  return head;
}

asio::awaitable<void> Connection::run() {
  bool more = co_await secure();
  while (more) more = co_await serve_one();
  if (stream_.socket().is_open()) co_await linger();
}

asio::awaitable<bool> Connection::serve_one() {
  Parser parser;
  parser.header_limit(kHeaderBytesMax);
  parser.body_limit(kModelBytesMax);
  expires_after(std::exchange(first_, false) ? kHeaderTime : kIdleTime);
  co_await http::async_read_header(stream_, buffer_, parser,
                                   asio::redirect_error(asio::use_awaitable, error_));
  if (error_) co_return co_await reject_malformed();
  const RequestHead head = understand(parser.get());
  auto request = screen(head, context_.options);
  if (!request) co_return co_await answer(head, request.error(), false);
  // Callers without rights to a session must not learn that it is loading.
  Caller caller;
  const RouteMatch match = context_.api.routes().match(request->method, request->path);
  auto rejection = context_.api.refuse(*request, match, caller);
  if (!rejection) co_await wait_until_loaded(*request, only_looks(match));
  if (beast::websocket::is_upgrade(parser.get())) {
    co_await upgrade(parser.get(), head, *request);
    co_return false;
  }
  if (!head.reads_only() && !origin_allowed(head.browser(), context_.options)) {
    ApiResponse foreign = foreign_origin();
    co_return co_await answer(head, foreign, false);
  }
  if (request->method == "OPTIONS" && !head.origin.empty() && !match.allow.empty()) {
    ApiResponse allowed = preflight(match.allow);
    const bool has_body = is_encoded(parser.get()) || parser.content_length().value_or(0) > 0;
    co_return co_await answer(head, allowed, parser.get().keep_alive() && !has_body);
  }
  if (rejection) co_return co_await answer(head, *rejection, false);
  if (!co_await read_body(parser, body_bytes_max(match, request->method))) co_return false;
  request->body = std::move(parser.get().body());
  const bool keep_alive = parser.get().keep_alive();
  const Runs runs = match.route == nullptr ? Runs::kAtOnce : match.route->runs;
  ApiResponse response = co_await handle(*request, runs, caller);
  upload_ = {};
  co_return co_await answer(head, response, keep_alive);
}

asio::awaitable<void> Connection::wait_until_loaded(const ApiRequest& target, bool only_looks) {
  const std::string id = is_below_session(target.path) ? target.path[2] : "";
  if (id.empty() || !is_coming(context_.registry, id, only_looks)) co_return;
  context_.registry.hasten(id);
  end_deadline();
  ++context_.metrics.waiting_to_load;
  asio::steady_timer pause(stream_.get_executor());
  const auto end = Clock::now() + kLoadTime;
  while (is_coming(context_.registry, id, only_looks) && Clock::now() < end) {
    pause.expires_after(kLoadPoll);
    co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error_));
  }
  --context_.metrics.waiting_to_load;
}

asio::awaitable<bool> Connection::reject_malformed() {
  const bool is_http =
      error_.category() == http::make_error_code(http::error::bad_method).category() &&
      error_ != http::error::end_of_stream && error_ != http::error::partial_message;
  if (!is_http) co_return false;
  const RequestHead unknown;
  if (error_ == http::error::header_limit) {
    co_return co_await reject(unknown, 431, "too_large", "the request header is larger than 8 kB");
  }
  if (error_ == http::error::body_limit) {
    co_return co_await reject(unknown, 413, "too_large", "the request body is larger than 64 MB");
  }
  const std::string reason = error_.message();
  co_return co_await reject(unknown, 400, "bad_request", reason);
}

asio::awaitable<bool> Connection::read_body(Parser& parser, std::size_t bytes_max) {
  const auto length = parser.content_length();
  const RequestHead head = understand(parser.get());
  // Memory is reserved by Content-Length, and an unknown coding does not define the end of the
  // body.
  if (is_encoded(parser.get())) {
    co_return co_await reject(head, 411, "length_required", "the body needs a Content-Length");
  }
  if (length && *length > bytes_max) {
    const std::string reason = "the body has " + std::to_string(*length) + " bytes; the limit is " +
                               std::to_string(bytes_max);
    co_return co_await reject(head, 413, "too_large", reason);
  }
  const std::size_t bytes = length.value_or(0);
  if (bytes > 0) {
    auto share = context_.api.begin_upload(head.address, bytes);
    if (!share) co_return co_await answer(head, share.error(), false);
    upload_ = *std::move(share);
  }
  if (beast::iequals(parser.get()[http::field::expect], "100-continue")) {
    static constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
    co_await send(kContinue, {});
    if (error_) co_return false;
  }
  const UploadPace& pace = context_.options.upload_pace;
  const auto end = Clock::now() + pace.time_for(bytes);
  while (!error_ && !parser.is_done()) {
    if (Clock::now() > end) {
      // Release the memory now: the peer may take seconds to close the connection.
      upload_ = {};
      const std::string reason = pace.too_slow();
      co_return co_await reject(head, 408, "too_slow", reason);
    }
    expires_after(kChunkTime);
    co_await http::async_read_some(stream_, buffer_, parser,
                                   asio::redirect_error(asio::use_awaitable, error_));
  }
  if (error_) upload_ = {};
  co_return !error_;
}

// The parameters are references and views because g++ 12 destroys some temporaries in the arguments
// of awaited calls twice.
asio::awaitable<bool> Connection::reject(const RequestHead& head, unsigned status,
                                         std::string_view code, std::string_view reason) {
  ApiResponse response = error_response(status, code, reason);
  co_return co_await answer(head, response, false);
}

/// Drains the connection before closing it. Closing at once would reset it, and the peer might not
/// receive the response.
asio::awaitable<void> Connection::linger() {
  error_code ignored;
  stream_.end_sending();
  expires_after(kLingerTime);
  std::vector<char> rest(kLingerChunk);
  for (std::size_t read = 0; read < kLingerBytes && !ignored;) {
    read += co_await stream_.socket().async_read_some(
        asio::buffer(rest), asio::redirect_error(asio::use_awaitable, ignored));
  }
}

asio::awaitable<bool> Connection::answer(const RequestHead& head, ApiResponse& response,
                                         bool keep_alive) {
  context_.metrics.http_answered(response.status);
  add_browser_headers(head.browser(), context_.options, response);
  const std::string first = response_head(
      response, {.version = head.version,
                 .reason = view(http::obsolete_reason(static_cast<http::status>(response.status))),
                 .keep_alive = keep_alive});
  const bool has_body = head.method != "HEAD";
  co_await send(first, has_body ? response.body : std::string_view());
  if (has_body && response.text) co_await send_text(*response.text);
  if (has_body && response.file) {
    const ByteRange part = response.part.value_or(ByteRange{0, response.file->bytes()});
    co_await send_file(*response.file, part);
  }
  co_return !error_ && keep_alive;
}

asio::awaitable<void> Connection::send(std::string_view first, std::string_view second) {
  const std::array<asio::const_buffer, 2> parts = {asio::buffer(first), asio::buffer(second)};
  expires_after(kChunkTime);
  co_await asio::async_write(stream_, parts, asio::redirect_error(asio::use_awaitable, error_));
}

asio::awaitable<void> Connection::send_text(std::string_view text) {
  for (std::size_t offset = 0; offset < text.size() && !error_; offset += kFileChunk) {
    const std::string_view chunk = text.substr(offset, kFileChunk);
    co_await send(chunk, {});
  }
}

asio::awaitable<void> Connection::send_file(const OpenFile& file, const ByteRange& part) {
  std::vector<char> chunk(std::min<std::uint64_t>(kFileChunk, part.count));
  const std::uint64_t end = part.first + part.count;
  for (std::uint64_t offset = part.first; offset < end && !error_;) {
    const std::size_t count = std::min<std::uint64_t>(chunk.size(), end - offset);
    const std::size_t size = file.read(offset, chunk.data(), count);
    if (size == 0) {
      error_ = asio::error::broken_pipe;  // the announced length cannot be sent: close
      co_return;
    }
    const std::string_view bytes(chunk.data(), size);
    co_await send(bytes, {});
    offset += size;
  }
}

asio::awaitable<void> Connection::upgrade(const BeastRequest& request, const RequestHead& head,
                                          const ApiRequest& target) {
  auto open = open_upgrade(head, target, context_.api, context_.registry, context_.options);
  if (open && buffer_.size() != 0) {
    open = std::unexpected(
        error_response(400, "bad_request", "data was sent before the connection was upgraded"));
  }
  if (!open) {
    co_await answer(head, open.error(), false);
    co_return;
  }
  context_.metrics.http_answered(101);
  UpgradeRequest handshake;
  handshake.message.base() = request.base();
  end_deadline();
  place_.leave();
  if (!open->session) {
    serve_redirect(std::move(stream_), std::move(handshake), open->protocol, open->redirect);
  } else if (open->kind == Upgrade::kAgent) {
    context_.api.tell_regions(*open->session);
    serve_agent(std::move(stream_), std::move(handshake), std::move(open->session),
                std::move(open->caller), context_.peers);
  } else {
    serve_viewer(std::move(stream_), std::move(handshake), std::move(open->session),
                 std::move(open->caller), context_.peers);
  }
}

}  // namespace

asio::awaitable<void> serve_http(asio::ip::tcp::socket socket, HttpContext& context) {
  std::unique_ptr<TlsChannel> tls;
  if (context.certificate != nullptr)
    tls = std::make_unique<TlsChannel>(context.certificate->current(), socket.native_handle());
  Connection connection(ByteStream(std::move(socket), std::move(tls)), context);
  co_await connection.run();
}

}  // namespace kerf::net
