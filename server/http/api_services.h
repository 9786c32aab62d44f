// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "server/http/download_cache.h"
#include "server/http/http_options.h"
#include "server/http/late_pool.h"
#include "server/http/matter_stores.h"
#include "server/http/upload_folder.h"
#include "server/rights/access.h"
#include "server/session/memory_budget.h"
#include "server/session/session_registry.h"

namespace kerf::net {

/// The parts of a server that the handlers of all matters use. Thread-safe.
struct ApiServices {
  /// `options`, `registry` and `access` must outlive this object.
  ApiServices(const HttpOptions& options, SessionRegistry& registry, Access& access,
              std::span<const HttpMatter> matters);

  const HttpOptions& options;
  SessionRegistry& registry;
  Access& access;
  DownloadCache downloads;
  MemoryBudget memory;  ///< for programs until they end, and for meshes being read; see take_memory
  UploadFolder uploads;  ///< meshes that scenes may name
  LatePool carvers;      ///< carve tiles for undo, redo and the past
  MatterStores stores;
};

/// Subfolder of the data folder, for the server's own use only.
inline constexpr const char* kCacheFolder = ".kerf-cache";

/// Takes a share of ApiServices::memory. If it is exhausted, matters free some. Nullopt if that is
/// not enough.
std::optional<MemoryBudget::Share> take_memory(ApiServices& services, std::size_t bytes);

}  // namespace kerf::net
