// docs/formats.md names every key that is written.
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <string>

#include "program.hpp"

namespace voroform::test {
namespace {

using Json = nlohmann::ordered_json;

// All words in `backticks` of the document's parts on metrics.json.
std::set<std::string> documentedWords() {
  const std::string document = readFile(std::filesystem::path(VOROFORM_DOCS) / "formats.md");
  const std::size_t begin = document.find("### metrics.json");
  const std::size_t end = document.find("### comparison.json");
  EXPECT_LT(begin, end);
  const std::string part = document.substr(begin, end - begin);
  const std::regex word("`([a-z_0-9]+)`");
  std::set<std::string> words;
  for (std::sregex_iterator match(part.begin(), part.end(), word), none; match != none; ++match) {
    words.insert((*match)[1].str());
  }
  return words;
}

void addKeys(const Json& json, const std::string& at, std::set<std::string>& undocumented,
             const std::set<std::string>& documented) {
  if (json.is_array() && !json.empty()) addKeys(json.front(), at + "[]", undocumented, documented);
  if (!json.is_object() || at == "/sha256") return;  // by the names of files
  for (const auto& [key, value] : json.items()) {
    if (!documented.contains(key)) undocumented.insert(at + "/" + key);
    addKeys(value, at + "/" + key, undocumented, documented);
  }
}

TEST(Documentation, NamesEveryKeyOfMetrics) {
  const TemporaryFolder folder;
  const std::string cloud = folder.write("torus.xyz", xyzText(torusPoints(1500)));
  const std::string mesh =
      folder.write("tetra.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  const std::vector<std::vector<std::string>> runs = {
      {"shape:torus", "--init", "hierarchical-random", "--density", "boundary", "--rotation-seed", "1"},
      {"shape:sphere", "--optimizer", "lloyd-newton", "--no-accuracy"},
      {cloud},
      {mesh},
      {mesh, "--implicit", "poisson", "--samples", "2000"},
      {"shape2d:star", "--init", "hierarchical-lattice", "--density", "boundary"},
  };
  const std::set<std::string> documented = documentedWords();
  for (const std::vector<std::string>& options : runs) {
    std::vector<std::string> arguments = {"tessellate", "-o", folder / "out", "--sites", "200", "--iterations", "2"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = run(arguments);
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    std::set<std::string> undocumented;
    addKeys(readJson(folder / "out/metrics.json"), "", undocumented, documented);
    EXPECT_EQ(undocumented, std::set<std::string>()) << options.front();
  }
}

}  // namespace
}  // namespace voroform::test
