#include "comparing.hpp"

namespace voroform::pipeline {

const std::vector<std::string>& methodNames() {
  static const std::vector<std::string> names = {"mc", "delaunay", kNotOptimized, "cvt1", "cvt2", "cvt3"};
  return names;
}

}  // namespace voroform::pipeline
