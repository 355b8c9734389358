#include "tetrahedra.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::baselines {

namespace {

struct Header {
  std::uint64_t vertices;
  std::uint64_t tetrahedra;
  double secondsRefinement;
  double secondsOptimization;
};

static_assert(sizeof(Vec3) == 3 * sizeof(double));

// The corners of the face opposite to corner k, counter-clockwise seen from outside a positive tetrahedron.
constexpr std::array<std::array<std::size_t, 3>, 4> kOpposite = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

// Copies the values to the front of `space`, and takes that part off.
template <class T>
void put(std::span<std::byte>& space, std::span<const T> values) {
  if (!values.empty()) std::memcpy(space.data(), values.data(), values.size_bytes());
  space = space.subspan(values.size_bytes());
}

template <class T>
std::vector<T> take(std::span<const std::byte>& bytes, std::uint64_t count) {
  if (count > bytes.size() / sizeof(T)) throw Error("a list of tetrahedra is cut off");
  std::vector<T> values(static_cast<std::size_t>(count));
  if (count > 0) std::memcpy(static_cast<void*>(values.data()), bytes.data(), values.size() * sizeof(T));
  bytes = bytes.subspan(values.size() * sizeof(T));
  return values;
}

void check(const Tetrahedra& t) {
  const auto vertexCount = static_cast<Index>(t.vertices.size());
  const auto count = static_cast<Index>(t.corners.size());
  for (const Vec3& vertex : t.vertices) {
    if (!vertex.allFinite()) throw Error("a vertex of the tetrahedra is not finite");
  }
  for (Index i = 0; i < count; ++i) {
    for (const Index corner : t.corners[static_cast<std::size_t>(i)]) {
      if (corner < 0 || corner >= vertexCount) throw Error("a tetrahedron names a vertex that does not exist");
    }
    for (const Index neighbor : t.neighbors[static_cast<std::size_t>(i)]) {
      if (neighbor == kNone) continue;
      if (neighbor < 0 || neighbor >= count || neighbor == i) throw Error("a tetrahedron's neighbor does not exist");
      const auto& back = t.neighbors[static_cast<std::size_t>(neighbor)];
      if (std::find(back.begin(), back.end(), i) == back.end()) throw Error("neighboring tetrahedra disagree");
    }
  }
}

}  // namespace

std::vector<std::byte> pack(const Tetrahedra& tetrahedra) {
  const Header header = {.vertices = tetrahedra.vertices.size(),
                         .tetrahedra = tetrahedra.corners.size(),
                         .secondsRefinement = tetrahedra.secondsRefinement,
                         .secondsOptimization = tetrahedra.secondsOptimization};
  std::vector<std::byte> bytes(sizeof header + tetrahedra.vertices.size() * sizeof(Vec3) +
                               tetrahedra.corners.size() * 2 * sizeof(std::array<Index, 4>));
  std::span<std::byte> space = bytes;
  put<Header>(space, {&header, 1});
  put<Vec3>(space, tetrahedra.vertices);
  put<std::array<Index, 4>>(space, tetrahedra.corners);
  put<std::array<Index, 4>>(space, tetrahedra.neighbors);
  return bytes;
}

Tetrahedra unpack(std::span<const std::byte> bytes) {
  const Header header = take<Header>(bytes, 1).front();
  Tetrahedra tetrahedra;
  tetrahedra.vertices = take<Vec3>(bytes, header.vertices);
  tetrahedra.corners = take<std::array<Index, 4>>(bytes, header.tetrahedra);
  tetrahedra.neighbors = take<std::array<Index, 4>>(bytes, header.tetrahedra);
  if (!bytes.empty()) throw Error("a list of tetrahedra is too long");
  tetrahedra.secondsRefinement = header.secondsRefinement;
  tetrahedra.secondsOptimization = header.secondsOptimization;
  check(tetrahedra);
  return tetrahedra;
}

mesh::PolyhedralComplex toComplex(const Tetrahedra& tetrahedra, const implicit::ImplicitFunction& f, const Frame& frame,
                                  const RunContext& context) {
  mesh::PolyhedralComplex complex;
  complex.vertices = tetrahedra.vertices;
  complex.frame = frame;
  complex.cellCount = static_cast<Index>(tetrahedra.corners.size());
  for (Index cell = 0; cell < complex.cellCount; ++cell) {
    const auto& corners = tetrahedra.corners[static_cast<std::size_t>(cell)];
    const auto& neighbors = tetrahedra.neighbors[static_cast<std::size_t>(cell)];
    for (std::size_t k = 0; k < 4; ++k) {
      const Index neighbor = neighbors[k];
      if (neighbor != kNone && neighbor < cell) continue;  // the neighbor has added it
      const auto& [a, b, c] = kOpposite[k];
      complex.addFace(std::array{corners[a], corners[b], corners[c]}, cell, neighbor);
    }
  }
  parallelFor(context, complex.faceTags.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t face = begin; face < end; ++face) {
      if (!complex.isBoundary(static_cast<Index>(face))) continue;
      Vec3 centroid = Vec3::Zero();
      for (const Index vertex : complex.face(static_cast<Index>(face))) {
        centroid += complex.vertices[static_cast<std::size_t>(vertex)] / 3;
      }
      if (f.onEnvelope(centroid)) complex.faceTags[face] = mesh::FaceTag::envelope;
    }
  });
  return complex;
}

}  // namespace voroform::baselines
