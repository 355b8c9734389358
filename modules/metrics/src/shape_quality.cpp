#include "voroform/metrics/shape_quality.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::metrics {

namespace {

constexpr std::size_t kGrain = 512;
constexpr double kDegrees = 180 / std::numbers::pi;

// The smallest and the largest of an element's angles. An angle beside a side or a face of size zero is undefined; it
// counts as the worst of both kinds.
class AngleRange {
 public:
  // Of the angle between two vectors, from the sine and the cosine up to a common factor: exact near 0 and 180 degrees
  // too, where the arccosine loses half of the digits.
  void add(double sine, double cosine) {
    const bool defined = sine > 0 || cosine != 0;
    const double angle = defined ? std::atan2(sine, cosine) * kDegrees : 0;
    smallest_ = std::min(smallest_, angle);
    largest_ = std::max(largest_, defined ? angle : 180.0);
  }
  double smallest() const { return smallest_; }
  double largest() const { return largest_; }

 private:
  double smallest_ = 180;
  double largest_ = 0;
};

// Scales by a power of two, which rounds nothing, so that the largest coordinate is near 1: products of six lengths
// would leave the range of double for elements of 1e-60 or 1e60 units.
template <std::size_t N>
void normalize(std::array<Vec3, N>& vectors) {
  double largest = 0;
  for (const Vec3& v : vectors) largest = std::max(largest, v.cwiseAbs().maxCoeff());
  if (!(largest > 0) || !std::isfinite(largest)) return;
  const int exponent = -std::ilogb(largest);
  for (Vec3& v : vectors) {
    for (double& coordinate : v) coordinate = std::ldexp(coordinate, exponent);
  }
}

double ratio(double numerator, double denominator) {
  return denominator > 0 ? std::clamp(numerator / denominator, 0.0, 1.0) : 0.0;
}

}  // namespace

TetrahedronQuality tetrahedronQuality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // Edges ab, ac, ad, bc, cd, db.
  std::array<Vec3, 6> edges = {b - a, c - a, d - a, c - b, d - c, b - d};
  normalize(edges);
  const auto& [ab, ac, ad, bc, cd, db] = edges;

  // Twice the outward area vectors of the faces opposite a, b, c and d, for a positive orientation.
  const std::array<Vec3, 4> normals = {bc.cross(cd), ad.cross(ac), ab.cross(ad), ac.cross(ab)};
  std::array<double, 4> areas{};
  std::transform(normals.begin(), normals.end(), areas.begin(), [](const Vec3& n) { return n.norm(); });
  const double sixVolume = std::abs(ab.dot(ac.cross(ad)));

  // The faces opposite i and j meet at the edge of the other two vertices at the dihedral angle θ; with n the outward
  // normals |nᵢ × nⱼ| = |edge|·6V and nᵢ·nⱼ = −|nᵢ||nⱼ| cos θ.
  constexpr std::array<std::array<std::size_t, 3>, 6> kFacesAtEdge = {
      {{0, 2, 3}, {1, 1, 3}, {2, 1, 2}, {3, 0, 3}, {4, 0, 1}, {5, 0, 2}}};
  AngleRange angles;
  double squaredLengths = 0;
  for (const auto& [edge, i, j] : kFacesAtEdge) {
    squaredLengths += edges[edge].squaredNorm();
    if (areas[i] > 0 && areas[j] > 0) {
      angles.add(edges[edge].norm() * sixVolume, -normals[i].dot(normals[j]));
    } else {
      angles.add(0, 0);
    }
  }

  TetrahedronQuality quality;
  quality.smallestDihedral = angles.smallest();
  quality.largestDihedral = angles.largest();
  // Inradius 3V/Σ areas; circumradius ‖‖ab‖² ac×ad + ‖ac‖² ad×ab + ‖ad‖² ab×ac‖ / 12V.
  const double circumscribed =
      (ab.squaredNorm() * ac.cross(ad) + ac.squaredNorm() * ad.cross(ab) + ad.squaredNorm() * ab.cross(ac)).norm();
  const double doubleAreas = areas[0] + areas[1] + areas[2] + areas[3];
  quality.radiusRatio = ratio(6 * sixVolume * sixVolume, doubleAreas * circumscribed);
  // 12·∛(9V²) = 12·∛((6V)²/4).
  const double root = std::cbrt(sixVolume);
  quality.meshingQuality = ratio(12 * root * root / std::cbrt(4.0), squaredLengths);
  return quality;
}

TriangleQuality triangleQuality(const Vec3& a, const Vec3& b, const Vec3& c) {
  std::array<Vec3, 3> sides = {b - a, c - b, a - c};
  normalize(sides);
  const auto& [ab, bc, ca] = sides;
  const double doubleArea = ab.cross(ca).norm();

  AngleRange angles;
  angles.add(doubleArea, -ca.dot(ab));
  angles.add(doubleArea, -ab.dot(bc));
  angles.add(doubleArea, -bc.dot(ca));

  TriangleQuality quality;
  quality.smallestAngle = angles.smallest();
  quality.largestAngle = angles.largest();
  // Inradius 2A/Σ l, circumradius l₁l₂l₃/4A.
  const double lab = ab.norm();
  const double lbc = bc.norm();
  const double lca = ca.norm();
  quality.radiusRatio = ratio(4 * doubleArea * doubleArea, (lab + lbc + lca) * lab * lbc * lca);
  quality.meshingQuality = ratio(2 * std::numbers::sqrt3 * doubleArea, lab * lab + lbc * lbc + lca * lca);
  return quality;
}

