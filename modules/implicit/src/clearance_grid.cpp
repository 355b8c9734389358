#include "clearance_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "box_distance.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::implicit {

namespace {

constexpr int kPadding = 2;               // free voxels around the solid's box
constexpr double kRelativeMargin = 1e-9;  // of the grid's size
constexpr int kLargestCode = 127;
constexpr int kStepsPerVoxel = 2;
constexpr std::uint16_t kFar = 65535;  // squared gaps are capped here

// The lower envelope of the parabolas (y − k)² + line[k], in integers (Meijster, Roerdink & Hesselink 2000).
class LowerEnvelope {
 public:
  explicit LowerEnvelope(int size)
      : apex_(static_cast<std::size_t>(size)), from_(static_cast<std::size_t>(size)), copy_(apex_.size()) {}

  // Replaces line[y] by min over k of line[k] + gap(y − k)², where gap(d) = max(|d| − 1, 0) is the free space between
  // the voxels: the smallest of three neighbors first, then plain squared distances.
  void apply(std::vector<std::uint16_t>& line) {
    const int size = static_cast<int>(line.size());
    for (int k = 0; k < size; ++k) {
      const std::uint16_t before = line[index(std::max(k - 1, 0))];
      const std::uint16_t after = line[index(std::min(k + 1, size - 1))];
      copy_[index(k)] = std::min({before, line[index(k)], after});
    }
    int last = -1;
    for (int k = 0; k < size; ++k) {
      if (copy_[index(k)] == kFar) continue;
      while (last >= 0 && at(from_[index(last)], apex_[index(last)]) > at(from_[index(last)], k)) --last;
      int begin = 0;
      if (last >= 0) {
        begin = 1 + separator(apex_[index(last)], k);
        if (begin >= size) continue;
      }
      ++last;
      apex_[index(last)] = k;
      from_[index(last)] = std::max(begin, 0);
    }
    if (last < 0) {
      std::fill(line.begin(), line.end(), kFar);
      return;
    }
    for (int y = size - 1; y >= 0; --y) {
      line[index(y)] = static_cast<std::uint16_t>(std::min<int>(at(y, apex_[index(last)]), kFar));
      if (y == from_[index(last)]) --last;
    }
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  int at(int y, int k) const { return (y - k) * (y - k) + copy_[index(k)]; }
  // The last y at which the parabola of i is not above that of k > i.
  int separator(int i, int k) const {
    const int numerator = k * k - i * i + copy_[index(k)] - copy_[index(i)];
    const int denominator = 2 * (k - i);
    return numerator >= 0 ? numerator / denominator : -((-numerator + denominator - 1) / denominator);
  }

  std::vector<int> apex_;
  std::vector<int> from_;
  std::vector<std::uint16_t> copy_;
};

// Squared gap to the nearest marked voxel of the same row.
void rowGaps(const std::int8_t* codes, int size, std::uint16_t* gaps) {
  constexpr int kNever = 1 << 20;
  int distance = kNever;
  for (int x = 0; x < size; ++x) {
    distance = codes[x] == 0 ? 0 : distance + 1;
    const int gap = std::min(std::max(distance - 1, 0), 255);
    gaps[x] = distance >= 256 ? kFar : static_cast<std::uint16_t>(gap * gap);
  }
  distance = kNever;
  for (int x = size - 1; x >= 0; --x) {
    distance = codes[x] == 0 ? 0 : distance + 1;
    const int gap = std::min(std::max(distance - 1, 0), 255);
    const std::uint16_t squared = distance >= 256 ? kFar : static_cast<std::uint16_t>(gap * gap);
    gaps[x] = std::min(gaps[x], squared);
  }
}

// Applies the envelope along `stride` to a bundle of lines that lie side by side in memory.
void transformLines(std::uint16_t* first, int lines, int size, std::size_t stride, LowerEnvelope& envelope,
                    std::vector<std::vector<std::uint16_t>>& bundle) {
  for (int k = 0; k < size; ++k) {
    for (int i = 0; i < lines; ++i) {
      bundle[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] =
          first[static_cast<std::size_t>(k) * stride + static_cast<std::size_t>(i)];
    }
  }
  for (int i = 0; i < lines; ++i) envelope.apply(bundle[static_cast<std::size_t>(i)]);
  for (int k = 0; k < size; ++k) {
    for (int i = 0; i < lines; ++i) {
      first[static_cast<std::size_t>(k) * stride + static_cast<std::size_t>(i)] =
          bundle[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
    }
  }
}

constexpr int kBundle = 32;

}  // namespace

ClearanceGrid::ClearanceGrid(const Box3& solid, int resolution) : solid_(solid) {
  const double longest = solid.sizes().maxCoeff();
  edge_ = longest / resolution;
  margin_ = kRelativeMargin * longest + roundingMargin(solid.center().norm() + longest);
  origin_ = solid.min() - Vec3::Constant(kPadding * edge_);
  std::size_t total = 1;
  for (int axis = 0; axis < 3; ++axis) {
    counts_[static_cast<std::size_t>(axis)] = static_cast<int>(std::ceil(solid.sizes()[axis] / edge_)) + 2 * kPadding;
    total *= static_cast<std::size_t>(counts_[static_cast<std::size_t>(axis)]);
  }
  codes_.assign(total, 1);
}

std::size_t ClearanceGrid::indexOf(int x, int y, int z) const {
  return (static_cast<std::size_t>(z) * static_cast<std::size_t>(counts_[1]) + static_cast<std::size_t>(y)) *
             static_cast<std::size_t>(counts_[0]) +
         static_cast<std::size_t>(x);
}

void ClearanceGrid::mark(const Box3& box, const Vec3& point, const Vec3& normal) {
  std::array<int, 3> low;
  std::array<int, 3> high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const double from = std::floor((box.min()[i] - margin_ - origin_[i]) / edge_);
    const double to = std::floor((box.max()[i] + margin_ - origin_[i]) / edge_);
    if (!(to >= 0) || !(from < counts_[axis])) return;
    low[axis] = static_cast<int>(std::max(from, 0.0));
    high[axis] = static_cast<int>(std::min(to, counts_[axis] - 1.0));
  }
  const double reach = 0.5 * edge_ * normal.lpNorm<1>() + margin_ * normal.norm();
  const bool planar = normal.squaredNorm() > 0;
  for (int z = low[2]; z <= high[2]; ++z) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int x = low[0]; x <= high[0]; ++x) {
        const Vec3 center = origin_ + edge_ * Vec3(x + 0.5, y + 0.5, z + 0.5);
        if (planar && std::abs(normal.dot(center - point)) > reach) continue;
        codes_[indexOf(x, y, z)] = 0;
      }
    }
  }
}

