// Sites, and tessellations of shapes by few lines, for tests of the Voronoi diagram and its clipping.
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "voroform/core/random.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/voronoi/clip.hpp"

namespace voroform::testing {

inline std::vector<Vec3> sitesInBox(std::size_t count, std::uint64_t seed, const Box3& box) {
  std::vector<Vec3> sites;
  for (std::uint64_t i = 0; i < count; ++i) sites.push_back(randomInBox(seed, RandomStream::test, i, box));
  return sites;
}

inline std::vector<Vec3> sitesInside(const implicit::ImplicitFunction& f, std::size_t count, std::uint64_t seed) {
  std::vector<Vec3> sites;
  const Box3 bounds = f.bounds();
  for (std::uint64_t i = 0; sites.size() < count; ++i) {
    const Vec3 p = randomInBox(seed, RandomStream::test, i, bounds);
    if (f.value(p) < 0) sites.push_back(p);
  }
  return sites;
}

// n × n × n points of the integer lattice around the origin, moved by up to `jitter` along each axis.
inline std::vector<Vec3> latticeSites(int n, double jitter, std::uint64_t seed) {
  std::vector<Vec3> sites;
  const Box3 cube(Vec3::Constant(-jitter), Vec3::Constant(jitter));
  const Vec3 shift = Vec3::Constant(0.5 * (n - 1));
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        sites.push_back(Vec3(i, j, k) - shift + randomInBox(seed, RandomStream::test, sites.size(), cube));
      }
    }
  }
  return sites;
}

// The form's bounds with room for its sites.
inline Box3 domainOf(const implicit::ImplicitFunction& f) {
  const Box3 bounds = f.bounds();
  const Vec3 margin = 0.1 * bounds.sizes();
  return {bounds.min() - margin, bounds.max() + margin};
}

// The sites after some rounds of Lloyd's method.
inline std::vector<Vec3> relaxed(std::vector<Vec3> sites, const implicit::ImplicitFunction& f, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    const voronoi::Diagram diagram = voronoi::buildDiagram(sites, domainOf(f), {});
    const auto clipped = voronoi::clip(diagram, f, {.cap = voronoi::CapKind::flat}, {});
    const auto moments = voronoi::siteMoments(diagram, clipped, {});
    for (std::size_t i = 0; i < sites.size(); ++i) {
      if (moments[i].mass > 0) sites[i] += moments[i].first / moments[i].mass;
    }
  }
  return sites;
}

struct Tessellation {
  voronoi::Diagram diagram;
  voronoi::ClippedDiagram clipped;
  mesh::PolyhedralComplex complex;
};

inline Tessellation tessellateSites(std::span<const Vec3> sites, const implicit::ImplicitFunction& f,
                                    const voronoi::ClipOptions& options, const RunContext& context = {}) {
  Tessellation result;
  result.diagram = voronoi::buildDiagram(sites, domainOf(f), context);
  result.clipped = voronoi::clip(result.diagram, f, options, context);
  result.complex = voronoi::toComplex(result.diagram, result.clipped, f, {}, options, context);
  return result;
}

// f without its inside oracle.
class WithoutOracle final : public implicit::ImplicitFunction {
 public:
  explicit WithoutOracle(implicit::ImplicitPtr form) : form_(std::move(form)) {}
  double value(const Vec3& p) const override { return form_->value(p); }
  Vec3 gradient(const Vec3& p) const override { return form_->gradient(p); }
  Box3 bounds() const override { return form_->bounds(); }

 private:
  implicit::ImplicitPtr form_;
};

inline bool sameBits(std::span<const Vec3> a, std::span<const Vec3> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

// Which of two complexes' arrays differ; empty if none does, to the last bit.
inline std::vector<std::string> differences(const mesh::PolyhedralComplex& a, const mesh::PolyhedralComplex& b) {
  std::vector<std::string> result;
  if (!sameBits(a.vertices, b.vertices)) result.emplace_back("vertices");
  if (a.faceOffsets != b.faceOffsets) result.emplace_back("faceOffsets");
  if (a.faceVertices != b.faceVertices) result.emplace_back("faceVertices");
  if (a.faceCells != b.faceCells) result.emplace_back("faceCells");
  if (a.faceTags != b.faceTags) result.emplace_back("faceTags");
  if (a.cellCount != b.cellCount) result.emplace_back("cellCount");
  if (!sameBits(a.cellSites, b.cellSites)) result.emplace_back("cellSites");
  return result;
}

}  // namespace voroform::testing
