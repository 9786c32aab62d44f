// SPDX-License-Identifier: Apache-2.0
#include "server/socket/websocket.h"

#include <chrono>

namespace kerf::net {

namespace websocket = boost::beast::websocket;

void prepare(WebSocket& socket, std::string_view protocol) {
  boost::beast::get_lowest_layer(socket).expires_never();  // the WebSocket has deadlines of its own
  websocket::stream_base::timeout timeout{};
  timeout.handshake_timeout = std::chrono::seconds(5);
  timeout.idle_timeout = std::chrono::seconds(20);
  timeout.keep_alive_pings = true;
  socket.set_option(timeout);
  socket.set_option(websocket::stream_base::decorator(
      [name = std::string(protocol)](websocket::response_type& response) {
        response.set(boost::beast::http::field::sec_websocket_protocol, name);
        response.set(boost::beast::http::field::server, "kerf");
      }));
  socket.auto_fragment(false);
  socket.read_message_max(kFrameReadMax);
}

std::uint64_t clock_us() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(
                                        std::chrono::steady_clock::now().time_since_epoch())
                                        .count());
}

}  // namespace kerf::net
