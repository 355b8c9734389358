// Decompression of LZF (M. Lehmann's LibLZF), which PCD's binary_compressed uses.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace voroform::points {

// The most bytes that `compressed` bytes can decode to: the densest code is three bytes for a copy of 264.
std::size_t lzfLargestOutput(std::size_t compressed);

// Decodes into exactly `size` bytes. Returns false if the data are no LZF or of another length.
bool decodeLzf(std::string_view compressed, std::size_t size, std::vector<char>& output);

}  // namespace voroform::points
