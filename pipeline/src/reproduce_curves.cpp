// How mean G and the energy fall, as figure 4.10 of the thesis shows it.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "rank_records.hpp"
#include "reproduce_cvt.hpp"
#include "svg_drawing.hpp"
#include "text_files.hpp"

namespace voroform::pipeline {

namespace {

// In pixels.
constexpr double kPanelWidth = 520;
constexpr double kPanelHeight = 360;
constexpr double kLeft = 70;
constexpr double kTop = 40;
constexpr double kBottom = 50;
constexpr double kRight = 20;
constexpr double kLegendLine = 16;
constexpr std::array<const char*, 6> kColors = {"#000000", "#b2182b", "#2166ac", "#1b7837", "#e08214", "#762a83"};

using ValueOf = std::function<double(const Curve&, const cvt::IterationRecord&)>;

// One panel: the values against the iterations, both axes logarithmic, for the values are excesses over the optimum.
void drawPanel(SvgDrawing& drawing, const std::vector<Curve>& curves, double left, const std::string& title,
               const ValueOf& valueOf) {
  double low = std::numeric_limits<double>::infinity();
  double high = 0;
  std::size_t most = 2;
  for (const Curve& curve : curves) {
    most = std::max(most, curve.iterations.size());
    for (const cvt::IterationRecord& record : curve.iterations) {
      const double value = valueOf(curve, record);
      if (!(value > 0)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  if (!(high > low)) return;
  const double width = kPanelWidth - kLeft - kRight;
  const double height = kPanelHeight - kTop - kBottom;
  const auto placeX = [&](double iteration) {
    return left + kLeft + width * std::log(1 + iteration) / std::log(static_cast<double>(most));
  };
  const auto placeY = [&](double value) { return kTop + height * std::log(high / value) / std::log(high / low); };
  drawing.text(left + kLeft + width / 2, 24, title, 13);
  drawing.line(left + kLeft, kTop, left + kLeft, kTop + height);
  drawing.line(left + kLeft, kTop + height, left + kLeft + width, kTop + height);
  drawing.text(left + kLeft + width / 2, kTop + height + 38, "iterations, restarts counted", 11);
  for (double tick = 1; tick < static_cast<double>(most); tick *= 10) {
    drawing.line(placeX(tick), kTop + height, placeX(tick), kTop + height + 4);
    drawing.text(placeX(tick), kTop + height + 18, shortNumber(tick), 10);
  }
  for (const double value : {high, std::sqrt(high * low), low}) {
    drawing.line(left + kLeft - 4, placeY(value), left + kLeft, placeY(value));
    drawing.text(left + kLeft - 7, placeY(value) + 4, shortNumber(value, 3), 10, "end");
  }
  for (std::size_t c = 0; c < curves.size(); ++c) {
    std::vector<std::array<double, 2>> points;
    for (std::size_t i = 0; i < curves[c].iterations.size(); ++i) {
      const double value = valueOf(curves[c], curves[c].iterations[i]);
      if (value > 0) points.push_back({placeX(static_cast<double>(i)), placeY(value)});
    }
    drawing.polyline(points, 1.5, kColors[c % kColors.size()]);
  }
}

}  // namespace

std::string curvesCsv(const std::vector<Curve>& curves) {
  std::string csv = "curve,iteration,evaluations,mean_regularity,energy,relative_error,rms_move\n";
  for (const Curve& curve : curves) {
    for (std::size_t i = 0; i < curve.iterations.size(); ++i) {
      const cvt::IterationRecord& record = curve.iterations[i];
      csv += quoted(curve.name) + ',' + std::to_string(i) + ',' + std::to_string(record.evaluations);
      for (const double value :
           {record.meanRegularity, record.energy, record.energy / curve.optimalEnergy - 1, record.rmsMove}) {
        csv += ',' + shortNumber(value, 10);
      }
      csv += '\n';
    }
  }
  return csv;
}

std::string curvesSvg(const std::vector<Curve>& curves) {
  SvgDrawing drawing;
  drawPanel(drawing, curves, 0, "mean G / G_m − 1", [](const Curve& curve, const cvt::IterationRecord& record) {
    return record.meanRegularity / curve.optimalRegularity - 1;
  });
  drawPanel(drawing, curves, kPanelWidth, "E / E_m − 1", [](const Curve& curve, const cvt::IterationRecord& record) {
    return record.energy / curve.optimalEnergy - 1;
  });
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const double y = kPanelHeight + kLegendLine * static_cast<double>(c);
    drawing.line(kLeft, y, kLeft + 30, y, 2, kColors[c % kColors.size()]);
    drawing.text(kLeft + 38, y + 4, curves[c].name, 11, "start");
  }
  return drawing.document(2 * kPanelWidth, kPanelHeight + kLegendLine * static_cast<double>(curves.size()) + 10);
}

}  // namespace voroform::pipeline
