#include "recon/mesh_io.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "recon/reconstructor.hpp"
#include "synthetic_cloud.hpp"
#include "types/error.hpp"

namespace depthscope::recon {
namespace {

using std::filesystem::path;

class MeshIo : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    dir_ = path(testing::TempDir()) / (std::string("depthscope_mesh_io_") + test->name());
    std::filesystem::remove_all(dir_);
    std::filesystem::create_directories(dir_);
  }
  void TearDown() override { std::filesystem::remove_all(dir_); }

  path write(const std::string& bytes) const {
    std::ofstream(dir_ / "in.ply", std::ios::binary) << bytes;
    return dir_ / "in.ply";
  }

  /// The error readPly gives for a file of these bytes.
  std::string errorFor(const std::string& bytes) const {
    try {
      readPly(write(bytes));
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }

  path dir_;
};

const std::string kVertexHeader =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\n";

TEST_F(MeshIo, ReplacesAFileAndLeavesNothingElseBehind) {
  const SparseCloud cloud = heightCloud(cap, 5, 0.01f);
  writePly(dir_ / "map.ply", cloud);
  writePly(dir_ / "map.ply", cloud);
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(dir_)) ++files;
  EXPECT_EQ(files, 1);
}

TEST_F(MeshIo, WritesASparseCloudThatCanBeReadAsPoints) {
  const SparseCloud cloud = heightCloud(cap, 5, 0.01f);
  writePly(dir_ / "map.ply", cloud);
  const SurfaceMesh read = readPly(dir_ / "map.ply");
  ASSERT_EQ(read.vertices.size(), 25u);
  EXPECT_TRUE(read.empty());
  EXPECT_EQ(read.vertices[13], cloud.points[13].position);
  EXPECT_EQ(read.normals[13], cloud.points[13].view_direction);
}

TEST_F(MeshIo, SaysWhichFolderCannotBeWritten) {
  try {
    writePly(dir_ / "missing" / "map.ply", SparseCloud());
    FAIL() << "written";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("missing/map.ply"));
  }
}

TEST_F(MeshIo, SplitsPolygonsAndComputesMissingNormals) {
  const SurfaceMesh mesh =
      readPly(write(kVertexHeader + "element face 1\nproperty list uchar int vertex_indices\n"
                                    "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"));
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
  EXPECT_EQ(mesh.normals[0], Eigen::Vector3f::UnitZ());
  EXPECT_EQ(mesh.confidence[0], 1.f);
}

TEST_F(MeshIo, SkipsElementsAndPropertiesItDoesNotKnow) {
  const SurfaceMesh mesh =
      readPly(write("ply\r\nformat ascii 1.0\r\ncomment made elsewhere\r\nelement camera 1\r\n"
                    "property list uchar float view\r\nelement vertex 1\r\nproperty uchar red\r\n"
                    "property double x\r\nproperty double y\r\nproperty double z\r\nend_header\r\n"
                    "2 9 9\r\n255 1 2 3\r\n"));
  ASSERT_EQ(mesh.vertices.size(), 1u);
  EXPECT_EQ(mesh.vertices[0], Eigen::Vector3f(1, 2, 3));
}

TEST_F(MeshIo, ReadsTheSceneOfTheSampleClip) {
  const SurfaceMesh scene = readPly(path(DEPTHSCOPE_TEST_DATA) / "sample" / "scene.ply");
  EXPECT_EQ(scene.vertices.size(), 121290u);
  EXPECT_EQ(scene.triangles.size(), 242512u);
}

TEST_F(MeshIo, NamesTheFileAndWhatIsWrongWithIt) {
  using testing::AllOf;
  using testing::HasSubstr;
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string corners = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  EXPECT_THAT(errorFor(""), AllOf(HasSubstr("in.ply"), HasSubstr("cut short")));
  EXPECT_THAT(errorFor("solid thing\n"), HasSubstr("not a PLY file"));
  EXPECT_THAT(errorFor("ply\nformat binary_big_endian 1.0\nend_header\n"), HasSubstr("big_endian"));
  EXPECT_THAT(errorFor("ply\nformat ascii 1.0\nend_header\n"), HasSubstr("without vertices"));
  EXPECT_THAT(errorFor(kVertexHeader + "end_header\n0 0 0\n1 0"), HasSubstr("cut short"));
  EXPECT_THAT(errorFor(kVertexHeader + "end_header\n0 0 0\n1 0 nan\n0 0 0\n0 0 0\n"),
              HasSubstr("vertex 1 is not finite"));
  EXPECT_THAT(errorFor(kVertexHeader + faces + corners + "3 0 1 9\n"), HasSubstr("face 0"));
  EXPECT_THAT(errorFor(kVertexHeader + faces + corners + "200 0 1 2\n"), HasSubstr("longer"));
  EXPECT_THAT(errorFor("ply\nformat ascii 1.0\nelement vertex 4000000000\nend_header\n"),
              HasSubstr("do not fit"));
  EXPECT_THAT(
      errorFor("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
      HasSubstr("without x, y and z"));
  EXPECT_THROW(readPly(dir_ / "nowhere.ply"), InputError);
  EXPECT_THROW(readPly(dir_), InputError);
}

TEST_F(MeshIo, NoticesABinaryFileCutAnywhere) {
  writePly(dir_ / "map.ply", heightCloud(cap, 3, 0.01f));
  std::ifstream in(dir_ / "map.ply", std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  for (std::size_t n = 0; n < whole.size(); ++n)
    ASSERT_NE(errorFor(whole.substr(0, n)), "no error") << n;
  EXPECT_EQ(errorFor(whole), "no error");
}

}  // namespace
}  // namespace depthscope::recon
