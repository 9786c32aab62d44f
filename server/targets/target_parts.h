// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "server/error.h"
#include "server/formats/mesh_file.h"
#include "server/formats/model/model_limits.h"
#include "server/http/matter_store.h"
#include "server/rights/caller.h"
#include "server/targets/target_part.h"
#include "server/verify/part_model.h"

namespace kerf::net {

/// The error of a request for a part that the session does not have.
Error unknown_target(const std::string& name);
/// Explains that a caller may not change a part that somebody else has stored.
std::string others_target(const std::string& name);

/// Stores the target parts of sessions as files, in a folder for each session, and caches those
/// used last in memory. A part replaces the one with the same name. Thread-safe. A call that reads
/// a part may take seconds.
class TargetParts final : public MatterStore {
 public:
  static constexpr std::size_t kPartsOfSession = 8;
  /// About 150 bytes of memory per triangle while a part is in use.
  static constexpr std::uint64_t kTrianglesMax = kModelTrianglesMax;
  /// Limit for the parts cached in memory.
  static constexpr std::uint64_t kTrianglesKept = 2'000'000;

  explicit TargetParts(std::filesystem::path folder) : folder_(std::move(folder)) {}
  static std::unique_ptr<MatterStore> make(ApiServices& services);

  /// Reads and stores a mesh file. The extension of its name determines the format. `as` has the
  /// name, the unit and the translation; the rest of its placement is ignored. A part with the same
  /// name is replaced if the caller may change it: its own, or any as an owner. Stops soon after a
  /// stop is requested.
  std::expected<TargetFacts, Error> put(const std::string& session, const MeshFile& as,
                                        const std::string& bytes, const Caller& caller,
                                        const std::stop_token& stop = {});
  /// The parts of a session, by name.
  std::vector<TargetFacts> list(const std::string& session) const;
  /// Null if the session has no such part, or its file can no longer be read.
  std::shared_ptr<const TargetPart> get(const std::string& session, const std::string& name);
  /// The part on the rays `grid` of a session's block, cached with the part; null as for get().
  std::shared_ptr<const PartModel> model(const std::string& session, const std::string& name,
                                         const DexelGrid& grid);
  /// The properties of a part; nullopt if the session has none with this name.
  std::optional<TargetFacts> facts(const std::string& session, const std::string& name) const;
  /// Deletes a part. Returns whether it existed.
  bool remove(const std::string& session, const std::string& name);

  // See MatterStore. The parts of a session are attachments of its journal.
  void attach_all(Session& session) override;
  std::expected<void, std::string> adopt(Session& session,
                                         std::span<const Attachment> attachments) override;
  void forget(const std::string& session) override;
  /// Attaches the current state of a part, or its removal.
  void attach(Session& session, const std::string& name);

 private:
  /// Belongs to one session: a part is never used for another, whatever its tag.
  struct Kept {
    std::string session;
    std::shared_ptr<const TargetPart> part;
    std::shared_ptr<const PartModel> model = {};  ///< created on first use
  };
  std::filesystem::path facts_file(const std::string& session, const std::string& name) const;
  std::optional<std::vector<std::byte>> pack(const std::string& session,
                                             const std::string& name) const;
  bool unpack(const std::string& session, std::span<const std::byte> bytes);
  // Call these with the mutex locked:
  bool store(const std::string& session, const TargetFacts& facts, const std::string& bytes) const;
  std::vector<TargetFacts> stored(const std::string& session) const;
  std::shared_ptr<const TargetPart> known(const std::string& session, const std::string& tag);
  void keep(const std::string& session, std::shared_ptr<const TargetPart> part);

  std::filesystem::path folder_;
  std::mutex attaching_;      ///< the newest state of a part must be attached last
  std::mutex reading_;        ///< held while a part is read
  mutable std::mutex mutex_;  ///< guards the files and kept_
  std::list<Kept> kept_;      ///< most recently used first
};

}  // namespace kerf::net
