// SPDX-License-Identifier: Apache-2.0
// 3MF files, read by the consortium's own library in its strict mode.
#include <Model/COM/NMR_DLLInterfaces.h>
#include <unistd.h>

#include "server/formats/model/model_writer.h"
#include "tests/support/carvings.h"
#include "tests/support/model_files.h"
#include "tests/support/test.h"

namespace kerf::threemf_test {
namespace {

using test::ReadModel;

struct Read3mf {
  ReadModel model;
  unsigned objects = 0, items = 0, warnings = 0;
  bool manifold = true, millimetres = false;
};

template <class T>
struct Handle {
  T* object = nullptr;
  Handle() = default;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (object != nullptr) NMR::lib3mf_release(object);
  }
};

void read_object(NMR::PLib3MFModelMeshObject* object, Read3mf& out) {
  DWORD vertices = 0, triangles = 0;
  BOOL manifold = false;
  EXPECT_EQ(NMR::lib3mf_meshobject_ismanifoldandoriented(object, &manifold), 0);
  out.manifold = out.manifold && manifold != 0;
  EXPECT_EQ(NMR::lib3mf_meshobject_getvertexcount(object, &vertices), 0);
  EXPECT_EQ(NMR::lib3mf_meshobject_gettrianglecount(object, &triangles), 0);
  for (DWORD n = 0; n < vertices; ++n) {
    NMR::MODELMESHVERTEX vertex;
    EXPECT_EQ(NMR::lib3mf_meshobject_getvertex(object, n, &vertex), 0);
    out.model.vertices.push_back(
        {vertex.m_fPosition[0], vertex.m_fPosition[1], vertex.m_fPosition[2]});
  }
  for (DWORD n = 0; n < triangles; ++n) {
    NMR::MODELMESHTRIANGLE triangle;
    EXPECT_EQ(NMR::lib3mf_meshobject_gettriangle(object, n, &triangle), 0);
    out.model.triangles.push_back(
        {triangle.m_nIndices[0], triangle.m_nIndices[1], triangle.m_nIndices[2]});
  }
}

Read3mf read_3mf(const std::filesystem::path& path) {
  Read3mf out;
  Handle<NMR::PLib3MFModel> model;
  EXPECT_EQ(NMR::lib3mf_createmodel(&model.object), 0);
  Handle<NMR::PLib3MFModelReader> reader;
  EXPECT_EQ(NMR::lib3mf_model_queryreader(model.object, "3mf", &reader.object), 0);
  EXPECT_EQ(NMR::lib3mf_reader_setstrictmodeactive(reader.object, true), 0);
  EXPECT_EQ(NMR::lib3mf_reader_readfromfileutf8(reader.object, path.c_str()), 0);
  DWORD warnings = 0, unit = 0;
  EXPECT_EQ(NMR::lib3mf_reader_getwarningcount(reader.object, &warnings), 0);
  out.warnings = warnings;
  EXPECT_EQ(NMR::lib3mf_model_getunit(model.object, &unit), 0);
  out.millimetres = unit == NMR::MODELUNIT_MILLIMETER;
  Handle<NMR::PLib3MFModelBuildItemIterator> items;
  EXPECT_EQ(NMR::lib3mf_model_getbuilditems(model.object, &items.object), 0);
  BOOL more = false;
  while (NMR::lib3mf_builditemiterator_movenext(items.object, &more) == 0 && more != 0) {
    ++out.items;
  }
  Handle<NMR::PLib3MFModelResourceIterator> meshes;
  EXPECT_EQ(NMR::lib3mf_model_getmeshobjects(model.object, &meshes.object), 0);
  while (NMR::lib3mf_resourceiterator_movenext(meshes.object, &more) == 0 && more != 0) {
    Handle<NMR::PLib3MFModelResource> resource;
    EXPECT_EQ(NMR::lib3mf_resourceiterator_getcurrent(meshes.object, &resource.object), 0);
    read_object(static_cast<NMR::PLib3MFModelMeshObject*>(resource.object), out);
    ++out.objects;
  }
  return out;
}

Read3mf write_and_read(const SolidSnapshot& snapshot, const std::string& title) {
  const auto path =
      std::filesystem::path(::testing::TempDir()) / (std::to_string(::getpid()) + "_model.3mf");
  SnapshotMesh mesh(snapshot);
  const auto written = write_model(path, mesh,
                                   {.format = ModelFormat::k3mf,
                                    .encoding = ModelEncoding::kXml,
                                    .title = title,
                                    .progress = {}});
  EXPECT_TRUE(written) << written.error().reason;
  Read3mf read = read_3mf(path);
  EXPECT_EQ(read.model.vertices.size(), written->vertices);
  EXPECT_EQ(read.model.triangles.size(), written->triangles);
  std::filesystem::remove(path);
  return read;
}

TEST(ThreemfWriter, IsManifoldAndBitIdenticalToTheSurface) {
  const BoxStock block{{-6, -4, 2}, {30, 26, 9}};
  for (unsigned seed = 1; seed <= 3; ++seed) {
    Sculpture sculpture = test::make_sculpture(block, 0.4);
    test::RandomCarver carver(sculpture, block.min_mm, block.max_mm, seed);
    for (int n = 0; n < 25; ++n) carver.cut();
    const SolidSnapshot snapshot = sculpture.solid();
    const Read3mf read = write_and_read(snapshot, "a <block> & \"more\"\x01");
    EXPECT_EQ(read.warnings, 0U);
    EXPECT_EQ(read.objects, 1U);
    EXPECT_EQ(read.items, 1U);
    EXPECT_TRUE(read.manifold);
    EXPECT_TRUE(read.millimetres);
    EXPECT_EQ(test::unmatched_edges(read.model), 0U);
    const auto path =
        std::filesystem::path(::testing::TempDir()) / (std::to_string(::getpid()) + "_same.stl");
    SnapshotMesh mesh(snapshot);
    ASSERT_TRUE(write_model(path, mesh, {.format = ModelFormat::kStl}));
    EXPECT_EQ(test::sorted_triangles(read.model),
              test::sorted_triangles(test::read_stl_bytes(test::content_of(path))));
    std::filesystem::remove(path);
  }
}

TEST(ThreemfWriter, EmptyModelIsAValidPackage) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{0, 0, 0}, {4, 4, 4}}, 0.5);
  ASSERT_TRUE(sculpture.apply(DefineTool{1, make_tool(FlatShape{20, 40}).value()}));
  ASSERT_TRUE(sculpture.apply(MoveTool{1, {{2, 2, -1}}, {{2, 2, -1}}, 1, false}));
  const Read3mf read = write_and_read(sculpture.solid(), "gone");
  EXPECT_EQ(read.objects, 0U);
  EXPECT_EQ(read.items, 0U);
}

}  // namespace
}  // namespace kerf::threemf_test
