#include "platform/ply_writer.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

namespace depthscope::platform {
namespace {

TEST(PlyWriter, WritesVerticesAndFacesAfterTheHeader) {
  SurfaceMesh mesh;
  mesh.vertices = {{0, 0, 1}, {1, 0, 2}, {0, 1, 3}};
  mesh.normals.assign(3, {0, 0, -1});
  mesh.confidence = {0.25f, 0.5f, 1};
  mesh.triangles = {{0, 2, 1}};
  std::ostringstream out;
  writePly(out, mesh);
  const std::string text = out.str();
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

TEST(PlyWriter, AnEmptyMeshIsAValidFile) {
  std::ostringstream out;
  writePly(out, SurfaceMesh());
  EXPECT_NE(out.str().find("element vertex 0\n"), std::string::npos);
  EXPECT_TRUE(out.str().ends_with("end_header\n"));
}

}  // namespace
}  // namespace depthscope::platform
