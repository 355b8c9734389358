// Pictures of plain shapes and text, without style sheets, fonts or links of their own.
#pragma once

#include <array>
#include <span>
#include <string>

namespace voroform::pipeline {

class SvgDrawing {
 public:
  // In pixels; `note` is shown where the pointer rests.
  void rectangle(double x, double y, double width, double height, const std::string& fill, const std::string& note);
  void line(double x1, double y1, double x2, double y2, double width = 1, const std::string& color = "#222222");
  void polyline(std::span<const std::array<double, 2>> points, double width, const std::string& color);
  void text(double x, double y, const std::string& content, double size = 11, const std::string& anchor = "middle",
            const std::string& fill = "#111111");
  // The file's content.
  std::string document(double width, double height) const;

 private:
  std::string body_;
};

}  // namespace voroform::pipeline
