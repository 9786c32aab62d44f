// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/mesh_reader.h"
#include "tests/support/test.h"
#include "tests/support/zip_files.h"

namespace kerf::threemf_reader_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kRelationships =
    R"(<?xml version="1.0"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/Metadata/picture.png" Id="r0" Type="http://schemas.example/thumbnail"/>
<Relationship Target="/3D/part.model" Id="r1"
  Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)";

std::string tetrahedron(const std::string& id, const std::string& more = "") {
  return "<object id=\"" + id + "\" " + more +
         "><mesh><vertices>\n<vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>"
         "<vertex x=\"0\" y=\"1\" z=\"0\"/><vertex x=\"0\" y=\"0\" "
         "z=\"1e0\"/></vertices><triangles>"
         "<triangle v1=\"0\" v2=\"2\" v3=\"1\" pid=\"9\"/><triangle v1=\"0\" v2=\"1\" v3=\"3\"/>"
         "<triangle v1=\"1\" v2=\"2\" v3=\"3\"/><triangle v1=\"2\" v2=\"0\" "
         "v3=\"3\"/></triangles></mesh></object>\n";
}

std::string model(const std::string& resources, const std::string& build,
                  const std::string& unit = "millimeter") {
  const std::string schemas = "http://schemas.microsoft.com/3dmanufacturing/";
  return R"(<?xml version="1.0" encoding="UTF-8"?><model unit=")" + unit + R"(" xmlns=")" +
         schemas + R"(core/2015/02" xmlns:p=")" + schemas + "production/2015/06\">\n" +
         "<metadata name=\"Title\">a &lt; b</metadata><resources>" + resources +
         "</resources><build>" + build + "</build></model>";
}

MeshFileResult read(const std::string& bytes, std::uint64_t most = 1000) {
  return read_mesh(MeshFileFormat::k3mf, std::as_bytes(std::span(bytes)), most);
}
MeshFileResult read_model(const std::string& text, std::uint64_t most = 1000) {
  return read(test::zip_of({{"_rels/.rels", kRelationships}, {"3D/part.model", text}}), most);
}

TEST(ThreemfReader, ReadsItemsInTheFilesUnit) {
  const auto mesh = test::value_of(
      read_model(model(tetrahedron("1") + tetrahedron("2", "type=\"support\"") + tetrahedron("7"),
                       R"(<item objectid="1"/><item objectid="2"/>)", "inch")));
  EXPECT_THAT(mesh.vertices_mm,
              ElementsAre(Vec3{0, 0, 0}, Vec3{25.4, 0, 0}, Vec3{0, 25.4, 0}, Vec3{0, 0, 25.4}));
  EXPECT_EQ(mesh.triangles.size(), 4U);
}

