#include "slam/essential_graph.hpp"

#include <algorithm>
#include <cmath>

namespace depthscope::slam {

namespace {
constexpr int kStrong = 100;       // shared points that make an edge (section III.D: theta_min)
constexpr int kEdgesPerNode = 16;  // on average, that there is room for
constexpr int kIterations = 20;
}  // namespace

EssentialGraph::EssentialGraph(const SlamSettings& settings, Map& map)
    : map_(map), graph_(settings.capacity.keyframes, kEdgesPerNode * settings.capacity.keyframes) {
  const std::size_t keyframes = settings.capacity.keyframes;
  keyframes_.reserve(keyframes);
  node_of_.resize(keyframes);
  shared_.resize(keyframes);
  tie_.resize(keyframes);
  tied_to_.resize(keyframes);
  in_tree_.resize(keyframes);
  T_new_old_.resize(keyframes);
  loops_.reserve(kMaxLoops);
}

LoopBend EssentialGraph::optimize(const PlaceLink& link) {
  graph_.clear();
  addNodes(link);
  addTreeAndStrongEdges(link.before);
  addLoops();
  graph_.solve(kIterations);
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    Sim3 T_camera_world = graph_.node(static_cast<int>(i));
    T_camera_world.t *= depth_;
    const KeyframeId k = keyframes_[i];
    T_new_old_[k] = T_camera_world.inverse() * Sim3(map_.keyframe(k).T_camera_world);
  }
  return bend();
}

LoopBend EssentialGraph::bend() const {
  LoopBend bend;
  for (int e = 0; e < graph_.edges(); ++e) {
    const PoseGraphEdge& edge = graph_.edge(e);
    if (edge.weight < 1) continue;
    const Vector7d error = graph_.error(edge);
    const double depth = map_.medianDepth(keyframes_[edge.a]) / depth_;
    bend.rotation_rad = std::max(bend.rotation_rad, error.head<3>().norm());
    bend.translation = std::max(bend.translation, error.segment<3>(3).norm() / depth);
    bend.log_scale = std::max(bend.log_scale, std::abs(error[6]));
  }
  return bend;
}

void EssentialGraph::addNodes(const PlaceLink& link) {
  keyframes_.clear();
  std::fill(node_of_.begin(), node_of_.end(), kNone);
  double depths = 0;
  for (KeyframeId k = 0; k < map_.keyframeCapacity(); ++k) {
    if (!map_.keyframe(k).alive || map_.keyframe(k).map_id != map_.keyframe(link.now).map_id)
      continue;
    keyframes_.push_back(k);
    depths += map_.medianDepth(k);
  }
  depth_ = depths > 0 ? depths / static_cast<double>(keyframes_.size()) : 1;
  for (const KeyframeId k : keyframes_) {
    Sim3 T_camera_world(map_.keyframe(k).T_camera_world);
    if (k == link.now) T_camera_world = T_camera_world * link.T_before_now.inverse();
    T_camera_world.t /= depth_;
    node_of_[k] = graph_.addNode(T_camera_world, k == link.now || k == link.before);
  }
}

/// Prim's algorithm: the next keyframe is the one most tied to those that are in. One that shares
/// nothing with any of them comes last, tied to its neighbour in time.
void EssentialGraph::addTreeAndStrongEdges(KeyframeId root) {
  std::fill(tie_.begin(), tie_.end(), 0);
  std::fill(in_tree_.begin(), in_tree_.end(), 0);
  std::fill(tied_to_.begin(), tied_to_.end(), kNone);
  // Of the tree's and the loops' edges none may be missing.
  int room = graph_.maxEdges() - map_.keyframeCapacity() - static_cast<int>(kMaxLoops);
  for (KeyframeId k = root; k != kNone; k = nextOfTree()) {
    if (k != root && tied_to_[k] == kNone) tied_to_[k] = neighbourInTime(k);
    if (k != root) addEdge(tied_to_[k], k, tie_[k]);
    map_.countShared(k, shared_);
    for (const KeyframeId other : keyframes_) {
      if (in_tree_[other]) {
        if (shared_[other] >= kStrong && other != tied_to_[k] && room-- > 0)
          addEdge(other, k, kStrong);
      } else if (shared_[other] > tie_[other]) {
        tie_[other] = shared_[other];
        tied_to_[other] = k;
      }
    }
    in_tree_[k] = 1;
  }
}

KeyframeId EssentialGraph::neighbourInTime(KeyframeId keyframe) const {
  const auto gap = [&](KeyframeId k) {
    return std::abs(map_.keyframe(k).serial - map_.keyframe(keyframe).serial);
  };
  KeyframeId nearest = kNone;
  for (const KeyframeId k : keyframes_)
    if (in_tree_[k] && (nearest == kNone || gap(k) < gap(nearest))) nearest = k;
  return nearest;
}

KeyframeId EssentialGraph::nextOfTree() const {
  KeyframeId next = kNone;
  for (const KeyframeId k : keyframes_)
    if (!in_tree_[k] && (next == kNone || tie_[k] > tie_[next])) next = k;
  return next;
}

void EssentialGraph::addLoops() {
  for (const Loop& loop : loops_)
    if (node_of_[loop.a] != kNone && node_of_[loop.b] != kNone &&
        map_.keyframe(loop.a).serial == loop.serial_a &&
        map_.keyframe(loop.b).serial == loop.serial_b)
      addEdge(loop.a, loop.b, kStrong);
}

/// As the two lie now; what few points hold together gives way more easily.
void EssentialGraph::addEdge(KeyframeId a, KeyframeId b, int shared_points) {
  Sim3 T_b_a(map_.keyframe(b).T_camera_world * map_.keyframe(a).T_camera_world.inverse());
  T_b_a.t /= depth_;
  const double weight = std::clamp(shared_points, 1, kStrong) / static_cast<double>(kStrong);
  graph_.addEdge({node_of_[a], node_of_[b], T_b_a, weight});
}

void EssentialGraph::remember(const PlaceLink& link) {
  const Loop loop{link.now, link.before, map_.keyframe(link.now).serial,
                  map_.keyframe(link.before).serial};
  if (loops_.size() < kMaxLoops)
    loops_.push_back(loop);
  else
    loops_[next_loop_++ % kMaxLoops] = loop;
}

}  // namespace depthscope::slam
