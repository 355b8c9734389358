#include "voroform/pipeline/site_options.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "voroform/core/error.hpp"
#include "voroform/points/read.hpp"

namespace voroform::pipeline {

namespace {

template <class T>
struct Named {
  const char* name;
  T value;
};

constexpr Named<cvt::Optimizer> kOptimizers[] = {{"lbfgs", cvt::Optimizer::lbfgs},
                                                 {"lloyd", cvt::Optimizer::lloyd},
                                                 {"lloyd-newton", cvt::Optimizer::lloydNewton},
                                                 {"monte-carlo", cvt::Optimizer::monteCarlo}};

constexpr Named<cvt::Initialization> kInitializations[] = {
    {"random", cvt::Initialization::random},
    {"hammersley", cvt::Initialization::hammersley},
    {"lattice", cvt::Initialization::lattice},
    {"farthest-point", cvt::Initialization::farthestPoint},
    {"greedy-edge-collapse", cvt::Initialization::greedyEdgeCollapse},
    {"hierarchical-random", cvt::Initialization::hierarchicalRandom},
    {"hierarchical-lattice", cvt::Initialization::hierarchicalLattice}};

template <class T, std::size_t N>
std::vector<std::string> namesOf(const Named<T> (&table)[N]) {
  std::vector<std::string> names;
  for (const Named<T>& entry : table) names.emplace_back(entry.name);
  return names;
}

}  // namespace

std::vector<std::string> optimizerNames() { return namesOf(kOptimizers); }

const char* toString(cvt::Optimizer optimizer) {
  for (const auto& entry : kOptimizers) {
    if (entry.value == optimizer) return entry.name;
  }
  throw UsageError("unknown optimizer");
}

cvt::Optimizer optimizerNamed(const std::string& name) {
  for (const auto& entry : kOptimizers) {
    if (name == entry.name) return entry.value;
  }
  throw UsageError("unknown optimizer " + name);
}

std::vector<std::string> initializationNames() { return namesOf(kInitializations); }

const char* toString(cvt::Initialization initialization) {
  for (const auto& entry : kInitializations) {
    if (entry.value == initialization) return entry.name;
  }
  return "given";
}

std::optional<cvt::Initialization> initializationNamed(const std::string& name) {
  for (const auto& entry : kInitializations) {
    if (name == entry.name) return entry.value;
  }
  return std::nullopt;
}

std::vector<Vec3> readSites(const std::filesystem::path& path, const RunContext& context) {
  const std::vector<Vec3> sites = points::readPoints(path, context).cloud.positions;
  const auto fail = [&](const std::string& what) { throw InputError(path.string() + ": " + what); };
  if (sites.empty()) fail("holds no site");
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (!sites[i].allFinite()) fail("site " + std::to_string(i + 1) + " is not finite");
  }
  std::vector<std::size_t> order(sites.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto less = [&](std::size_t a, std::size_t b) {
    const auto result =
        std::lexicographical_compare(sites[a].begin(), sites[a].end(), sites[b].begin(), sites[b].end());
    return result || (sites[a] == sites[b] && a < b);
  };
  std::sort(order.begin(), order.end(), less);
  for (std::size_t k = 1; k < order.size(); ++k) {
    if (sites[order[k - 1]] == sites[order[k]]) {
      fail("sites " + std::to_string(order[k - 1] + 1) + " and " + std::to_string(order[k] + 1) + " coincide");
    }
  }
  return sites;
}

}  // namespace voroform::pipeline
