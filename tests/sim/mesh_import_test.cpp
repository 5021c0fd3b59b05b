// Mesh files are untrusted: whatever is wrong with one, the answer is a mesh or an Error.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/base/random.hpp>
#include <isobath/sim/triangle_mesh.hpp>
#include <sstream>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using test::scratch_folder;

/// A box of 2 x 4 x 1 m.
std::string box_ply() {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 6\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < 8; ++i) text += fmt::format("{} {} {}\n", 2 * (i & 1), 2 * (i & 2), (i & 4) / 4);
  return text + "4 0 1 3 2\n4 4 6 7 5\n4 0 4 5 1\n4 2 3 7 6\n4 0 2 6 4\n4 1 5 7 3\n";
}

std::string box_obj() {
  std::string text = "o box\n";
  for (int i = 0; i < 8; ++i) text += fmt::format("v {} {} {}\n", 2 * (i & 1), 2 * (i & 2), (i & 4) / 4);
  return text + "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n";
}

std::string wedge_stl() {
  const auto facet = [](const char* corners) {
    return fmt::format("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", corners);
  };
  return "solid wedge\n" + facet("vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n") +
         facet("vertex 0 0 0\nvertex 0 1 0\nvertex 0 0 1\n") + "endsolid wedge\n";
}

std::string sheet_dae() {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 3 0 0 3 2 0 0 2 0</float_array>
<technique_common><accessor source="#a" count="4" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 0 2 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
)";
}

TriangleMesh mesh_from(const std::string& name, const std::string& text) {
  const auto file = scratch_folder() / name;
  write_whole_file(file, text);
  return load_mesh(file.string(), 1, {});
}

TEST(MeshImport, ReadsTheFormatsThatSceneAuthorsUse) {
  EXPECT_EQ(mesh_from("box.ply", box_ply()).triangles.size(), 12u);
  EXPECT_EQ(mesh_from("box.obj", box_obj()).triangles.size(), 12u);
  EXPECT_EQ(mesh_from("wedge.stl", wedge_stl()).triangles.size(), 2u);
  EXPECT_EQ(mesh_from("sheet.dae", sheet_dae()).triangles.size(), 2u);
  const TriangleMesh sheet = mesh_from("sheet.dae", sheet_dae());
  Eigen::Vector3f most = sheet.vertices[0];
  for (const Eigen::Vector3f& v : sheet.vertices) most = most.cwiseMax(v);
  EXPECT_EQ(most, Eigen::Vector3f(3, 2, 0)) << "in the axes of the file";
}

/// The text with one line gone, doubled or changed, or with one byte changed.
std::string damaged(const std::string& text, Random& random) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line + "\n");
  const std::size_t at = random.index(lines.size());
  switch (random.index(4)) {
    case 0: lines[at].clear(); break;
    case 1: lines[at] += lines[at]; break;
    case 2: lines[at] = lines[random.index(lines.size())]; break;
    default: lines[at][random.index(lines[at].size())] = static_cast<char>(random.index(256));
  }
  std::string all;
  for (const std::string& line : lines) all += line;
  return all;
}

// Read by Assimp in this process, a third of the damaged PLY files end it.
TEST(MeshImport, ADamagedFileIsAMeshOrAnErrorAndNoCrash) {
  Random random(1);
  int read = 0, refused = 0;
  for (const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{
           {"box.ply", box_ply()}, {"box.obj", box_obj()}, {"wedge.stl", wedge_stl()}, {"sheet.dae", sheet_dae()}}) {
    for (int i = 0; i < 50; ++i) {
      try {
        const TriangleMesh mesh = mesh_from(name, damaged(text, random));
        EXPECT_FALSE(mesh.triangles.empty());
        for (const Eigen::Vector3i& t : mesh.triangles) {
          ASSERT_GE(t.minCoeff(), 0);
          ASSERT_LT(t.maxCoeff(), static_cast<int>(mesh.vertices.size()));
        }
        ++read;
      } catch (const Error& refusal) {
        EXPECT_NE(std::string(refusal.what()).find("no readable mesh: "), std::string::npos) << refusal.what();
        ++refused;
      }
    }
  }
  EXPECT_GT(read, 20);
  EXPECT_GT(refused, 20);
}

}  // namespace
}  // namespace isobath
