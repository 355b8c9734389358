#include "voroform/mesh/planar_validate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "boundary_topology.hpp"
#include "planar_point_samples.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/mesh/planar_moments.hpp"

namespace voroform::mesh {

namespace {

// At least this share of the point samples must be decidable, or the point location has shown nothing.
constexpr double kLocatedShare = 0.5;
constexpr std::size_t kGrain = 1024;

void complain(PlanarCertificate& certificate, const Violations& violations, const std::string& what,
              const std::string& element) {
  if (violations.count == 0) return;
  certificate.problems.push_back(std::to_string(violations.count) + " " + what + ", the first at " + element + " " +
                                 std::to_string(violations.first));
}

// Do the arrays fit each other, so that they can be walked at all?
bool sound(const PlanarTessellation& tessellation, PlanarCertificate& certificate) {
  constexpr auto kMax = static_cast<std::size_t>(std::numeric_limits<Index>::max());
  const auto fits = [](const std::vector<std::uint32_t>& offsets, std::size_t total) {
    return !offsets.empty() && offsets.front() == 0 && offsets.back() == total &&
           std::is_sorted(offsets.begin(), offsets.end());
  };
  std::string fault;
  if (tessellation.vertices.size() > kMax || tessellation.loopVertices.size() > kMax ||
      tessellation.cellOffsets.size() > kMax) {
    fault = "more cells, vertices or edges than an index can name";
  } else if (!fits(tessellation.loopOffsets, tessellation.loopVertices.size()) ||
             !fits(tessellation.cellOffsets, tessellation.loopOffsets.size() - 1)) {
    fault = "the offsets of the cells or loops do not fit the loops";
  } else if (tessellation.neighbors.size() != tessellation.loopVertices.size()) {
    fault = std::to_string(tessellation.neighbors.size()) + " neighbors for " +
            std::to_string(tessellation.loopVertices.size()) + " edges";
  } else if (tessellation.sites.size() != static_cast<std::size_t>(tessellation.cellCount())) {
    fault =
        std::to_string(tessellation.sites.size()) + " sites for " + std::to_string(tessellation.cellCount()) + " cells";
  }
  if (fault.empty()) return true;
  certificate.invalidLoops = 1;
  certificate.problems.push_back(fault);
  return false;
}

void checkLoops(const PlanarTessellation& tessellation, PlanarCertificate& certificate) {
  Violations invalid;
  std::vector<std::int64_t> lastLoop(tessellation.vertices.size(), -1);
  for (Index cell = 0; cell < tessellation.cellCount(); ++cell) {
    for (std::size_t l = tessellation.firstLoop(cell); l < tessellation.endLoop(cell); ++l) {
      bool valid = tessellation.loop(l).size() >= 3;
      for (const Index v : tessellation.loop(l)) {
        if (v < 0 || static_cast<std::size_t>(v) >= tessellation.vertices.size()) {
          valid = false;
        } else if (auto& last = lastLoop[static_cast<std::size_t>(v)]; last == static_cast<std::int64_t>(l)) {
          valid = false;
        } else {
          last = static_cast<std::int64_t>(l);
        }
      }
      for (const Index neighbor : tessellation.loopNeighbors(l)) {
        if (neighbor < kNone || neighbor >= tessellation.cellCount() || neighbor == cell) valid = false;
      }
      if (!valid) invalid.add(static_cast<Index>(l));
    }
  }
  certificate.invalidLoops = invalid.count;
  complain(certificate, invalid, "invalid loops (too few vertices, a vertex twice, an index out of range)", "loop");
}

void checkCoordinates(const PlanarTessellation& tessellation, PlanarCertificate& certificate) {
  Violations vertices;
  Violations sites;
  const auto examine = [](const std::vector<Vec2>& points, Violations& violations) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!points[i].allFinite()) violations.add(static_cast<Index>(i));
    }
  };
  examine(tessellation.vertices, vertices);
  examine(tessellation.sites, sites);
  certificate.nonFiniteVertices = vertices.count + sites.count;
  complain(certificate, vertices, "vertices that are not finite", "vertex");
  complain(certificate, sites, "sites that are not finite", "cell");
}

struct Edge {
  Index from = kNone;
  Index to = kNone;
  Index cell = kNone;
  Index neighbor = kNone;
};

