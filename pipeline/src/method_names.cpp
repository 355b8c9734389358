#include "comparing.hpp"

namespace voroform::pipeline {

const std::vector<std::string>& methodNames() {
  static const std::vector<std::string> names = {"mc",   "delaunay", kNotOptimized, "cvt1", "cvt1+fit",
                                                 "cvt2", "cvt2+fit", "cvt3",        "cvt4"};
  return names;
}

const std::vector<std::string>& defaultMethods() {
  static const std::vector<std::string> names = {"mc", "delaunay", kNotOptimized, "cvt1", "cvt2", "cvt3", "cvt4"};
  return names;
}

}  // namespace voroform::pipeline
