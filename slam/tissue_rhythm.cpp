#include "slam/tissue_rhythm.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace depthscope::slam {
namespace {

// Breaths a second, of a ventilated patient and of one who breathes by himself.
constexpr double kSlowest_hz = 0.1, kFastest_hz = 0.6;
constexpr double kMinPeriods = 2.5;  // fewer cannot be told from a drift
constexpr int kMinViewsAPeriod = 4;
constexpr int kStepsAPeriodogram = 8;  // to 1 / duration, the width of its peaks
// By how much a rhythm must lessen the errors' cost for each number that it takes, in units of what
// chance does, and how far it must stand out from the median of all frequencies, which models that
// do not quite fit lift as well. Seen: breathing 88 to 128, 2.3 to 4.6 times the median; still
// tissue 7 to 16; a hand-held camera 56. Breathing seen for little more than two breaths, or from
// few places, 97 to 220, but 1.3 to 1.5 times the median, and the rhythm may be wrong. Where it was
// taken all the same, and over still tissue, paths were off by 5 % more or less.
constexpr double kMinGain = 70, kMinProminence = 1.8;
constexpr double kShapeSigma = 0.03;  // relative change of lengths that is no surprise
constexpr double kDamping = 1e-6;  // relative: nothing holds place, direction and scale of it all
constexpr int kMinTermsOfPoint = 2;

}  // namespace

/// The normal equations of poses and shapes, one of each a view, points eliminated.
class TissueRhythm::Problem {
 public:
  Problem(const Intrinsics& camera, std::span<const TimedView> views,
          std::span<const Eigen::Vector3d> points, std::span<const BaObservation> observations)
      : camera_(camera),
        views_(views),
        points_(points),
        n_(static_cast<int>(views.size())),
        H_poses_(Eigen::MatrixXd::Zero(6 * n_, 6 * n_)),
        H_mixed_(Eigen::MatrixXd::Zero(6 * n_, kShapes * n_)),
        H_shapes_(Eigen::MatrixXd::Zero(kShapes * n_, kShapes * n_)),
        b_poses_(Eigen::VectorXd::Zero(6 * n_)),
        b_shapes_(Eigen::VectorXd::Zero(kShapes * n_)),
        held_(views.size(), Held::Zero()) {
    middle_ = points.empty() ? Eigen::Vector3d::Zero() : middleOf(points);
    for (std::size_t begin = 0, end = 0; begin < observations.size(); begin = end) {
      while (end < observations.size() && observations[end].point == observations[begin].point)
        ++end;
      addPoint(observations.subspan(begin, end - begin));
    }
  }

  /// Eliminates the poses; false where that cannot be done.
  bool eliminatePoses() {
    H_poses_.diagonal() *= 1 + kDamping;
    Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(H_poses_);
    if (llt.info() != Eigen::Success) return false;
    llt.matrixL().solveInPlace(H_mixed_);
    llt.matrixL().solveInPlace(b_poses_);
    H_shapes_.noalias() -= H_mixed_.transpose() * H_mixed_;
    b_shapes_.noalias() -= H_mixed_.transpose() * b_poses_;
    return true;
  }

  /// By how much a rhythm lessens the cost, for each number that it takes, in units of noise.
  double gain(double frequency_hz, Shape& cosine, Shape& sine) const {
    Eigen::Matrix<double, 2 * kShapes, 2 * kShapes> H;
    H.setIdentity();
    H /= kShapeSigma * kShapeSigma;
    Eigen::Matrix<double, 2 * kShapes, 1> b;
    b.setZero();
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(kShapes * n_, 2 * kShapes);
    for (int i = 0; i < n_; ++i) {
      const double phase = 2 * std::numbers::pi * frequency_hz * views_[i].timestamp_s;
      for (int k = 0; k < kShapes; ++k) {
        basis(kShapes * i + k, k) = std::cos(phase);
        basis(kShapes * i + k, kShapes + k) = std::sin(phase);
      }
    }
    H += basis.transpose() * (H_shapes_ * basis);
    b += basis.transpose() * b_shapes_;
    const Eigen::LDLT<Eigen::Matrix<double, 2 * kShapes, 2 * kShapes>> ldlt(H);
    const Eigen::Matrix<double, 2 * kShapes, 1> x = ldlt.solve(b);
    if (ldlt.info() != Eigen::Success || !x.allFinite()) return 0;
    cosine = x.head<kShapes>();
    sine = x.tail<kShapes>();
    const double noise = cost_ / (2 * terms_);  // variance of one of a term's two coordinates
    return b.dot(x) / (2 * kShapes * noise);
  }

