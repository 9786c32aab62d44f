// SPDX-License-Identifier: Apache-2.0
#include "server/downloads/download_handlers.h"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>

#include "kernel/cut/workers.h"
#include "server/downloads/download_name.h"
#include "server/downloads/download_request.h"
#include "server/formats/model/fitting_model.h"
#include "server/http/api_services.h"
#include "server/http/entity_tag.h"
#include "server/http/hashed_solid.h"
#include "server/http/responses.h"
#include "server/session/hash_text.h"
#include "server/session/session_walls.h"

namespace kerf::net {
namespace {

template <typename Result>
MadeFile reason_only(const Result& result) {
  if (!result) return std::unexpected(MakeError{result.error().reason});
  return {};
}

/// Carves from the nearest earlier state of the block that its history can give.
ExportResult write_plot(const ForcePlotRequest& plot, Session& session, std::ostream& out,
                        const std::stop_token& stop) {
  SerialWorkers alone;
  const auto start = session.past().felt_start(plot.first, plot.only, alone, stop);
  if (!start) return std::unexpected(start.error());
  return export_force_plot(session.journal_file(), plot, out, stop, &*start);
}

/// Returns the header Kerf-Model: how the model differs from the exact surface.
std::string note_of(const FittingModel& model, const SolidSnapshot& solid) {
  nlohmann::ordered_json note{{"triangles", model.summary.triangles}};
  if (model.exact_triangles) {
    note["exact_triangles"] = *model.exact_triangles;
    note["within_mm"] = model.tolerance_mm;
  }
  if (model.summary.collapsed > 0) note["collapsed_triangles"] = model.summary.collapsed;
  const std::string warning =
      coarse_coordinates(model.summary, solid.grid().pitch_mm, solid.grid().origin_mm,
                         SnapshotMesh(solid).size_mm(), "shift_mm=");
  if (!warning.empty()) note["warning"] = warning;
  return note.dump();
}

/// Copies the journal without its attachments: not everybody may see rights and target parts.
MadeFile write_journal(const std::filesystem::path& journal, const std::filesystem::path& path) {
  if (auto copied = copy_journal(journal, path); !copied) return reason_only(copied);
  return reason_only(remove_attachments(path));
}

MadeFile write_motions(const DownloadRequest& download, Session& session,
                       const SolidSnapshot& solid, const std::filesystem::path& path,
                       const std::stop_token& stop) {
  if (auto ok = session.flush(); !ok) return std::unexpected(MakeError{describe(ok.error())});
  const std::string_view name = download.kind.name;
  const auto& journal = session.journal_file();
  if (name == "journal") return write_journal(journal, path);
  std::ofstream out(path, std::ios::binary);
  if (!out) return std::unexpected(MakeError{"the file cannot be created"});
  const auto written = name == "thin_walls.json"
                           ? export_thin_walls(journal, solid.fields.front(), out, stop)
                       : name == "forces.csv" ? export_forces(journal, download.forces, out, stop)
                       : name == "forces"     ? write_plot(download.plot, session, out, stop)
                                          : export_program(journal, download.program, out, stop);
  if (!written) return std::unexpected(MakeError{written.error()});
  out.close();
  if (!out) return std::unexpected(MakeError{"writing the file failed: the disk may be full"});
  return {};
}

/// Puts the whole file or the requested range into the response.
void put_file(const ApiRequest& request, const std::string& etag, ApiResponse& response) {
  const std::uint64_t bytes = response.file->bytes();
  response.headers.emplace_back("Accept-Ranges", "bytes");
  // The client has parts of an older state: send the whole file.
  if (!request.if_range.empty() && request.if_range != etag) return;
  const auto range = parse_range(request.range, bytes);
  if (!range) {
    auto rejection =
        error_response(416, "bad_range", "the file has " + std::to_string(bytes) + " bytes");
    rejection.headers.emplace_back("Content-Range", "bytes */" + std::to_string(bytes));
    response = std::move(rejection);
    return;
  }
  if (!*range) return;
  response.status = 206;
  response.part = *range;
  const std::uint64_t last = (*range)->first + (*range)->count - 1;
  response.headers.emplace_back("Content-Range", "bytes " + std::to_string((*range)->first) + "-" +
                                                     std::to_string(last) + "/" +
                                                     std::to_string(bytes));
}

MadeFile write_surface(const DownloadRequest& download, const SolidSnapshot& snapshot,
                       const std::string& title, const std::filesystem::path& path,
                       const DownloadCache::Progress& progress, const std::stop_token& stop) {
  const ModelRequest request{.format = *download.model,
                             .encoding = download.encoding,
                             .title = title,
                             .shift_mm = download.shift_mm,
                             .progress = progress,
                             .stop = stop};
  if (!download.simplify.triangles && !download.simplify.error_mm) {
    // Without limits the exact surface preserves them.
    const auto written = write_fitting_model(
        path, snapshot, request,
        download.is_exact ? ModelLimits{.bytes = UINT64_MAX, .triangles = UINT64_MAX}
                          : ModelLimits{});
    if (!written) return reason_only(written);
    return note_of(*written, snapshot);
  }
  SnapshotMesh exact(snapshot);
  const auto simplified = simplify_mesh(exact, download.simplify, progress, stop);
  if (stop.stop_requested()) return std::unexpected(MakeError{"stopped"});
  if (!simplified) return std::unexpected(MakeError{simplified.error().reason, true});
  WholeMesh mesh(simplified->mesh);
  const auto written = write_model(path, mesh, request);
  if (!written) return reason_only(written);
  return note_of({*written, simplified->original_triangles, simplified->error_mm}, snapshot);
}

}  // namespace

ApiResponse download(const ApiCall& call) {
  const ApiRequest& request = call.request;
  Session& session = *call.session;
  auto download = read_download_request(request);
  if (!download) return error_response(download.error());
  if (auto refused =
          post_rejection(download->program.style.post, session.scene()->machine.kinematics)) {
    return error_response(422, "bad_post", *refused);
  }
  HashedSolid now;
  if (download->at) {
    const auto record = find_record(session, *download->at);
    if (!record) return record.error();
    auto then = solid_after(call, *record);
    if (!then) return then.error();
    now = *std::move(then);
    download->suffix += "-at-" + std::to_string(*record);
  } else {
    now = current_solid(session);
  }
  std::string tag = hash_text(now.hash.hash);
  // Different motions may leave the same solid, so files made of motions are also identified by the
  // number of the last record.
  if (!download->model) tag += "-" + std::to_string(now.hash.sequence);
  tag += download->suffix;
  const std::string etag = '"' + tag + '"';
  ApiResponse response;
  if (has_client(request, etag, response)) return response;
  const auto file = call.services.downloads.get(
      session.id() + "/" + request.path[3] + "/" + tag + "/" + std::to_string(session.epoch()),
      [&](const std::filesystem::path& path, const DownloadCache::Progress& progress,
          const std::stop_token& stop) -> MadeFile {
        if (!download->model) return write_motions(*download, session, now.solid, path, stop);
        return write_surface(*download, now.solid, session.scene()->name, path, progress, stop);
      },
      request.stop);
  if (!file) {
    const MakeError& error = file.error();
    if (error.no_space) return error_response(507, "disk_full", error.reason);
    if (!download->model && !error.impossible) {
      const auto damage = session.past().damage_after(error.reason, request.stop);
      if (damage) return damaged_journal(*damage);
    }
    return error.impossible ? error_response(422, "budget_impossible", error.reason)
                            : error_response(503, "export_failed", error.reason);
  }
  response.file = *file;
  response.content_type = download->kind.content_type;
  const std::string name = download_name(session.scene()->name, session.id(), download->suffix,
                                         download->kind.extension);
  response.headers.emplace_back("Content-Disposition", content_disposition(name));
  if (!(*file)->note().empty()) response.headers.emplace_back("Kerf-Model", (*file)->note());
  put_file(request, etag, response);
  return response;
}

ApiResponse list_exports(const ApiCall& call) {
  nlohmann::json list = nlohmann::json::array();
  const std::string prefix = call.session->id() + "/";
  for (const auto& making : call.services.downloads.making(prefix)) {
    const std::string rest = making.key.substr(prefix.size());
    list.push_back({{"name", rest.substr(0, rest.find('/'))},
                    {"share", std::round(making.share * 1000) / 1000},
                    {"seconds", std::round(making.seconds * 1000) / 1000}});
  }
  return json_response(200, nlohmann::json{{"exports", list}}.dump());
}

}  // namespace kerf::net
