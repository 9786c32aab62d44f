// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "server/http/matter_store.h"

namespace kerf::net {

/// The programs of all sessions of a server: their texts in memory and in the journals.
class ProgramStore final : public MatterStore {
 public:
  explicit ProgramStore(SessionRegistry& registry) : registry_(registry) {}
  static std::unique_ptr<MatterStore> make(ApiServices& services);

  /// Lists the programs that ran when the session stopped.
  std::expected<void, std::string> adopt(Session& session,
                                         std::span<const Attachment> attachments) override;
  /// Drops the texts of ended programs.
  void free_memory() override;

 private:
  SessionRegistry& registry_;
};

}  // namespace kerf::net
