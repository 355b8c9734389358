#include "voroform/core/memory.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace voroform {
namespace {

TEST(UsableMemory, IsPositiveAndAtMostTheMachines) {
  const auto machine =
      static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  EXPECT_GT(usableMemory(), 0U);
  EXPECT_LE(usableMemory(), machine);
}

#ifndef __SANITIZE_ADDRESS__  // it reserves terabytes of address space
TEST(UsableMemory, IsAtMostTheLimitOfTheProcess) {
  constexpr rlim_t kLimit = rlim_t{1} << 30;
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const rlimit limit = {kLimit, kLimit};
    ::setrlimit(RLIMIT_AS, &limit);
    ::_exit(usableMemory() <= kLimit ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}
#endif

}  // namespace
}  // namespace voroform
