#pragma once
#include <cstddef>
#include <vector>

#include "slam/sim3.hpp"

namespace depthscope::slam {

/// Where node `b` should lie as seen from node `a`, both cameras.
struct PoseGraphEdge {
  int a = 0, b = 0;
  Sim3 T_b_a;
  double weight = 1;  // of its squared error
};

struct PoseGraphSummary {
  int iterations = 0;  // steps taken
  double initial_cost = 0, final_cost = 0;
};

/// Poses with a scale of their own, tied to each other by measured similarities (Strasdat et al.
/// 2010, section III): minimizes the sum of w |log(T_b_a T_a T_b^-1)|^2 over the edges by
/// Levenberg and Marquardt's method, each step found by conjugate gradients with the diagonal
/// blocks for preconditioner. Errors in rotation [rad], in translation and in the logarithm of the
/// scale count alike: choose the unit of length so that the scene is about 1 away. All storage is
/// allocated by the constructor; the same input gives the same bits.
class PoseGraph {
 public:
  PoseGraph(int max_nodes, int max_edges);

  void clear();
  /// A camera, `T_camera_world`. Returns its index, -1 when the capacity is used up. Every node
  /// must hang together, over edges, with one that is fixed.
  int addNode(const Sim3& T_camera_world, bool fixed);
  /// False when the capacity is used up.
  bool addEdge(const PoseGraphEdge& edge);

  PoseGraphSummary solve(int max_iterations);

  const Sim3& node(int index) const { return nodes_[index].T; }
  const PoseGraphEdge& edge(int index) const { return edges_[index]; }
  int maxEdges() const { return static_cast<int>(edges_.capacity()); }
  int edges() const { return static_cast<int>(edges_.size()); }
  Vector7d error(const PoseGraphEdge& edge) const;
  std::size_t bytes() const;

 private:
  struct Node {
    Sim3 T;
    bool fixed;
  };
  struct Linearized {
    Matrix7d J_a, J_b;  // derivatives of an edge's error
  };

  double cost() const;
  void linearize();
  bool invertDiagonal(double lambda);
  void multiply(const std::vector<Vector7d>& x, double lambda, std::vector<Vector7d>& Hx) const;
  void conjugateGradients(double lambda);

  std::vector<Node> nodes_;
  std::vector<Sim3> before_;  // the step
  std::vector<PoseGraphEdge> edges_;
  std::vector<Linearized> linearized_;                  // per edge
  std::vector<Matrix7d> H_diagonal_, inverse_;          // per node
  std::vector<Vector7d> b_, step_, residual_, p_, Hp_;  // per node; those of fixed nodes stay 0
};

}  // namespace depthscope::slam
