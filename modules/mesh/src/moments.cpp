#include "voroform/mesh/moments.hpp"

#include "voroform/core/parallel.hpp"

namespace voroform::mesh {

namespace {

constexpr std::size_t kGrain = 512;

CellMoments momentsOfCell(const PolyhedralComplex& complex, const CellFaces& rows, std::size_t cell) {
  CellMoments moments;
  const auto begin = static_cast<std::size_t>(rows.offsets[cell]);
  const auto end = static_cast<std::size_t>(rows.offsets[cell + 1]);
  if (begin == end) return moments;
  const auto vertex = [&](Index v) -> const Vec3& { return complex.vertices[static_cast<std::size_t>(v)]; };
  const Vec3 apex = vertex(complex.face(rows.faces[begin])[0]);
  // Signed tetrahedra (apex, a, b, c) over all triangles; 6 × their volume is the determinant. With the apex at the
  // origin: ∫ x = V (a+b+c)/4 and ∫ ‖x‖² = V (‖a‖² + ‖b‖² + ‖c‖² + ‖a+b+c‖²)/20.
  double sixVolume = 0;
  Vec3 first = Vec3::Zero();
  double second = 0;
  for (std::size_t k = begin; k < end; ++k) {
    const auto loop = complex.face(rows.faces[k]);
    const double side = rows.sides[k];
    const Vec3 a = vertex(loop[0]) - apex;
    Vec3 b = vertex(loop[1]) - apex;
    double b2 = b.squaredNorm();
    const double a2 = a.squaredNorm();
    for (std::size_t i = 2; i < loop.size(); ++i) {
      const Vec3 c = vertex(loop[i]) - apex;
      const double c2 = c.squaredNorm();
      const double determinant = side * a.dot(b.cross(c));
      const Vec3 sum = a + b + c;
      sixVolume += determinant;
      first += determinant * sum;
      second += determinant * (a2 + b2 + c2 + sum.squaredNorm());
      b = c;
      b2 = c2;
    }
  }
  moments.volume = sixVolume / 6;
  moments.centroid = apex;
  if (sixVolume == 0) return moments;
  const Vec3 offset = first / (4 * sixVolume);
  moments.centroid += offset;
  moments.secondMoment = second / 120 - moments.volume * offset.squaredNorm();
  return moments;
}

}  // namespace

std::vector<CellMoments> cellMoments(const PolyhedralComplex& complex, const RunContext& context) {
  const CellFaces rows = cellFaces(complex);
  std::vector<CellMoments> moments(static_cast<std::size_t>(complex.cellCount));
  parallelFor(context, moments.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t cell = begin; cell < end; ++cell) moments[cell] = momentsOfCell(complex, rows, cell);
  });
  return moments;
}

double enclosedVolume(const TriangleMesh& mesh) {
  Box3 box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  if (box.isEmpty()) return 0;
  const Vec3 center = box.center();
  double sum = 0;
  for (const auto& triangle : mesh.triangles) {
    const auto corner = [&](std::size_t i) {
      return Vec3(mesh.vertices[static_cast<std::size_t>(triangle[i])] - center);
    };
    sum += corner(0).dot(corner(1).cross(corner(2)));
  }
  return sum / 6;
}

}  // namespace voroform::mesh
