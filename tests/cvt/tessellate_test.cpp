#include "voroform/cvt/tessellate.hpp"
#include "voroform/cvt/implicit_domain.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include "support/voronoi_sites.hpp"
#include "voroform/core/error.hpp"
#include "voroform/cvt/energy.hpp"
#include "voroform/cvt/initial_sites.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/mesh/validate.hpp"
#include "voroform/metrics/regularity.hpp"

namespace voroform::cvt {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(Tessellate, LloydNeverRaisesTheEnergy) {
  // On a convex solid each cell's inscribed part depends on the sites through planes alone; the caps' small term does
  // not overcome the descent.
  for (const auto& form : {implicit::box(Vec3(2, 2, 2)), implicit::sphere(1)}) {
    TessellateOptions options;
    options.sites = 1500;
    options.iterations = 25;
    options.optimizer = Optimizer::lloyd;
    options.convergence = 0;
    const TessellateSummary summary = tessellate(*form, {}, options, {}).summary;
    EXPECT_EQ(summary.stop, StopReason::iterations);
    ASSERT_THAT(summary.iterations, SizeIs(26));
    EXPECT_EQ(summary.evaluations, 26);
    for (std::size_t k = 1; k < summary.iterations.size(); ++k) {
      EXPECT_LT(summary.iterations[k].energy, summary.iterations[k - 1].energy) << "iteration " << k;
      EXPECT_EQ(summary.iterations[k].evaluations, static_cast<int>(k) + 1);
    }
  }
}

TEST(Tessellate, LbfgsNeverRaisesTheEnergyAndBeatsLloyd) {
  for (const std::string name : {"sphere", "torus", "box", "gyroid-ball"}) {
    const auto form = implicit::namedShape(name);
    TessellateOptions options;
    options.sites = 2000;
    options.seed = 3;
    options.reseedRounds = 0;  // a restart may
    const TessellateSummary summary = tessellate(*form, {}, options, {}).summary;
    EXPECT_EQ(summary.stop, StopReason::iterations) << name;
    ASSERT_THAT(summary.iterations, SizeIs(11)) << name;
    for (std::size_t k = 1; k < summary.iterations.size(); ++k) {
      EXPECT_LE(summary.iterations[k].energy, summary.iterations[k - 1].energy) << name << ", iteration " << k;
    }
    EXPECT_LE(summary.evaluations, 14) << name;
    EXPECT_EQ(summary.energy, summary.iterations.back().energy);
    EXPECT_GT(summary.energy, summary.optimalEnergy);
    EXPECT_NEAR(summary.relativeError, summary.energy / summary.optimalEnergy - 1, 1e-14);
    options.optimizer = Optimizer::lloyd;
    EXPECT_GT(tessellate(*form, {}, options, {}).summary.energy, summary.energy) << name;
  }
}

TEST(Tessellate, ConvergedSitesAreCentroids) {
  const auto form = implicit::sphere(1);
  TessellateOptions options;
  options.sites = 400;
  options.iterations = 2000;
  options.optimizer = Optimizer::lloyd;  // its fixed points are centroids, whatever the energy's cap term
  const TessellateResult result = tessellate(*form, {}, options, {});
  EXPECT_EQ(result.summary.stop, StopReason::converged);
  EXPECT_LE(result.summary.iterations.back().rmsMove, options.convergence);
  EXPECT_GT(result.summary.iterations[result.summary.iterations.size() - 2].rmsMove, options.convergence);
  // With cvt3 caps, which the optimization did not see, interior cells' sites are still their centroids.
  const auto cells = mesh::cellMoments(result.complex, {});
  std::vector<bool> boundary(cells.size(), false);
  for (Index f = 0; f < result.complex.faceCount(); ++f) {
    if (result.complex.isBoundary(f))
      boundary[static_cast<std::size_t>(result.complex.faceCells[static_cast<std::size_t>(f)][0])] = true;
  }
  double squares = 0;
  int interior = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (boundary[i]) continue;
    ++interior;
    squares += (cells[i].centroid - result.complex.cellSites[i]).squaredNorm() / std::pow(cells[i].volume, 2.0 / 3);
  }
  EXPECT_GT(interior, 100);
  EXPECT_LE(std::sqrt(squares / interior), 2 * options.convergence);
}