namespace {

// Sums while the elements are gone through; joined in a fixed order.
struct Sums {
  std::array<double, 4> sum = {};
  std::array<double, 4> worst = {std::numeric_limits<double>::infinity(), 0, std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::infinity()};
  std::int64_t slivers = 0;

  void add(const std::array<double, 4>& criteria) {
    for (std::size_t k = 0; k < 4; ++k) sum[k] += criteria[k];
    takeWorst(criteria);
  }
  void takeWorst(const std::array<double, 4>& criteria) {
    for (std::size_t k = 0; k < 4; ++k) {
      worst[k] = k == 1 ? std::max(worst[k], criteria[k]) : std::min(worst[k], criteria[k]);
    }
  }
};

Sums join(const Sums& a, const Sums& b) {
  Sums result = a;
  for (std::size_t k = 0; k < 4; ++k) result.sum[k] += b.sum[k];
  result.takeWorst(b.worst);
  result.slivers += b.slivers;
  return result;
}

QualityStatistics statistics(const Sums& sums, std::size_t elements) {
  QualityStatistics result;
  result.elements = static_cast<std::int64_t>(elements);
  if (elements == 0) return result;
  for (std::size_t k = 0; k < 4; ++k) result.mean[k] = sums.sum[k] / static_cast<double>(elements);
  result.worst = sums.worst;
  result.slivers = sums.slivers;
  return result;
}

// The four vertices of a cell that must be a tetrahedron.
std::array<Index, 4> verticesOf(const mesh::PolyhedralComplex& complex, std::span<const Index> faces,
                                std::size_t cell) {
  std::array<Index, 4> vertices = {kNone, kNone, kNone, kNone};
  std::size_t known = 0;
  bool fits = faces.size() == 4;
  for (std::size_t k = 0; fits && k < faces.size(); ++k) {
    const auto loop = complex.face(faces[k]);
    fits = loop.size() == 3;
    for (std::size_t i = 0; fits && i < loop.size(); ++i) {
      const auto end = vertices.begin() + static_cast<std::ptrdiff_t>(known);
      if (std::find(vertices.begin(), end, loop[i]) != end) continue;
      fits = known < 4;
      if (fits) vertices[known++] = loop[i];
    }
  }
  if (!fits || known != 4) {
    throw UsageError("cell " + std::to_string(cell) + " is no tetrahedron: it has " + std::to_string(faces.size()) +
                     " faces, or one that is no triangle, or not four vertices");
  }
  return vertices;
}

}  // namespace

QualityStatistics tetrahedraQuality(const mesh::PolyhedralComplex& complex, const RunContext& context) {
  const mesh::CellFaces rows = mesh::cellFaces(complex);
  const auto count = static_cast<std::size_t>(complex.cellCount);
  const Sums sums = parallelReduce(
      context, count, kGrain, Sums{},
      [&](std::size_t begin, std::size_t end, Sums sum) {
        for (std::size_t cell = begin; cell < end; ++cell) {
          const auto first = static_cast<std::size_t>(rows.offsets[cell]);
          const auto last = static_cast<std::size_t>(rows.offsets[cell + 1]);
          const auto vertices = verticesOf(complex, {rows.faces.data() + first, last - first}, cell);
          const auto vertex = [&](std::size_t k) -> const Vec3& {
            return complex.vertices[static_cast<std::size_t>(vertices[k])];
          };
          const TetrahedronQuality q = tetrahedronQuality(vertex(0), vertex(1), vertex(2), vertex(3));
          sum.add({q.smallestDihedral, q.largestDihedral, q.radiusRatio, q.meshingQuality});
          if (q.smallestDihedral < kSliverAngle) ++sum.slivers;
        }
        return sum;
      },
      join);
  return statistics(sums, count);
}

QualityStatistics boundaryTriangleQuality(const mesh::PolyhedralComplex& complex, bool withEnvelope) {
  const mesh::BoundarySurface boundary = mesh::boundarySurface(complex);
  Sums sums;
  std::size_t count = 0;
  for (std::size_t t = 0; t < boundary.mesh.triangles.size(); ++t) {
    const auto face = static_cast<std::size_t>(boundary.sourceFaces[t]);
    if (!withEnvelope && complex.faceTags[face] == mesh::FaceTag::envelope) continue;
    const auto& triangle = boundary.mesh.triangles[t];
    const auto corner = [&](std::size_t k) -> const Vec3& {
      return boundary.mesh.vertices[static_cast<std::size_t>(triangle[k])];
    };
    const TriangleQuality q = triangleQuality(corner(0), corner(1), corner(2));
    sums.add({q.smallestAngle, q.largestAngle, q.radiusRatio, q.meshingQuality});
    ++count;
  }
  return statistics(sums, count);
}

}  // namespace voroform::metrics
