// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <memory>
#include <span>
#include <string>

#include "server/session/session_registry.h"
#include "server/store/attachment.h"

namespace kerf::net {

struct ApiServices;
struct Route;

/// Data that a matter keeps for the sessions of a server outside their journals, such as files of
/// target parts. It moves to other servers as attachments of the journals. Thread-safe.
class MatterStore {
 public:
  virtual ~MatterStore() = default;
  /// Attaches all data of a session to its journal.
  virtual void attach_all(Session& session) { (void)session; }
  /// Takes over a session whose journal has these attachments. Not called for one that this server
  /// follows. The error is one sentence.
  virtual std::expected<void, std::string> adopt(Session& session,
                                                 std::span<const Attachment> attachments) {
    (void)session, (void)attachments;
    return {};
  }
  /// Deletes all data of a session.
  virtual void forget(const std::string& session) { (void)session; }
  /// Frees memory that other requests need.
  virtual void free_memory() {}
  /// Stops all work in progress, and later work as it begins.
  virtual void stop() {}
};

/// Makes the store of a server. The services outlive it.
using MakeStore = std::unique_ptr<MatterStore> (*)(ApiServices& services);

/// The part of a matter in the HTTP interface.
struct HttpMatter {
  std::span<const Route> routes;
  MakeStore make_store = nullptr;  ///< null if the matter needs no store
};

}  // namespace kerf::net
