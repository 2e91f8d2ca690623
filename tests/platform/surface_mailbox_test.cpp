#include "platform/ipc/surface_mailbox.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <thread>

namespace depthscope::platform {
namespace {

using Result = SurfaceMailboxReader::Result;

/// A strip of triangles; every number tells the version, so that a torn mesh shows.
SurfaceMesh strip(std::uint32_t version, std::size_t vertices) {
  SurfaceMesh mesh;
  mesh.map_id = 5;
  mesh.version = version;
  const auto value = static_cast<float>(version);
  mesh.vertices.assign(vertices, Eigen::Vector3f(value, value, value));
  mesh.normals.assign(vertices, Eigen::Vector3f(0, 0, -1));
  mesh.confidence.assign(vertices, 1.0f / (1 + value));
  mesh.observations.assign(vertices, static_cast<std::uint16_t>(version));
  mesh.colors.assign(vertices, Rgb{static_cast<std::uint8_t>(version), 2, 3});
  for (std::uint32_t i = 0; i + 2 < vertices; ++i) mesh.triangles.push_back({i, i + 1, i + 2});
  return mesh;
}

TEST(SurfaceMailbox, HandsOverTheNewestOnce) {
  const SharedMemory memory = SharedMemory::create({8, 8, 50, 60});
  SurfaceMailboxWriter writer(memory);
  SurfaceMailboxReader reader(memory);
  SurfaceMesh mesh;
  EXPECT_EQ(reader.takeNewest(mesh), Result::Nothing);
  for (std::uint32_t v = 1; v < 6; ++v) {
    ASSERT_TRUE(writer.publish(strip(v, 10 + v)));
    ASSERT_EQ(reader.takeNewest(mesh), Result::Taken);
    const SurfaceMesh expected = strip(v, 10 + v);
    EXPECT_EQ(mesh.map_id, 5u);
    EXPECT_EQ(mesh.version, v);
    EXPECT_EQ(mesh.vertices, expected.vertices);
    EXPECT_EQ(mesh.normals, expected.normals);
    EXPECT_EQ(mesh.confidence, expected.confidence);
    EXPECT_EQ(mesh.observations, expected.observations);
    EXPECT_EQ(mesh.colors, expected.colors);
    EXPECT_EQ(mesh.triangles, expected.triangles);
    EXPECT_EQ(reader.takeNewest(mesh), Result::Nothing);
  }
}

TEST(SurfaceMailbox, ASurfaceMayHaveNoColours) {
  const SharedMemory memory = SharedMemory::create({8, 8, 50, 60});
  SurfaceMailboxReader reader(memory);
  SurfaceMesh mesh;
  ASSERT_TRUE(SurfaceMailboxWriter(memory).publish(strip(1, 20)));
  ASSERT_EQ(reader.takeNewest(mesh), Result::Taken);
  SurfaceMesh plain = strip(2, 20);
  plain.colors.clear();
  plain.observations.clear();
  ASSERT_TRUE(SurfaceMailboxWriter(memory).publish(plain));
  ASSERT_EQ(reader.takeNewest(mesh), Result::Taken);
  EXPECT_TRUE(mesh.colors.empty());
  EXPECT_TRUE(mesh.observations.empty());
}

TEST(SurfaceMailbox, RefusesWhatHasNoRoomOrDoesNotMatch) {
  const SharedMemory memory = SharedMemory::create({8, 8, 50, 60});
  SurfaceMailboxWriter writer(memory);
  EXPECT_FALSE(writer.publish(strip(1, 51)));
  SurfaceMesh mesh = strip(1, 20);
  mesh.triangles.resize(61);
  EXPECT_FALSE(writer.publish(mesh));
  mesh = strip(1, 20);
  mesh.normals.pop_back();
  EXPECT_FALSE(writer.publish(mesh));
  mesh = strip(1, 20);
  mesh.colors.pop_back();
  EXPECT_FALSE(writer.publish(mesh));
}

TEST(SurfaceMailbox, ReadsWithoutAllocatingOnceThereIsRoom) {
  const SharedMemory memory = SharedMemory::create({8, 8, 50, 60});
  SurfaceMesh mesh;
  reserve(mesh, memory.capacity());
  const auto* place = mesh.vertices.data();
  SurfaceMailboxWriter(memory).publish(strip(1, 50));
  ASSERT_EQ(SurfaceMailboxReader(memory).takeNewest(mesh), Result::Taken);
  EXPECT_EQ(mesh.vertices.data(), place);
}

TEST(SurfaceMailbox, RejectsUnsoundMeshes) {
  const SharedMemory memory = SharedMemory::create({8, 8, 50, 60});
  SurfaceMailboxReader reader(memory);
  SurfaceMesh read;
  const auto rejected = [&](auto&& spoil) {
    SurfaceMesh mesh = strip(1, 20);
    spoil(mesh);
    EXPECT_TRUE(SurfaceMailboxWriter(memory).publish(mesh));
    return reader.takeNewest(read) == Result::Rejected;
  };
  EXPECT_TRUE(rejected([](SurfaceMesh& m) { m.vertices[3].y() = NAN; }));
  EXPECT_TRUE(rejected([](SurfaceMesh& m) { m.vertices[0].x() = INFINITY; }));
  EXPECT_TRUE(rejected([](SurfaceMesh& m) { m.vertices[0].x() = 1e30f; }));
  EXPECT_TRUE(rejected([](SurfaceMesh& m) { m.normals[19].z() = NAN; }));
  EXPECT_TRUE(rejected([](SurfaceMesh& m) { m.normals[19].z() = 4; }));
  EXPECT_TRUE(rejected([](SurfaceMesh& m) { m.confidence[7] = -0.1f; }));
  EXPECT_TRUE(rejected([](SurfaceMesh& m) { m.confidence[7] = NAN; }));
  EXPECT_TRUE(rejected([](SurfaceMesh& m) { m.triangles.back()[2] = 20; }));
  EXPECT_TRUE(rejected([](SurfaceMesh& m) { m.triangles.front()[0] = 0xFFFFFFFF; }));
  EXPECT_FALSE(rejected([](SurfaceMesh&) {}));
}

TEST(SurfaceMailbox, RejectsCountsBeyondTheCapacity) {
  const SharedMemory memory = SharedMemory::create({8, 8, 50, 60});
  SurfaceMailboxWriter(memory).publish(strip(1, 20));
  for (const WireSurfaceInfo lie :
       {WireSurfaceInfo{1, 1, 51, 10, 0, 0}, WireSurfaceInfo{1, 1, 20, 61, 0, 0},
        WireSurfaceInfo{1, 1, 20, 10, 21, 20}, WireSurfaceInfo{1, 1, 20, 10, 20, 0xFFFFFFFF}}) {
    seqlock::store(memory.block().surfaces[1].info, &lie, sizeof lie);
    SurfaceMesh mesh;
    EXPECT_EQ(SurfaceMailboxReader(memory).takeNewest(mesh), Result::Rejected);
  }
}

TEST(SurfaceMailbox, AWriterThatDiedWithinAWriteLeavesNothingToTake) {
  const SharedMemory memory = SharedMemory::create({8, 8, 50, 60});
  SurfaceMailboxWriter(memory).publish(strip(1, 20));
  seqlock::beginWrite(memory.block().surfaces[1].count);
  SurfaceMailboxReader reader(memory);
  SurfaceMesh mesh;
  EXPECT_EQ(reader.takeNewest(mesh), Result::Nothing);
  SurfaceMailboxWriter(memory).publish(strip(2, 20));  // its successor
  EXPECT_EQ(reader.takeNewest(mesh), Result::Taken);
}

TEST(SurfaceMailbox, ReadersSurviveGarbage) {
  const SharedMemory memory = SharedMemory::create({8, 8, 50, 60});
  std::mt19937_64 random(1);
  SurfaceMailboxReader reader(memory);
  SurfaceMesh mesh;
  int taken = 0;
  for (int i = 0; i < 5000; ++i) {
    SharedBlock& block = memory.block();
    block.surfaces_published.store(random());
    for (std::uint32_t s = 0; s < 2; ++s) {
      block.surfaces[s].count.store(random());
      const auto small = [&] { return static_cast<std::uint32_t>(random() % 70); };
      const WireSurfaceInfo info{1,
                                 1,
                                 i % 3 == 0 ? static_cast<std::uint32_t>(random()) : small(),
                                 small(),
                                 i % 2 == 0 ? 0 : small(),
                                 0};
      seqlock::store(block.surfaces[s].info, &info, sizeof info);
      const SurfaceArrays a = memory.surface(s);
      for (seqlock::Word* array :
           {a.vertices, a.normals, a.confidence, a.observations, a.colors, a.triangles})
        for (int k = 0; k < 12; ++k) array[k].store(random() & 0x3FFFFFFF3FFFFFFF);
    }
    if (reader.takeNewest(mesh) == Result::Taken) {
      ++taken;
      ASSERT_TRUE(isSound(mesh));
    }
  }
  SUCCEED() << taken;
}

TEST(SurfaceMailbox, TwoThreadsNeverSeeATornSurface) {
  const SharedMemory memory = SharedMemory::create({8, 8, 50, 60});
  constexpr std::uint32_t surfaces = 5000;
  std::thread thread([&] {
    SurfaceMailboxWriter writer(memory);
    for (std::uint32_t v = 1; v <= surfaces; ++v) writer.publish(strip(v, 3 + v % 40));
  });
  SurfaceMailboxReader reader(memory);
  SurfaceMesh mesh;
  std::uint32_t last = 0;
  while (last < surfaces) {
    const Result result = reader.takeNewest(mesh);
    ASSERT_NE(result, Result::Rejected);
    if (result != Result::Taken) continue;
    ASSERT_GT(mesh.version, last);
    last = mesh.version;
    const SurfaceMesh expected = strip(last, 3 + last % 40);
    ASSERT_EQ(mesh.vertices, expected.vertices);
    ASSERT_EQ(mesh.triangles, expected.triangles);
  }
  thread.join();
}

}  // namespace
}  // namespace depthscope::platform
