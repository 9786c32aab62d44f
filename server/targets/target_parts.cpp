// SPDX-License-Identifier: Apache-2.0
#include "server/targets/target_parts.h"

#include <algorithm>
#include <bit>
#include <fstream>
#include <set>
#include <span>

#include "kernel/dexel/mesh_stock.h"
#include "kernel/math/hash.h"
#include "server/formats/model/mesh_reader.h"
#include "server/formats/text_file.h"
#include "server/http/api_services.h"
#include "server/rights/rights.h"
#include "server/session/hash_text.h"
#include "server/session/session.h"
#include "server/store/byte_code.h"
#include "server/store/plain_text.h"

namespace kerf::net {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPartNameBytesMax = 64;
constexpr const char* kTargetKind = "target";  ///< of attachments
constexpr const char* kFactsExtension = ".json";
constexpr const char* kMeshExtension = ".mesh";

/// Encodes the name of a part as a safe file name.
std::string file_name_of(const std::string& name) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string file;
  for (const char c : name) {
    file += kDigits[static_cast<unsigned char>(c) >> 4];
    file += kDigits[static_cast<unsigned char>(c) & 15];
  }
  return file;
}

std::string tag_of(const std::string& name, const std::string& bytes, double unit_mm, Vec3 shift) {
  Hash hash;
  for (const char c : name) hash.add(static_cast<unsigned char>(c));
  for (const char c : bytes) hash.add(static_cast<unsigned char>(c));
  for (const double v : {shift.x, shift.y, shift.z}) hash.add(std::bit_cast<std::uint64_t>(v));
  if (unit_mm != 1) hash.add(std::bit_cast<std::uint64_t>(unit_mm));
  return hash_text(hash.value());
}

/// Nullopt if the file is missing or damaged.
std::optional<TargetFacts> read_facts(const fs::path& path) {
  const auto text = read_file(path);
  return text ? parse_facts(*text) : std::nullopt;
}

bool write_part_file(const fs::path& path, const std::string& bytes) {
  const fs::path part = path.string() + ".part";
  std::ofstream file(part, std::ios::binary);
  file << bytes;
  file.close();
  std::error_code error;
  if (file) fs::rename(part, path, error);
  if (file && !error) return true;
  fs::remove(part, error);
  return false;
}

std::expected<std::shared_ptr<const TargetPart>, Error> read_part(const std::string& name,
                                                                  const std::string& bytes,
                                                                  double unit_mm, Vec3 shift,
                                                                  const std::string& author,
                                                                  const std::stop_token& stop) {
  const auto format = mesh_file_format(name);
  if (!format || !is_plain_text(name, kPartNameBytesMax)) {
    return std::unexpected(Error{
        ErrorKind::kInvalid, "bad_name",
        std::string("name must be 1 to 64 bytes of UTF-8 without control characters, and end in ") +
            kMeshFileNames});
  }
  auto mesh = read_mesh(*format, std::as_bytes(std::span(bytes)), TargetParts::kTrianglesMax, stop);
  if (!mesh) {
    return std::unexpected(
        Error{ErrorKind::kInvalid, to_string(mesh.error().code), mesh.error().reason});
  }
  for (Vec3& vertex : mesh->vertices_mm) vertex = unit_mm * vertex + shift;
  const BoxStock box = mesh_bounds(*mesh);
  return std::make_shared<const TargetPart>(
      TargetFacts{name, tag_of(name, bytes, unit_mm, shift), mesh->triangles.size(), box.min_mm,
                  box.max_mm, shift, unit_mm, author, mesh_stock_fault(*mesh)},
      indexed_mesh(*mesh));
}

}  // namespace

Error unknown_target(const std::string& name) {
  return {ErrorKind::kUnknown, "unknown_target", "the session has no target part \"" + name + "\""};
}

std::string others_target(const std::string& name) {
  return "target part \"" + name + "\" is another's: an owner may replace and delete it";
}

std::unique_ptr<MatterStore> TargetParts::make(ApiServices& services) {
  return std::make_unique<TargetParts>(services.options.data_folder / "targets");
}

