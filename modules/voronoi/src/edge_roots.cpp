#include "edge_roots.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "voroform/core/parallel.hpp"

namespace voroform::voronoi {

namespace {

constexpr std::size_t kGrain = 2048;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Probes along an edge are at most this far apart, in units of the distance of the edge's nearest two sites, so that a
// sheet of half the cell size cannot slip through.
constexpr double kProbeSpacing = 0.3;
constexpr int kMostProbes = 32;
// A probe's neighborhood is looked at closer when a parabola predicts that |f| falls below this share of the probe's.
constexpr double kNearMiss = 0.25;
// Roots keep this share of the edge's length off its ends, so that no point of the clipped diagram coincides with
// another.
constexpr double kRootMargin = 1e-6;

struct Edge {
  Index vertex;
  int slot;
};

// Clearances and, where needed, values of f at the diagram's vertices.
struct VertexSigns {
  std::vector<float> clearance;  // rounded towards 0
  std::vector<double> value;     // kUnknown where the oracle decided and no edge asked
  std::vector<std::uint8_t> inside;
};

float towardsZero(double clearance) {
  const auto rounded = static_cast<float>(clearance);
  if (rounded == 0.0F || std::abs(static_cast<double>(rounded)) <= std::abs(clearance)) return rounded;
  return std::nextafter(rounded, 0.0F);
}

// Evaluates f at the listed vertices.
void evaluateAt(const std::vector<Index>& list, const Diagram& diagram, const implicit::ImplicitFunction& f,
                std::vector<double>& value, const RunContext& context) {
  parallelFor(context, list.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> points;
    points.reserve(end - begin);
    for (std::size_t k = begin; k < end; ++k) points.push_back(diagram.vertices[static_cast<std::size_t>(list[k])]);
    std::vector<double> results(points.size());
    f.values(points, results);
    for (std::size_t k = begin; k < end; ++k) value[static_cast<std::size_t>(list[k])] = results[k - begin];
  });
}

// The indices of [0, count) that `wanted` accepts, ascending.
template <class Wanted>
std::vector<Index> collect(std::size_t count, const Wanted& wanted, const RunContext& context) {
  std::vector<std::vector<Index>> chunks((count + kGrain - 1) / kGrain);
  parallelFor(context, count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (wanted(i)) chunks[begin / kGrain].push_back(static_cast<Index>(i));
    }
  });
  std::vector<Index> result;
  for (const auto& chunk : chunks) result.insert(result.end(), chunk.begin(), chunk.end());
  return result;
}

VertexSigns vertexSigns(const Diagram& diagram, const implicit::ImplicitFunction& f, EdgeRoots& result,
                        const RunContext& context) {
  const std::size_t count = diagram.vertices.size();
  VertexSigns signs;
  signs.clearance.resize(count);
  signs.value.assign(count, kUnknown);
  signs.inside.resize(count);
  parallelFor(context, count, kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<double> clearances(end - begin);
    f.clearances(std::span(diagram.vertices).subspan(begin, end - begin), clearances);
    for (std::size_t v = begin; v < end; ++v) signs.clearance[v] = towardsZero(clearances[v - begin]);
  });
  const std::vector<Index> undecided = collect(
      count, [&](std::size_t v) { return signs.clearance[v] == 0.0F; }, context);
  evaluateAt(undecided, diagram, f, signs.value, context);
  for (std::size_t v = 0; v < count; ++v) {
    signs.inside[v] = signs.clearance[v] < 0.0F || signs.value[v] < 0.0 ? 1 : 0;
  }
  result.evaluations += static_cast<std::int64_t>(undecided.size());
  result.oracleShare = count == 0 ? 0.0 : 1.0 - static_cast<double>(undecided.size()) / static_cast<double>(count);
  return signs;
}

