#include "text_files.hpp"

#include "voroform/core/output_file.hpp"

namespace voroform::pipeline {

std::string quoted(const std::string& field) {
  if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
  std::string result = "\"";
  for (const char c : field) result += c == '"' ? "\"\"" : std::string(1, c);
  return result + '"';
}

void putText(ArtifactStore& store, const std::string& name, const std::string& content) {
  store.put(name, [&content](const std::filesystem::path& path) {
    OutputFile file(path);
    file.stream() << content;
    file.commit();
  });
}

}  // namespace voroform::pipeline
