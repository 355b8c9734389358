// CGAL's kd-tree over a cloud's positions; for sources only.
#pragma once

#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>

#include <boost/iterator/counting_iterator.hpp>

#include <cstdint>
#include <vector>

#include "voroform/core/types.hpp"

namespace voroform::points {

using Kernel = CGAL::Simple_cartesian<double>;

// Gives the position of an index, as CGAL's search asks for it.
struct PositionOf {
  using key_type = std::size_t;
  using value_type = Kernel::Point_3;
  using reference = const value_type&;
  using category = boost::lvalue_property_map_tag;

  const std::vector<Kernel::Point_3>* points = nullptr;
  friend reference get(const PositionOf& map, key_type index) { return (*map.points)[index]; }
};

class KdTree {
 public:
  using Traits = CGAL::Search_traits_adapter<std::size_t, PositionOf, CGAL::Search_traits_3<Kernel>>;
  using Search = CGAL::Orthogonal_k_neighbor_search<Traits>;

  explicit KdTree(const std::vector<Vec3>& positions)
      : points_(copy(positions)),
        traits_(PositionOf{&points_}),
        tree_(boost::counting_iterator<std::size_t>(0), boost::counting_iterator<std::size_t>(points_.size()),
              Search::Splitter(), traits_) {
    tree_.build();  // at once: a lazy build would race between queries
  }
  KdTree(const KdTree&) = delete;
  KdTree& operator=(const KdTree&) = delete;

  // The k points nearest to a point of the tree, itself included, nearest first; pairs of index and squared distance.
  // Safe to call from many threads at once.
  Search search(std::size_t index, unsigned k) const {
    return Search(tree_, points_[index], k, 0.0, true, Search::Distance(PositionOf{&points_}));
  }

 private:
  static std::vector<Kernel::Point_3> copy(const std::vector<Vec3>& positions) {
    std::vector<Kernel::Point_3> points;
    points.reserve(positions.size());
    for (const Vec3& p : positions) points.emplace_back(p.x(), p.y(), p.z());
    return points;
  }

  std::vector<Kernel::Point_3> points_;
  Traits traits_;
  Search::Tree tree_;
};

}  // namespace voroform::points