// Edges that S may cross: the ends differ in sign, or their clearances do not cover the edge. Each once, from its lower
// vertex.
std::vector<Edge> candidateEdges(const Diagram& diagram, const VertexSigns& signs, const RunContext& context) {
  const std::size_t count = diagram.vertices.size();
  std::vector<std::vector<Edge>> chunks((count + kGrain - 1) / kGrain);
  parallelFor(context, count, kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Edge>& chunk = chunks[begin / kGrain];
    for (std::size_t v = begin; v < end; ++v) {
      const double own = std::abs(static_cast<double>(signs.clearance[v]));
      for (int slot = 0; slot < 4; ++slot) {
        const Index neighbor = diagram.vertexNeighbors[v][static_cast<std::size_t>(slot)];
        if (neighbor < static_cast<Index>(v)) continue;  // kNone included
        const auto w = static_cast<std::size_t>(neighbor);
        if (signs.inside[v] == signs.inside[w]) {
          const double covered = own + std::abs(static_cast<double>(signs.clearance[w]));
          if (covered * covered >= (diagram.vertices[w] - diagram.vertices[v]).squaredNorm()) continue;
        }
        chunk.push_back({static_cast<Index>(v), slot});
      }
    }
  });
  std::vector<Edge> edges;
  for (const auto& chunk : chunks) edges.insert(edges.end(), chunk.begin(), chunk.end());
  return edges;
}

std::array<Index, 3> edgeSites(const Diagram& diagram, const Edge& edge) {
  std::array<Index, 3> sites{};
  std::size_t k = 0;
  for (int slot = 0; slot < 4; ++slot) {
    if (slot != edge.slot) {
      sites[k++] = diagram.vertexSites[static_cast<std::size_t>(edge.vertex)][static_cast<std::size_t>(slot)];
    }
  }
  std::sort(sites.begin(), sites.end());
  return sites;
}

// f along one edge: finds its roots in their order.
class EdgeProbe {
 public:
  EdgeProbe(const Vec3& a, const Vec3& b, const implicit::ImplicitFunction& f, const ClipOptions& options)
      : a_(a), b_(b), length_((b - a).norm()), f_(f), options_(options) {}

  void setEnds(bool insideA, double valueA, double clearanceA, bool insideB, double valueB, double clearanceB) {
    first_ = {0, valueA, insideA};
    last_ = {1, valueB, insideB};
    clearBegin_ = length_ > 0 ? std::min(1.0, std::abs(clearanceA) / length_) : 1.0;
    clearEnd_ = length_ > 0 ? std::max(0.0, 1.0 - std::abs(clearanceB) / length_) : 0.0;
  }

  // Appends the parameters of the roots; an even number if the ends agree in sign, else an odd one.
  void roots(double siteDistance, std::vector<double>& result) {
    samples_.clear();
    samples_.push_back(first_);
    if (clearEnd_ > clearBegin_) probe(siteDistance);
    samples_.push_back(last_);
    if (samples_.size() > 2) addNearMisses();
    const std::size_t begin = result.size();
    for (std::size_t k = 0; k + 1 < samples_.size(); ++k) {
      if (samples_[k].inside != samples_[k + 1].inside) appendRoot(samples_[k], samples_[k + 1], begin, result);
    }
  }

  std::int64_t evaluations = 0;

 private:
  struct Sample {
    double t;
    double value;  // kUnknown where the oracle decided
    bool inside;
  };

  Vec3 at(double t) const { return a_ + t * (b_ - a_); }

  double evaluate(double t) {
    ++evaluations;
    return f_.value(at(t));
  }

  void probe(double siteDistance) {
    const double spacing = kProbeSpacing * siteDistance;
    const double open = (clearEnd_ - clearBegin_) * length_;
    // Where the ends differ one root is known to be there: a single crossing of a short edge needs no probe.
    const double wanted = first_.inside == last_.inside ? std::ceil(open / spacing) : std::floor(0.5 * open / spacing);
    const int count = static_cast<int>(std::min<double>(wanted, kMostProbes));
    for (int k = 0; k < count; ++k) {
      const double t = clearBegin_ + (k + 0.5) * (clearEnd_ - clearBegin_) / count;
      const double clearance = f_.clearance(at(t));
      const double value = clearance == 0 ? evaluate(t) : kUnknown;
      samples_.push_back({t, value, clearance < 0 || value < 0});
    }
  }