TEST(Tessellate, RegularityOfABallNearsTheOptimum) {
  TessellateOptions options;
  options.sites = 2000;
  options.iterations = 60;
  const TessellateResult result = tessellate(*implicit::sphere(1), {}, options, {});
  const auto values = metrics::regularities(mesh::cellMoments(result.complex, {}));
  const metrics::Regularity regularity = metrics::regularity(result.complex, values);
  // No partition of space into equal cells is known to beat G₃; a CVT from random sites comes within 2 %.
  EXPECT_GT(regularity.interior.mean, kOptimalRegularity<3>);
  EXPECT_LT(regularity.interior.mean, 0.0805);
  EXPECT_GT(regularity.all.mean, 0.0785);
  EXPECT_LT(regularity.all.mean, 0.0815);
}

TEST(Tessellate, NoIterationsClipTheInitialSites) {
  const auto form = implicit::torus(1, 0.4);
  TessellateOptions options;
  options.sites = 800;
  options.iterations = 0;
  options.seed = 5;
  const TessellateResult result = tessellate(*form, {}, options, {});
  EXPECT_EQ(result.summary.evaluations, 1);
  ASSERT_THAT(result.summary.iterations, SizeIs(1));
  EXPECT_EQ(result.summary.stop, StopReason::iterations);
  EXPECT_EQ(result.summary.reseededSites, 0);
  EXPECT_TRUE(testing::sameBits(result.complex.cellSites, randomSites(ImplicitDomain(*form), 800, 5, {})));
}

TEST(Tessellate, StopsAtARelativeError) {
  TessellateOptions options;
  options.sites = 1000;
  options.iterations = 200;
  options.relativeError = 0.1;
  const TessellateSummary summary = tessellate(*implicit::sphere(1), {}, options, {}).summary;
  EXPECT_EQ(summary.stop, StopReason::relativeError);
  EXPECT_LE(summary.relativeError, 0.1);
  const double before = summary.iterations[summary.iterations.size() - 2].energy;
  EXPECT_GT(before / summary.optimalEnergy - 1, 0.09) << "not long before";
  EXPECT_LT(summary.iterations.size(), 100U);
}

TEST(Tessellate, ReasonsHaveNames) {
  EXPECT_STREQ(toString(StopReason::iterations), "iterations");
  EXPECT_STREQ(toString(StopReason::converged), "converged");
  EXPECT_STREQ(toString(StopReason::relativeError), "relative-error");
  EXPECT_STREQ(toString(StopReason::stalled), "stalled");
}

TEST(Tessellate, CountsSitesWithoutACell) {
  // Sheets far thinner than the sites' spacing, and thin walls with few sites: centroids leave the solid.
  struct Case {
    implicit::ImplicitPtr form;
    Index sites;
  };
  const Case cases[] = {
      {implicit::transformed(implicit::box(Vec3(2, 2, 0.004)), randomRotation(3), Vec3::Zero()), 100},
      {implicit::gyroidBall(), 60},
      {implicit::gyroidBall(), 600},
      {implicit::differenceOf(implicit::sphere(1), implicit::sphere(0.97)), 150},
  };
  Index reseeded = 0;
  for (const Case& c : cases) {
    for (const Optimizer optimizer : {Optimizer::lbfgs, Optimizer::lloyd}) {
      TessellateOptions options;
      options.sites = c.sites;
      options.optimizer = optimizer;
      options.seed = 2;
      const TessellateResult result = tessellate(*c.form, {}, options, {});
      EXPECT_EQ(result.complex.cellCount + result.summary.emptySites, c.sites);
      EXPECT_EQ(result.complex.cellSites.size(), static_cast<std::size_t>(result.complex.cellCount));
      for (const Vec3& site : result.complex.cellSites) EXPECT_TRUE(site.allFinite());
      for (const IterationRecord& record : result.summary.iterations) {
        EXPECT_TRUE(std::isfinite(record.energy));
        EXPECT_TRUE(std::isfinite(record.rmsMove));
      }
      EXPECT_LE(result.summary.reseededSites, options.reseedRounds * c.sites);
      EXPECT_THAT(mesh::validate(result.complex, {}, {}).problems, IsEmpty());
      reseeded += result.summary.reseededSites;
      options.reseedRounds = 0;
      EXPECT_EQ(tessellate(*c.form, {}, options, {}).summary.reseededSites, 0);
    }
  }
  EXPECT_GT(reseeded, 0);
}

