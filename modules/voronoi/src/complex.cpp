#include <algorithm>

#include "caps.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/voronoi/clip.hpp"

namespace voroform::voronoi {

namespace {

using State = ClippedDiagram::FacetState;

// Calls visit(polygon, facet) for what the solid keeps of each facet, in the facets' order.
template <class Visit>
void forEachPolygon(const Diagram& diagram, const ClippedDiagram& clipped, const Visit& visit) {
  Index polygon = 0;
  for (Index f = 0; f < diagram.facetCount(); ++f) {
    const State state = clipped.facetStates[static_cast<std::size_t>(f)];
    if (state == State::whole) visit(diagram.facet(f), f);
    for (; polygon < clipped.polygonCount() && clipped.polygonFacets[static_cast<std::size_t>(polygon)] == f; ++polygon) {
      visit(clipped.polygon(polygon), f);
    }
  }
}

// Numbers the marked entries in their order; the others get kNone.
Index number(std::vector<Index>& marked) {
  Index next = 0;
  for (Index& entry : marked) entry = entry != 0 ? next++ : kNone;
  return next;
}

}  // namespace

mesh::PolyhedralComplex toComplex(const Diagram& diagram, ClippedDiagram& clipped, const implicit::ImplicitFunction& f,
                                  const Frame& frame, const ClipOptions& options, const RunContext& context) {
  const Caps caps = buildCaps(diagram, clipped, f, options, context);
  const std::size_t pointCount = diagram.vertices.size() + clipped.points.size() + caps.points.size();
  const auto position = [&](std::size_t point) -> const Vec3& {
    const std::size_t own = diagram.vertices.size() + clipped.points.size();
    return point < own ? clipped.position(diagram, static_cast<Index>(point)) : caps.points[point - own];
  };

  std::vector<Index> vertexOf(pointCount, 0);
  std::vector<Index> cellOf(static_cast<std::size_t>(diagram.siteCount), 0);
  std::size_t faceCount = caps.triangles.size();
  std::size_t cornerCount = 3 * caps.triangles.size();
  forEachPolygon(diagram, clipped, [&](std::span<const Index> polygon, Index facet) {
    for (const Index point : polygon) vertexOf[static_cast<std::size_t>(point)] = 1;
    for (const Index site : diagram.facetSites[static_cast<std::size_t>(facet)]) {
      if (diagram.isReal(site)) cellOf[static_cast<std::size_t>(site)] = 1;
    }
    ++faceCount;
    cornerCount += polygon.size();
  });
  for (const auto& triangle : caps.triangles) {
    for (const Index point : triangle) vertexOf[static_cast<std::size_t>(point)] = 1;
  }

  mesh::PolyhedralComplex complex;
  complex.frame = frame;
  complex.vertices.resize(static_cast<std::size_t>(number(vertexOf)));
  for (std::size_t point = 0; point < pointCount; ++point) {
    if (vertexOf[point] != kNone) complex.vertices[static_cast<std::size_t>(vertexOf[point])] = position(point);
  }
  complex.cellCount = number(cellOf);
  for (std::size_t site = 0; site < cellOf.size(); ++site) {
    if (cellOf[site] != kNone) complex.cellSites.push_back(diagram.sites[site]);
  }

  complex.faceOffsets.reserve(faceCount + 1);
  complex.faceVertices.reserve(cornerCount);
  complex.faceCells.reserve(faceCount);
  complex.faceTags.reserve(faceCount);
  std::vector<Index> loop;
  forEachPolygon(diagram, clipped, [&](std::span<const Index> polygon, Index facet) {
    loop.clear();
    for (const Index point : polygon) loop.push_back(vertexOf[static_cast<std::size_t>(point)]);
    const auto& [a, b] = diagram.facetSites[static_cast<std::size_t>(facet)];
    complex.addFace(loop, cellOf[static_cast<std::size_t>(a)],
                    diagram.isReal(b) ? cellOf[static_cast<std::size_t>(b)] : kNone);
  });

  std::vector<mesh::FaceTag> tags(caps.triangles.size());
  parallelFor(context, tags.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      Vec3 centroid = Vec3::Zero();
      for (const Index point : caps.triangles[t]) centroid += position(static_cast<std::size_t>(point)) / 3;
      tags[t] = f.onEnvelope(centroid) ? mesh::FaceTag::envelope : mesh::FaceTag::surface;
    }
  });
  for (Index l = 0; l < clipped.loopCount(); ++l) {
    const Index cell = cellOf[static_cast<std::size_t>(clipped.loopSites[static_cast<std::size_t>(l)])];
    for (std::size_t t = caps.triangleOffsets[static_cast<std::size_t>(l)];
         t < caps.triangleOffsets[static_cast<std::size_t>(l) + 1]; ++t) {
      std::array<Index, 3> triangle{};
      std::transform(caps.triangles[t].begin(), caps.triangles[t].end(), triangle.begin(),
                     [&](Index point) { return vertexOf[static_cast<std::size_t>(point)]; });
      complex.addFace(triangle, cell, kNone, tags[t]);
    }
  }
  return complex;
}

}  // namespace voroform::voronoi
