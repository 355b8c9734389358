#include "boundary_topology.hpp"

#include <algorithm>
#include <vector>

#include "disjoint_sets.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::mesh {

namespace {

constexpr std::size_t kGrain = 512;

std::uint64_t edgeKey(Index a, Index b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32U | static_cast<std::uint64_t>(std::max(a, b));
}

// A directed edge of a boundary face: from corner `from` to the next corner `to` of the same face.
struct HalfEdge {
  std::uint64_t key;
  Index from;
  Index to;
  Index face;
};

}  // namespace

Violations openCells(const PolyhedralComplex& complex, const CellFaces& rows, const RunContext& context) {
  std::vector<std::uint8_t> open(static_cast<std::size_t>(complex.cellCount), 0);
  parallelFor(context, open.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    // Key of the edge times two, plus one for the direction from the higher to the lower vertex.
    std::vector<std::uint64_t> edges;
    for (std::size_t cell = begin; cell < end; ++cell) {
      edges.clear();
      for (auto k = static_cast<std::size_t>(rows.offsets[cell]); k < static_cast<std::size_t>(rows.offsets[cell + 1]);
           ++k) {
        const auto loop = complex.face(rows.faces[k]);
        for (std::size_t i = 0; i < loop.size(); ++i) {
          const Index a = loop[i];
          const Index b = loop[i + 1 == loop.size() ? 0 : i + 1];
          edges.push_back(edgeKey(a, b) << 1U | static_cast<std::uint64_t>((a > b) == (rows.sides[k] > 0)));
        }
      }
      std::sort(edges.begin(), edges.end());
      for (std::size_t i = 0; i < edges.size();) {
        std::int64_t balance = 0;
        const std::uint64_t key = edges[i] >> 1U;
        for (; i < edges.size() && edges[i] >> 1U == key; ++i) balance += (edges[i] & 1U) != 0 ? 1 : -1;
        if (balance != 0) open[cell] = 1;
      }
    }
  });
  Violations violations;
  for (std::size_t cell = 0; cell < open.size(); ++cell) {
    if (open[cell] != 0) violations.add(static_cast<Index>(cell));
  }
  return violations;
}

BoundaryTopology boundaryTopology(const PolyhedralComplex& complex) {
  std::vector<HalfEdge> edges;
  std::vector<Index> cornerVertex;
  std::int64_t faces = 0;
  for (Index f = 0; f < complex.faceCount(); ++f) {
    if (!complex.isBoundary(f)) continue;
    const auto loop = complex.face(f);
    const auto first = static_cast<Index>(cornerVertex.size());
    const auto size = static_cast<Index>(loop.size());
    for (Index i = 0; i < size; ++i) {
      const Index next = i + 1 == size ? 0 : i + 1;
      const Index a = loop[static_cast<std::size_t>(i)];
      cornerVertex.push_back(a);
      edges.push_back(
          {edgeKey(a, loop[static_cast<std::size_t>(next)]), first + i, first + next, static_cast<Index>(faces)});
    }
    ++faces;
  }
  std::sort(edges.begin(), edges.end(),
            [](const HalfEdge& a, const HalfEdge& b) { return a.key < b.key || (a.key == b.key && a.from < b.from); });

  const auto vertexOf = [&](Index corner) { return cornerVertex[static_cast<std::size_t>(corner)]; };
  // A vertex's fans are the sets of its corners that are joined across edges: corners less joins.
  std::vector<Index> fans(complex.vertices.size(), 0);
  for (const Index v : cornerVertex) ++fans[static_cast<std::size_t>(v)];
  std::int64_t usedVertices = 0;
  for (const Index corners : fans) usedVertices += corners > 0 ? 1 : 0;
  DisjointSets corners(cornerVertex.size());
  DisjointSets patches(static_cast<std::size_t>(faces));
  std::int64_t components = faces;
  const auto joinCorners = [&](Index a, Index b) {
    if (corners.join(a, b)) --fans[static_cast<std::size_t>(vertexOf(a))];
  };
  BoundaryTopology topology;
  std::int64_t edgeCount = 0;
  for (std::size_t i = 0; i < edges.size();) {
    const std::size_t begin = i;
    while (i < edges.size() && edges[i].key == edges[begin].key) ++i;
    ++edgeCount;
    const HalfEdge& first = edges[begin];
    if (i - begin != 2) topology.nonManifoldEdges.add(vertexOf(first.from));
    for (std::size_t j = begin + 1; j < i; ++j) {
      const bool opposite = vertexOf(edges[j].from) != vertexOf(first.from);
      joinCorners(first.from, opposite ? edges[j].to : edges[j].from);
      joinCorners(first.to, opposite ? edges[j].from : edges[j].to);
      if (patches.join(first.face, edges[j].face)) --components;
      if (i - begin == 2 && !opposite) topology.inconsistentEdges.add(vertexOf(first.from));
    }
  }
  for (std::size_t v = 0; v < fans.size(); ++v) {
    if (fans[v] > 1) topology.nonManifoldVertices.add(static_cast<Index>(v));
  }
  topology.components = static_cast<Index>(components);
  topology.eulerCharacteristic = usedVertices - edgeCount + faces;
  return topology;
}

}  // namespace voroform::mesh
