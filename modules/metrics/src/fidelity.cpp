#include "voroform/metrics/fidelity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "voroform/core/parallel.hpp"
#include "voroform/core/random.hpp"
#include "voroform/mesh/box_tree.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/mesh/surface_locator.hpp"

namespace voroform::metrics {

namespace {

constexpr std::size_t kSampleGrain = std::size_t{1} << 15U;
constexpr std::size_t kLookUpGrain = 4096;
constexpr std::size_t kGrain = 512;
// A boundary triangle is supported by the cloud if a point lies within this many spacings of its centroid.
constexpr double kSupportSpacings = 4;

// Spreads the lowest ten bits to every third bit.
std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 16U) & 0x030000FFU;
  x = (x | x << 8U) & 0x0300F00FU;
  x = (x | x << 4U) & 0x030C30C3U;
  return (x | x << 2U) & 0x09249249U;
}

std::uint32_t mortonKey(const Vec3& point, const Box3& box) {
  constexpr double kCells = 1023;
  const Vec3 unit = (point - box.min()).cwiseQuotient(box.sizes().cwiseMax(1e-300));
  const auto cell = [&](Eigen::Index axis) {
    return static_cast<std::uint32_t>(kCells * std::clamp(unit[axis], 0.0, 1.0));
  };
  return spread(cell(0)) << 2U | spread(cell(1)) << 1U | spread(cell(2));
}

// Which of the points are inside: by the oracle, and where it is silent by f, asked in spatial order because forms find
// their way from one point to the next.
void insideFlags(const implicit::ImplicitFunction& f, std::span<const Vec3> points, const Box3& box,
                 std::vector<std::uint8_t>& inside) {
  std::vector<double> clearance(points.size());
  f.clearances(points, clearance);
  inside.assign(points.size(), 0);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> undecided;
  for (std::size_t i = 0; i < points.size(); ++i) {
    inside[i] = clearance[i] < 0 ? 1 : 0;
    if (clearance[i] == 0) undecided.emplace_back(mortonKey(points[i], box), static_cast<std::uint32_t>(i));
  }
  std::sort(undecided.begin(), undecided.end());
  std::vector<Vec3> asked;
  asked.reserve(undecided.size());
  for (const auto& [key, i] : undecided) asked.push_back(points[i]);
  std::vector<double> values(asked.size());
  f.values(asked, values);
  for (std::size_t k = 0; k < undecided.size(); ++k) inside[undecided[k].second] = values[k] < 0 ? 1 : 0;
}

struct ChunkSamples {
  std::int64_t inside = 0;
  std::vector<Vec3> chosen;
};

struct MissedCounts {
  std::int64_t lookedUp = 0;
  std::int64_t missed = 0;
};

void compareWithForm(const mesh::TriangleMesh& boundary, const InsideSamples& samples, const RunContext& context,
                     Fidelity& result) {
  if (samples.total == 0) return;
  Box3 extent;
  for (const Vec3& vertex : boundary.vertices) extent.extend(vertex);
  const mesh::SurfaceLocator locator(boundary, 2, mesh::locationTolerance(extent));
  const MissedCounts counts = parallelReduce(
      context, samples.chosen.size(), kLookUpGrain, MissedCounts{},
      [&](std::size_t begin, std::size_t end, MissedCounts found) {
        for (std::size_t k = begin; k < end; ++k) {
          const mesh::Location location = locator.locate(samples.chosen[k]);
          if (location == mesh::Location::uncertain) continue;
          ++found.lookedUp;
          if (location == mesh::Location::outside) ++found.missed;
        }
        return found;
      },
      [](const MissedCounts& a, const MissedCounts& b) {
        return MissedCounts{a.lookedUp + b.lookedUp, a.missed + b.missed};
      });
  result.sampledVolume = samples.volume;
  result.sampledVolumeSigma = samples.volumeSigma;
  result.missedSamples = counts.lookedUp;
  if (counts.lookedUp > 0) {
    result.missedShare = static_cast<double>(counts.missed) / static_cast<double>(counts.lookedUp);
  }
  result.volumeError =
      samples.volume > 0 ? std::abs(mesh::enclosedVolume(boundary) - samples.volume) / samples.volume : 1;
}

struct CellEdge {
  Index low;
  Index high;
  Index face;
};

// Number of parts that a cell's faces form across shared edges.
Index partsOfCell(const mesh::PolyhedralComplex& complex, std::span<const Index> faces, std::vector<CellEdge>& edges,
                  std::vector<Index>& parent) {
  edges.clear();
  parent.resize(faces.size());
  std::iota(parent.begin(), parent.end(), Index{0});
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const auto loop = complex.face(faces[k]);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Index a = loop[i];
      const Index b = loop[i + 1 == loop.size() ? 0 : i + 1];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<Index>(k)});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const CellEdge& a, const CellEdge& b) {
    return std::array{a.low, a.high, a.face} < std::array{b.low, b.high, b.face};
  });
  const auto root = [&](Index i) {
    while (parent[static_cast<std::size_t>(i)] != i) i = parent[static_cast<std::size_t>(i)];
    return i;
  };
  auto parts = static_cast<Index>(faces.size());
  for (std::size_t i = 1; i < edges.size(); ++i) {
    if (edges[i].low != edges[i - 1].low || edges[i].high != edges[i - 1].high) continue;
    const Index a = root(edges[i].face);
    const Index b = root(edges[i - 1].face);
    if (a == b) continue;
    parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    --parts;
  }
  return parts;
}