TEST(Tessellate, FlatCellsCountAsEmpty) {
  // Cells that hold nothing but a patch in a facet's plane have a mass of rounding errors. Taken for a mass, it gave
  // centroids anywhere, and these runs of Lloyd's method carried sites out of the domain.
  const auto form = implicit::gyroidBall();
  for (const std::uint64_t seed : {1U, 2U, 3U, 5U, 7U, 9U}) {
    for (const int rounds : {0, 3}) {
      TessellateOptions options;
      options.sites = 60;
      options.optimizer = Optimizer::lloyd;
      options.seed = seed;
      options.reseedRounds = rounds;
      TessellateResult result;
      ASSERT_NO_THROW(result = tessellate(*form, {}, options, {})) << "seed " << seed;
      EXPECT_EQ(result.complex.cellCount + result.summary.emptySites, 60);
      EXPECT_GT(result.complex.cellCount, 30);
    }
  }
}

TEST(Tessellate, ReseedingRecoversCells) {
  const auto form = implicit::gyroidBall();
  TessellateOptions options;
  options.sites = 200;
  options.iterations = 12;
  Index with = 0;
  Index without = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    options.seed = seed;
    options.reseedRounds = 3;
    with += tessellate(*form, {}, options, {}).summary.emptySites;
    options.reseedRounds = 0;
    without += tessellate(*form, {}, options, {}).summary.emptySites;
  }
  EXPECT_LT(with, without);
}

TEST(Tessellate, WithoutASiteThatHasNoCellItsNeighborReachesFurther) {
  // The site at x = 0.7 is alone in the end of a thin ellipsoid: no edge of the diagram meets that.
  const auto form = implicit::ellipsoid(Vec3(1, 0.1, 0.1));
  OptimizedSites<3> optimized;
  for (std::uint64_t i = 0; optimized.sites.size() < 150; ++i) {
    const Vec3 p = randomInBox(1, RandomStream::test, i, form->bounds());
    if (p.x() < 0.3 && form->value(p) < 0) optimized.sites.push_back(p);
  }
  optimized.sites.emplace_back(0.7, 0, 0);
  const TessellateResult result = tessellateSites(optimized, *form, {}, {}, {});
  EXPECT_GE(result.summary.emptySites, 1);
  EXPECT_EQ(result.complex.cellCount + result.summary.emptySites, 151);
  double farthest = 0;
  for (const Vec3& vertex : result.complex.vertices) farthest = std::max(farthest, vertex.x());
  EXPECT_GT(farthest, 0.9);
}

TEST(Tessellate, AFewSitesAreNoError) {
  // No edge of the diagram of one, two or three sites meets the sphere: they have no cell, and that is counted.
  for (const Index count : {1, 2, 3, 4, 5, 8, 12}) {
    for (const Optimizer optimizer : {Optimizer::lbfgs, Optimizer::lloyd}) {
      TessellateOptions options;
      options.sites = count;
      options.optimizer = optimizer;
      const TessellateResult result = tessellate(*implicit::sphere(1), {}, options, {});
      EXPECT_EQ(result.complex.cellCount + result.summary.emptySites, count);
      if (count >= 8) {
        EXPECT_GT(result.complex.cellCount, 0);
      }
      for (const Vec3& site : result.complex.cellSites) EXPECT_TRUE(site.allFinite());
      EXPECT_TRUE(std::isfinite(result.summary.energy));
      if (result.complex.cellCount > 0) {
        EXPECT_TRUE(std::isfinite(result.summary.relativeError)) << count << " sites";
      }
    }
  }
}

