// The part of the HTTP interface that hands out files made from a session.
#include <charconv>
#include <fstream>

#include "server/formats/glb.h"
#include "server/formats/stl.h"
#include "server/net/api.h"
#include "server/net/on_executor.h"
#include "server/session/hash_text.h"
#include "server/session/session_export.h"

namespace kerf::net {
namespace {

struct Download {
  const char* name;
  const char* content_type;
  bool of_solid;  ///< depends on the solid alone, so its ETag is the state hash
};
constexpr Download kDownloads[] = {
    {"model.stl", "model/stl", true},     {"model.glb", "model/gltf-binary", true},
    {"program.ngc", "text/plain", false}, {"program.apt", "text/plain", false},
    {"forces.csv", "text/csv", false},    {"journal", "application/vnd.sqlite3", false}};

const Download* find_download(const std::string& name) {
  for (const Download& download : kDownloads) {
    if (name == download.name) return &download;
  }
  return nullptr;
}

std::expected<std::optional<ParticipantId>, std::string> participant(const ApiRequest& request) {
  const auto found = request.query.find("participant");
  if (found == request.query.end()) return std::nullopt;
  ParticipantId id = 0;
  const char* end = found->second.data() + found->second.size();
  const auto parsed = std::from_chars(found->second.data(), end, id);
  if (parsed.ec != std::errc() || parsed.ptr != end) {
    return std::unexpected("participant is not a number");
  }
  return id;
}

template <typename Write>
std::expected<void, std::string> write_text(const std::filesystem::path& path, Write&& write) {
  std::ofstream out(path, std::ios::binary);
  if (!out) return std::unexpected("the file cannot be created");
  if (auto ok = write(out); !ok) return ok;
  out.close();
  if (!out) return std::unexpected("the disk is full or broken");
  return {};
}

template <typename Result>
std::expected<void, std::string> reason_only(const Result& result) {
  if (!result) return std::unexpected(result.error().reason);
  return {};
}

std::string file_name(const Session& session, const std::string& name) {
  if (name == "journal") return session.id() + ".kerf";
  return session.id() + name.substr(name.find('.'));
}

}  // namespace

ApiResponse Api::download(const ApiRequest& request, const SessionPtr& session) {
  const std::string& name = request.path[3];
  const Download* what = find_download(name);
  if (what == nullptr) return error_response(404, "not_found", "there is no download " + name);
  if (request.method != "GET" && request.method != "HEAD") {
    auto response = error_response(405, "bad_method", request.method + " is not possible here");
    response.headers.emplace_back("Allow", "GET, HEAD");
    return response;
  }
  const auto who = participant(request);
  if (!who) return error_response(400, "bad_participant", who.error());

  const StateHash hash = current_hash(*session);
  std::string tag = hash_text(hash.hash);
  // Different motions may leave the same solid, so what is made of motions is named by their number
  // too.
  if (!what->of_solid) tag += "-" + std::to_string(hash.sequence);
  if (*who) tag += "-p" + std::to_string(**who);
  const std::string etag = '"' + tag + '"';
  ApiResponse response;
  response.headers.emplace_back("ETag", etag);
  response.headers.emplace_back("Cache-Control", "no-cache");
  if (request.if_none_match == etag || request.if_none_match == "*") {
    response.status = 304;
    return response;
  }
  const auto file = downloads_.get(
      session->id() + "/" + name + "/" + tag + "/" + std::to_string(session->epoch()),
      [&](const std::filesystem::path& path) { return make_download(name, *who, *session, path); });
  if (!file) return error_response(500, "export_failed", file.error());
  response.file = *file;
  response.content_type = what->content_type;
  response.headers.emplace_back("Content-Disposition",
                                "attachment; filename=\"" + file_name(*session, name) + "\"");
  return response;
}

std::expected<void, std::string> Api::make_download(const std::string& name,
                                                    std::optional<ParticipantId> who,
                                                    Session& session,
                                                    const std::filesystem::path& path) {
  if (name == "model.stl" || name == "model.glb") {
    const auto snapshot = on_executor(session, [](Session& s) { return s.snapshot(); });
    if (name == "model.stl") {
      return reason_only(write_stl_file(path, snapshot, session.scene().name));
    }
    return reason_only(write_model_glb_file(path, snapshot, session.scene().name));
  }
  if (auto ok = session.flush(); !ok) return std::unexpected(describe(ok.error()));
  const auto& journal = session.journal_file();
  if (name == "journal") return reason_only(copy_journal(journal, path));
  return write_text(path, [&](std::ostream& out) -> ExportResult {
    if (name == "forces.csv") return export_forces(journal, who, out);
    const auto format = name == "program.apt" ? ProgramFormat::kApt : ProgramFormat::kGcode;
    return export_program(journal, format, who, out);
  });
}

}  // namespace kerf::net
