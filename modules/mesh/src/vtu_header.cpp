#include "vtu_header.hpp"

#include <charconv>
#include <map>
#include <optional>

#include "voroform/core/error.hpp"

namespace voroform::mesh::vtu {

namespace {

struct Tag {
  std::string name;  // with a leading slash for an end tag
  bool selfClosing = false;
  std::map<std::string, std::string> attributes;
};

// Steps through the tags of an XML text without entities in names, comments or CDATA: what writeCellsVtu writes.
class TagReader {
 public:
  TagReader(std::string_view xml, const std::string& file) : xml_(xml), file_(file) {}

  std::optional<Tag> next() {
    skipSpace();
    if (position_ == xml_.size()) return std::nullopt;
    if (xml_[position_] != '<') fail("expected a tag");
    ++position_;
    Tag tag;
    tag.name = takeWhile([](char c) { return c != '>' && c != ' ' && c != '\n' && c != '\t'; });
    while (tag.name.size() > 1 && tag.name.back() == '/') {
      tag.name.pop_back();
      tag.selfClosing = true;
    }
    while (true) {
      skipSpace();
      const char c = peek();
      if (c == '>') {
        ++position_;
        return tag;
      }
      if (c == '/' || c == '?') {
        ++position_;
        tag.selfClosing = true;
        continue;
      }
      const std::string name = takeWhile([](char d) { return d != '=' && d != '>' && d != ' '; });
      if (peek() != '=') fail("expected '=' after the attribute '" + name + "'");
      ++position_;
      if (peek() != '"') fail("expected a quoted value of the attribute '" + name + "'");
      ++position_;
      std::string value = takeWhile([](char d) { return d != '"'; });
      ++position_;
      if (!tag.attributes.emplace(name, std::move(value)).second) fail("the attribute '" + name + "' stands twice");
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(file_ + ": byte " + std::to_string(position_) + ": " + what);
  }

 private:
  char peek() const {
    if (position_ == xml_.size()) fail("the XML part ends inside a tag");
    return xml_[position_];
  }
  void skipSpace() {
    while (position_ < xml_.size() && (xml_[position_] == ' ' || xml_[position_] == '\n' || xml_[position_] == '\t')) {
      ++position_;
    }
  }
  template <class Accept>
  std::string takeWhile(const Accept& accept) {
    const std::size_t begin = position_;
    while (accept(peek())) ++position_;
    return std::string(xml_.substr(begin, position_ - begin));
  }

  std::string_view xml_;
  const std::string& file_;
  std::size_t position_ = 0;
};

const std::string& attribute(const TagReader& reader, const Tag& tag, const std::string& name) {
  const auto found = tag.attributes.find(name);
  if (found == tag.attributes.end()) reader.fail("<" + tag.name + "> lacks the attribute '" + name + "'");
  return found->second;
}

std::uint64_t number(const TagReader& reader, const Tag& tag, const std::string& name) {
  const std::string& text = attribute(reader, tag, name);
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    reader.fail("the attribute '" + name + "' of <" + tag.name + "> is '" + text + "', expected a count");
  }
  return value;
}

void require(const TagReader& reader, const Tag& tag, const std::string& name, const std::string& value) {
  const std::string& found = attribute(reader, tag, name);
  if (found != value) {
    reader.fail("the attribute '" + name + "' of <" + tag.name + "> is '" + found + "', expected '" + value +
                "' as voroform writes it");
  }
}

}  // namespace

Header parseHeader(std::string_view xml, const std::string& file) {
  Header header;
  TagReader reader(xml, file);
  std::string section;
  bool sawFile = false;
  bool sawPiece = false;
  while (const std::optional<Tag> tag = reader.next()) {
    if (tag->name == "VTKFile") {
      require(reader, *tag, "type", "UnstructuredGrid");
      require(reader, *tag, "byte_order", "LittleEndian");
      require(reader, *tag, "header_type", "UInt64");
      if (tag->attributes.contains("compressor"))
        reader.fail("compressed data; expected plain data as voroform writes");
      sawFile = true;
    } else if (tag->name == "Piece") {
      if (sawPiece) reader.fail("a second <Piece>; voroform writes one");
      header.points = number(reader, *tag, "NumberOfPoints");
      header.cells = number(reader, *tag, "NumberOfCells");
      sawPiece = true;
    } else if (tag->name == "DataArray") {
      require(reader, *tag, "format", "appended");
      DataArray array;
      array.section = section;
      array.name = attribute(reader, *tag, "Name");
      array.type = attribute(reader, *tag, "type");
      array.offset = number(reader, *tag, "offset");
      if (tag->attributes.contains("NumberOfComponents")) array.components = number(reader, *tag, "NumberOfComponents");
      header.arrays.push_back(std::move(array));
    } else if (tag->name == "AppendedData") {
      require(reader, *tag, "encoding", "raw");
    } else if (tag->name.starts_with("/")) {
      if (tag->name == "/" + section) section.clear();
    } else if (!tag->selfClosing && tag->name != "UnstructuredGrid") {
      section = tag->name;
    }
  }
  if (!sawFile || !sawPiece) throw InputError(file + ": no VTK unstructured grid (no <VTKFile> or no <Piece>)");
  return header;
}

}  // namespace voroform::mesh::vtu
