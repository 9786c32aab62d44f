// SPDX-License-Identifier: Apache-2.0
#include "server/http/response_head.h"

namespace kerf::net {
namespace {

void add_field(std::string& head, std::string_view name, std::string_view value) {
  head.append(name).append(": ").append(value).append("\r\n");
}

}  // namespace

std::uint64_t content_length(const ApiResponse& response) {
  if (response.text) return response.text->size();
  if (!response.file) return response.body.size();
  return response.part ? response.part->count : response.file->bytes();
}

std::string response_head(const ApiResponse& response, const ResponseFraming& framing) {
  std::string head = framing.version == 10 ? "HTTP/1.0 " : "HTTP/1.1 ";
  head.append(std::to_string(response.status)).append(" ").append(framing.reason).append("\r\n");
  add_field(head, "Server", "kerf");
  for (const auto& [name, value] : response.headers) add_field(head, name, value);
  if (!framing.keep_alive) add_field(head, "Connection", "close");
  if (framing.keep_alive && framing.version == 10) add_field(head, "Connection", "keep-alive");
  const bool has_body = response.status != 304 && response.status != 204;
  if (has_body) {
    add_field(head, "Content-Type", response.content_type);
    add_field(head, "Content-Length", std::to_string(content_length(response)));
  }
  return head.append("\r\n");
}

}  // namespace kerf::net
