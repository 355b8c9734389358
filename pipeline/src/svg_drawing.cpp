#include "svg_drawing.hpp"

#include <algorithm>
#include <cstdio>

#include "voroform/core/xml_text.hpp"

namespace voroform::pipeline {

namespace {

// Control characters are no XML: each becomes a blank.
std::string escaped(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20; }, ' ');
  return xmlEscaped(text);
}

std::string coordinate(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

}  // namespace

void SvgDrawing::rectangle(double x, double y, double width, double height, const std::string& fill,
                           const std::string& note) {
  body_ += "<rect x=\"" + coordinate(x) + "\" y=\"" + coordinate(y) + "\" width=\"" + coordinate(width) +
           "\" height=\"" + coordinate(height) + "\" fill=\"" + fill + "\"";
  body_ += note.empty() ? "/>\n" : "><title>" + escaped(note) + "</title></rect>\n";
}

void SvgDrawing::line(double x1, double y1, double x2, double y2, double width, const std::string& color) {
  body_ += "<line x1=\"" + coordinate(x1) + "\" y1=\"" + coordinate(y1) + "\" x2=\"" + coordinate(x2) + "\" y2=\"" +
           coordinate(y2) + "\" stroke=\"" + color + "\" stroke-width=\"" + coordinate(width) + "\"/>\n";
}

void SvgDrawing::polyline(std::span<const std::array<double, 2>> points, double width, const std::string& color) {
  body_ += "<polyline fill=\"none\" stroke=\"" + color + "\" stroke-width=\"" + coordinate(width) + "\" points=\"";
  for (const auto& [x, y] : points) body_ += coordinate(x) + ',' + coordinate(y) + ' ';
  body_ += "\"/>\n";
}

void SvgDrawing::text(double x, double y, const std::string& content, double size, const std::string& anchor,
                      const std::string& fill) {
  body_ += "<text x=\"" + coordinate(x) + "\" y=\"" + coordinate(y) + "\" font-size=\"" + coordinate(size) +
           "\" text-anchor=\"" + anchor + "\" fill=\"" + fill + "\">" + escaped(content) + "</text>\n";
}

std::string SvgDrawing::document(double width, double height) const {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
         coordinate(width) + "\" height=\"" + coordinate(height) + "\" viewBox=\"0 0 " + coordinate(width) + " " +
         coordinate(height) +
         "\" font-family=\"sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n" + body_ +
         "</svg>\n";
}

}  // namespace voroform::pipeline
