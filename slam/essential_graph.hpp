#pragma once
#include <span>
#include <vector>

#include "slam/map.hpp"
#include "slam/place_recognizer.hpp"
#include "slam/pose_graph.hpp"

namespace depthscope::slam {

/// How far two keyframes that see much the same would have to give way to each other for a loop to
/// be closed: the largest errors left in strong edges.
struct LoopBend {
  double rotation_rad = 0;
  double translation = 0;  // over the depth that one of the two sees
  double log_scale = 0;
};

/// The essential graph of a connected map (Mur-Artal et al. 2015, sections III.D and VII.D): a
/// spanning tree of its keyframes, all pairs that share many points, and the loops closed before.
/// Called by the mapper, reads the map without its mutex. Allocates nothing.
class EssentialGraph {
 public:
  EssentialGraph(const SlamSettings& settings, Map& map);

  /// Spreads the drift found by a loop over the keyframes between its ends, which themselves lie
  /// where the link says. The map is not changed.
  LoopBend optimize(const PlaceLink& link);
  /// The motion of the world around a keyframe that this takes; only for those of the link's map.
  const Sim3& T_new_old(KeyframeId keyframe) const { return T_new_old_[keyframe]; }
  /// Keeps a loop that was closed, in place of the oldest when full.
  void remember(const PlaceLink& link);

  std::size_t bytes() const { return graph_.bytes(); }

 private:
  void addNodes(const PlaceLink& link);
  void addTreeAndStrongEdges(KeyframeId root);
  void addLoops();
  void addEdge(KeyframeId a, KeyframeId b, int shared_points);
  KeyframeId nextOfTree() const;
  KeyframeId neighbourInTime(KeyframeId keyframe) const;
  LoopBend bend() const;

  /// A loop's ends and their serials, by which it is seen that one was culled.
  struct Loop {
    KeyframeId a = kNone, b = kNone;
    std::int64_t serial_a = -1, serial_b = -1;
  };
  static constexpr std::size_t kMaxLoops = 64;

  Map& map_;
  PoseGraph graph_;
  double depth_ = 1;                   // typical, of the map's points [map unit]
  std::vector<KeyframeId> keyframes_;  // per node
  std::vector<int> node_of_;           // per keyframe, kNone: not in the graph
  std::vector<int> shared_;            // per keyframe, scratch
  std::vector<int> tie_;               // per keyframe: most points shared with one of the tree
  std::vector<KeyframeId> tied_to_;    // per keyframe: with whom
  std::vector<std::uint8_t> in_tree_;  // per keyframe
  std::vector<Sim3> T_new_old_;        // per keyframe
  std::vector<Loop> loops_;
  std::size_t next_loop_ = 0;
};

}  // namespace depthscope::slam