Index disconnectedCells(const mesh::PolyhedralComplex& complex, const RunContext& context) {
  const mesh::CellFaces rows = mesh::cellFaces(complex);
  return parallelReduce(
      context, static_cast<std::size_t>(complex.cellCount), kGrain, Index{0},
      [&](std::size_t begin, std::size_t end, Index count) {
        std::vector<CellEdge> edges;
        std::vector<Index> parent;
        for (std::size_t cell = begin; cell < end; ++cell) {
          const auto first = static_cast<std::size_t>(rows.offsets[cell]);
          const auto last = static_cast<std::size_t>(rows.offsets[cell + 1]);
          if (partsOfCell(complex, {rows.faces.data() + first, last - first}, edges, parent) > 1) ++count;
        }
        return count;
      },
      [](Index a, Index b) { return a + b; });
}

struct Areas {
  double all = 0;
  double envelope = 0;
  double unsupported = 0;
};

Areas boundaryAreas(const mesh::PolyhedralComplex& complex, const mesh::BoundarySurface& boundary,
                    const FidelityOptions& options, const RunContext& context) {
  std::vector<Box3> pointBoxes;
  pointBoxes.reserve(options.points.size());
  for (const Vec3& point : options.points) pointBoxes.emplace_back(point);
  const mesh::BoxTree cloud(pointBoxes);
  const double reach = kSupportSpacings * options.spacing;
  const auto supported = [&](const Vec3& place) {
    bool found = false;
    cloud.forEachOverlap(Box3(place - Vec3::Constant(reach), place + Vec3::Constant(reach)), [&](Index i) {
      found = found || (options.points[static_cast<std::size_t>(i)] - place).squaredNorm() <= reach * reach;
    });
    return found;
  };
  return parallelReduce(
      context, boundary.mesh.triangles.size(), kGrain, Areas{},
      [&](std::size_t begin, std::size_t end, Areas areas) {
        for (std::size_t t = begin; t < end; ++t) {
          const auto& triangle = boundary.mesh.triangles[t];
          const auto corner = [&](std::size_t i) -> const Vec3& {
            return boundary.mesh.vertices[static_cast<std::size_t>(triangle[i])];
          };
          const double area = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
          areas.all += area;
          const auto face = static_cast<std::size_t>(boundary.sourceFaces[t]);
          if (complex.faceTags[face] == mesh::FaceTag::envelope) areas.envelope += area;
          if (!options.points.empty() && !supported((corner(0) + corner(1) + corner(2)) / 3)) areas.unsupported += area;
        }
        return areas;
      },
      [](const Areas& a, const Areas& b) {
        return Areas{a.all + b.all, a.envelope + b.envelope, a.unsupported + b.unsupported};
      });
}

}  // namespace

InsideSamples insideSamples(const implicit::ImplicitFunction& f, const FidelityOptions& options,
                            const RunContext& context) {
  InsideSamples result;
  const Box3 box = f.bounds();
  if (options.volumeSamples <= 0 || box.isEmpty()) return result;
  const std::int64_t total = options.volumeSamples;
  const std::int64_t stride =
      options.missedSamples > 0 ? std::max<std::int64_t>(1, total / options.missedSamples) : total + 1;
  std::vector<ChunkSamples> chunks((static_cast<std::size_t>(total) + kSampleGrain - 1) / kSampleGrain);
  parallelFor(context, static_cast<std::size_t>(total), kSampleGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> points;
    points.reserve(end - begin);
    for (std::size_t i = begin; i < end; ++i) points.push_back(quasiRandomInBox(options.seed, i, box));
    std::vector<std::uint8_t> inside;
    insideFlags(f, points, box, inside);
    ChunkSamples& chunk = chunks[begin / kSampleGrain];
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (inside[k] == 0) continue;
      ++chunk.inside;
      if (static_cast<std::int64_t>(begin + k) % stride == 0) chunk.chosen.push_back(points[k]);
    }
  });
  std::int64_t inside = 0;
  for (const ChunkSamples& chunk : chunks) {
    inside += chunk.inside;
    result.chosen.insert(result.chosen.end(), chunk.chosen.begin(), chunk.chosen.end());
  }
  const double share = static_cast<double>(inside) / static_cast<double>(total);
  result.total = total;
  result.volume = box.volume() * share;
  result.volumeSigma = box.volume() * std::sqrt(share * (1 - share) / static_cast<double>(total));
  return result;
}

Fidelity fidelity(const mesh::PolyhedralComplex& complex, const InsideSamples& samples, const FidelityOptions& options,
                  const RunContext& context) {
  Fidelity result;
  const mesh::BoundarySurface boundary = mesh::boundarySurface(complex);
  compareWithForm(boundary.mesh, samples, context, result);
  result.disconnectedCells = disconnectedCells(complex, context);
  const Areas areas = boundaryAreas(complex, boundary, options, context);
  if (areas.all > 0) {
    result.envelopeShare = areas.envelope / areas.all;
    result.unsupportedShare = areas.unsupported / areas.all;
  }
  return result;
}

Fidelity fidelity(const mesh::PolyhedralComplex& complex, const implicit::ImplicitFunction& f,
                  const FidelityOptions& options, const RunContext& context) {
  return fidelity(complex, insideSamples(f, options, context), options, context);
}

}  // namespace voroform::metrics
