#include "recon/reconstruction_worker.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <future>

#include "synthetic_cloud.hpp"

namespace depthscope::recon {
namespace {

/// Collects reports and lets the test wait for the n-th.
class Reports {
 public:
  ReconstructionWorker::Listener listener() {
    return [this](const ReconReport& report) {
      const std::lock_guard lock(mutex_);
      reports_.push_back(report);
      changed_.notify_all();
    };
  }
  ReconReport wait(std::size_t n) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return reports_.size() > n; });
    return reports_[n];
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<ReconReport> reports_;
};

void request(ReconstructionWorker& worker, SparseCloud cloud) {
  while (!worker.request(cloud)) std::this_thread::yield();
}

bool take(ReconstructionWorker& worker, SurfaceMesh& mesh) {
  // After a report the lock is free but for an instant; a try may meet that instant.
  for (int i = 0; i < 1000; ++i) {
    if (worker.takeNewest(mesh)) return true;
    std::this_thread::yield();
  }
  return false;
}

TEST(ReconstructionWorker, GivesWayToTheThreadThatMadeIt) {
  std::promise<int> nice;
  ReconstructionWorker worker({}, sparseSettings(), [&](const ReconReport&) {
    nice.set_value(::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid())));
  });
  request(worker, heightCloud(flat, 20, 0.01f));
  const int mine = ::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()));
  EXPECT_EQ(nice.get_future().get(), std::min(mine + 10, 19));
}

TEST(ReconstructionWorker, DeliversEachMeshOnce) {
  Reports reports;
  ReconstructionWorker worker({}, sparseSettings(), reports.listener());
  SurfaceMesh mesh;
  EXPECT_FALSE(worker.takeNewest(mesh));
  request(worker, heightCloud(flat, 20, 0.01f));
  const ReconReport report = reports.wait(0);
  EXPECT_EQ(report.status, ReconStatus::Ok);
  EXPECT_EQ(report.map_id, 7u);
  EXPECT_EQ(report.points, 400u);
  EXPECT_GT(report.duration_ms, 0);
  ASSERT_TRUE(take(worker, mesh));
  EXPECT_EQ(mesh.triangles.size(), report.triangles);
  EXPECT_FALSE(worker.takeNewest(mesh));
}

TEST(ReconstructionWorker, GivesTheSameMeshAsTheReconstructor) {
  const SparseCloud cloud = heightCloud(cap, 20, 0.01f);
  SurfaceMesh direct, through;
  ASSERT_EQ(Reconstructor({}, sparseSettings()).reconstruct(cloud, direct), ReconStatus::Ok);
  Reports reports;
  ReconstructionWorker worker({}, sparseSettings(), reports.listener());
  request(worker, cloud);
  reports.wait(0);
  ASSERT_TRUE(take(worker, through));
  EXPECT_EQ(through.vertices, direct.vertices);
  EXPECT_EQ(through.triangles, direct.triangles);
}

TEST(ReconstructionWorker, SkipsARequestThatANewerOneReplaced) {
  Reports reports;
  std::promise<void> gate;
  std::shared_future<void> open = gate.get_future().share();
  auto collect = reports.listener();
  ReconstructionWorker worker({}, sparseSettings(), [&](const ReconReport& report) {
    collect(report);
    open.wait();  // the worker is held after its first reconstruction
  });
  request(worker, heightCloud(flat, 20, 0.01f));
  reports.wait(0);
  request(worker, heightCloud(flat, 22, 0.01f));
  request(worker, heightCloud(flat, 24, 0.01f));
  gate.set_value();
  EXPECT_EQ(reports.wait(1).points, 24u * 24u);
}

TEST(ReconstructionWorker, ReportsFailureAndGoesOn) {
  Reports reports;
  ReconstructionWorker worker({}, sparseSettings(), reports.listener());
  request(worker, SparseCloud{});
  EXPECT_EQ(reports.wait(0).status, ReconStatus::TooFewPoints);
  SurfaceMesh mesh;
  EXPECT_FALSE(worker.takeNewest(mesh));
  request(worker, heightCloud(flat, 20, 0.01f));
  EXPECT_EQ(reports.wait(1).status, ReconStatus::Ok);
}

TEST(ReconstructionWorker, ReturnsStorageForReuse) {
  Reports reports;
  ReconstructionWorker worker({}, sparseSettings(), reports.listener());
  SparseCloud cloud = heightCloud(flat, 20, 0.01f);
  while (!worker.request(cloud)) std::this_thread::yield();
  reports.wait(0);
  cloud = heightCloud(flat, 20, 0.02f);
  while (!worker.request(cloud)) std::this_thread::yield();
  reports.wait(1);
  SparseCloud third;
  while (!worker.request(third)) std::this_thread::yield();
  EXPECT_GE(third.points.capacity(), 400u);
}

TEST(ReconstructionWorker, CancelsAndWorksOn) {
  Reports reports;
  ReconstructionWorker worker({}, sparseSettings(), reports.listener());
  request(worker, heightCloud(flat, 40, 0.01f));
  worker.cancel();
  request(worker, heightCloud(flat, 20, 0.01f));
  // Depending on when the cancel struck there is a report of the first or not; the second always
  // comes.
  for (std::size_t i = 0;; ++i)
    if (reports.wait(i).points == 400u) break;
}

TEST(ReconstructionWorker, EndsInTheMiddleOfWork) {
  for (int i = 0; i < 5; ++i) {
    ReconstructionWorker worker({}, sparseSettings());
    request(worker, heightCloud(cap, 40, 0.01f));
  }
}

}  // namespace
}  // namespace depthscope::recon
