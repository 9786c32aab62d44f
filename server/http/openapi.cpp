// SPDX-License-Identifier: Apache-2.0
// The route that describes the HTTP interface.
#include "server/http/openapi.h"

#include <memory>
#include <string>

#include "kernel/math/hash.h"
#include "server/http/api.h"
#include "server/http/entity_tag.h"
#include "server/session/hash_text.h"

namespace kerf::net {
namespace {

struct SharedDescription {
  std::shared_ptr<const std::string> text;
  std::string etag;
};

SharedDescription shared_description() {
  Hash hash;
  for (const char c : openapi_text()) hash.add(static_cast<unsigned char>(c));
  return {std::make_shared<const std::string>(openapi_text()), '"' + hash_text(hash.value()) + '"'};
}

}  // namespace

ApiResponse Api::describe_interface(const ApiCall& call) {
  static const SharedDescription kDescription = shared_description();
  ApiResponse response;
  if (has_client(call.request, kDescription.etag, response)) return response;
  response.text = kDescription.text;
  return response;
}

}  // namespace kerf::net
