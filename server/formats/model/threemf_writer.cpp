// SPDX-License-Identifier: Apache-2.0
#include <minizip/zip.h>

#include <algorithm>
#include <cstring>

#include "server/formats/model/model_parts.h"
#include "server/formats/model/vertex_welder.h"
#include "server/formats/xml_entity.h"

// Writes the 3D Manufacturing Format, core specification 1.2: a package of three parts, one of
// which is the model, compressed by zlib's minizip and produced from front to back.

namespace kerf {
namespace {

// Coordinates as text compress to a third at any level. Higher levels take several times as long.
constexpr int kDeflateLevel = 2;

/// Connects minizip to a FileSink: it appends, and seeks back once per part to write its length.
struct ZipTarget {
  FileSink& sink;
  std::uint64_t at = 0;
};

voidpf open_target(voidpf opaque, const void*, int) { return opaque; }
uLong read_target(voidpf, voidpf, void*, uLong) { return 0; }
uLong write_target(voidpf, voidpf stream, const void* data, uLong size) {
  auto& target = *static_cast<ZipTarget*>(stream);
  const std::span bytes(static_cast<const std::byte*>(data), size);
  if (target.at == target.sink.bytes()) {
    target.sink.write(bytes);
  } else {
    target.sink.patch(target.at, bytes);
  }
  target.at += size;
  return target.sink.ok() ? size : 0;
}
ZPOS64_T tell_target(voidpf, voidpf stream) { return static_cast<ZipTarget*>(stream)->at; }
long seek_target(voidpf, voidpf stream, ZPOS64_T offset, int from) {
  auto& target = *static_cast<ZipTarget*>(stream);
  if (from == ZLIB_FILEFUNC_SEEK_CUR) offset += target.at;
  if (from == ZLIB_FILEFUNC_SEEK_END) offset += target.sink.bytes();
  target.at = offset;
  return 0;
}
int close_target(voidpf, voidpf) { return 0; }
int error_of_target(voidpf, voidpf stream) {
  return static_cast<ZipTarget*>(stream)->sink.ok() ? 0 : 1;
}

class Package {
 public:
  explicit Package(FileSink& sink) : target_{sink} {
    zlib_filefunc64_def functions{open_target, read_target,  write_target,    tell_target,
                                  seek_target, close_target, error_of_target, &target_};
    zip_ = zipOpen2_64("", APPEND_STATUS_CREATE, nullptr, &functions);
    ok_ = zip_ != nullptr;
  }
  Package(const Package&) = delete;
  Package& operator=(const Package&) = delete;
  ~Package() { close(); }

  void begin(const char* part) {
    zip_fileinfo info{};
    info.dosDate = (1U << 21U) | (1U << 16U);  // 1980-01-01: equal models are equal files
    note(zipOpenNewFileInZip64(zip_, part, &info, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED,
                               kDeflateLevel, 0));
  }
  void write(std::string_view text) {
    if (ok_) note(zipWriteInFileInZip(zip_, text.data(), static_cast<unsigned>(text.size())));
  }
  void end() {
    if (ok_) note(zipCloseFileInZip(zip_));
  }
  bool close() {
    if (zip_ != nullptr) note(zipClose(std::exchange(zip_, nullptr), nullptr));
    return ok_;
  }

 private:
  void note(int status) { ok_ = ok_ && status == ZIP_OK; }
  ZipTarget target_;
  zipFile zip_ = nullptr;
  bool ok_ = true;
};

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : one_line(text)) {
    const std::string_view entity = xml_entity(c);
    out += entity.empty() ? std::string_view(&c, 1) : entity;
  }
  return out;
}

void put(std::string& out, const std::array<float, 3>& p) {
  static constexpr std::array kBefore{"<vertex x=\"", "\" y=\"", "\" z=\""};
  for (std::size_t c = 0; c < 3; ++c) {
    out += kBefore[c];
    put_number(out, p[c]);
  }
  out += "\"/>\n";
}

void put(std::string& out, const std::array<std::uint32_t, 3>& triangle) {
  static constexpr std::array kBefore{"<triangle v1=\"", "\" v2=\"", "\" v3=\""};
  for (std::size_t c = 0; c < 3; ++c) {
    out += kBefore[c];
    put_number(out, triangle[c]);
  }
  out += "\"/>\n";
}

constexpr std::string_view kContentTypes =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
    "<Default Extension=\"rels\" "
    "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
    "<Default Extension=\"model\" "
    "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
constexpr std::string_view kRelations =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
    "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";

/// Writes vertices directly and spools triangles.
ModelResult write_vertices(const ModelOutput& output, Package& package, SpoolFile& triangles) {
  VertexWelder welder;
  ModelSummary summary;
  MeshPiece piece;
  std::string text;
  while (output.next(piece)) {
    const auto& welded = welder.weld(piece);
    text.clear();
    for (const std::uint32_t n : welded.fresh) put(text, output.in_scene(piece.positions_mm[n]));
    if (summary.triangles == 0 && !welded.indices.empty()) {
      package.write("<object id=\"1\" type=\"model\"><mesh><vertices>\n");
    }
    package.write(text);
    triangles.write(std::as_bytes(std::span(welded.indices)));
    summary.triangles += piece.indices.size() / 3;
  }
  summary.vertices = welder.vertices();
  // The specification limits indices to 31 bits.
  if (summary.vertices > INT32_MAX) return model_error("the surface has more than 2^31 vertices");
  return summary;
}

bool write_triangles(Package& package, SpoolFile& triangles) {
  package.write("</vertices><triangles>\n");
  std::string text;
  const bool whole = triangles.read_all([&](std::span<const std::byte> chunk) {
    text.clear();
    for (std::size_t at = 0; at + 12 <= chunk.size(); at += 12) {
      std::array<std::uint32_t, 3> triangle{};
      std::memcpy(triangle.data(), chunk.data() + at, sizeof triangle);
      put(text, triangle);
    }
    package.write(text);
  });
  package.write("</triangles></mesh></object>\n");
  return whole;
}

}  // namespace

ModelResult write_3mf(const ModelOutput& output) {
  SpoolFile triangles(output.path);
  Package package(output.sink);
  package.begin("[Content_Types].xml");
  package.write(kContentTypes);
  package.end();
  package.begin("_rels/.rels");
  package.write(kRelations);
  package.end();
  package.begin("3D/3dmodel.model");
  package.write(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" "
      "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
      "<metadata name=\"Title\">" +
      escaped(output.request.title) +
      "</metadata>\n<metadata name=\"Application\">Kerf</metadata>\n<resources>\n");
  auto summary = write_vertices(output, package, triangles);
  if (!summary) return summary;
  const bool some = summary->triangles > 0;
  if (some && !write_triangles(package, triangles)) {
    return model_error("writing the temporary file failed; is the disk full?");
  }
  package.write("</resources>\n<build>");
  if (some) package.write("<item objectid=\"1\"/>");
  package.write("</build>\n</model>\n");
  package.end();
  if (!package.close()) return model_error("the package cannot be written or exceeds 4 GiB");
  return summary;
}

}  // namespace kerf
