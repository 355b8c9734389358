#include "voroform/pipeline/sha256.hpp"

#include <gtest/gtest.h>

#include <string>

#include "program.hpp"
#include "voroform/core/error.hpp"

namespace voroform::pipeline {
namespace {

std::string digest(const std::string& text) {
  Sha256 hash;
  hash.update(std::as_bytes(std::span(text)));
  return hash.finish();
}

// The examples of FIPS 180-2, appendix B, and the empty message.
TEST(Sha256, AgreesWithThePublishedExamples) {
  EXPECT_EQ(digest(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(digest("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(digest("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(digest(std::string(1'000'000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, DoesNotDependOnHowTheDataIsCut) {
  const std::string text(1000, 'x');
  const std::string whole = digest(text);
  for (const std::size_t step : {1UL, 63UL, 64UL, 65UL, 999UL}) {
    Sha256 hash;
    for (std::size_t begin = 0; begin < text.size(); begin += step) {
      hash.update(std::as_bytes(std::span(text).subspan(begin, std::min(step, text.size() - begin))));
    }
    EXPECT_EQ(hash.finish(), whole) << "in steps of " << step;
  }
}

TEST(Sha256, ReadsFilesAndNamesThoseItCannotRead) {
  const test::TemporaryFolder folder;
  const std::string path = folder.write("abc", "abc");
  EXPECT_EQ(sha256OfFile(path), digest("abc"));
  EXPECT_THROW(sha256OfFile(folder / "none"), InputError);
}

}  // namespace
}  // namespace voroform::pipeline