  /// How poses go along with the shapes that a rhythm gives all views, and each with its own alone.
  void solvePoses(TissueRhythm& rhythm) const {
    Eigen::VectorXd shapes(kShapes * n_);
    for (int i = 0; i < n_; ++i)
      shapes.segment<kShapes>(kShapes * i) = rhythm.shapeAt(views_[i].timestamp_s);
    Eigen::VectorXd poses = -(H_mixed_ * shapes);
    H_poses_.triangularView<Eigen::Lower>().transpose().solveInPlace(poses);
    rhythm.offset_.resize(views_.size());
    rhythm.of_the_shape_.resize(views_.size());
    for (int i = 0; i < n_; ++i) {
      const Held& H = held_[i];
      const Matrix6d H_pose = H.topLeftCorner<6, 6>() + kDamping * Matrix6d::Identity();
      rhythm.of_the_shape_[i] = -H_pose.ldlt().solve(H.topRightCorner<6, kShapes>().eval());
      rhythm.offset_[i] =
          poses.segment<6>(6 * i) - rhythm.of_the_shape_[i] * shapes.segment<kShapes>(kShapes * i);
    }
  }

 private:
  using Held = Eigen::Matrix<double, 6 + kShapes, 6 + kShapes>;
  struct Term {
    int view;
    Eigen::Matrix<double, 6 + kShapes, 3> W;
  };

  static Eigen::Vector3d middleOf(std::span<const Eigen::Vector3d> points) {
    Eigen::Vector3d middle;
    std::vector<double> sorted(points.size());
    for (int axis = 0; axis < 3; ++axis) {
      std::transform(points.begin(), points.end(), sorted.begin(),
                     [&](const Eigen::Vector3d& p) { return p[axis]; });
      const auto half = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
      std::nth_element(sorted.begin(), half, sorted.end());
      middle[axis] = *half;
    }
    return middle;
  }

  /// How a point moves with each of the shapes, 3 x kShapes.
  Eigen::Matrix<double, 3, kShapes> motionWithShapes(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d d = point - middle_;
    Eigen::Matrix<double, 3, kShapes> M;
    M << d.x(), d.x(), d.y(), d.z(), 0,  //
        -d.y(), d.y(), d.x(), 0, d.z(),  //
        0, -2 * d.z(), 0, d.x(), d.y();
    return M;
  }

  void addPoint(std::span<const BaObservation> observations) {
    const Eigen::Vector3d& point = points_[observations.front().point];
    const Eigen::Matrix<double, 3, kShapes> M = motionWithShapes(point);
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    seen_.clear();
    if (observations.size() < kMinTermsOfPoint) return;
    for (const BaObservation& o : observations) {
      const Pose& T = views_[o.pose].T_camera_world;
      const Eigen::Vector3d p = T * point;
      if (!(p.z() > kMinDepth)) continue;
      const Eigen::Vector2d r = camera_.project(p) - o.pixel.cast<double>();
      const double chi2 = r.squaredNorm() * o.inv_sigma2, delta = std::sqrt(kChi2TwoDof95);
      const double w = o.inv_sigma2 * huberWeight(chi2, delta);
      cost_ += huberCost(chi2, delta);
      ++terms_;
      const Eigen::Matrix<double, 2, 3> Jp = pointJacobian(projectionJacobian(camera_, p), T.R);
      Eigen::Matrix<double, 2, 6 + kShapes> J;
      J << poseJacobian(camera_, p), Jp * M;
      H.noalias() += Jp.transpose() * (w * Jp);
      b.noalias() -= Jp.transpose() * (w * r);
      seen_.push_back({o.pose, J.transpose() * (w * Jp)});
      const Held own = J.transpose() * (w * J);
      held_[o.pose] += own;
      add(o.pose, o.pose, own);
      add(o.pose, -(J.transpose() * (w * r)));
    }
    H.diagonal() *= 1 + kDamping;
    Eigen::Matrix3d H_inverse;
    bool invertible = false;
    H.computeInverseWithCheck(H_inverse, invertible, 0);
    if (!invertible) return;
    for (const Term& i : seen_) {
      const Eigen::Matrix<double, 6 + kShapes, 3> W = i.W * H_inverse;
      add(i.view, -(W * b));
      for (const Term& j : seen_) add(i.view, j.view, -(W * j.W.transpose()));
    }
  }

