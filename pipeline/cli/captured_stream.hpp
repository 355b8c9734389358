// What libraries print.
#pragma once

#include <functional>
#include <mutex>
#include <ostream>
#include <streambuf>
#include <string>
#include <string_view>

namespace voroform::cli {

// While it lives, hands every line written to a stream to a function in place of the stream's own target. Libraries
// print to std::cerr when something fails that we report ourselves, in our own words.
class CapturedStream final : public std::streambuf {
 public:
  using Sink = std::function<void(std::string_view line)>;

  CapturedStream(std::ostream& stream, Sink sink);
  ~CapturedStream() override;
  CapturedStream(const CapturedStream&) = delete;
  CapturedStream& operator=(const CapturedStream&) = delete;

 protected:
  int_type overflow(int_type character) override;
  std::streamsize xsputn(const char* text, std::streamsize count) override;

 private:
  void take(char character);

  std::ostream& stream_;
  Sink sink_;
  std::streambuf* target_;
  std::mutex mutex_;
  std::string line_;
};

}  // namespace voroform::cli
