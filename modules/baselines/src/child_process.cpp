#include "child_process.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <exception>
#include <span>
#include <thread>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "voroform/core/error.hpp"

namespace voroform::baselines {

namespace {

// Exit codes of the child; anything else comes from elsewhere, a sanitizer for instance.
constexpr int kAnswered = 0;
constexpr int kThrew = 3;
constexpr int kUnsent = 4;

[[noreturn]] void throwSystemError(const std::string& what) {
  throw EnvironmentError(what + ": " + std::strerror(errno));
}

// A file without a name, in memory: the child inherits it, and unlike a pipe it need not be emptied while it is filled.
class AnonymousFile {
 public:
  AnonymousFile() : descriptor_(::memfd_create("voroform-answer", MFD_CLOEXEC)) {
    if (descriptor_ < 0) throwSystemError("cannot create a file for a child process's answer");
  }
  AnonymousFile(const AnonymousFile&) = delete;
  AnonymousFile& operator=(const AnonymousFile&) = delete;
  ~AnonymousFile() { ::close(descriptor_); }

  bool write(std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) return false;
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return true;
  }

  std::vector<std::byte> read() const {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) throwSystemError("cannot read a child process's answer");
    std::vector<std::byte> bytes(static_cast<std::size_t>(status.st_size));
    std::size_t got = 0;
    while (got < bytes.size()) {
      const ssize_t count = ::pread(descriptor_, bytes.data() + got, bytes.size() - got, static_cast<off_t>(got));
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) throwSystemError("cannot read a child process's answer");
      if (count == 0) break;
      got += static_cast<std::size_t>(count);
    }
    bytes.resize(got);
    return bytes;
  }

 private:
  int descriptor_;
};

// If memory runs out, the child goes rather than its caller. Where this cannot be set, the system decides by size.
void volunteerWhenMemoryRunsOut() {
  const int file = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (file < 0) return;
  static_cast<void>(!::write(file, "1000", 4));
  ::close(file);
}

// What a library prints or dumps when it fails is nobody's result: it goes nowhere, and into no folder of the user's.
void keepQuiet() {
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  if (nowhere >= 0) {
    for (const int standard : {STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, standard);
  }
  static_cast<void>(::chdir("/proc") == 0);  // nobody can create a file there
}

// The child's whole life. Leaves by _exit: what the parent registered to run at its own end is not the child's to run.
[[noreturn]] void live(const std::function<std::vector<std::byte>()>& work, const AnonymousFile& file, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kUnsent);
  // The terminal interrupts parent and child alike. Only the parent answers, and then kills the child.
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) ::signal(number, SIG_IGN);
  volunteerWhenMemoryRunsOut();
  keepQuiet();
  int code = kAnswered;
  std::vector<std::byte> bytes;
  try {
    try {
      bytes = work();
    } catch (const std::exception& exception) {
      code = kThrew;
      const auto text = std::as_bytes(std::span(exception.what(), std::strlen(exception.what())));
      bytes.assign(text.begin(), text.end());
    }
  } catch (...) {
    code = kThrew;
    bytes.clear();
  }
  ::_exit(file.write(bytes) ? code : kUnsent);
}

// A running child: killed and reaped when this goes out of scope.
class Child {
 public:
  explicit Child(pid_t process) : process_(process) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (!ended_) kill();
  }

  // True if it has ended.
  bool poll() { return ended_ || reap(WNOHANG); }
  void kill() {
    ::kill(process_, SIGKILL);
    reap(0);
  }
  int status() const { return status_; }
  // ru_maxrss counts KiB.
  std::uint64_t peakMemoryBytes() const { return static_cast<std::uint64_t>(usage_.ru_maxrss) * 1024; }

 private:
  bool reap(int options) {
    pid_t found = 0;
    do {
      found = ::wait4(process_, &status_, options, &usage_);
    } while (found < 0 && errno == EINTR);
    if (found == 0) return false;
    // Somebody else has waited for it (the program ignores SIGCHLD): it is gone, and nothing is known of its end.
    if (found < 0) status_ = W_EXITCODE(kUnsent, 0);
    ended_ = true;
    return true;
  }

  pid_t process_;
  bool ended_ = false;
  int status_ = 0;
  rusage usage_{};
};

// Waits for the child's end; false if the time ran out first.
bool await(Child& child, double timeLimit, const RunContext& context) {
  const Stopwatch watch;
  std::chrono::microseconds pause{500};
  while (!child.poll()) {
    context.throwIfCancelled();
    if (timeLimit > 0 && watch.seconds() >= timeLimit) return false;
    std::this_thread::sleep_for(pause);
    pause = std::min(pause * 2, std::chrono::microseconds{10'000});
  }
  return true;
}

std::string describeEnd(int status, const std::vector<std::byte>& bytes) {
  if (WIFSIGNALED(status)) {
    const int number = WTERMSIG(status);
    return "the child process was ended by signal " + std::to_string(number) + " (" + ::strsignal(number) + ")";
  }
  if (WEXITSTATUS(status) == kThrew) {
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return text.empty() ? "an exception of unknown type" : text;
  }
  return "the child process ended with code " + std::to_string(WEXITSTATUS(status)) + " and without an answer";
}

}  // namespace

ChildReport runInChild(const std::function<std::vector<std::byte>()>& work, double timeLimit,
                       const RunContext& context) {
  context.throwIfCancelled();
  const AnonymousFile file;
  const pid_t parent = ::getpid();
  const pid_t process = ::fork();
  if (process < 0) throwSystemError("cannot start a child process");
  if (process == 0) live(work, file, parent);

  Child child(process);
  ChildReport report;
  if (!await(child, timeLimit, context)) {
    child.kill();
    report.end = ChildEnd::timedOut;
  }
  report.peakMemoryBytes = child.peakMemoryBytes();
  if (report.end == ChildEnd::timedOut) return report;
  report.answer = file.read();
  if (WIFEXITED(child.status()) && WEXITSTATUS(child.status()) == kAnswered) {
    report.end = ChildEnd::answered;
    return report;
  }
  report.message = describeEnd(child.status(), report.answer);
  report.answer.clear();
  return report;
}

}  // namespace voroform::baselines
