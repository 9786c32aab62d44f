// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/formats/mesh_file.h"
#include "server/formats/model/indexed_mesh.h"
#include "server/formats/model/mesh_distance.h"
#include "server/formats/model/model_limits.h"
#include "server/rights/caller.h"
#include "server/verify/part_model.h"

namespace kerf::net {

/// What is known of a target part without its triangles.
struct TargetFacts {
  std::string name;  ///< the file name, by which it is addressed
  std::string tag;   ///< equal for equal files in equal places, else different
  std::size_t triangles = 0;
  Vec3 min_mm, max_mm;  ///< bounds in scene coordinates
  Vec3 shift_mm;        ///< added to the file's coordinates
  double unit_mm = 1;   ///< of the file's numbers, before the shift
  std::string author;   ///< grant by which it was stored; empty: none
  std::string fault;    ///< why the mesh bounds no solid, so that signs are unreliable; else empty
};

/// A part that blocks are compared with. Immutable.
class TargetPart {
 public:
  TargetPart(TargetFacts facts, IndexedMesh mesh)
      : facts_(std::move(facts)), mesh_(std::move(mesh)), distance_(mesh_) {}
  TargetPart(const TargetPart&) = delete;
  TargetPart& operator=(const TargetPart&) = delete;

  const TargetFacts& facts() const { return facts_; }
  const IndexedMesh& mesh() const { return mesh_; }
  const MeshDistance& distance() const { return distance_; }

 private:
  TargetFacts facts_;
  IndexedMesh mesh_;
  MeshDistance distance_;
};

struct TargetError {
  unsigned status;
  std::string code, reason;
};

/// Why a caller may not change a part: it was stored by somebody else.
std::string others_target(const std::string& name);

/// Keeps the target parts of sessions as files, each session's in a folder of its own, and the
/// parts that were used last in memory too. A part of a name replaces the one before. Thread-safe;
/// a call that reads a part may take seconds.
class TargetParts {
 public:
  static constexpr std::size_t kPartsOfSession = 8;
  /// About 150 bytes of memory each while a part is in use.
  static constexpr std::uint64_t kTrianglesMax = kModelTrianglesMax;
  /// Of the parts that are kept in memory.
  static constexpr std::uint64_t kTrianglesKept = 2'000'000;

  explicit TargetParts(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Reads and stores a mesh file, whose name tells the format. `as` has the name and the unit;
  /// its placement counts only for its translation. A part of the same name is replaced if the
  /// caller may change it: its own, or any as an owner. Ends soon after a stop is requested.
  std::expected<TargetFacts, TargetError> put(const std::string& session, const MeshFile& as,
                                              const std::string& bytes, const Caller& caller,
                                              const std::stop_token& stop = {});
  /// The parts of a session, by name.
  std::vector<TargetFacts> list(const std::string& session) const;
  /// Null if the session has no such part, or its file can no longer be read.
  std::shared_ptr<const TargetPart> get(const std::string& session, const std::string& name);
  /// The part on the rays of a session's block, which are `grid`; null likewise. Kept with the
  /// part.
  std::shared_ptr<const PartModel> model(const std::string& session, const std::string& name,
                                         const DexelGrid& grid);
  /// A part as bytes, from which unpack() makes it elsewhere; nullopt if there is none.
  std::optional<std::vector<std::byte>> pack(const std::string& session,
                                             const std::string& name) const;
  /// False if the bytes are none, or cannot be stored. A part that is there already stays.
  bool unpack(const std::string& session, std::span<const std::byte> bytes);
  /// What is known of a part; nullopt if the session has none of that name.
  std::optional<TargetFacts> facts(const std::string& session, const std::string& name) const;
  /// Returns whether the session had such a part.
  bool remove(const std::string& session, const std::string& name);
  /// Deletes the parts of a session.
  void forget(const std::string& session);

 private:
  /// A part of one session is never used for another, whatever its tag.
  struct Kept {
    std::string session;
    std::shared_ptr<const TargetPart> part;
    std::shared_ptr<const PartModel> model = {};  ///< null until it is needed
  };
  std::filesystem::path facts_file(const std::string& session, const std::string& name) const;
  // With the mutex locked:
  bool store(const std::string& session, const TargetFacts& facts, const std::string& bytes) const;
  std::vector<TargetFacts> stored(const std::string& session) const;
  std::shared_ptr<const TargetPart> known(const std::string& session, const std::string& tag);
  void keep(const std::string& session, std::shared_ptr<const TargetPart> part);

  std::filesystem::path folder_;
  std::mutex reading_;        ///< one part is read at a time
  mutable std::mutex mutex_;  ///< guards the files and kept_
  std::list<Kept> kept_;      ///< used last first
};

}  // namespace kerf::net