void ClearanceGrid::finish(const std::function<bool(const Vec3&)>& negative, const RunContext& context) {
  findSigns(negative);
  context.throwIfCancelled();
  findDistances(context);
}

void ClearanceGrid::findSigns(const std::function<bool(const Vec3&)>& negative) {
  for (int z = 0; z < counts_[2]; ++z) {
    for (int y = 0; y < counts_[1]; ++y) {
      for (int x = 0; x < counts_[0]; ++x) {
        std::int8_t& code = codes_[indexOf(x, y, z)];
        if (code == 0) continue;
        const std::int8_t left = x > 0 ? codes_[indexOf(x - 1, y, z)] : std::int8_t{0};
        const std::int8_t front = y > 0 ? codes_[indexOf(x, y - 1, z)] : std::int8_t{0};
        const std::int8_t below = z > 0 ? codes_[indexOf(x, y, z - 1)] : std::int8_t{0};
        if (left != 0) {
          code = left;
        } else if (front != 0) {
          code = front;
        } else if (below != 0) {
          code = below;
        } else {
          code = negative(origin_ + edge_ * Vec3(x + 0.5, y + 0.5, z + 0.5)) ? std::int8_t{-1} : std::int8_t{1};
        }
      }
    }
  }
}

void ClearanceGrid::findDistances(const RunContext& context) {
  std::vector<std::uint16_t> gaps(codes_.size());
  const auto [nx, ny, nz] = counts_;
  const std::size_t plane = indexOf(0, 0, 1);
  const std::size_t row = indexOf(0, 1, 0);
  const auto newBundle = [](int size) {
    return std::vector<std::vector<std::uint16_t>>(kBundle, std::vector<std::uint16_t>(static_cast<std::size_t>(size)));
  };
  parallelFor(context, static_cast<std::size_t>(nz), 4, [&, nx = nx, ny = ny](std::size_t begin, std::size_t end) {
    LowerEnvelope envelope(ny);
    auto bundle = newBundle(ny);
    for (std::size_t z = begin; z < end; ++z) {
      for (std::size_t y = 0; y < static_cast<std::size_t>(ny); ++y) {
        const std::size_t first = z * plane + y * row;
        rowGaps(&codes_[first], nx, &gaps[first]);
      }
      for (int x = 0; x < nx; x += kBundle) {
        transformLines(&gaps[z * plane + static_cast<std::size_t>(x)], std::min(kBundle, nx - x), ny, row, envelope,
                       bundle);
      }
    }
  });
  parallelFor(context, static_cast<std::size_t>(ny), 4, [&, nx = nx, nz = nz](std::size_t begin, std::size_t end) {
    LowerEnvelope envelope(nz);
    auto bundle = newBundle(nz);
    for (std::size_t y = begin; y < end; ++y) {
      for (int x = 0; x < nx; x += kBundle) {
        transformLines(&gaps[y * row + static_cast<std::size_t>(x)], std::min(kBundle, nx - x), nz, plane, envelope,
                       bundle);
      }
    }
  });
  // Codes of the squared gaps: 1 + ⌊steps·gap⌋.
  std::vector<std::int8_t> codeOfGap(static_cast<std::size_t>(kFar) + 1);
  int code = 1;
  for (int gap = 0; gap <= kFar; ++gap) {
    while (code < kLargestCode && code * code <= kStepsPerVoxel * kStepsPerVoxel * gap) ++code;
    codeOfGap[static_cast<std::size_t>(gap)] = static_cast<std::int8_t>(code);
  }
  constexpr std::size_t kGrain = 1 << 18;
  parallelFor(context, codes_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      codes_[i] = static_cast<std::int8_t>(codes_[i] * codeOfGap[gaps[i]]);
    }
  });
}

double ClearanceGrid::clearance(const Vec3& p) const {
  const Vec3 place = (p - origin_) / edge_;
  std::array<int, 3> voxel;
  double toSide = 0.5;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double coordinate = place[static_cast<Eigen::Index>(axis)];
    if (!(coordinate >= 0 && coordinate < counts_[axis])) return std::max(0.0, boxDistance(solid_, p) - margin_);
    voxel[axis] = static_cast<int>(coordinate);
    const double within = coordinate - voxel[axis];
    toSide = std::min({toSide, within, 1 - within});
  }
  const int code = codes_[indexOf(voxel[0], voxel[1], voxel[2])];
  if (code == 0) return 0;
  // With u the gap's vector between the voxels and the point at least δ from each side of its own, the distance to the
  // nearest marked voxel is at least |u + (δ, …)| ≥ |u| + δ.
  const double gap = (std::abs(code) - 1) * (1.0 / kStepsPerVoxel);
  const double distance = edge_ * (gap + toSide) - margin_;
  return distance > 0 ? std::copysign(distance, code) : 0.0;
}

}  // namespace voroform::implicit
