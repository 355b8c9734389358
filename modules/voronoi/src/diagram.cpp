#include "voroform/voronoi/diagram.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "delaunay.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::voronoi {

namespace {

constexpr std::size_t kGrain = 4096;

// The ghosts' distance from the domain's center, in units of its radius. Ghosts at the vertices of an icosahedron bound
// the real cells to about 0.63 of it.
constexpr double kGhostDistance = 8;

// Below this share of the edges' product a tetrahedron's determinant has lost too many digits to divide by.
constexpr double kFlatTetrahedron = 1e-9;

// kNextAroundEdge[i][j]: in a positively oriented tetrahedron, the vertex opposite the next tetrahedron about the edge
// from i to j, counter-clockwise seen from j.
constexpr int kNextAroundEdge[4][4] = {{-1, 2, 3, 1}, {3, -1, 0, 2}, {1, 3, -1, 0}, {2, 0, 1, -1}};

// kOtherTwo[i][j]: the lower of the two local indices that are neither i nor j.
constexpr std::size_t kOtherTwo[4][4] = {{0, 2, 1, 1}, {2, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}};

void appendGhosts(std::vector<Vec3>& sites, const Box3& domain) {
  const Vec3 center = domain.center();
  const double radius = 0.5 * domain.diagonal().norm();
  const double golden = (1 + std::sqrt(5.0)) / 2;
  const double scale = kGhostDistance * radius / std::sqrt(1 + golden * golden);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double s : {-1.0, 1.0}) {
      for (const double t : {-1.0, 1.0}) {
        Vec3 ghost = Vec3::Zero();
        ghost[(axis + 1) % 3] = s;
        ghost[(axis + 2) % 3] = t * golden;
        sites.push_back(center + scale * ghost);
      }
    }
  }
}

Vec3 circumcenter(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  const Vec3 a = q - p;
  const Vec3 b = r - p;
  const Vec3 c = s - p;
  const Vec3 ab = a.cross(b);
  const double determinant = ab.dot(c);
  const double aa = a.squaredNorm();
  const double bb = b.squaredNorm();
  const double cc = c.squaredNorm();
  if (determinant * determinant < kFlatTetrahedron * kFlatTetrahedron * aa * bb * cc) {
    return exactCircumcenter(p, q, r, s);
  }
  return p + (aa * b.cross(c) + bb * c.cross(a) + cc * ab) / (2 * determinant);
}

int localIndex(const std::array<Index, 4>& sites, Index site) {
  for (int k = 0; k < 3; ++k) {
    if (sites[static_cast<std::size_t>(k)] == site) return k;
  }
  return 3;
}

// The facets found by one chunk of vertices.
struct FacetChunk {
  std::vector<std::array<Index, 2>> sites;
  std::vector<std::uint32_t> sizes;
  std::vector<Index> vertices;
};

// Walks about the Delaunay edge (a, b) from its vertex `start`. A facet is taken by the lowest of its vertices: as soon
// as a lower one turns up the loop is given up.
bool collectLoop(const Diagram& diagram, Index start, Index a, Index b, std::vector<Index>& loop) {
  const std::size_t before = loop.size();
  Index vertex = start;
  do {
    loop.push_back(vertex);
    const auto& sites = diagram.vertexSites[static_cast<std::size_t>(vertex)];
    const int next = kNextAroundEdge[localIndex(sites, a)][localIndex(sites, b)];
    vertex = diagram.vertexNeighbors[static_cast<std::size_t>(vertex)][static_cast<std::size_t>(next)];
    if (vertex < start) {
      loop.resize(before);
      return false;
    }
  } while (vertex != start);
  return true;
}

FacetChunk collectFacets(const Diagram& diagram, std::size_t begin, std::size_t end) {
  FacetChunk chunk;
  chunk.sites.reserve((end - begin) * 5 / 4);
  chunk.sizes.reserve((end - begin) * 5 / 4);
  chunk.vertices.reserve((end - begin) * 6);
  for (std::size_t v = begin; v < end; ++v) {
    const auto& sites = diagram.vertexSites[v];
    const auto& neighbors = diagram.vertexNeighbors[v];
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) {
        const auto [a, b] = std::minmax(sites[i], sites[j]);
        if (!diagram.isReal(a)) continue;
        // Both neighbors about the edge are at hand: most loops that a lower vertex takes are known without a walk.
        const std::size_t k = kOtherTwo[i][j];
        if (neighbors[k] < static_cast<Index>(v) || neighbors[6 - i - j - k] < static_cast<Index>(v)) continue;
        const std::size_t before = chunk.vertices.size();
        if (!collectLoop(diagram, static_cast<Index>(v), a, b, chunk.vertices)) continue;
        chunk.sites.push_back({a, b});
        chunk.sizes.push_back(static_cast<std::uint32_t>(chunk.vertices.size() - before));
      }
    }
  }
  return chunk;
}