  // Three values of one sign with the least |f| in the middle may hide a pair of roots: look where a parabola through
  // them has its vertex.
  void addNearMisses() {
    for (std::size_t k = 1; k + 1 < samples_.size(); ++k) {
      const Sample& p = samples_[k - 1];
      const Sample& q = samples_[k];
      const Sample& r = samples_[k + 1];
      if (p.inside != q.inside || q.inside != r.inside) continue;
      if (!(std::abs(q.value) < std::abs(p.value)) || !(std::abs(q.value) < std::abs(r.value))) continue;
      const double left = (q.value - p.value) / (q.t - p.t);
      const double right = (r.value - q.value) / (r.t - q.t);
      const double curvature = (right - left) / (r.t - p.t);
      const double slope = left + curvature * (q.t - p.t);  // of the parabola, at q
      if (curvature == 0) continue;
      const double vertex = q.t - 0.5 * slope / curvature;
      const double predicted = q.value - 0.25 * slope * slope / curvature;
      const bool crosses = (predicted < 0) != q.inside || std::abs(predicted) < kNearMiss * std::abs(q.value);
      if (!crosses || !(vertex > p.t && vertex < r.t) || vertex == q.t) continue;
      const double value = evaluate(vertex);
      if ((value < 0) == q.inside) continue;
      samples_.insert(samples_.begin() + static_cast<std::ptrdiff_t>(vertex < q.t ? k : k + 1),
                      {vertex, value, value < 0});
      k += 2;
    }
  }

  void appendRoot(Sample& left, Sample& right, std::size_t begin, std::vector<double>& result) {
    for (Sample* sample : {&left, &right}) {
      if (std::isnan(sample->value)) sample->value = evaluate(sample->t);
    }
    const double width = right.t - left.t;
    const double s = implicit::findRoot(f_, at(left.t), at(right.t), left.value, right.value,
                                        options_.rootTolerance / width, options_.rootFinder, evaluations);
    const double t = std::clamp(left.t + s * width, kRootMargin, 1 - kRootMargin);
    // Two roots at one place enclose nothing.
    if (result.size() > begin && !(t > result.back())) {
      result.pop_back();
    } else {
      result.push_back(t);
    }
  }

  Vec3 a_;
  Vec3 b_;
  double length_;
  const implicit::ImplicitFunction& f_;
  const ClipOptions& options_;
  Sample first_{};
  Sample last_{};
  double clearBegin_ = 0;
  double clearEnd_ = 1;
  std::vector<Sample> samples_;
};

// Roots found by one chunk of edges.
struct RootChunk {
  std::vector<Edge> edges;
  std::vector<std::uint32_t> counts;
  std::vector<Vec3> positions;
  std::vector<std::array<Index, 3>> sites;
  std::vector<std::array<Index, 2>> ends;
  std::int64_t evaluations = 0;
};

double nearestSites(const Diagram& diagram, const std::array<Index, 3>& sites) {
  const auto distance = [&](std::size_t i, std::size_t j) {
    return (diagram.sites[static_cast<std::size_t>(sites[i])] - diagram.sites[static_cast<std::size_t>(sites[j])])
        .norm();
  };
  return std::min({distance(0, 1), distance(1, 2), distance(0, 2)});
}

