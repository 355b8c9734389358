// Pictures of planar tessellations: plain shapes and text, without style sheets, fonts or links of their own.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "voroform/core/error.hpp"
#include "voroform/core/output_file.hpp"
#include "voroform/core/xml_text.hpp"
#include "voroform/mesh/planar_formats.hpp"

namespace voroform::mesh {

namespace {

// In pixels.
constexpr double kLongerSide = 800;
constexpr double kMargin = 20;
constexpr double kBarWidth = 18;
constexpr double kBarHeight = 240;
constexpr double kBarSpace = 110;  // for the bar with its numbers
constexpr double kLabelHeight = 26;
constexpr double kFontSize = 13;
// Lines get thinner with the cells: share of √(area of the box / cells).
constexpr double kStrokeShare = 0.03;
constexpr double kWidestStroke = 1;
constexpr int kTicks = 5;

// From blue over light yellow to red, told apart by readers who do not see green.
using Color = std::array<int, 3>;
constexpr std::array<Color, 5> kColors = {
    {{0x2c, 0x7b, 0xb6}, {0xab, 0xd9, 0xe9}, {0xff, 0xff, 0xbf}, {0xfd, 0xae, 0x61}, {0xd7, 0x19, 0x1c}}};

std::string hex(const Color& color) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text = "#";
  for (const int channel : color) {
    text += kDigits[channel / 16];
    text += kDigits[channel % 16];
  }
  return text;
}

// Share 0 is the low end. What is not a number has the color of the high one.
std::string colorAt(double share) {
  const double place = share < 1 ? std::max(share, 0.0) * (kColors.size() - 1) : kColors.size() - 1;
  const auto stop = std::min(static_cast<std::size_t>(place), kColors.size() - 2);
  const double part = place - static_cast<double>(stop);
  Color color{};
  for (std::size_t c = 0; c < 3; ++c) {
    color[c] = static_cast<int>(std::lround((1 - part) * kColors[stop][c] + part * kColors[stop + 1][c]));
  }
  return hex(color);
}

std::string fixed(double value, int decimals = 2) {
  char digits[64];
  const auto result = std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals);
  return {digits, result.ptr};
}

class Picture {
 public:
  Picture(const PlanarTessellation& tessellation, const PlanarSvgOptions& options)
      : tessellation_(tessellation), options_(options) {
    for (const Index v : tessellation.loopVertices) box_.extend(tessellation.vertices[static_cast<std::size_t>(v)]);
    if (box_.isEmpty()) box_ = Box2(Vec2::Zero(), Vec2::Ones());
    scale_ = kLongerSide / box_.sizes().maxCoeff();
    size_ = scale_ * box_.sizes();
    const auto cells = static_cast<double>(std::max<Index>(tessellation.cellCount(), 1));
    cellSize_ = std::sqrt(size_.prod() / cells);
  }

  std::string document(std::span<const double> values) const {
    const double width = size_.x() + 2 * kMargin + kBarSpace;
    const double height = std::max(size_.y(), kBarHeight + 2 * kLabelHeight) + 2 * kMargin;
    std::string text =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
        fixed(width) + "\" height=\"" + fixed(height) + "\" viewBox=\"0 0 " + fixed(width) + " " + fixed(height) +
        "\" font-family=\"sans-serif\">\n<rect width=\"100%\" height=\"100%\" " + "fill=\"#ffffff\"/>\n";
    addCells(text, values);
    addBar(text);
    return text + "</svg>\n";
  }

 private:
  // The picture's y points downwards.
  std::string place(const Vec2& point) const {
    return fixed(kMargin + scale_ * (point.x() - box_.min().x())) + "," +
           fixed(kMargin + scale_ * (box_.max().y() - point.y()));
  }

  void addCells(std::string& text, std::span<const double> values) const {
    text += "<g fill-rule=\"evenodd\" stroke=\"#222222\" stroke-linejoin=\"round\" stroke-width=\"" +
            fixed(std::min(kStrokeShare * cellSize_, kWidestStroke)) + "\">\n";
    for (Index cell = 0; cell < tessellation_.cellCount(); ++cell) {
      if (tessellation_.firstLoop(cell) == tessellation_.endLoop(cell)) continue;
      const double value = values[static_cast<std::size_t>(cell)];
      text += "<path fill=\"" + colorAt((value - options_.low) / (options_.high - options_.low)) + "\" d=\"";
      for (std::size_t l = tessellation_.firstLoop(cell); l < tessellation_.endLoop(cell); ++l) {
        char mark = 'M';
        for (const Index v : tessellation_.loop(l)) {
          text += mark + place(tessellation_.vertices[static_cast<std::size_t>(v)]);
          mark = ' ';
        }
        text += 'z';
      }
      text += "\"/>\n";
    }
    text += "</g>\n";
  }

  void addBar(std::string& text) const {
    const double left = size_.x() + 2 * kMargin;
    const double top = kMargin + kLabelHeight;
    text += "<defs><linearGradient id=\"scale\" x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\">";
    for (std::size_t k = 0; k < kColors.size(); ++k) {
      text += "<stop offset=\"" + fixed(static_cast<double>(k) / (kColors.size() - 1)) + "\" stop-color=\"" +
              hex(kColors[k]) + "\"/>";
    }
    text += "</linearGradient></defs>\n<text x=\"" + fixed(left) + "\" y=\"" + fixed(kMargin + kFontSize) +
            "\" font-size=\"" + fixed(kFontSize) + "\">" + xmlEscaped(options_.label) + "</text>\n<rect x=\"" +
            fixed(left) + "\" y=\"" + fixed(top) + "\" width=\"" + fixed(kBarWidth) + "\" height=\"" +
            fixed(kBarHeight) + "\" fill=\"url(#scale)\" stroke=\"#222222\"/>\n";
    for (int k = 0; k < kTicks; ++k) {
      const double share = static_cast<double>(k) / (kTicks - 1);
      const double y = top + kBarHeight * (1 - share);
      text += "<text x=\"" + fixed(left + kBarWidth + 6) + "\" y=\"" + fixed(y + kFontSize / 3) + "\" font-size=\"" +
              fixed(kFontSize) + "\">" + (k == kTicks - 1 ? "≥ " : "") +
              fixed(options_.low + share * (options_.high - options_.low), 4) + "</text>\n";
    }
  }

  const PlanarTessellation& tessellation_;
  const PlanarSvgOptions& options_;
  Box2 box_;
  double scale_ = 1;     // pixels per unit
  Vec2 size_;            // in pixels
  double cellSize_ = 1;  // in pixels
};

}  // namespace

void writePlanarSvg(const std::filesystem::path& path, const PlanarTessellation& tessellation,
                    std::span<const double> values, const PlanarSvgOptions& options) {
  if (values.size() != static_cast<std::size_t>(tessellation.cellCount())) {
    throw UsageError(path.string() + ": " + std::to_string(values.size()) + " values for " +
                     std::to_string(tessellation.cellCount()) + " cells");
  }
  if (!(options.low < options.high))
    throw UsageError(path.string() + ": the color scale's low end is not below its high");
  OutputFile file(path);
  file.stream() << Picture(tessellation, options).document(values);
  file.commit();
}

}  // namespace voroform::mesh