  void add(int i, int j, const Held& block) {
    H_poses_.block<6, 6>(6 * i, 6 * j) += block.topLeftCorner<6, 6>();
    H_mixed_.block<6, kShapes>(6 * i, kShapes * j) += block.topRightCorner<6, kShapes>();
    H_shapes_.block<kShapes, kShapes>(kShapes * i, kShapes * j) +=
        block.bottomRightCorner<kShapes, kShapes>();
  }
  void add(int i, const Eigen::Matrix<double, 6 + kShapes, 1>& b) {
    b_poses_.segment<6>(6 * i) += b.head<6>();
    b_shapes_.segment<kShapes>(kShapes * i) += b.tail<kShapes>();
  }

  Intrinsics camera_;
  std::span<const TimedView> views_;
  std::span<const Eigen::Vector3d> points_;
  int n_;
  Eigen::Vector3d middle_;
  Eigen::MatrixXd H_poses_;  // after eliminatePoses() its Cholesky factor
  Eigen::MatrixXd H_mixed_, H_shapes_;
  Eigen::VectorXd b_poses_, b_shapes_;
  std::vector<Held> held_;  // per view, points held
  std::vector<Term> seen_;  // of the point at work
  double cost_ = 0;
  int terms_ = 0;
};

TissueRhythm::Shape TissueRhythm::shapeAt(double timestamp_s) const {
  const double phase = 2 * std::numbers::pi * frequency_hz_ * timestamp_s;
  return cosine_ * std::cos(phase) + sine_ * std::sin(phase);
}

Vector6d TissueRhythm::correction(int view, double timestamp_s) const {
  return offset_[view] + of_the_shape_[view] * shapeAt(timestamp_s);
}

std::optional<TissueRhythm> TissueRhythm::find(const Intrinsics& camera,
                                               std::span<const TimedView> views,
                                               std::span<const Eigen::Vector3d> points,
                                               std::span<const BaObservation> observations) {
  if (views.size() < 2 * kMinPeriods * kMinViewsAPeriod) return std::nullopt;
  const auto [first, last] = std::minmax_element(
      views.begin(), views.end(),
      [](const TimedView& a, const TimedView& b) { return a.timestamp_s < b.timestamp_s; });
  const double duration_s = last->timestamp_s - first->timestamp_s;
  const double slowest_hz = std::max(kSlowest_hz, kMinPeriods / duration_s);
  const double fastest_hz =
      std::min(kFastest_hz, static_cast<double>(views.size()) / (kMinViewsAPeriod * duration_s));
  if (!(duration_s > 0 && slowest_hz < fastest_hz)) return std::nullopt;

  Problem problem(camera, views, points, observations);
  if (!problem.eliminatePoses()) return std::nullopt;
  std::vector<double> gains;
  TissueRhythm best;
  double most = 0;
  bool rose = false;  // at the last frequency: what is highest there is the flank of a peak
  for (double f = slowest_hz; f <= fastest_hz; f += 1 / (kStepsAPeriodogram * duration_s)) {
    TissueRhythm tried;
    tried.frequency_hz_ = f;
    gains.push_back(problem.gain(f, tried.cosine_, tried.sine_));
    rose = gains.back() > most;
    if (!rose) continue;
    most = gains.back();
    best = tried;
  }
  const bool flank = rose || best.frequency_hz_ == slowest_hz;
  const auto median = gains.begin() + static_cast<std::ptrdiff_t>(gains.size() / 2);
  std::nth_element(gains.begin(), median, gains.end());
  if (flank || most < kMinGain || most < kMinProminence * *median) return std::nullopt;
  problem.solvePoses(best);
  return best;
}

}  // namespace depthscope::slam
