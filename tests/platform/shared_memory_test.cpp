#include "platform/ipc/shared_memory.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <random>
#include <vector>

#include "expect_input_error.hpp"

namespace depthscope::platform {
namespace {

using ::testing::HasSubstr;

constexpr SharedCapacity capacity{64, 48, 100, 200};

UniqueFd copyOf(int fd) {
  return UniqueFd(::fcntl(fd, F_DUPFD_CLOEXEC, 0));
}

/// A sealed memfd with these bytes at its start.
UniqueFd sealed(const std::vector<char>& bytes, std::size_t size) {
  UniqueFd fd(::memfd_create("test", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  EXPECT_EQ(::ftruncate(fd.get(), static_cast<off_t>(size)), 0);
  EXPECT_EQ(::pwrite(fd.get(), bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
  EXPECT_EQ(::fcntl(fd.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL), 0);
  return fd;
}

TEST(SharedMemory, AttachesToWhatWasMade) {
  const SharedMemory made = SharedMemory::create(capacity);
  const SharedMemory attached = SharedMemory::attach(copyOf(made.fd()));
  EXPECT_EQ(attached.capacity(), capacity);
  EXPECT_EQ(attached.bytes(), made.bytes());
  WirePose pose{};
  pose.frame = 42;
  made.block().pose.write(pose);
  pose = {};
  ASSERT_TRUE(attached.block().pose.read(pose));
  EXPECT_EQ(pose.frame, 42);
}

TEST(SharedMemory, RegionsLieInsideAndApart) {
  const SharedMemory m = SharedMemory::create(capacity);
  const auto at = [&](const seqlock::Word* w) {
    return static_cast<std::size_t>(reinterpret_cast<const char*>(w) -
                                    reinterpret_cast<const char*>(&m.block()));
  };
  std::vector<std::pair<std::size_t, std::size_t>> regions{{0, sizeof(SharedBlock)}};
  for (std::uint32_t i = 0; i < ring_slots; ++i) {
    regions.emplace_back(at(m.pixels(i)), 64 * 48);
    regions.emplace_back(at(m.color(i)), 64 * 48 * 3);  // too small to be reduced
  }
  for (std::uint32_t i = 0; i < 2; ++i) {
    const SurfaceArrays a = m.surface(i);
    regions.emplace_back(at(a.vertices), 1200);
    regions.emplace_back(at(a.normals), 1200);
    regions.emplace_back(at(a.confidence), 400);
    regions.emplace_back(at(a.observations), 200);
    regions.emplace_back(at(a.colors), 300);
    regions.emplace_back(at(a.triangles), 2400);
  }
  for (std::size_t i = 0; i + 1 < regions.size(); ++i)
    EXPECT_LE(regions[i].first + regions[i].second, regions[i + 1].first) << i;
  EXPECT_LE(regions.back().first + regions.back().second, m.bytes());
}

TEST(SharedMemory, CannotBeResizedByAnybody) {
  const SharedMemory m = SharedMemory::create(capacity);
  EXPECT_NE(::ftruncate(m.fd(), 16), 0);
  EXPECT_NE(::ftruncate(m.fd(), static_cast<off_t>(2 * m.bytes())), 0);
}

TEST(SharedMemory, RefusesWhatIsNotSealedOrTooSmall) {
  UniqueFd fd(::memfd_create("test", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  ASSERT_EQ(::ftruncate(fd.get(), 1 << 20), 0);
  EXPECT_INPUT_ERROR(SharedMemory::attach(copyOf(fd.get())), HasSubstr("not sealed"));
  EXPECT_INPUT_ERROR(SharedMemory::attach(sealed({}, 8)), HasSubstr("too small"));
  EXPECT_INPUT_ERROR(SharedMemory::attach(UniqueFd()), HasSubstr("too small"));
}

TEST(SharedMemory, RefusesAHeaderThatDoesNotFitTheSize) {
  const SharedMemory m = SharedMemory::create(capacity);
  std::vector<char> header(sizeof(SharedBlock));
  ASSERT_EQ(::pread(m.fd(), header.data(), header.size(), 0), static_cast<ssize_t>(header.size()));
  EXPECT_NO_THROW(SharedMemory::attach(sealed(header, m.bytes())));
  EXPECT_INPUT_ERROR(SharedMemory::attach(sealed(header, m.bytes() + 64)), HasSubstr("layout"));
  EXPECT_INPUT_ERROR(SharedMemory::attach(sealed(header, m.bytes() - 64)), HasSubstr("layout"));
  for (std::size_t offset : {offsetof(SharedBlock, magic), offsetof(SharedBlock, layout_version),
                             offsetof(SharedBlock, capacity)}) {
    std::vector<char> changed = header;
    changed[offset] = static_cast<char>(changed[offset] ^ 1);
    EXPECT_INPUT_ERROR(SharedMemory::attach(sealed(changed, m.bytes())), HasSubstr("layout"));
  }
}

TEST(SharedMemory, RefusesGarbage) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    std::vector<char> bytes(sizeof(SharedBlock));
    for (char& b : bytes) b = static_cast<char>(random());
    EXPECT_THROW(SharedMemory::attach(sealed(bytes, 1 << 16)), InputError);
  }
}

TEST(SharedMemory, RefusesACapacityThatCannotBe) {
  EXPECT_THROW(SharedMemory::create({0, 48, 1, 1}), InputError);
  EXPECT_THROW(SharedMemory::create({64, 1u << 30, 1, 1}), InputError);
  EXPECT_THROW(SharedMemory::create({64, 48, 0xFFFFFFFF, 1}), InputError);
}

}  // namespace
}  // namespace depthscope::platform
