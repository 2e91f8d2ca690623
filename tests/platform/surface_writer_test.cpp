#include "platform/surface_writer.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

namespace depthscope::platform {
namespace {

SurfaceMesh triangle() {
  SurfaceMesh mesh;
  mesh.vertices = {{0, 0, 1}, {1, 0, 2}, {0, 1, 3}};
  mesh.normals.assign(3, {0, 0, -1});
  mesh.confidence = {0.25f, 0.5f, 1};
  mesh.triangles = {{0, 2, 1}};
  return mesh;
}

std::string written(const SurfaceMesh& mesh, SurfaceFormat format) {
  std::ostringstream out;
  writeSurface(out, mesh, format);
  return out.str();
}

TEST(SurfaceWriter, WritesVerticesAndFacesAfterTheHeaderOfPly) {
  const std::string text = written(triangle(), SurfaceFormat::Ply);
  const std::string end = "end_header\n";
  const std::size_t body = text.find(end) + end.size();
  EXPECT_NE(text.find("element vertex 3\n"), std::string::npos);
  EXPECT_NE(text.find("element face 1\n"), std::string::npos);
  ASSERT_EQ(text.size(), body + 3 * 7 * 4 + 1 + 3 * 4);
  float second[7];
  std::memcpy(second, text.data() + body + 28, sizeof second);
  EXPECT_EQ(second[0], 1);
  EXPECT_EQ(second[2], 2);
  EXPECT_EQ(second[5], -1);
  EXPECT_EQ(second[6], 0.5f);
  EXPECT_EQ(text[body + 84], 3);
  std::int32_t face[3];
  std::memcpy(face, text.data() + body + 85, sizeof face);
  EXPECT_EQ(face[1], 2);
}

TEST(SurfaceWriter, WritesObjThatCountsFromOne) {
  SurfaceMesh mesh = triangle();
  mesh.vertices[1].x() = 0.1f;
  const std::string text = written(mesh, SurfaceFormat::Obj);
  EXPECT_NE(text.find("\nv 0.1 0 2\n"), std::string::npos);
  EXPECT_NE(text.find("\nvn 0 0 -1\n"), std::string::npos);
  EXPECT_TRUE(text.ends_with("\nf 1//1 3//3 2//2\n"));
}

TEST(SurfaceWriter, WritesColoursAndObservationsWhereThereAreAny) {
  SurfaceMesh mesh = triangle();
  mesh.colors = {{255, 0, 51}, {1, 2, 3}, {4, 5, 6}};
  mesh.observations = {7, 300, 9};
  const std::string ply = written(mesh, SurfaceFormat::Ply);
  EXPECT_NE(ply.find("property float confidence\nproperty uchar red\nproperty uchar green\n"
                     "property uchar blue\nproperty ushort observations\nelement face"),
            std::string::npos);
  const std::size_t body = ply.find("end_header\n") + 11;
  ASSERT_EQ(ply.size(), body + 3 * 33 + 13);
  EXPECT_EQ(static_cast<std::uint8_t>(ply[body + 28]), 255);
  std::uint16_t seen = 0;
  std::memcpy(&seen, ply.data() + body + 33 + 31, sizeof seen);
  EXPECT_EQ(seen, 300);
  EXPECT_NE(written(mesh, SurfaceFormat::Obj).find("\nv 0 0 1 1 0 0.2\n"), std::string::npos);
  EXPECT_EQ(written(triangle(), SurfaceFormat::Ply).find("red"), std::string::npos);
}

TEST(SurfaceWriter, WritesStlWithTheTrianglesNormals) {
  SurfaceMesh mesh = triangle();
  mesh.vertices = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  const std::string text = written(mesh, SurfaceFormat::Stl);
  ASSERT_EQ(text.size(), 80u + 4 + 50);
  EXPECT_FALSE(text.starts_with("solid"));  // would be taken for the kind in text
  std::uint32_t count = 0;
  std::memcpy(&count, text.data() + 80, sizeof count);
  EXPECT_EQ(count, 1u);
  float numbers[12];
  std::memcpy(numbers, text.data() + 84, sizeof numbers);
  EXPECT_EQ(numbers[2], -1);  // normal z: the corners go round the other way
  EXPECT_EQ(numbers[7], 1);   // y of the second corner, vertex 2
}

const SurfaceFormat all_formats[] = {SurfaceFormat::Ply, SurfaceFormat::Obj, SurfaceFormat::Stl};

TEST(SurfaceWriter, SaysThatItIsUpToScale) {
  for (SurfaceFormat format : all_formats)
    EXPECT_NE(written(triangle(), format).find("up to scale"), std::string::npos);
}

TEST(SurfaceWriter, WritesMillimetresWhereTheScaleIsKnown) {
  const MapScale scale{1, 23.5, 0.25, parseScaleRequest("10 1,2 3,4")};
  for (SurfaceFormat format : all_formats) {
    std::ostringstream mm, units;
    writeSurface(mm, triangle(), format, scale);
    writeSurface(units, triangle(), format, scale, Lengths::MapUnits);
    EXPECT_NE(mm.str().find("in mm, scale: 23.5 mm per unit +- 0.25"), std::string::npos);
    EXPECT_NE(units.str().find("in map units, scale: 23.5 mm per unit +- 0.25"), std::string::npos);
    SurfaceMesh larger = triangle();
    for (auto& v : larger.vertices) v *= 23.5f;
    const auto body = [&](const std::string& file) {
      const std::size_t header = format == SurfaceFormat::Stl
                                     ? 80
                                     : file.find(format == SurfaceFormat::Ply ? "element" : "v ");
      return file.substr(header);
    };
    EXPECT_EQ(body(mm.str()), body(written(larger, format)));
    EXPECT_EQ(body(units.str()), body(written(triangle(), format)));
  }
}

TEST(SurfaceWriter, SaysWhatTheScaleIsFrom) {
  std::ostringstream out;
  writeSurface(out, triangle(), SurfaceFormat::Obj,
               MapScale{1, 2, 0.1, parseScaleRequest("diameter 5 1,2 3,4")});
  EXPECT_NE(out.str().find("\n# scale from 5 mm across an instrument\n"), std::string::npos);
}

TEST(SurfaceWriter, AnEmptyMeshIsAValidFile) {
  const std::string ply = written({}, SurfaceFormat::Ply);
  EXPECT_NE(ply.find("element vertex 0\n"), std::string::npos);
  EXPECT_TRUE(ply.ends_with("end_header\n"));
  EXPECT_EQ(written({}, SurfaceFormat::Stl).size(), 84u);
}

TEST(SurfaceWriter, KnowsFormatsByTheEndOfAFilesName) {
  EXPECT_EQ(surfaceFormat("ply"), SurfaceFormat::Ply);
  EXPECT_EQ(surfaceFormat("OBJ"), SurfaceFormat::Obj);
  EXPECT_EQ(surfaceFormat("Stl"), SurfaceFormat::Stl);
  EXPECT_EQ(surfaceFormat("txt"), std::nullopt);
  EXPECT_EQ(surfaceFormat(""), std::nullopt);
}

}  // namespace
}  // namespace depthscope::platform
