// SPDX-License-Identifier: Apache-2.0
#include "server/http/api_services.h"

namespace kerf::net {

ApiServices::ApiServices(const HttpOptions& options_in, SessionRegistry& registry_in,
                         Access& access_in, std::span<const HttpMatter> matters)
    : options(options_in),
      registry(registry_in),
      access(access_in),
      downloads(options.data_folder / kCacheFolder / "downloads"),
      memory(options.program_bytes),
      uploads(options.data_folder / "uploads"),
      stores(matters, *this) {}

std::optional<MemoryBudget::Share> take_memory(ApiServices& services, std::size_t bytes) {
  if (auto share = services.memory.take(bytes)) return share;
  services.stores.free_memory();
  return services.memory.take(bytes);
}

}  // namespace kerf::net
