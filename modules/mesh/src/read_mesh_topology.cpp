// The examination of a mesh that is to bound a solid.
#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "disjoint_sets.hpp"
#include "read_mesh.hpp"
#include "voroform/mesh/surface_locator.hpp"

namespace voroform::mesh {
namespace {

// Extents beyond this range would overflow or underflow when squared and cubed.
constexpr double kLargestExtent = 1e100;
constexpr double kSmallestExtent = 1e-100;
// A component whose volume is a smaller share of area times extent is a double sheet.
constexpr double kNoVolume = 1e-13;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

// A directed edge: corner `corner` of triangle `triangle` to its next corner.
struct HalfEdge {
  Index low;
  Index high;
  Index triangle;
  std::int8_t corner;
  bool rising;  // from `low` to `high`
};

class Examination {
 public:
  Examination(RawMesh& raw, const std::string& name, const RunContext& context)
      : raw_(raw), mesh_(raw.mesh), name_(name), context_(context) {}

  void run() {
    requireTriangles();
    findHalfEdges();
    requireClosed();
    requireManifoldVertices();
    context_.throwIfCancelled();
    orientComponents();
    context_.throwIfCancelled();
    turnOutward();
    dropUnusedVertices();
    warn();
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw NotSolid(name_ + ": " + message, raw_.summary); }

  std::string place(Index vertex) const {
    const Vec3& p = mesh_.vertices[at(vertex)];
    std::ostringstream text;
    text.precision(10);
    if (raw_.firstNumber != kNone) text << "vertex " << vertex + raw_.firstNumber << ' ';
    text << '(' << p.x() << ", " << p.y() << ", " << p.z() << ')';
    return text.str();
  }
  std::string face(Index triangle) const { return "face " + std::to_string(raw_.faces[at(triangle)] + 1); }
  std::string edge(const HalfEdge& half) const {
    return "the edge from " + place(half.rising ? half.low : half.high) + " to " +
           place(half.rising ? half.high : half.low);
  }
  static std::string total(std::int64_t count, const std::string& things) {
    return count > 1 ? " (the first of " + std::to_string(count) + " such " + things + ")" : std::string();
  }

  void requireTriangles() const {
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v) {
      if (mesh_.vertices[v].allFinite()) continue;
      fail(place(static_cast<Index>(v)) + ": expected finite coordinates");
    }
    if (mesh_.triangles.empty()) fail("the file holds no faces");
    Box3 box;
    for (const auto& triangle : mesh_.triangles) {
      for (const Index v : triangle) box.extend(mesh_.vertices[at(v)]);
    }
    const double extent = box.sizes().maxCoeff();
    const double farthest = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
    if (extent >= kSmallestExtent && farthest <= kLargestExtent) return;
    std::ostringstream text;
    text << "expected an extent of at least 1e-100 and coordinates up to 1e100, found an extent of " << extent
         << " and coordinates up to " << farthest;
    fail(text.str());
  }