std::expected<TargetFacts, Error> TargetParts::put(const std::string& session, const MeshFile& as,
                                                   const std::string& bytes, const Caller& caller,
                                                   const std::stop_token& stop) {
  const std::string& name = as.file;
  std::expected<std::shared_ptr<const TargetPart>, Error> part;
  {
    const std::lock_guard one(reading_);
    part = read_part(name, bytes, as.unit_mm.value_or(1), as.placement.translate_mm, caller.grant,
                     stop);
  }
  if (!part) return std::unexpected(part.error());
  const std::lock_guard lock(mutex_);
  const auto parts = stored(session);
  const auto before = std::ranges::find(parts, name, &TargetFacts::name);
  const bool replaces = before != parts.end();
  if (replaces && !may_change(caller, before->author, Action::kRunPrograms)) {
    return std::unexpected(Error{ErrorKind::kNotAllowed, "not_allowed",
                                 others_target(name) + "; choose another name"});
  }
  if (parts.size() >= kPartsOfSession && !replaces) {
    return std::unexpected(Error{ErrorKind::kConflict, "limit",
                                 "a session has at most " + std::to_string(kPartsOfSession) +
                                     " target parts: remove one first"});
  }
  if (!store(session, (*part)->facts(), bytes)) {
    return std::unexpected(Error{ErrorKind::kFailed, "disk", "the file could not be stored"});
  }
  keep(session, *part);
  return (*part)->facts();
}

bool TargetParts::store(const std::string& session, const TargetFacts& facts,
                        const std::string& bytes) const {
  std::error_code error;
  fs::create_directories(folder_ / session, error);
  const fs::path file = facts_file(session, facts.name);
  fs::path mesh = file;
  mesh.replace_extension(kMeshExtension);
  if (write_part_file(mesh, bytes) && write_part_file(file, facts_text(facts))) {
    return true;
  }
  fs::remove(mesh, error);
  fs::remove(file, error);
  return false;
}

/// Packs a part into bytes for unpack() at another server; nullopt if there is no such part.
std::optional<std::vector<std::byte>> TargetParts::pack(const std::string& session,
                                                        const std::string& name) const {
  std::optional<std::string> facts, mesh;
  {
    const std::lock_guard lock(mutex_);
    fs::path file = facts_file(session, name);
    facts = read_file(file);
    mesh = read_file(file.replace_extension(kMeshExtension));
  }
  if (!facts || !mesh) return std::nullopt;
  ByteWriter out;
  out.reserve(sizeof(std::uint32_t) + facts->size() + mesh->size());
  out.put(static_cast<std::uint32_t>(facts->size()));
  out.put(std::as_bytes(std::span(*facts)));
  out.put(std::as_bytes(std::span(*mesh)));
  return out.take();
}

/// Stores a packed part unless it exists. Returns false if the bytes are malformed or cannot be
/// stored.
bool TargetParts::unpack(const std::string& session, std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  const auto size = in.get<std::uint32_t>();
  const auto text = in.get_bytes(size);
  if (in.truncated()) return false;
  const auto string_of = [](std::span<const std::byte> part) {
    return std::string(reinterpret_cast<const char*>(part.data()), part.size());
  };
  const auto facts = parse_facts(string_of(text));
  if (!facts) return false;
  const std::lock_guard lock(mutex_);
  const auto here = read_facts(facts_file(session, facts->name));
  if (here && here->tag == facts->tag) return true;
  return store(session, *facts, string_of(bytes.subspan(sizeof size + text.size())));
}

void TargetParts::attach(Session& session, const std::string& name) {
  const std::lock_guard lock(attaching_);
  session.attach({kTargetKind, name, pack(session.id(), name)});
}

void TargetParts::attach_all(Session& session) {
  for (const TargetFacts& facts : list(session.id())) attach(session, facts.name);
}

std::expected<void, std::string> TargetParts::adopt(Session& session,
                                                    std::span<const Attachment> attachments) {
  const std::string& id = session.id();
  std::set<std::string> attached;
  for (const Attachment& attachment : attachments) {
    if (attachment.kind != kTargetKind) continue;
    attached.insert(attachment.name);
    if (!unpack(id, attachment.bytes)) {
      return std::unexpected("target part " + attachment.name + " of session " + id +
                             " cannot be stored");
    }
  }
  for (const TargetFacts& facts : list(id)) {
    if (!attached.contains(facts.name)) remove(id, facts.name);
  }
  return {};
}

std::optional<TargetFacts> TargetParts::facts(const std::string& session,
                                              const std::string& name) const {
  const std::lock_guard lock(mutex_);
  return read_facts(facts_file(session, name));
}

