// The layout of VTK's XML unstructured grids with appended raw data. VTK's own writer gives different bytes from call
// to call, so files are laid out here.
#pragma once

#include <bit>
#include <cstdint>
#include <functional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "voroform/core/xml_text.hpp"

namespace voroform::mesh::vtu {

static_assert(std::endian::native == std::endian::little, "VTU files are written as the machine's own bytes");

// What follows the last block.
inline constexpr char kEnd[] = "\n  </AppendedData>\n</VTKFile>\n";

inline constexpr std::size_t kBufferBytes = std::size_t{4} << 20U;

// Collects values and hands them to the stream in large pieces.
class AppendedBuffer {
 public:
  explicit AppendedBuffer(std::ostream& stream) : stream_(stream) { bytes_.reserve(kBufferBytes + 64); }

  template <class T>
  void put(const T& value) {
    const auto* raw = reinterpret_cast<const char*>(&value);
    bytes_.insert(bytes_.end(), raw, raw + sizeof(T));
    if (bytes_.size() >= kBufferBytes) flush();
  }
  void write(const void* data, std::size_t bytes) {
    flush();
    stream_.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
  }
  void flush() {
    stream_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
    bytes_.clear();
  }

 private:
  std::ostream& stream_;
  std::vector<char> bytes_;
};

// The XML part with the offsets of the blocks, and what writes each block's bytes.
class AppendedLayout {
 public:
  using Emit = std::function<void(AppendedBuffer&)>;

  AppendedLayout() {
    text("<?xml version=\"1.0\"?>");
    text("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">");
    text("  <UnstructuredGrid>");
  }
  void text(const std::string& line) { xml_ += line + "\n"; }

  // tuples < 0: the count follows from the number of points or cells (VTK wants it for field data only).
  void array(const std::string& type, const std::string& name, int components, std::int64_t tuples, std::uint64_t bytes,
             Emit emit) {
    xml_ += "        <DataArray type=\"" + type + "\" Name=\"" + xmlEscaped(name) + "\"";
    if (components > 1) xml_ += " NumberOfComponents=\"" + std::to_string(components) + "\"";
    if (tuples >= 0) xml_ += " NumberOfTuples=\"" + std::to_string(tuples) + "\"";
    xml_ += " format=\"appended\" offset=\"" + std::to_string(offset_) + "\"/>\n";
    offset_ += sizeof(std::uint64_t) + bytes;
    blocks_.push_back({bytes, std::move(emit)});
  }

  template <class T>
  void vector(const std::string& type, const std::string& name, int components, bool field,
              const std::vector<T>& values) {
    const std::uint64_t bytes = values.size() * sizeof(T);
    array(type, name, components, field ? static_cast<std::int64_t>(values.size()) : -1, bytes,
          [&values, bytes](AppendedBuffer& buffer) { buffer.write(values.data(), bytes); });
  }

  // The whole file. Ends the grid's element first.
  void write(std::ostream& stream) {
    text("  </UnstructuredGrid>");
    text("  <AppendedData encoding=\"raw\">");
    stream << xml_ << '_';
    AppendedBuffer buffer(stream);
    for (const Block& block : blocks_) {
      buffer.put(block.bytes);
      block.emit(buffer);
    }
    buffer.flush();
    stream << kEnd;
  }

 private:
  struct Block {
    std::uint64_t bytes;
    Emit emit;
  };
  std::string xml_;
  std::uint64_t offset_ = 0;
  std::vector<Block> blocks_;
};

}  // namespace voroform::mesh::vtu
