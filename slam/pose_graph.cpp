#include "slam/pose_graph.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace depthscope::slam {

namespace {

constexpr double kMinRelativeDecrease = 1e-6;  // of the cost: below, it has converged
constexpr double kResidual = 1e-8;             // of the squared residual: a step is good enough
constexpr int kMaxProducts = 400;              // of a step
constexpr double kMinLambda = 1e-9, kMaxLambda = 1e6;

/// In an order that is fixed, whatever the vectors are aligned to.
double dot(const std::vector<Vector7d>& a, const std::vector<Vector7d>& b, std::size_t n) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i].dot(b[i]);
  return sum;
}

}  // namespace

PoseGraph::PoseGraph(int max_nodes, int max_edges) {
  nodes_.reserve(max_nodes);
  before_.resize(max_nodes);
  edges_.reserve(max_edges);
  linearized_.resize(max_edges);
  for (auto* matrices : {&H_diagonal_, &inverse_}) matrices->resize(max_nodes);
  for (auto* vectors : {&b_, &step_, &residual_, &p_, &Hp_}) vectors->resize(max_nodes);
}

std::size_t PoseGraph::bytes() const {
  return nodes_.capacity() * (sizeof(Node) + sizeof(Sim3) + 2 * sizeof(Matrix7d)) +
         edges_.capacity() * (sizeof(PoseGraphEdge) + sizeof(Linearized)) +
         5 * nodes_.capacity() * sizeof(Vector7d);
}

void PoseGraph::clear() {
  nodes_.clear();
  edges_.clear();
}

int PoseGraph::addNode(const Sim3& T_camera_world, bool fixed) {
  if (nodes_.size() == nodes_.capacity()) return -1;
  nodes_.push_back({T_camera_world, fixed});
  return static_cast<int>(nodes_.size()) - 1;
}

bool PoseGraph::addEdge(const PoseGraphEdge& edge) {
  if (edges_.size() == edges_.capacity()) return false;
  edges_.push_back(edge);
  return true;
}

Vector7d PoseGraph::error(const PoseGraphEdge& e) const {
  return logSim3(e.T_b_a * nodes_[e.a].T * nodes_[e.b].T.inverse());
}

double PoseGraph::cost() const {
  double sum = 0;
  for (const PoseGraphEdge& e : edges_) sum += e.weight * error(e).squaredNorm();
  return sum;
}

PoseGraphSummary PoseGraph::solve(int max_iterations) {
  PoseGraphSummary summary;
  summary.initial_cost = summary.final_cost = cost();
  double lambda = 1e-6;
  bool linearized = false;
  while (summary.iterations < max_iterations && lambda < kMaxLambda) {
    if (!linearized) linearize();
    linearized = true;
    ++summary.iterations;
    if (!invertDiagonal(lambda)) break;
    conjugateGradients(lambda);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      before_[i] = nodes_[i].T;
      if (!nodes_[i].fixed) nodes_[i].T = expSim3(step_[i]) * nodes_[i].T;
    }
    const double decrease = summary.final_cost - cost();
    if (decrease > 0) {
      const bool converged = decrease <= kMinRelativeDecrease * summary.final_cost;
      summary.final_cost -= decrease;
      if (converged) break;
      lambda = std::max(kMinLambda, lambda / 10);
      linearized = false;
    } else {
      for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i].T = before_[i];
      lambda *= 100;
    }
  }
  for (Node& n : nodes_) n.T.R = orthonormal(n.T.R);
  return summary;
}

/// An edge's error e = log(E), E = T_b_a T_a T_b^-1; small motions exp(x) of a from the left pass
/// through T_b_a by its adjoint, those of b through E by that of E.
void PoseGraph::linearize() {
  std::fill_n(H_diagonal_.begin(), nodes_.size(), Matrix7d::Zero());
  std::fill_n(b_.begin(), nodes_.size(), Vector7d::Zero());
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const PoseGraphEdge& edge = edges_[i];
    const Vector7d e = error(edge);
    const Matrix7d J = leftJacobianInverse(e);
    Linearized& l = linearized_[i];
    l.J_a.noalias() = J * adjoint(edge.T_b_a);
    l.J_b.noalias() = -J * adjoint(expSim3(e));
    if (!nodes_[edge.a].fixed) {
      H_diagonal_[edge.a].noalias() += edge.weight * (l.J_a.transpose() * l.J_a);
      b_[edge.a].noalias() -= edge.weight * (l.J_a.transpose() * e);
    }
    if (!nodes_[edge.b].fixed) {
      H_diagonal_[edge.b].noalias() += edge.weight * (l.J_b.transpose() * l.J_b);
      b_[edge.b].noalias() -= edge.weight * (l.J_b.transpose() * e);
    }
  }
}

bool PoseGraph::invertDiagonal(double lambda) {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (nodes_[i].fixed) continue;
    Matrix7d H = H_diagonal_[i];
    H.diagonal() *= 1 + lambda;
    const Eigen::LLT<Matrix7d> llt(H);
    if (llt.info() != Eigen::Success) return false;
    inverse_[i] = llt.solve(Matrix7d::Identity());
  }
  return true;
}

/// The damped normal equations' matrix times x, edge by edge.
void PoseGraph::multiply(const std::vector<Vector7d>& x, double lambda,
                         std::vector<Vector7d>& Hx) const {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Hx[i].setZero();
    if (!nodes_[i].fixed) Hx[i] = lambda * H_diagonal_[i].diagonal().cwiseProduct(x[i]);
  }
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const PoseGraphEdge& edge = edges_[i];
    const Linearized& l = linearized_[i];
    Vector7d Jx;
    Jx.noalias() = edge.weight * (l.J_a * x[edge.a]);
    Jx.noalias() += edge.weight * (l.J_b * x[edge.b]);
    if (!nodes_[edge.a].fixed) Hx[edge.a].noalias() += l.J_a.transpose() * Jx;
    if (!nodes_[edge.b].fixed) Hx[edge.b].noalias() += l.J_b.transpose() * Jx;
  }
}

void PoseGraph::conjugateGradients(double lambda) {
  const std::size_t n = nodes_.size();
  for (std::size_t i = 0; i < n; ++i) {
    step_[i].setZero();
    p_[i].setZero();
    residual_[i] = b_[i];
    if (!nodes_[i].fixed) p_[i].noalias() = inverse_[i] * b_[i];
  }
  double rz = dot(residual_, p_, n);
  const double enough = kResidual * rz;
  for (int k = 0; k < kMaxProducts && rz > enough; ++k) {
    multiply(p_, lambda, Hp_);
    const double curvature = dot(p_, Hp_, n);
    if (!(curvature > 0)) return;
    const double alpha = rz / curvature;
    double rz_next = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (nodes_[i].fixed) continue;
      step_[i] += alpha * p_[i];
      residual_[i] -= alpha * Hp_[i];
      Hp_[i].noalias() = inverse_[i] * residual_[i];  // preconditioned, in its place
      rz_next += residual_[i].dot(Hp_[i]);
    }
    const double beta = rz_next / rz;
    rz = rz_next;
    for (std::size_t i = 0; i < n; ++i)
      if (!nodes_[i].fixed) p_[i] = Hp_[i] + beta * p_[i];
  }
}

}  // namespace depthscope::slam
