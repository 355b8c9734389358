#include "voroform/mesh/planar_moments.hpp"

#include <algorithm>

#include "voroform/core/parallel.hpp"

namespace voroform::mesh {

namespace {

constexpr std::size_t kGrain = 1024;

PlanarCellMoments momentsOf(const PlanarTessellation& tessellation, Index cell) {
  PlanarCellMoments moments;
  const std::size_t firstLoop = tessellation.firstLoop(cell);
  if (firstLoop == tessellation.endLoop(cell)) return moments;
  const auto vertex = [&](Index v) -> const Vec2& { return tessellation.vertices[static_cast<std::size_t>(v)]; };
  const Vec2 origin = vertex(tessellation.loop(firstLoop).front());
  double area = 0;
  Vec2 first = Vec2::Zero();
  double second = 0;
  for (std::size_t l = firstLoop; l < tessellation.endLoop(cell); ++l) {
    const auto loop = tessellation.loop(l);
    Vec2 p = vertex(loop.back()) - origin;
    for (const Index v : loop) {
      const Vec2 q = vertex(v) - origin;
      // Twice the signed area of the triangle origin, p, q.
      const double cross = p.x() * q.y() - p.y() * q.x();
      area += cross / 2;
      first += (p + q) * (cross / 6);
      second += (p.squaredNorm() + p.dot(q) + q.squaredNorm()) * (cross / 12);
      p = q;
    }
  }
  moments.area = area;
  const Vec2 offset = first / area;
  moments.centroid = origin + offset;
  moments.secondMoment = second - area * offset.squaredNorm();
  return moments;
}

}  // namespace

std::vector<PlanarCellMoments> cellMoments(const PlanarTessellation& tessellation, const RunContext& context) {
  std::vector<PlanarCellMoments> moments(static_cast<std::size_t>(tessellation.cellCount()));
  parallelFor(context, moments.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t cell = begin; cell < end; ++cell)
      moments[cell] = momentsOf(tessellation, static_cast<Index>(cell));
  });
  return moments;
}

std::vector<std::uint8_t> boundaryCells(const PlanarTessellation& tessellation) {
  std::vector<std::uint8_t> onBoundary(static_cast<std::size_t>(tessellation.cellCount()), 0);
  for (Index cell = 0; cell < tessellation.cellCount(); ++cell) {
    for (std::size_t l = tessellation.firstLoop(cell); l < tessellation.endLoop(cell); ++l) {
      const auto neighbors = tessellation.loopNeighbors(l);
      if (std::find(neighbors.begin(), neighbors.end(), kNone) != neighbors.end()) {
        onBoundary[static_cast<std::size_t>(cell)] = 1;
      }
    }
  }
  return onBoundary;
}

}  // namespace voroform::mesh
