// SPDX-License-Identifier: Apache-2.0
#pragma once

// Converts Beast's requests to plain data. For http_connection.cpp only.

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <string>
#include <string_view>

#include "server/http/request_head.h"

namespace kerf::net {

using BeastRequest = boost::beast::http::request<boost::beast::http::string_body>;

inline std::string_view view(boost::beast::string_view text) { return {text.data(), text.size()}; }

/// Joins the values of all headers with this name to one list.
inline std::string values_of(const BeastRequest& request, const char* name) {
  std::string list;
  const auto [first, last] = request.equal_range(name);
  for (auto field = first; field != last; ++field) {
    list.append(list.empty() ? "" : ",").append(view(field->value()));
  }
  return list;
}

/// Whether the body has a transfer coding, so that Content-Length does not define its end.
inline bool is_encoded(const BeastRequest& request) {
  return request.count(boost::beast::http::field::transfer_encoding) > 0;
}

inline RequestHead head_of(const BeastRequest& request) {
  const auto value = [&](boost::beast::http::field name) { return view(request[name]); };
  return {.method = view(request.method_string()),
          .target = view(request.target()),
          .version = request.version() == 0 ? 11 : request.version(),
          .hosts = request.count(boost::beast::http::field::host),
          .host = value(boost::beast::http::field::host),
          .origin = value(boost::beast::http::field::origin),
          .cookie = value(boost::beast::http::field::cookie),
          .authorization = value(boost::beast::http::field::authorization),
          .if_none_match = value(boost::beast::http::field::if_none_match),
          .range = value(boost::beast::http::field::range),
          .if_range = value(boost::beast::http::field::if_range),
          .accept_encoding = value(boost::beast::http::field::accept_encoding),
          .is_forwarded = request.count("X-Forwarded-For") + request.count("Forwarded") > 0,
          .forwarded_for = values_of(request, "X-Forwarded-For"),
          .forwarded_host = view(request["X-Forwarded-Host"]),
          .forwarded_proto = view(request["X-Forwarded-Proto"]),
          .protocols = value(boost::beast::http::field::sec_websocket_protocol),
          .key = value(boost::beast::http::field::sec_websocket_key)};
}

}  // namespace kerf::net