RootChunk chunkRoots(std::span<const Edge> edges, const Diagram& diagram, const VertexSigns& signs,
                     const implicit::ImplicitFunction& f, const ClipOptions& options) {
  RootChunk chunk;
  std::vector<double> roots;
  for (const Edge& edge : edges) {
    const auto v = static_cast<std::size_t>(edge.vertex);
    const auto w = static_cast<std::size_t>(diagram.vertexNeighbors[v][static_cast<std::size_t>(edge.slot)]);
    const std::array<Index, 3> sites = edgeSites(diagram, edge);
    EdgeProbe probe(diagram.vertices[v], diagram.vertices[w], f, options);
    probe.setEnds(signs.inside[v] != 0, signs.value[v], static_cast<double>(signs.clearance[v]), signs.inside[w] != 0,
                  signs.value[w], static_cast<double>(signs.clearance[w]));
    roots.clear();
    probe.roots(nearestSites(diagram, sites), roots);
    chunk.evaluations += probe.evaluations;
    if (roots.empty()) continue;
    chunk.edges.push_back(edge);
    chunk.counts.push_back(static_cast<std::uint32_t>(roots.size()));
    for (const double t : roots) {
      chunk.positions.push_back(diagram.vertices[v] + t * (diagram.vertices[w] - diagram.vertices[v]));
      chunk.sites.push_back(sites);
      chunk.ends.push_back({static_cast<Index>(v), static_cast<Index>(w)});
    }
  }
  return chunk;
}

}  // namespace

EdgeRoots findEdgeRoots(const Diagram& diagram, const implicit::ImplicitFunction& f, const ClipOptions& options,
                        const RunContext& context) {
  EdgeRoots result;
  VertexSigns signs = vertexSigns(diagram, f, result, context);
  const std::vector<Edge> edges = candidateEdges(diagram, signs, context);

  // The values at the ends of candidate edges: many edges share an end, so they are computed at once.
  std::vector<std::uint8_t> wanted(diagram.vertices.size(), 0);
  for (const Edge& edge : edges) {
    const auto v = static_cast<std::size_t>(edge.vertex);
    const auto w = static_cast<std::size_t>(diagram.vertexNeighbors[v][static_cast<std::size_t>(edge.slot)]);
    if (signs.inside[v] != signs.inside[w]) wanted[v] = wanted[w] = 1;
  }
  const std::vector<Index> ends = collect(
      wanted.size(), [&](std::size_t v) { return wanted[v] != 0 && std::isnan(signs.value[v]); }, context);
  evaluateAt(ends, diagram, f, signs.value, context);
  result.evaluations += static_cast<std::int64_t>(ends.size());

  constexpr std::size_t kEdgeGrain = 256;
  std::vector<RootChunk> chunks((edges.size() + kEdgeGrain - 1) / kEdgeGrain);
  parallelFor(context, edges.size(), kEdgeGrain, [&](std::size_t begin, std::size_t end) {
    chunks[begin / kEdgeGrain] = chunkRoots(std::span(edges).subspan(begin, end - begin), diagram, signs, f, options);
  });

  result.touched.assign(diagram.vertices.size(), 0);
  result.crossedEdge.assign(4 * diagram.vertices.size(), kNone);
  for (const RootChunk& chunk : chunks) {
    result.evaluations += chunk.evaluations;
    for (std::size_t e = 0; e < chunk.edges.size(); ++e) {
      const Edge& edge = chunk.edges[e];
      const auto v = static_cast<std::size_t>(edge.vertex);
      const Index neighbor = diagram.vertexNeighbors[v][static_cast<std::size_t>(edge.slot)];
      const auto w = static_cast<std::size_t>(neighbor);
      const auto number = static_cast<Index>(result.rootOffsets.size());
      result.crossedEdge[4 * v + static_cast<std::size_t>(edge.slot)] = number;
      result.crossedEdge[4 * w + static_cast<std::size_t>(diagram.slotOf(neighbor, edge.vertex))] = number;
      result.touched[v] = result.touched[w] = 1;
      result.rootOffsets.push_back(chunk.counts[e]);
      if (chunk.counts[e] > 1) ++result.doubleRootEdges;
    }
    result.positions.insert(result.positions.end(), chunk.positions.begin(), chunk.positions.end());
    result.sites.insert(result.sites.end(), chunk.sites.begin(), chunk.sites.end());
    result.ends.insert(result.ends.end(), chunk.ends.begin(), chunk.ends.end());
  }
  exclusiveScan(result.rootOffsets);
  result.inside = std::move(signs.inside);
  return result;
}

}  // namespace voroform::voronoi
