#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "planar_delaunay.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/voronoi/planar.hpp"

namespace voroform::voronoi {

namespace {

constexpr std::size_t kGrain = 4096;

// Ghosts at the corners of a regular polygon this many radii of the domain away: a point of the domain is at most two
// radii from any site, so no ghost's cell reaches it.
constexpr double kGhostDistance = 8;
constexpr int kGhosts = 8;

// Fourth powers of coordinates must not overflow.
constexpr double kFarthest = 1e70;

// Below this share of the edges' product a triangle's determinant has lost too many digits to divide by.
constexpr double kFlatTriangle = 1e-5;

constexpr std::size_t next(std::size_t k) { return k == 2 ? 0 : k + 1; }
constexpr std::size_t before(std::size_t k) { return k == 0 ? 2 : k - 1; }

Vec2 circumcenter(const Vec2& p, const Vec2& q, const Vec2& r) {
  const Vec2 a = q - p;
  const Vec2 b = r - p;
  const double determinant = a.x() * b.y() - a.y() * b.x();
  const double aa = a.squaredNorm();
  const double bb = b.squaredNorm();
  if (!(determinant * determinant > kFlatTriangle * kFlatTriangle * aa * bb)) return exactCircumcenter(p, q, r);
  return p + Vec2(aa * b.y() - bb * a.y(), bb * a.x() - aa * b.x()) / (2 * determinant);
}

// The sites, then the ghosts around them and the domain.
std::vector<Vec2> withGhosts(std::span<const Vec2> sites, Box2 domain) {
  std::vector<Vec2> result(sites.begin(), sites.end());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (!(sites[i].cwiseAbs().maxCoeff() < kFarthest) || !sites[i].allFinite()) {
      throw MethodError("site " + std::to_string(i) + " is not finite or too far away");
    }
    domain.extend(sites[i]);
  }
  const double distance = kGhostDistance * 0.5 * domain.diagonal().norm();
  for (int k = 0; k < kGhosts; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / kGhosts;
    result.push_back(domain.center() + distance * Vec2(std::cos(angle), std::sin(angle)));
  }
  return result;
}

// Numbers the edges by the first triangle that has them.
void buildEdges(const Triangles& triangles, PlanarDiagram& diagram) {
  const std::size_t count = triangles.vertices.size();
  auto& edgeOf = diagram.vertexEdges;
  edgeOf.assign(count, {kNone, kNone, kNone});
  diagram.edgeSites.reserve(count + count / 2);
  diagram.edgeVertices.reserve(count + count / 2);
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index neighbor = triangles.neighbors[t][k];
      // From i to j the triangle lies on the left, its neighbor on the right: on the way from the neighbor's center to
      // the triangle's i is on the left.
      const Index i = triangles.vertices[t][next(k)];
      const Index j = triangles.vertices[t][before(k)];
      if (neighbor < static_cast<Index>(t) || !(diagram.isReal(i) || diagram.isReal(j))) continue;
      const Index edge = diagram.edgeCount();
      const auto self = static_cast<Index>(t);
      diagram.edgeSites.push_back(i < j ? std::array{i, j} : std::array{j, i});
      diagram.edgeVertices.push_back(i < j ? std::array{neighbor, self} : std::array{self, neighbor});
      edgeOf[t][k] = edge;
      const auto& mirrored = triangles.neighbors[static_cast<std::size_t>(neighbor)];
      std::size_t slot = 0;
      while (mirrored[slot] != self || triangles.vertices[static_cast<std::size_t>(neighbor)][next(slot)] != j) ++slot;
      edgeOf[static_cast<std::size_t>(neighbor)][slot] = edge;
    }
  }
}

void buildSiteEdges(const Triangles& triangles, PlanarDiagram& diagram) {
  const auto siteCount = static_cast<std::size_t>(diagram.siteCount);
  std::vector<std::uint32_t> offsets(siteCount, 0);
  std::vector<Index> firstTriangle(siteCount, kNone);
  for (std::size_t t = triangles.vertices.size(); t-- > 0;) {
    for (const Index site : triangles.vertices[t]) {
      if (!diagram.isReal(site)) continue;
      ++offsets[static_cast<std::size_t>(site)];
      firstTriangle[static_cast<std::size_t>(site)] = static_cast<Index>(t);
    }
  }
  exclusiveScan(offsets);
  diagram.siteEdges.resize(offsets.back());
  for (std::size_t site = 0; site < siteCount; ++site) {
    Index triangle = firstTriangle[site];
    for (std::uint32_t place = offsets[site]; place < offsets[site + 1]; ++place) {
      const auto t = static_cast<std::size_t>(triangle);
      std::size_t k = 0;
      while (triangles.vertices[t][k] != static_cast<Index>(site)) ++k;
      // Counter-clockwise about the site the next triangle shares its edge to the triangle's last vertex.
      diagram.siteEdges[place] = diagram.vertexEdges[t][next(k)];
      triangle = triangles.neighbors[t][next(k)];
    }
  }
  diagram.siteEdgeOffsets = std::move(offsets);
}

}  // namespace

PlanarDiagram buildPlanarDiagram(std::span<const Vec2> sites, const Box2& domain, const RunContext& context) {
  if (sites.empty()) throw MethodError("a Voronoi diagram needs at least one site");
  PlanarDiagram diagram;
  Stopwatch watch;
  diagram.siteCount = static_cast<Index>(sites.size());
  diagram.sites = withGhosts(sites, domain);
  Triangles triangles = delaunayTriangles(diagram.sites, diagram.siteCount);
  diagram.secondsDelaunay = watch.seconds();
  context.throwIfCancelled();

  watch.restart();
  diagram.vertices.resize(triangles.vertices.size());
  parallelFor(context, diagram.vertices.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const auto& s = triangles.vertices[v];
      const auto site = [&](std::size_t k) -> const Vec2& { return diagram.sites[static_cast<std::size_t>(s[k])]; };
      diagram.vertices[v] = circumcenter(site(0), site(1), site(2));
    }
  });
  buildEdges(triangles, diagram);
  buildSiteEdges(triangles, diagram);
  diagram.vertexSites = std::move(triangles.vertices);
  diagram.secondsFlattening = watch.seconds();
  return diagram;
}

}  // namespace voroform::voronoi