void buildFacets(Diagram& diagram, const RunContext& context) {
  const std::size_t count = diagram.vertices.size();
  std::vector<FacetChunk> chunks((count + kGrain - 1) / kGrain);
  parallelFor(context, count, kGrain,
              [&](std::size_t begin, std::size_t end) { chunks[begin / kGrain] = collectFacets(diagram, begin, end); });

  std::vector<std::size_t> facetBegin(chunks.size());
  std::vector<std::size_t> vertexBegin(chunks.size());
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    facetBegin[c] = chunks[c].sites.size();
    vertexBegin[c] = chunks[c].vertices.size();
  }
  exclusiveScan(facetBegin);
  exclusiveScan(vertexBegin);
  diagram.facetSites.resize(facetBegin.back());
  diagram.facetOffsets.resize(facetBegin.back() + 1);
  diagram.facetVertices.resize(vertexBegin.back());
  diagram.facetOffsets.back() = static_cast<std::uint32_t>(vertexBegin.back());
  parallelFor(context, chunks.size(), 1, [&](std::size_t c, std::size_t) {
    FacetChunk chunk = std::move(chunks[c]);
    std::copy(chunk.sites.begin(), chunk.sites.end(),
              diagram.facetSites.begin() + static_cast<std::ptrdiff_t>(facetBegin[c]));
    std::copy(chunk.vertices.begin(), chunk.vertices.end(),
              diagram.facetVertices.begin() + static_cast<std::ptrdiff_t>(vertexBegin[c]));
    std::size_t offset = vertexBegin[c];
    for (std::size_t f = 0; f < chunk.sizes.size(); ++f) {
      diagram.facetOffsets[facetBegin[c] + f] = static_cast<std::uint32_t>(offset);
      offset += chunk.sizes[f];
    }
  });
}

void buildSiteFacets(Diagram& diagram) {
  std::vector<std::uint32_t> offsets(static_cast<std::size_t>(diagram.siteCount), 0);
  for (const auto& [a, b] : diagram.facetSites) {
    ++offsets[static_cast<std::size_t>(a)];
    if (diagram.isReal(b)) ++offsets[static_cast<std::size_t>(b)];
  }
  exclusiveScan(offsets);
  diagram.siteFacets.resize(offsets.back());
  std::vector<std::uint32_t> next(offsets.begin(), offsets.end() - 1);
  for (std::size_t f = 0; f < diagram.facetSites.size(); ++f) {
    const auto [a, b] = diagram.facetSites[f];
    diagram.siteFacets[next[static_cast<std::size_t>(a)]++] = static_cast<Index>(f);
    if (diagram.isReal(b)) diagram.siteFacets[next[static_cast<std::size_t>(b)]++] = static_cast<Index>(f);
  }
  diagram.siteFacetOffsets = std::move(offsets);
}

}  // namespace

Diagram buildDiagram(std::span<const Vec3> sites, const Box3& domain, const RunContext& context) {
  Diagram diagram;
  Stopwatch watch;
  diagram.siteCount = static_cast<Index>(sites.size());
  diagram.sites.reserve(sites.size() + 12);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (!domain.contains(sites[i])) {  // false for NaN too
      throw MethodError("site " + std::to_string(i) + " lies outside the domain or is not finite");
    }
    diagram.sites.push_back(sites[i]);
  }
  appendGhosts(diagram.sites, domain);
  {
    Tetrahedra tetrahedra = delaunayTetrahedra(diagram.sites, diagram.siteCount);
    diagram.vertexSites = std::move(tetrahedra.vertices);
    diagram.vertexNeighbors = std::move(tetrahedra.neighbors);
  }
  diagram.secondsDelaunay = watch.seconds();
  context.throwIfCancelled();

  watch.restart();
  diagram.vertices.resize(diagram.vertexSites.size());
  parallelFor(context, diagram.vertices.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const auto& s = diagram.vertexSites[v];
      const auto site = [&](std::size_t k) -> const Vec3& { return diagram.sites[static_cast<std::size_t>(s[k])]; };
      diagram.vertices[v] = circumcenter(site(0), site(1), site(2), site(3));
    }
  });
  buildFacets(diagram, context);
  buildSiteFacets(diagram);
  diagram.secondsFlattening = watch.seconds();
  return diagram;
}

}  // namespace voroform::voronoi
