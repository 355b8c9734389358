#include <algorithm>
#include <map>

#include "caps.hpp"
#include "fit.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/voronoi/clip.hpp"

namespace voroform::voronoi {

namespace {

using State = ClippedDiagram::FacetState;

// Calls visit(polygon, facet, owners) for what the solid keeps of each facet, in the facets' order. Owners are the
// facet's sites, or kNone for one that is a ghost or has given the polygon up; polygons that both gave up are left out.
template <class Visit>
void forEachPolygon(const Diagram& diagram, const ClippedDiagram& clipped, const Caps& caps, const Visit& visit) {
  Index polygon = 0;
  for (Index f = 0; f < diagram.facetCount(); ++f) {
    const State state = clipped.facetStates[static_cast<std::size_t>(f)];
    std::array<Index, 2> sites = diagram.facetSites[static_cast<std::size_t>(f)];
    if (!diagram.isReal(sites[1])) sites[1] = kNone;
    if (state == State::whole) visit(diagram.facet(f), f, sites);
    for (; polygon < clipped.polygonCount() && clipped.polygonFacets[static_cast<std::size_t>(polygon)] == f;
         ++polygon) {
      std::array<Index, 2> owners = sites;
      for (const Caps::Collapsed& collapsed : caps.collapsed) {
        if (collapsed.polygon == polygon) std::replace(owners.begin(), owners.end(), collapsed.site, kNone);
      }
      if (owners[0] != kNone || owners[1] != kNone) visit(clipped.polygon(polygon), f, owners);
    }
  }
}

// Numbers the marked entries in their order; the others get kNone.
Index number(std::vector<Index>& marked) {
  Index next = 0;
  for (Index& entry : marked) entry = entry != 0 ? next++ : kNone;
  return next;
}

Vec3 across(const Diagram& diagram, Index from, Index to) {
  return diagram.sites[static_cast<std::size_t>(to)] - diagram.sites[static_cast<std::size_t>(from)];
}

// Adds a boundary polygon of a cell, counter-clockwise seen against the normal, as triangles: a fan about its centroid,
// or, if chord points have made it too reentrant for that, ears.
void addPlanarBoundary(mesh::PolyhedralComplex& complex, std::span<const Index> loop, const Vec3& normal, Index cell) {
  std::vector<Vec3> corners;
  Vec3 centroid = Vec3::Zero();
  for (const Index vertex : loop) {
    corners.push_back(complex.vertices[static_cast<std::size_t>(vertex)]);
    centroid += corners.back() / static_cast<double>(loop.size());
  }
  bool starShaped = true;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3& next = corners[(k + 1) % loop.size()];
    if (!(normal.dot((corners[k] - centroid).cross(next - centroid)) > 0)) starShaped = false;
  }
  if (starShaped) {
    const auto center = static_cast<Index>(complex.vertices.size());
    complex.vertices.push_back(centroid);
    for (std::size_t k = 0; k < loop.size(); ++k) {
      complex.addFace(std::array{center, loop[k], loop[(k + 1) % loop.size()]}, cell, kNone);
    }
    return;
  }
  for (const auto& [i, j, k] : cutEars(corners, normal)) {
    complex.addFace(std::array{loop[i], loop[j], loop[k]}, cell, kNone);
  }
}

std::vector<mesh::FaceTag> capTags(const Diagram& diagram, const ClippedDiagram& clipped, const Caps& caps,
                                   const implicit::ImplicitFunction& f, const RunContext& context) {
  const std::size_t own = diagram.vertices.size() + clipped.points.size();
  std::vector<mesh::FaceTag> tags(caps.triangles.size());
  parallelFor(context, tags.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      Vec3 centroid = Vec3::Zero();
      for (const Index point : caps.triangles[t]) {
        const auto p = static_cast<std::size_t>(point);
        centroid += (p < own ? clipped.position(diagram, point) : caps.points[p - own]) / 3;
      }
      tags[t] = f.onEnvelope(centroid) ? mesh::FaceTag::envelope : mesh::FaceTag::surface;
    }
  });
  return tags;
}

}  // namespace

