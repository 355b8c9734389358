// Block-wise reading of a stream, by lines or by bytes, that knows where it is and says so in its errors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

#include "voroform/core/run_context.hpp"

namespace voroform {

// A token as it may stand in a message: quoted, at most 32 characters, what cannot be printed as \xNN.
std::string quotedToken(std::string_view token);

class ByteSource {
 public:
  // Longest line and largest piece that take() gives; it bounds the memory that any input can make us use for a record.
  static constexpr std::size_t kBlockBytes = std::size_t{1} << 20;

  ByteSource(std::istream& stream, std::string name, const RunContext& context);

  // The next line without its end (LF or CRLF) and the first one without a byte order mark, valid until the next call;
  // false at the end of the file.
  bool nextLine(std::string_view& line);
  // The next bytes, at most kBlockBytes, valid until the next call; nullptr (and nothing consumed) if fewer are left.
  const char* take(std::size_t bytes);
  // Passes over bytes; false if the file ends before.
  bool skip(std::uint64_t bytes);
  bool atEnd();

  const std::string& name() const { return name_; }
  const RunContext& context() const { return context_; }
  std::uint64_t line() const { return line_; }  // number of the line that nextLine() gave last, from 1

  // "name: message"
  [[noreturn]] void fail(const std::string& message) const;
  // "name:line: expected …, found …"
  [[noreturn]] void failAtLine(const std::string& expected, const std::string& found) const;
  // "name: declares N things, file ends after record K (…byte B)". To be called once the end has been reached.
  [[noreturn]] void failTruncated(std::uint64_t declared, std::string_view things, std::uint64_t complete) const;

 private:
  static constexpr std::size_t kFirstBlockBytes = std::size_t{1} << 16;

  // Reads more behind what is left; false at the end of the file or if the block is full and cannot grow.
  bool fill();
  std::size_t available() const { return end_ - begin_; }

  std::istream& stream_;
  std::string name_;
  const RunContext& context_;
  std::vector<char> block_;  // grows up to kBlockBytes when one record needs it
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t bytesRead_ = 0;  // from the stream, ahead of what was given out
  std::uint64_t line_ = 0;
};

// Says through the context that a file goes on behind what its header declares.
void warnOfExtraData(ByteSource& source);

}  // namespace voroform