TEST(TessellateOptions, ListEveryViolation) {
  EXPECT_THAT(validate(TessellateOptions{}), IsEmpty());
  TessellateOptions bad;
  bad.sites = 0;
  bad.iterations = -1;
  bad.convergence = -1;
  bad.relativeError = std::nan("");
  bad.reseedRounds = -2;
  EXPECT_THAT(validate(bad),
              ElementsAre(HasSubstr("sites is 0"), HasSubstr("iterations is -1"), HasSubstr("convergence is -1"),
                          HasSubstr("relative-error is "), HasSubstr("reseedRounds is -2")));
  EXPECT_THROW(tessellate(*implicit::sphere(1), {}, bad, {}), UsageError);
  TessellateOptions many;
  many.sites = 50'000'001;
  EXPECT_THAT(validate(many), ElementsAre(HasSubstr("sites is 50000001")));
}

TEST(Tessellate, NeedsMemory) {
  TessellateOptions options;
  options.sites = 1000;
  options.iterations = 0;
  options.memoryLimit = estimatedMemory(options) - 1;
  try {
    tessellate(*implicit::sphere(1), {}, options, {});
    ADD_FAILURE() << "no error";
  } catch (const EnvironmentError& error) {
    EXPECT_THAT(error.what(), HasSubstr("1000 sites"));
    EXPECT_THAT(error.what(), HasSubstr("fewer sites"));
  }
  options.memoryLimit = estimatedMemory(options);
  EXPECT_EQ(tessellate(*implicit::sphere(1), {}, options, {}).complex.cellCount, 1000);
}

TEST(Tessellate, EstimatesMemoryByTheSitesThatThereAre) {
  TessellateOptions options;
  options.sites = 1000;
  const std::uint64_t ofThousand = estimatedMemory(options);
  options.initialization = Initialization::given;
  options.given.resize(4000);
  EXPECT_EQ(estimatedMemory(options), 4 * ofThousand);
  // Measured: 8.3 kB a site.
  options.initialization = Initialization::greedyEdgeCollapse;
  EXPECT_GT(estimatedMemory(options), 1000U * 8300U);
  options.initialization = Initialization::random;
  options.density.kind = DensityKind::boundary;
  // Measured with the finest grid: 280 MB.
  EXPECT_GT(estimatedMemory(options), ofThousand + 280'000'000U);
}

TEST(Tessellate, CanBeCancelled) {
  std::atomic<bool> cancelled = false;
  RunContext context;
  context.cancelled = &cancelled;
  int reports = 0;
  context.progress = [&](std::string_view stage, double share) {
    EXPECT_EQ(stage, "optimize");
    EXPECT_LE(share, 1);
    if (++reports == 3) cancelled = true;
  };
  TessellateOptions options;
  options.sites = 500;
  for (const Optimizer optimizer : {Optimizer::lbfgs, Optimizer::lloyd}) {
    options.optimizer = optimizer;
    reports = 0;
    cancelled = false;
    EXPECT_THROW(tessellate(*implicit::sphere(1), {}, options, context), Cancelled);
    EXPECT_EQ(reports, 3);
  }
}

TEST(Tessellate, RejectsAFormThatIsTooThin) {
  const auto shell = implicit::differenceOf(implicit::sphere(1), implicit::sphere(1 - 1e-7));
  TessellateOptions options;
  options.sites = 100;
  EXPECT_THROW(tessellate(*shell, {}, options, {}), MethodError);
}