TEST(ThreemfReader, PlacesComponentsByTheirTransforms) {
  // A component moved by 10 along x, in an item that turns by 90 degrees about z and moves along z.
  const std::string parts =
      tetrahedron("1") +
      R"(<object id="2"><components><component objectid="1" transform="1 0 0 0 1 0 0 0 1 10 0 0"/></components></object>)";
  const auto mesh = test::value_of(
      read_model(model(parts, R"(<item objectid="2" transform="0 1 0 -1 0 0 0 0 1 0 0 5"/>)")));
  EXPECT_THAT(mesh.vertices_mm,
              ElementsAre(Vec3{0, 10, 5}, Vec3{0, 11, 5}, Vec3{-1, 10, 5}, Vec3{0, 10, 6}));
  // A mirror image is turned, so that it is not inside out.
  const auto plain = read_model(model(tetrahedron("1"), R"(<item objectid="1"/>)"));
  const auto mirrored = read_model(
      model(tetrahedron("1"), R"(<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>)"));
  ASSERT_TRUE(plain && mirrored);
  EXPECT_EQ(plain->triangles[0], (std::array<std::uint32_t, 3>{0, 2, 1}));
  EXPECT_EQ(mirrored->triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
}

TEST(ThreemfReader, ReadsObjectsInOtherParts) {
  const std::string root = model(
      R"(<object id="2"><components><component p:path="/3D/Objects/one.model" objectid="1"/></components></object>)",
      R"(<item objectid="2"/>)");
  const auto mesh =
      test::value_of(read(test::zip_of({{"_rels/.rels", kRelationships},
                                        {"3D/part.model", root},
                                        {"3D/Objects/one.model", model(tetrahedron("1"), "")}})));
  EXPECT_EQ(mesh.triangles.size(), 4U);
}

constexpr const char* kItem = R"(<item objectid="1"/>)";

std::string reason_of(const MeshFileResult& result) {
  EXPECT_FALSE(result);
  return result ? std::string()
                : std::string(to_string(result.error().code)) + ": " + result.error().reason;
}

TEST(ThreemfReader, RejectsInvalidPackagesWithTheReason) {
  EXPECT_THAT(reason_of(read("PK")), HasSubstr("syntax: the file is not a ZIP archive"));
  EXPECT_THAT(reason_of(read(test::zip_of({{"a.txt", "b"}}))),
              HasSubstr("no part 3D/3dmodel.model"));
  EXPECT_THAT(reason_of(read_model(model(tetrahedron("1"), R"(<item objectid="3"/>)"))),
              HasSubstr("has no object 3"));
  EXPECT_THAT(reason_of(read_model(model(tetrahedron("1"), ""))),
              HasSubstr("empty: the package builds no object"));
  EXPECT_THAT(reason_of(read_model(model(tetrahedron("1"), kItem, "ell"))),
              HasSubstr("line 1: an unknown unit"));
  EXPECT_THAT(reason_of(read_model(model(tetrahedron("1") + tetrahedron("1"), kItem))),
              HasSubstr("line 4: object 1 comes twice"));
  EXPECT_THAT(reason_of(read_model(model(tetrahedron("1"), kItem) + "<")),
              HasSubstr("/3D/part.model, line 4: unclosed token"));
  EXPECT_THAT(reason_of(read_model("<!DOCTYPE a [<!ENTITY b \"c\">]>" + model("", kItem))),
              HasSubstr("document type"));
  EXPECT_THAT(reason_of(read_model(model(tetrahedron("1"), kItem), 3)), HasSubstr("too_large"));
  EXPECT_THAT(reason_of(read_model(model(tetrahedron("1"), std::string(kItem) + kItem), 7)),
              HasSubstr("too_large"));
  EXPECT_THAT(
      reason_of(read_model(model(
          R"(<object id="1"><components><component objectid="1"/></components></object>)", kItem))),
      HasSubstr("nested more than 32 deep"));
  std::string text = model(tetrahedron("1"), kItem);
  text.replace(text.find("v3=\"1\""), 6, "v3=\"4\"");
  EXPECT_THAT(reason_of(read_model(text)),
              HasSubstr("bad_index: /3D/part.model, line 3: vertex 4 is out of range"));
  EXPECT_THAT(reason_of(read_model(
                  model(tetrahedron("1") + std::string(std::size_t{8} << 20U, '\n'), kItem))),
              HasSubstr("100 times its size"));
  // A truncated file is rejected, unless only the end of the archive's last record is missing.
  constexpr std::size_t kEndRecord = 22;
  const std::string whole = test::zip_of({{"3D/3dmodel.model", model(tetrahedron("1"), kItem)}});
  ASSERT_TRUE(read(whole));
  for (std::size_t size = 0; size + kEndRecord < whole.size(); ++size)
    EXPECT_FALSE(read(whole.substr(0, size))) << size;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    read(damaged);  // at worst an error
  }
}

TEST(ThreemfReader, RejectsExcessiveMemory) {
  // Objects that no item builds take memory too, and so do vertices without triangles.
  EXPECT_THAT(reason_of(read_model(model(tetrahedron("1") + tetrahedron("2"), kItem), 7)),
              HasSubstr("line 5: the file has more than 7 triangles"));
  std::string crowded = tetrahedron("1");
  for (int n = 0; n < 9; ++n)
    crowded.insert(crowded.find("</vertices>"), R"(<vertex x="0" y="0" z="0"/>)");
  EXPECT_TRUE(read_model(model(crowded, kItem), 13));
  EXPECT_THAT(
      reason_of(read_model(model(crowded, kItem), 4)),
      HasSubstr("too_large: /3D/part.model, line 3: the file has vertices for more than 4"));
  const std::string other =
      R"(<object id="3"><components><component p:path="/3D/other.model" objectid="1"/></components></object>)";
  EXPECT_THAT(reason_of(read(test::zip_of({{"_rels/.rels", kRelationships},
                                           {"3D/part.model", model(tetrahedron("1") + other,
                                                                   R"(<item objectid="3"/>)")},
                                           {"3D/other.model", model(tetrahedron("1"), "")}}),
                             7)),
              HasSubstr("/3D/other.model, line 3: the file has more than 7 triangles"));
  EXPECT_THAT(
      reason_of(read_model(model(
          tetrahedron("1") + "<!--" + std::string((std::size_t{1} << 20U) + 100'000, 'a') + "-->",
          kItem))),
      HasSubstr("too_large: /3D/part.model, line 4: an element or a comment has more than 1 MB"));
  std::string many;
  for (int n = 0; n <= 100'000; ++n) many += "<object id=\"" + std::to_string(n) + "\"/>";
  EXPECT_THAT(reason_of(read_model(model(many, kItem))), HasSubstr("more than 100000 objects"));
}

}  // namespace
}  // namespace kerf::threemf_reader_test
