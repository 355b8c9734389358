#include "voroform/core/parallel.hpp"
#include "voroform/voronoi/weighted_moments.hpp"
#include "weighted_cell.hpp"

namespace voroform::voronoi {

namespace {

constexpr std::size_t kGrain = 256;

}  // namespace

WeightedMoments<2> weightedMoments(const PlanarDiagram& diagram, const PlanarClip& clip,
                                   const DensityValues<2>& density, const RunContext& context) {
  const auto siteCount = static_cast<std::size_t>(diagram.siteCount);
  WeightedMoments<2> result;
  result.moments.resize(siteCount);
  result.volumes.resize(siteCount);
  parallelFor(context, siteCount, kGrain, [&](std::size_t begin, std::size_t end) {
    WeightedCell<2> cell(density);
    std::vector<CellWall> walls;
    for (std::size_t s = begin; s < end; ++s) {
      const Vec2& site = diagram.sites[s];
      cell.begin(site);
      walls.clear();
      appendCellWalls(diagram, clip, static_cast<Index>(s), walls);
      for (const CellWall& wall : walls) {
        const Vec2 a = clip.position(diagram, wall.from) - site;
        const Vec2 b = clip.position(diagram, wall.to) - site;
        cell.add(a, b, 0.5 * (a.x() * b.y() - a.y() * b.x()));
      }
      cell.finish(result.moments[s], result.volumes[s]);
    }
  });
  return result;
}

}  // namespace voroform::voronoi
