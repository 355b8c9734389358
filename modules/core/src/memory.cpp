#include "voroform/core/memory.hpp"

#include <algorithm>
#include <fstream>
#include <limits>

#include <sys/resource.h>
#include <unistd.h>

namespace voroform {

namespace {

constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

// The number that a control group's file holds; the word "max" and a file that is not there stand for no limit.
std::uint64_t limitIn(const char* path) {
  std::ifstream stream(path);
  std::uint64_t value = 0;
  return stream >> value ? value : kUnlimited;
}

std::uint64_t physicalMemory() {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  const long size = ::sysconf(_SC_PAGESIZE);
  return pages > 0 && size > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(size) : kUnlimited;
}

std::uint64_t addressSpaceLimit() {
  rlimit limit{};
  return ::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY ? limit.rlim_cur : kUnlimited;
}

}  // namespace

std::uint64_t usableMemory() {
  return std::min({physicalMemory(), addressSpaceLimit(), limitIn("/sys/fs/cgroup/memory.max"),
                   limitIn("/sys/fs/cgroup/memory/memory.limit_in_bytes")});
}

}  // namespace voroform
