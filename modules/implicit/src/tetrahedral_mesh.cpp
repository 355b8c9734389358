// Checking and renumbering the mesh of a tetrahedral form.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "tetrahedron.hpp"
#include "voroform/implicit/tetrahedral_form.hpp"

namespace voroform::implicit {

namespace {

// 21 bits spread to every third place.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1FFFFFU;
  x = (x | x << 32U) & 0x1F00000000FFFFU;
  x = (x | x << 16U) & 0x1F0000FF0000FFU;
  x = (x | x << 8U) & 0x100F00F00F00F00FU;
  x = (x | x << 4U) & 0x10C30C30C30C30C3U;
  return (x | x << 2U) & 0x1249249249249249U;
}

class MortonCurve {
 public:
  explicit MortonCurve(const Box3& box) : origin_(box.min()) {
    const double longest = box.sizes().maxCoeff();
    stepsPerUnit_ = longest > 0 ? 2097151.0 / longest : 0.0;
  }
  std::uint64_t operator()(const Vec3& p) const {
    const Vec3 steps = ((p - origin_) * stepsPerUnit_).cwiseMax(0.0);
    return spread(static_cast<std::uint64_t>(steps.x())) | spread(static_cast<std::uint64_t>(steps.y())) << 1U |
           spread(static_cast<std::uint64_t>(steps.z())) << 2U;
  }

 private:
  Vec3 origin_;
  double stepsPerUnit_;
};

using Keyed = std::pair<std::uint64_t, Index>;

// Sorts and returns for each old number its new one.
std::vector<Index> rank(std::vector<Keyed>& keyed) {
  std::sort(keyed.begin(), keyed.end());
  std::vector<Index> newNumber(keyed.size());
  for (std::size_t i = 0; i < keyed.size(); ++i)
    newNumber[static_cast<std::size_t>(keyed[i].second)] = static_cast<Index>(i);
  return newNumber;
}

Vec3 centroid(const TetrahedralMesh& mesh, const FormTetrahedron& tetrahedron) {
  Vec3 sum = Vec3::Zero();
  for (const Index v : tetrahedron.vertices) sum += mesh.vertices[static_cast<std::size_t>(v)].position;
  return 0.25 * sum;
}

std::array<Index, 3> sortedFace(const FormTetrahedron& tetrahedron, std::size_t opposite) {
  std::array<Index, 3> face{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (i != opposite) face[n++] = tetrahedron.vertices[i];
  }
  std::sort(face.begin(), face.end());
  return face;
}

bool touches(const TetrahedralMesh& mesh, Index from, std::size_t face) {
  const FormTetrahedron& tetrahedron = mesh.tetrahedra[static_cast<std::size_t>(from)];
  const FormTetrahedron& other = mesh.tetrahedra[static_cast<std::size_t>(tetrahedron.neighbors[face])];
  const auto shared = sortedFace(tetrahedron, face);
  for (std::size_t i = 0; i < 4; ++i) {
    if (other.neighbors[i] == from && sortedFace(other, i) == shared) return true;
  }
  return false;
}

}  // namespace

std::string findProblem(const TetrahedralMesh& mesh) {
  const auto vertices = static_cast<Index>(mesh.vertices.size());
  const auto tetrahedra = static_cast<Index>(mesh.tetrahedra.size());
  if (mesh.tetrahedra.empty()) return "there are no tetrahedra";
  if (!mesh.measured.empty() && mesh.measured.size() != mesh.vertices.size()) {
    return "the flags of measured vertices do not match the number of vertices";
  }
  for (Index v = 0; v < vertices; ++v) {
    const FormVertex& vertex = mesh.vertices[static_cast<std::size_t>(v)];
    if (!vertex.position.allFinite()) return "vertex " + std::to_string(v) + ": a coordinate is not a finite number";
    if (!std::isfinite(vertex.value)) return "vertex " + std::to_string(v) + ": the value is not a finite number";
  }
  for (Index t = 0; t < tetrahedra; ++t) {
    const FormTetrahedron& tetrahedron = mesh.tetrahedra[static_cast<std::size_t>(t)];
    const std::string name = "tetrahedron " + std::to_string(t);
    for (const Index v : tetrahedron.vertices) {
      if (v < 0 || v >= vertices) return name + ": there is no vertex " + std::to_string(v);
    }
    for (const Index n : tetrahedron.neighbors) {
      if (n < kNone || n >= tetrahedra || n == t) return name + ": there is no neighbor " + std::to_string(n);
    }
    const TetrahedronFrame frame(mesh, t);
    // Slivers may come out a rounding error below zero.
    if (!(frame.determinant >= -1e-12 * frame.lengthCubed())) return name + " is turned inside out";
  }
  for (Index t = 0; t < tetrahedra; ++t) {
    const FormTetrahedron& tetrahedron = mesh.tetrahedra[static_cast<std::size_t>(t)];
    for (std::size_t face = 0; face < 4; ++face) {
      if (tetrahedron.neighbors[face] != kNone && !touches(mesh, t, face)) {
        return "tetrahedra " + std::to_string(t) + " and " + std::to_string(tetrahedron.neighbors[face]) +
               " are said to be neighbors but share no face";
      }
    }
  }
  return {};
}

void sortSpatially(TetrahedralMesh& mesh) {
  Box3 box;
  for (const FormVertex& vertex : mesh.vertices) box.extend(vertex.position);
  const MortonCurve curve(box);

  std::vector<Keyed> keyed(mesh.vertices.size());
  for (std::size_t v = 0; v < keyed.size(); ++v) keyed[v] = {curve(mesh.vertices[v].position), static_cast<Index>(v)};
  const std::vector<Index> newVertex = rank(keyed);
  std::vector<FormVertex> vertices(keyed.size());
  for (std::size_t v = 0; v < keyed.size(); ++v) vertices[static_cast<std::size_t>(newVertex[v])] = mesh.vertices[v];
  if (!mesh.measured.empty()) {
    std::vector<std::uint8_t> measured(keyed.size());
    for (std::size_t v = 0; v < keyed.size(); ++v) measured[static_cast<std::size_t>(newVertex[v])] = mesh.measured[v];
    mesh.measured = std::move(measured);
  }

  keyed.resize(mesh.tetrahedra.size());
  for (std::size_t t = 0; t < keyed.size(); ++t)
    keyed[t] = {curve(centroid(mesh, mesh.tetrahedra[t])), static_cast<Index>(t)};
  const std::vector<Index> newTetrahedron = rank(keyed);
  mesh.vertices = std::move(vertices);
  std::vector<FormTetrahedron> tetrahedra(keyed.size());
  for (std::size_t t = 0; t < keyed.size(); ++t) {
    FormTetrahedron& target = tetrahedra[t];
    target = mesh.tetrahedra[static_cast<std::size_t>(keyed[t].second)];
    for (Index& v : target.vertices) v = newVertex[static_cast<std::size_t>(v)];
    for (Index& n : target.neighbors) {
      if (n != kNone) n = newTetrahedron[static_cast<std::size_t>(n)];
    }
  }
  mesh.tetrahedra = std::move(tetrahedra);
}

}  // namespace voroform::implicit
