// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cassert>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/http/matter_store.h"

namespace kerf::net {

/// The stores of all matters of a server (matter_store.h). Thread-safe.
class MatterStores {
 public:
  MatterStores(std::span<const HttpMatter> matters, ApiServices& services);
  /// Returns the store of a type that a matter of this server has.
  template <class S>
  S& get() {
    for (const auto& store : stores_) {
      if (auto* found = dynamic_cast<S*>(store.get())) return *found;
    }
    assert(false);
    __builtin_unreachable();
  }
  /// See MatterStore.
  void attach_all(Session& session);
  std::expected<void, std::string> adopt(Session& session, std::span<const Attachment> attachments);
  void forget(const std::string& session);
  void free_memory();
  void stop();

 private:
  std::vector<std::unique_ptr<MatterStore>> stores_;
};

}  // namespace kerf::net