std::vector<TargetFacts> TargetParts::list(const std::string& session) const {
  const std::lock_guard lock(mutex_);
  return stored(session);
}

std::vector<TargetFacts> TargetParts::stored(const std::string& session) const {
  std::vector<TargetFacts> parts;
  std::error_code error;
  for (fs::directory_iterator at(folder_ / session, error);
       !error && at != fs::directory_iterator(); at.increment(error)) {
    if (at->path().extension() != kFactsExtension) continue;
    if (auto facts = read_facts(at->path())) parts.push_back(*std::move(facts));
  }
  std::ranges::sort(parts, {}, &TargetFacts::name);
  return parts;
}

std::shared_ptr<const TargetPart> TargetParts::get(const std::string& session,
                                                   const std::string& name) {
  // A call that waits here then finds the part in memory.
  const std::lock_guard one(reading_);
  std::optional<TargetFacts> facts;
  std::optional<std::string> bytes;
  {
    const std::lock_guard lock(mutex_);
    fs::path file = facts_file(session, name);
    facts = read_facts(file);
    if (!facts) return nullptr;
    if (auto part = known(session, facts->tag)) return part;
    bytes = read_file(file.replace_extension(kMeshExtension));
  }
  if (!bytes) return nullptr;
  auto part = read_part(name, *bytes, facts->unit_mm, facts->shift_mm, facts->author, {});
  if (!part) return nullptr;
  const std::lock_guard lock(mutex_);
  keep(session, *part);
  return *part;
}

std::shared_ptr<const PartModel> TargetParts::model(const std::string& session,
                                                    const std::string& name,
                                                    const DexelGrid& grid) {
  const auto part = get(session, name);
  if (!part) return nullptr;
  const std::lock_guard one(reading_);
  const auto kept_model = [&]() -> std::shared_ptr<const PartModel>* {
    const auto found = std::ranges::find(kept_, part, &Kept::part);
    return found == kept_.end() ? nullptr : &found->model;
  };
  {
    const std::lock_guard lock(mutex_);
    if (auto* kept = kept_model(); kept != nullptr && *kept && (*kept)->grid() == grid) {
      return *kept;
    }
  }
  struct Owner {
    Owner(std::shared_ptr<const TargetPart> of, const DexelGrid& grid)
        : part(std::move(of)), model(part->mesh(), part->distance(), grid) {}
    std::shared_ptr<const TargetPart> part;
    PartModel model;
  };
  const auto owner = std::make_shared<const Owner>(part, grid);
  const std::shared_ptr<const PartModel> model(owner, &owner->model);
  const std::lock_guard lock(mutex_);
  if (auto* kept = kept_model()) *kept = model;
  return model;
}

bool TargetParts::remove(const std::string& session, const std::string& name) {
  const std::lock_guard lock(mutex_);
  fs::path file = facts_file(session, name);
  std::error_code error;
  const bool existed = fs::remove(file, error);
  fs::remove(file.replace_extension(kMeshExtension), error);
  return existed;
}

void TargetParts::forget(const std::string& session) {
  const std::lock_guard lock(mutex_);
  std::error_code error;
  fs::remove_all(folder_ / session, error);
  std::erase_if(kept_, [&](const Kept& kept) { return kept.session == session; });
}

fs::path TargetParts::facts_file(const std::string& session, const std::string& name) const {
  return folder_ / session / (file_name_of(name) + kFactsExtension);
}

std::shared_ptr<const TargetPart> TargetParts::known(const std::string& session,
                                                     const std::string& tag) {
  const auto found = std::ranges::find_if(kept_, [&](const Kept& kept) {
    return kept.session == session && kept.part->facts().tag == tag;
  });
  if (found == kept_.end()) return nullptr;
  kept_.splice(kept_.begin(), kept_, found);
  return kept_.front().part;
}

void TargetParts::keep(const std::string& session, std::shared_ptr<const TargetPart> part) {
  if (known(session, part->facts().tag)) return;
  kept_.push_front({session, std::move(part)});
  std::uint64_t triangles = 0;
  std::erase_if(kept_, [&](const Kept& kept) {
    triangles += kept.part->facts().triangles;
    return triangles > kTrianglesKept;
  });
}

}  // namespace kerf::net