std::vector<Edge> edgesOf(const PlanarTessellation& tessellation) {
  std::vector<Edge> edges;
  edges.reserve(tessellation.loopVertices.size());
  for (Index cell = 0; cell < tessellation.cellCount(); ++cell) {
    for (std::size_t l = tessellation.firstLoop(cell); l < tessellation.endLoop(cell); ++l) {
      const auto loop = tessellation.loop(l);
      const auto neighbors = tessellation.loopNeighbors(l);
      for (std::size_t k = 0; k < loop.size(); ++k) {
        edges.push_back({loop[k], loop[(k + 1) % loop.size()], cell, neighbors[k]});
      }
    }
  }
  return edges;
}

// Every edge to a neighbor stands in the neighbor once in the opposite direction; no third edge joins its vertices.
void checkInnerEdges(std::vector<Edge> edges, PlanarCertificate& certificate) {
  const auto key = [](const Edge& edge) {
    return std::array<Index, 3>{std::min(edge.from, edge.to), std::max(edge.from, edge.to), edge.cell};
  };
  std::sort(edges.begin(), edges.end(), [&key](const Edge& a, const Edge& b) { return key(a) < key(b); });
  Violations unmatched;
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin + 1;
    while (end < edges.size() && key(edges[end])[0] == key(edges[begin])[0] &&
           key(edges[end])[1] == key(edges[begin])[1]) {
      ++end;
    }
    const Edge& a = edges[begin];
    const bool isBoundary = end - begin == 1 && a.neighbor == kNone;
    const Edge& b = edges[end - 1];
    const bool isPair = end - begin == 2 && a.from == b.to && a.neighbor == b.cell && b.neighbor == a.cell;
    if (!isBoundary && !isPair) {
      for (std::size_t k = begin; k < end; ++k) unmatched.add(edges[k].cell);
    }
    begin = end;
  }
  certificate.unmatchedEdges = unmatched.count;
  complain(certificate, unmatched, "edges without exactly one opposite edge in the neighbor", "cell");
}

// The boundary edge that begins at each vertex; open vertices are counted.
std::vector<Index> boundarySuccessors(const std::vector<Edge>& boundary, std::size_t vertices,
                                      PlanarCertificate& certificate) {
  std::vector<Index> successors(vertices, kNone);
  std::vector<Index> balance(vertices, 0);
  Violations open;
  for (const Edge& edge : boundary) {
    if (successors[static_cast<std::size_t>(edge.from)] != kNone) open.add(edge.from);
    successors[static_cast<std::size_t>(edge.from)] = edge.to;
    ++balance[static_cast<std::size_t>(edge.from)];
    --balance[static_cast<std::size_t>(edge.to)];
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    if (balance[v] != 0) open.add(static_cast<Index>(v));
  }
  certificate.openVertices = open.count;
  complain(certificate, open, "vertices at which the boundary is open or meets itself", "vertex");
  return successors;
}

double lengthOf(std::span<const Vec2> ring) {
  double length = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) length += (ring[(k + 1) % ring.size()] - ring[k]).norm();
  return length;
}

// Lengths of the loops of a closed boundary, ascending.
std::vector<double> loopLengths(const PlanarTessellation& tessellation, std::vector<Index> successors) {
  std::vector<double> lengths;
  for (std::size_t start = 0; start < successors.size(); ++start) {
    double length = 0;
    auto at = start;
    while (successors[at] != kNone) {
      const auto next = static_cast<std::size_t>(successors[at]);
      length += (tessellation.vertices[next] - tessellation.vertices[at]).norm();
      successors[at] = kNone;
      at = next;
    }
    if (length > 0) lengths.push_back(length);
  }
  std::sort(lengths.begin(), lengths.end());
  return lengths;
}

void checkBoundary(const PlanarTessellation& tessellation, const PlanarRegion& region, const std::vector<Edge>& edges,
                   PlanarCertificate& certificate) {
  std::vector<Edge> boundary;
  std::copy_if(edges.begin(), edges.end(), std::back_inserter(boundary),
               [](const Edge& edge) { return edge.neighbor == kNone; });
  const std::vector<Index> successors = boundarySuccessors(boundary, tessellation.vertices.size(), certificate);
  if (certificate.openVertices > 0) return;
  const std::vector<double> lengths = loopLengths(tessellation, successors);
  std::vector<double> expected;
  for (std::size_t r = 0; r < region.ringCount(); ++r) expected.push_back(lengthOf(region.ring(r)));
  std::sort(expected.begin(), expected.end());
  certificate.boundaryLoops = static_cast<Index>(lengths.size());
  certificate.rings = static_cast<Index>(expected.size());
  if (lengths.size() != expected.size()) {
    certificate.problems.push_back("the number of the boundary's loops is " + std::to_string(lengths.size()) +
                                   ", that of the region's rings " + std::to_string(expected.size()));
    return;
  }
  for (std::size_t r = 0; r < lengths.size(); ++r) {
    certificate.boundaryError = std::max(certificate.boundaryError, std::abs(lengths[r] - expected[r]) / expected[r]);
  }
  if (!(certificate.boundaryError <= kPlanarConsistency)) {
    certificate.problems.emplace_back("the boundary's loops are not as long as the region's rings");
  }
}

