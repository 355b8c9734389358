#include "normals.hpp"

#include <CGAL/mst_orient_normals.h>
#include <CGAL/property_map.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "kd_tree.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::points {
namespace {

struct Neighborhoods {
  std::size_t count = 0;         // neighbors of each point
  std::vector<Index> neighbors;  // row after row, nearest first
  std::vector<Vec3> normals;     // of the fitted planes, of either sign
  std::vector<double> areas;     // that the points stand for, up to a common factor
};

// The normal of the plane through the neighbors and the point that fits best: the direction of least variance.
Vec3 planeNormal(const std::vector<Vec3>& positions, std::size_t point, const Index* neighbors, std::size_t count) {
  const Vec3& origin = positions[point];
  Vec3 sum = Vec3::Zero();
  Mat3 moments = Mat3::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 offset = positions[static_cast<std::size_t>(neighbors[i])] - origin;
    sum += offset;
    moments += offset * offset.transpose();
  }
  const Mat3 covariance = moments - sum * sum.transpose() / static_cast<double>(count + 1);
  const double scale = covariance.cwiseAbs().maxCoeff();
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(scale > 0 ? Mat3(covariance / scale) : covariance);
  return solver.eigenvectors().col(0).normalized();
}

Neighborhoods findNeighborhoods(const std::vector<Vec3>& positions, std::size_t count, const RunContext& context) {
  constexpr std::size_t kGrain = 512;
  const KdTree tree(positions);
  Neighborhoods result;
  result.count = count;
  result.neighbors.resize(positions.size() * count);
  result.normals.resize(positions.size());
  result.areas.resize(positions.size());
  parallelFor(context, positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Index* const row = result.neighbors.data() + i * count;
      std::size_t found = 0;
      for (const auto& [neighbor, squaredDistance] : tree.search(i, static_cast<unsigned>(count + 1))) {
        if (neighbor == i || found == count) continue;
        row[found++] = static_cast<Index>(neighbor);
        result.areas[i] = squaredDistance;
      }
      result.normals[i] = planeNormal(positions, i, row, count);
    }
  });
  return result;
}

// Connected pieces of the graph that joins each point with its neighbors; the points of each in ascending order.
std::vector<std::vector<Index>> connectedPieces(const Neighborhoods& hoods) {
  std::vector<Index> parent(hoods.normals.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto rootOf = [&](Index i) {
    while (parent[static_cast<std::size_t>(i)] != i) {
      Index& up = parent[static_cast<std::size_t>(i)];
      up = parent[static_cast<std::size_t>(up)];
      i = up;
    }
    return i;
  };
  for (std::size_t k = 0; k < hoods.neighbors.size(); ++k) {
    const Index a = rootOf(static_cast<Index>(k / hoods.count));
    const Index b = rootOf(hoods.neighbors[k]);
    parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  std::vector<Index> pieceOfRoot(parent.size(), kNone);
  std::vector<std::vector<Index>> pieces;
  for (std::size_t i = 0; i < parent.size(); ++i) {
    Index& piece = pieceOfRoot[static_cast<std::size_t>(rootOf(static_cast<Index>(i)))];
    if (piece == kNone) {
      piece = static_cast<Index>(pieces.size());
      pieces.emplace_back();
    }
    pieces[static_cast<std::size_t>(piece)].push_back(static_cast<Index>(i));
  }
  return pieces;
}

// Flips all normals of a piece if the volume that it encloses, by the divergence theorem with a disk at each point,
// is negative. The center matters for open pieces only.
void orientOutward(const PointCloud& cloud, const Neighborhoods& hoods, const std::vector<Index>& piece,
                   std::vector<Vec3>& normals) {
  Vec3 center = Vec3::Zero();
  double area = 0;
  for (const Index i : piece) {
    center += hoods.areas[static_cast<std::size_t>(i)] * cloud.positions[static_cast<std::size_t>(i)];
    area += hoods.areas[static_cast<std::size_t>(i)];
  }
  center /= area;
  double flux = 0;
  for (const Index i : piece) {
    const auto k = static_cast<std::size_t>(i);
    flux += hoods.areas[k] * normals[k].dot(cloud.positions[k] - center);
  }
  if (flux >= 0) return;
  for (const Index i : piece) normals[static_cast<std::size_t>(i)] = -normals[static_cast<std::size_t>(i)];
}

// Orients the normals of one piece. Returns its points that the tree reached.
std::vector<Index> orientPiece(const PointCloud& cloud, const Neighborhoods& hoods, const std::vector<Index>& piece,
                               std::vector<Vec3>& normals) {
  using Item = std::tuple<Kernel::Point_3, Kernel::Vector_3, Index>;
  std::vector<Item> items;
  items.reserve(piece.size());
  for (const Index i : piece) {
    const Vec3& p = cloud.positions[static_cast<std::size_t>(i)];
    const Vec3& n = hoods.normals[static_cast<std::size_t>(i)];
    items.emplace_back(Kernel::Point_3(p.x(), p.y(), p.z()), Kernel::Vector_3(n.x(), n.y(), n.z()), i);
  }
  const auto unreached =
      CGAL::mst_orient_normals(items, static_cast<unsigned>(hoods.count),
                               CGAL::parameters::point_map(CGAL::Nth_of_tuple_property_map<0, Item>())
                                   .normal_map(CGAL::Nth_of_tuple_property_map<1, Item>()));
  std::vector<Index> reached;
  for (auto item = items.begin(); item != unreached; ++item) {
    const Kernel::Vector_3& n = std::get<1>(*item);
    reached.push_back(std::get<2>(*item));
    normals[static_cast<std::size_t>(reached.back())] = Vec3(n.x(), n.y(), n.z());
  }
  return reached;
}

}  // namespace

void estimateNormals(PointCloud& cloud, const PrepareOptions& options, PrepareSummary& summary,
                     const RunContext& context) {
  const std::size_t count = std::min(static_cast<std::size_t>(options.normalNeighbors), cloud.positions.size() - 1);
  const Neighborhoods hoods = findNeighborhoods(cloud.positions, count, context);
  const std::vector<std::vector<Index>> pieces = connectedPieces(hoods);
  std::vector<Vec3> normals(cloud.positions.size(), Vec3::Zero());
  for (const std::vector<Index>& piece : pieces) {
    context.throwIfCancelled();
    orientOutward(cloud, hoods, orientPiece(cloud, hoods, piece, normals), normals);
  }
  summary.pieces = pieces.size();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (normals[i].isZero(0)) continue;
    cloud.positions[kept] = cloud.positions[i];
    normals[kept] = normals[i];
    ++kept;
  }
  summary.unoriented += normals.size() - kept;
  cloud.positions.resize(kept);
  normals.resize(kept);
  cloud.normals = std::move(normals);
}

}  // namespace voroform::points