  void findHalfEdges() {
    halves_.reserve(3 * mesh_.triangles.size());
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Index a = mesh_.triangles[t][i];
        const Index b = mesh_.triangles[t][(i + 1) % 3];
        halves_.push_back({std::min(a, b), std::max(a, b), static_cast<Index>(t), static_cast<std::int8_t>(i), a < b});
      }
    }
    std::sort(halves_.begin(), halves_.end(), [](const HalfEdge& a, const HalfEdge& b) {
      if (a.low != b.low) return a.low < b.low;
      if (a.high != b.high) return a.high < b.high;
      return a.triangle < b.triangle;
    });
  }

  // Two triangles an edge. Names the first fault in the order of the faces.
  void requireClosed() const {
    std::optional<HalfEdge> open;
    std::optional<HalfEdge> crowded;
    std::int64_t openCount = 0;
    std::int64_t crowdedCount = 0;
    std::size_t crowd = 0;
    for (std::size_t i = 0; i < halves_.size();) {
      const HalfEdge& first = halves_[i];
      const std::size_t begin = i;
      while (i < halves_.size() && halves_[i].low == first.low && halves_[i].high == first.high) ++i;
      if (i - begin == 1) {
        ++openCount;
        if (!open || first.triangle < open->triangle) open = first;
      } else if (i - begin > 2) {
        ++crowdedCount;
        if (!crowded || first.triangle < crowded->triangle) {
          crowded = first;
          crowd = i - begin;
        }
      }
    }
    if (crowded) {
      fail("the mesh is not 2-manifold: " + edge(*crowded) + " belongs to " + std::to_string(crowd) + " faces, " +
           face(crowded->triangle) + " among them" + total(crowdedCount, "edges"));
    }
    if (open) {
      fail("the mesh is not closed: " + edge(*open) + " belongs to " + face(open->triangle) + " only" +
           total(openCount, "edges"));
    }
  }

  // One fan of triangles a vertex: the corners at a vertex are joined across the edges.
  void requireManifoldVertices() const {
    DisjointSets corners(3 * mesh_.triangles.size());
    std::vector<Index> fans(mesh_.vertices.size(), 0);
    for (const auto& triangle : mesh_.triangles) {
      for (const Index v : triangle) ++fans[at(v)];
    }
    const auto cornerAt = [this](const HalfEdge& half, Index vertex) {
      const bool atStart = half.rising == (vertex == half.low);
      return 3 * half.triangle + (atStart ? half.corner : (half.corner + 1) % 3);
    };
    for (std::size_t i = 0; i < halves_.size(); i += 2) {
      for (const Index v : {halves_[i].low, halves_[i].high}) {
        if (corners.join(cornerAt(halves_[i], v), cornerAt(halves_[i + 1], v))) --fans[at(v)];
      }
    }
    const auto isFault = [](Index count) { return count > 1; };
    const auto first = std::find_if(fans.begin(), fans.end(), isFault);
    if (first == fans.end()) return;
    const auto vertex = static_cast<Index>(first - fans.begin());
    fail("the mesh is not 2-manifold: " + std::to_string(*first) + " fans of faces meet in " + place(vertex) +
         total(std::count_if(fans.begin(), fans.end(), isFault), "vertices"));
  }

  // Turns the triangles of each component to agree with its first one.
  void orientComponents() {
    const std::size_t count = mesh_.triangles.size();
    struct Link {
      Index triangle = kNone;
      bool same = false;  // both run along the edge in one direction
      std::size_t half = 0;
    };
    std::vector<std::array<Link, 3>> links(count);
    for (std::size_t i = 0; i < halves_.size(); i += 2) {
      const HalfEdge& a = halves_[i];
      const HalfEdge& b = halves_[i + 1];
      links[at(a.triangle)][at(a.corner)] = {b.triangle, a.rising == b.rising, i};
      links[at(b.triangle)][at(b.corner)] = {a.triangle, a.rising == b.rising, i};
    }
    component_.assign(count, kNone);
    turned_.assign(count, 0);
    std::vector<Index> front;
    for (std::size_t seed = 0; seed < count; ++seed) {
      if (component_[seed] != kNone) continue;
      component_[seed] = components_;
      front.push_back(static_cast<Index>(seed));
      while (!front.empty()) {
        const Index t = front.back();
        front.pop_back();
        for (const Link& link : links[at(t)]) {
          const auto turn = static_cast<std::uint8_t>(turned_[at(t)] ^ static_cast<std::uint8_t>(link.same));
          if (component_[at(link.triangle)] == kNone) {
            component_[at(link.triangle)] = components_;
            turned_[at(link.triangle)] = turn;
            front.push_back(link.triangle);
          } else if (turned_[at(link.triangle)] != turn) {
            const HalfEdge& half = halves_[link.half];
            fail("the mesh is not orientable: its faces cannot be turned to agree along " + edge(half) + " of " +
                 face(half.triangle));
          }
        }
      }
      ++components_;
    }
  }

  std::array<Index, 3> triangle(std::size_t t) const {
    std::array<Index, 3> corners = mesh_.triangles[t];
    if (turned_[t] != 0) std::swap(corners[1], corners[2]);
    return corners;
  }

  // Outward, but inward where a component lies within an odd number of others.
  void turnOutward() {
    const auto count = at(components_);
    std::vector<Box3> boxes(count);
    std::vector<double> volumes(count, 0);
    std::vector<double> areas(count, 0);
    std::vector<Index> firsts(count, kNone);
    std::vector<std::int64_t> sizes(count, 0);
    std::vector<std::int64_t> turns(count, 0);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const std::size_t c = at(component_[t]);
      for (const Index v : mesh_.triangles[t]) boxes[c].extend(mesh_.vertices[at(v)]);
      if (firsts[c] == kNone) firsts[c] = static_cast<Index>(t);
    }
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const std::size_t c = at(component_[t]);
      const std::array<Index, 3> corners = triangle(t);
      const Vec3 center = boxes[c].center();
      const Vec3 p = mesh_.vertices[at(corners[0])] - center;
      const Vec3 q = mesh_.vertices[at(corners[1])] - center;
      const Vec3 r = mesh_.vertices[at(corners[2])] - center;
      volumes[c] += p.dot(q.cross(r)) / 6;
      areas[c] += (q - p).cross(r - p).norm() / 2;
      ++sizes[c];
      turns[c] += turned_[t];
    }
    const std::vector<bool> isVoid = findVoids(boxes);
    bool allInsideOut = true;
    std::vector<std::uint8_t> turnComponent(count, 0);
    for (std::size_t c = 0; c < count; ++c) {
      if (!(std::abs(volumes[c]) > kNoVolume * areas[c] * boxes[c].diagonal().norm())) {
        fail("the part of the mesh with " + face(firsts[c]) + " encloses no volume; it begins at " +
             place(mesh_.triangles[at(firsts[c])][0]));
      }
      turnComponent[c] = static_cast<std::uint8_t>((volumes[c] < 0) != isVoid[c]);
      allInsideOut = allInsideOut && turnComponent[c] != 0 && turns[c] == 0;
    }
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      turned_[t] ^= turnComponent[at(component_[t])];
      mesh_.triangles[t] = triangle(t);
      raw_.summary.turnedFaces += turned_[t];
    }
    raw_.summary.components = components_;
    raw_.summary.turned = allInsideOut;
  }

  // For each component whether it lies within an odd number of others.
  std::vector<bool> findVoids(const std::vector<Box3>& boxes) const {
    std::vector<bool> isVoid(boxes.size(), false);
    std::vector<std::vector<Index>> members(boxes.size());
    if (boxes.size() > 1) {
      for (std::size_t t = 0; t < component_.size(); ++t) {
        members[at(component_[t])].push_back(static_cast<Index>(t));
      }
    }
    for (std::size_t outer = 0; outer < boxes.size() && boxes.size() > 1; ++outer) {
      std::optional<ComponentLocator> locator;
      for (std::size_t inner = 0; inner < boxes.size(); ++inner) {
        if (inner == outer || !boxes[outer].contains(boxes[inner])) continue;
        context_.throwIfCancelled();
        if (!locator) locator.emplace(mesh_, members[outer], boxes[outer]);
        if (locator->contains(members[inner])) isVoid[inner] = !isVoid[inner];
      }
    }
    return isVoid;
  }

  class ComponentLocator {
   public:
    ComponentLocator(const TriangleMesh& mesh, const std::vector<Index>& members, const Box3& box) : mesh_(mesh) {
      part_.vertices = mesh.vertices;
      for (const Index t : members) part_.triangles.push_back(mesh.triangles[at(t)]);
      for (int axis = 0; axis < 3; ++axis) {
        locators_[at(axis)].emplace(part_, axis, locationTolerance(box));
      }
    }
    ComponentLocator(const ComponentLocator&) = delete;
    ComponentLocator& operator=(const ComponentLocator&) = delete;

    // Decided by the first vertex of the other component that a ray decides.
    bool contains(const std::vector<Index>& triangles) const {
      for (const Index t : triangles) {
        for (const auto& locator : locators_) {
          const Location location = locator->locate(mesh_.vertices[at(mesh_.triangles[at(t)][0])]);
          if (location != Location::uncertain) return location == Location::inside;
        }
      }
      return false;
    }

   private:
    const TriangleMesh& mesh_;
    TriangleMesh part_;
    std::array<std::optional<SurfaceLocator>, 3> locators_;
  };

  void dropUnusedVertices() {
    std::vector<Index> numbers(mesh_.vertices.size(), kNone);
    for (const auto& corners : mesh_.triangles) {
      for (const Index v : corners) numbers[at(v)] = 0;
    }
    Index kept = 0;
    for (std::size_t v = 0; v < numbers.size(); ++v) {
      if (numbers[v] == kNone) continue;
      mesh_.vertices[at(kept)] = mesh_.vertices[v];
      numbers[v] = kept++;
    }
    raw_.summary.unusedVertices = mesh_.vertices.size() - at(kept);
    mesh_.vertices.resize(at(kept));
    for (auto& corners : mesh_.triangles) {
      for (Index& v : corners) v = numbers[at(v)];
    }
  }

  void warn() const {
    const MeshReadSummary& summary = raw_.summary;
    const auto say = [this](std::uint64_t count, const std::string& what) {
      if (count > 0) context_.warn(name_ + ": " + std::to_string(count) + " " + what);
    };
    say(summary.degenerate, "triangles that name a vertex twice were left out");
    say(summary.unusedVertices, "vertices of no face were left out");
    if (summary.turned) {
      context_.warn(name_ + ": the mesh was inside out and was turned");
    } else {
      say(summary.turnedFaces, "triangles were turned to make the mesh consistent and outward");
    }
  }

  RawMesh& raw_;
  TriangleMesh& mesh_;
  const std::string& name_;
  const RunContext& context_;
  std::vector<HalfEdge> halves_;
  std::vector<Index> component_;
  std::vector<std::uint8_t> turned_;
  Index components_ = 0;
};

}  // namespace

void makeSolid(RawMesh& raw, const std::string& name, const RunContext& context) {
  Examination(raw, name, context).run();
}

}  // namespace voroform::mesh