void checkBoundaryPlaces(const PlanarTessellation& tessellation, const PlanarRegion& region,
                         const std::vector<Edge>& edges, PlanarCertificate& certificate, const RunContext& context) {
  const double tolerance = kPlanarConsistency * region.bounds().diagonal().norm() + coordinateRounding(region);
  std::vector<std::uint8_t> stray(edges.size(), 0);
  parallelFor(context, edges.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (edges[k].neighbor != kNone) continue;
      const Vec2& a = tessellation.vertices[static_cast<std::size_t>(edges[k].from)];
      const Vec2& b = tessellation.vertices[static_cast<std::size_t>(edges[k].to)];
      for (const Vec2& point : {a, b, Vec2(0.5 * (a + b))}) {
        if (!(std::abs(region.signedDistance(point)) <= tolerance)) stray[k] = 1;
      }
    }
  });
  Violations violations;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    if (stray[k] != 0) violations.add(edges[k].cell);
  }
  certificate.strayEdges = violations.count;
  complain(certificate, violations, "boundary edges off the region's boundary", "cell");
}

void checkAreas(const PlanarTessellation& tessellation, const PlanarRegion& region, PlanarCertificate& certificate,
                const RunContext& context) {
  Violations notPositive;
  const std::vector<PlanarCellMoments> moments = cellMoments(tessellation, context);
  for (std::size_t cell = 0; cell < moments.size(); ++cell) {
    certificate.area += moments[cell].area;
    if (!(moments[cell].area > 0)) notPositive.add(static_cast<Index>(cell));
  }
  certificate.nonPositiveAreas = notPositive.count;
  complain(certificate, notPositive, "cells without a positive area", "cell");
  certificate.areaError = std::abs(certificate.area - region.area()) / region.area();
  if (!(certificate.areaError <= kPlanarConsistency)) {
    certificate.problems.push_back("the cells' areas add up to " + std::to_string(certificate.area) +
                                   ", the region's is " + std::to_string(region.area()));
  }
}

void checkPoints(const PlanarTessellation& tessellation, const PlanarRegion& region,
                 const PlanarValidateOptions& options, PlanarCertificate& certificate, const RunContext& context) {
  if (options.pointSamples <= 0) return;
  const PlanarPointSamples samples = locateSamples(tessellation, region, options.pointSamples, options.seed, context);
  certificate.pointSamples = samples.located;
  certificate.pointViolations = samples.violations.count;
  complain(certificate, samples.violations,
           "random points not in the one cell of their nearest site inside the region, or not in none outside",
           "sample");
  if (samples.located < kLocatedShare * options.pointSamples) {
    certificate.problems.push_back("only " + std::to_string(samples.located) + " of " +
                                   std::to_string(options.pointSamples) + " random points could be located");
  }
}

}  // namespace

PlanarCertificate validate(const PlanarTessellation& tessellation, const PlanarRegion& region,
                           const PlanarValidateOptions& options, const RunContext& context) {
  PlanarCertificate certificate;
  if (!sound(tessellation, certificate)) return certificate;
  checkLoops(tessellation, certificate);
  checkCoordinates(tessellation, certificate);
  // What follows walks the loops and would read out of range.
  if (certificate.invalidLoops > 0) return certificate;
  const std::vector<Edge> edges = edgesOf(tessellation);
  checkInnerEdges(edges, certificate);
  if (certificate.nonFiniteVertices == 0) {
    checkBoundary(tessellation, region, edges, certificate);
    checkBoundaryPlaces(tessellation, region, edges, certificate, context);
    checkAreas(tessellation, region, certificate, context);
    checkPoints(tessellation, region, options, certificate, context);
  }
  certificate.valid = certificate.problems.empty();
  return certificate;
}

}  // namespace voroform::mesh