TEST(Tessellate, ThreadsGiveTheSameBits) {
  for (const auto& form : {implicit::torus(1, 0.4), implicit::gyroidBall()}) {
    TessellateOptions options;
    options.sites = 5000;
    options.iterations = 4;
    RunContext one;
    one.threads = 1;
    const TessellateResult reference = tessellate(*form, {}, options, one);
    for (const int threads : {2, 3}) {
      RunContext several;
      several.threads = threads;
      const TessellateResult result = tessellate(*form, {}, options, several);
      EXPECT_THAT(testing::differences(reference.complex, result.complex), IsEmpty());
      EXPECT_EQ(reference.summary.energy, result.summary.energy);
      EXPECT_EQ(reference.summary.evaluations, result.summary.evaluations);
    }
  }
}

TEST(Tessellate, OneOptimizationServesAllCaps) {
  const auto form = implicit::namedShape("bumpy-sphere");
  TessellateOptions options;
  options.sites = 400;
  options.seed = 11;
  options.cap = voronoi::CapKind::flat;  // the optimization must not ask
  const OptimizedSites<3> optimized = optimizeSites(*form, options, {});
  ASSERT_THAT(optimized.sites, SizeIs(400));
  for (const auto cap : {voronoi::CapKind::cvt1, voronoi::CapKind::cvt2, voronoi::CapKind::cvt3}) {
    options.cap = cap;
    const TessellateResult apart = tessellateSites(optimized, *form, {}, options, {});
    const TessellateResult whole = tessellate(*form, {}, options, {});
    EXPECT_THAT(testing::differences(whole.complex, apart.complex), IsEmpty());
    EXPECT_EQ(apart.summary.energy, whole.summary.energy);
    EXPECT_EQ(apart.summary.iterationsDone, whole.summary.iterationsDone);
    EXPECT_EQ(apart.summary.emptySites, whole.summary.emptySites);
    EXPECT_EQ(apart.summary.clip.loops, whole.summary.clip.loops);
    EXPECT_EQ(apart.summary.secondsOptimization, optimized.summary.secondsOptimization);
  }
}

TEST(Tessellate, SeedsDiffer) {
  TessellateOptions options;
  options.sites = 200;
  const TessellateResult first = tessellate(*implicit::sphere(1), {}, options, {});
  EXPECT_THAT(testing::differences(first.complex, tessellate(*implicit::sphere(1), {}, options, {}).complex),
              IsEmpty());
  options.seed = 1;
  EXPECT_THAT(testing::differences(first.complex, tessellate(*implicit::sphere(1), {}, options, {}).complex),
              ::testing::Not(IsEmpty()));
}

TEST(Tessellate, ScaleChangesNoIndex) {
  const double tiny = std::ldexp(1.0, -30);
  for (const auto& shape : {implicit::bumpySphere(), implicit::gyroidBall()}) {
    const auto form = implicit::transformed(shape, randomRotation(5), Vec3::Zero());
    const auto small = implicit::transformed(shape, randomRotation(5), Vec3::Zero(), tiny);
    TessellateOptions options;
    options.sites = 700;
    for (const Optimizer optimizer : {Optimizer::lbfgs, Optimizer::lloyd}) {
      options.optimizer = optimizer;
      const TessellateResult a = tessellate(*form, {}, options, {});
      const TessellateResult b = tessellate(*small, {}, options, {});
      EXPECT_EQ(a.complex.faceOffsets, b.complex.faceOffsets);
      EXPECT_EQ(a.complex.faceVertices, b.complex.faceVertices);
      EXPECT_EQ(a.complex.faceCells, b.complex.faceCells);
      EXPECT_EQ(a.summary.evaluations, b.summary.evaluations);
      EXPECT_NEAR(a.summary.energy, b.summary.energy * std::pow(tiny, -5), 1e-9 * a.summary.energy);
    }
  }
}

TEST(Tessellate, TheFrameIsPassedOn) {
  TessellateOptions options;
  options.sites = 50;
  const Frame frame{Vec3(4500000, 1, 2)};
  EXPECT_EQ(tessellate(*implicit::sphere(1), frame, options, {}).complex.frame.origin, frame.origin);
}

}  // namespace
}  // namespace voroform::cvt