mesh::PolyhedralComplex toComplex(const Diagram& diagram, ClippedDiagram& clipped, const implicit::ImplicitFunction& f,
                                  const Frame& frame, const ClipOptions& options, const RunContext& context) {
  Caps caps = buildCaps(diagram, clipped, f, options, context);
  std::vector<mesh::FaceTag> tags = capTags(diagram, clipped, caps, f, context);
  if (options.fit) {
    fitCaps(diagram, clipped, caps, tags, f, options, context);
    if (options.cap == CapKind::cvt1) {
      // The hulls over the moved roots.
      clipped.summary.fallbackCaps = clipped.summary.crossingCells = 0;
      caps = buildCaps(diagram, clipped, f, options, context);
      tags = capTags(diagram, clipped, caps, f, context);
    }
  }
  const std::size_t pointCount = diagram.vertices.size() + clipped.points.size() + caps.points.size();
  const auto position = [&](std::size_t point) -> const Vec3& {
    const std::size_t own = diagram.vertices.size() + clipped.points.size();
    return point < own ? clipped.position(diagram, static_cast<Index>(point)) : caps.points[point - own];
  };

  std::vector<Index> vertexOf(pointCount, 0);
  std::vector<Index> cellOf(static_cast<std::size_t>(diagram.siteCount), 0);
  std::size_t faceCount = caps.triangles.size();
  std::size_t cornerCount = 3 * caps.triangles.size();
  using Owners = std::array<Index, 2>;
  forEachPolygon(diagram, clipped, caps, [&](std::span<const Index> polygon, Index, const Owners& owners) {
    for (const Index point : polygon) vertexOf[static_cast<std::size_t>(point)] = 1;
    for (const Index site : owners) {
      if (site != kNone) cellOf[static_cast<std::size_t>(site)] = 1;
    }
    ++faceCount;
    cornerCount += polygon.size();
  });
  for (const Caps::Patch& patch : caps.patches) {
    for (const Index point : patch.loop) vertexOf[static_cast<std::size_t>(point)] = 1;
  }
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
  forEachPolygon(diagram, clipped, caps, [&](std::span<const Index> polygon, Index facet, const Owners& owners) {
    loop.clear();
    for (const Index point : polygon) loop.push_back(vertexOf[static_cast<std::size_t>(point)]);
    if (owners[0] != kNone && owners[1] != kNone) {
      complex.addFace(loop, cellOf[static_cast<std::size_t>(owners[0])], cellOf[static_cast<std::size_t>(owners[1])]);
      return;
    }
    // Boundary of the one owner left.
    const auto& [a, b] = diagram.facetSites[static_cast<std::size_t>(facet)];
    const bool second = owners[0] == kNone;
    if (second) std::reverse(loop.begin(), loop.end());
    addPlanarBoundary(complex, loop, across(diagram, second ? b : a, second ? a : b),
                      cellOf[static_cast<std::size_t>(second ? b : a)]);
  });

  std::map<std::array<Index, 3>, const Caps::Patch*> open;  // by site, neighbor, lowest point
  for (const Caps::Patch& patch : caps.patches) {
    const Index lowest = *std::min_element(patch.loop.begin(), patch.loop.end());
    const auto opposite = open.find({patch.neighbor, patch.site, lowest});
    if (opposite == open.end()) {
      open[{patch.site, patch.neighbor, lowest}] = &patch;
      continue;
    }
    open.erase(opposite);
    loop.clear();
    for (const Index point : patch.loop) loop.push_back(vertexOf[static_cast<std::size_t>(point)]);
    complex.addFace(loop, cellOf[static_cast<std::size_t>(patch.site)],
                    cellOf[static_cast<std::size_t>(patch.neighbor)]);
  }
  for (const auto& [key, patch] : open) {
    loop.clear();
    for (const Index point : patch->loop) loop.push_back(vertexOf[static_cast<std::size_t>(point)]);
    addPlanarBoundary(complex, loop, across(diagram, patch->site, patch->neighbor),
                      cellOf[static_cast<std::size_t>(patch->site)]);
  }

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
