// rankings.svg: plain shapes and text, without style sheets, fonts or links of its own.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "rank_records.hpp"
#include "svg_drawing.hpp"

namespace voroform::pipeline {

namespace {

// In pixels.
constexpr double kPanelWidth = 420;
constexpr double kPanelHeight = 330;
constexpr double kBarHeight = 130;
constexpr double kMargin = 20;
constexpr double kTitleHeight = 34;
constexpr double kLegendHeight = 40;
constexpr std::size_t kPanelsPerRow = 4;

// From first to last place; told apart in gray as well.
constexpr std::array<const char*, 9> kColors = {"#00441b", "#1b7837", "#5aae61", "#a6dba0", "#d9f0d3",
                                                "#fee0b6", "#fdb863", "#e08214", "#b35806"};

// Of all places that there are in the experiment, so that one legend serves all tables.
const char* colorOf(std::size_t place, std::size_t places) {
  if (places <= 1) return kColors.front();
  return kColors[(place * (kColors.size() - 1) + (places - 1) / 2) / (places - 1)];
}

// Stacked bars: how often each method has each place, the first at the bottom.
void drawBars(SvgDrawing& drawing, const CriterionRanking& ranking, std::size_t places, double left, double top) {
  const std::size_t methods = ranking.methods.size();
  const double slot = (kPanelWidth - 2 * kMargin) / static_cast<double>(methods);
  const auto inputs = static_cast<double>(ranking.summary.inputs);
  for (std::size_t j = 0; j < methods; ++j) {
    const double x = left + kMargin + slot * static_cast<double>(j) + 0.12 * slot;
    double bottom = top + kBarHeight;
    for (std::size_t place = 0; place < methods; ++place) {
      const std::size_t count = ranking.summary.counts[j][place];
      if (count == 0) continue;
      const double height = kBarHeight * static_cast<double>(count) / inputs;
      bottom -= height;
      const char* const color = colorOf(place, places);
      drawing.rectangle(
          x, bottom, 0.76 * slot, height, color,
          ranking.methods[j].method + ", place " + std::to_string(place + 1) + ": " + std::to_string(count));
      if (height >= 11) {
        const bool dark = color == kColors[0] || color == kColors[1] || color == kColors[8];
        drawing.text(x + 0.38 * slot, bottom + 0.5 * height + 3.5, std::to_string(count), 10, "middle",
                     dark ? "#ffffff" : "#111111");
      }
    }
    drawing.text(x + 0.38 * slot, top + kBarHeight + 14, ranking.methods[j].method, 10);
  }
  drawing.line(left + kMargin, top + kBarHeight, left + kPanelWidth - kMargin, top + kBarHeight);
}

// Methods on the axis of mean ranks; a thick bar joins those that are not significantly different (Demšar 2006).
void drawCriticalDifference(SvgDrawing& drawing, const CriterionRanking& ranking, double left, double top) {
  const std::size_t methods = ranking.methods.size();
  const std::vector<double>& ranks = ranking.summary.meanRanks;
  const double start = left + 3 * kMargin;
  const double unit = (kPanelWidth - 6 * kMargin) / static_cast<double>(methods - 1);
  const auto placeOf = [&](double rank) { return start + unit * (rank - 1); };
  const double difference = ranking.summary.criticalDifference05;
  const double shown = std::min(difference, static_cast<double>(methods - 1));
  drawing.line(start, top, placeOf(1 + shown), top, 1.5);
  drawing.text(start, top - 4, "CD " + shortNumber(difference, 3) + " (0.05)", 9, "start");
  const double axis = top + 26;
  drawing.line(start, axis, placeOf(static_cast<double>(methods)), axis);
  for (std::size_t rank = 1; rank <= methods; ++rank) {
    const double x = placeOf(static_cast<double>(rank));
    drawing.line(x, axis - 4, x, axis);
    drawing.text(x, axis - 7, std::to_string(rank), 9);
  }
  std::vector<std::size_t> order(methods);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return ranks[a] < ranks[b]; });
  // The better half has its names on the left.
  const std::size_t onLeft = (methods + 1) / 2;
  for (std::size_t i = 0; i < methods; ++i) {
    const bool leftSide = i < onLeft;
    const std::size_t row = leftSide ? i : methods - 1 - i;
    const double y = axis + 34 + 14 * static_cast<double>(row);
    const double x = placeOf(ranks[order[i]]);
    const double end = leftSide ? start - 6 : placeOf(static_cast<double>(methods)) + 6;
    drawing.line(x, axis, x, y);
    drawing.line(x, y, end, y);
    const std::string label = ranking.methods[order[i]].method;
    drawing.text(leftSide ? end - 3 : end + 3, y + 3.5, label, 10, leftSide ? "end" : "start");
  }
  double barTop = axis + 7;
  std::size_t joined = 0;  // one past the last method of the bar before
  for (std::size_t i = 0; i < methods; ++i) {
    std::size_t last = i;
    while (last + 1 < methods && ranks[order[last + 1]] - ranks[order[i]] < difference) ++last;
    if (last == i || last + 1 <= joined) continue;
    joined = last + 1;
    drawing.line(placeOf(ranks[order[i]]) - 3, barTop, placeOf(ranks[order[last]]) + 3, barTop, 3.5);
    barTop += 6;
  }
}

std::string captionOf(const RankingTable& table) {
  return "At " + table.rule + ", group " + table.group + ", resolution " + std::to_string(table.resolution) + ", " +
         std::to_string(table.inputs.size()) + (table.inputs.size() == 1 ? " input" : " inputs");
}

void drawLegend(SvgDrawing& drawing, std::size_t places, double top) {
  double x = kMargin;
  drawing.text(x, top, "place:", 11, "start");
  x += 40;
  for (std::size_t place = 0; place < places; ++place) {
    drawing.rectangle(x, top - 10, 12, 12, colorOf(place, places), "");
    drawing.text(x + 16, top, std::to_string(place + 1), 11, "start");
    x += 40;
  }
  drawing.text(x + 10, top,
               "Bars: how often each method has each place. Below: mean ranks; joined methods do not differ "
               "significantly (Nemenyi, 0.05).",
               11, "start");
}

}  // namespace

std::string rankingsSvg(const Rankings& rankings) {
  SvgDrawing drawing;
  const double width = kPanelsPerRow * kPanelWidth + 2 * kMargin;
  drawing.text(kMargin, 26, "Rankings: " + rankings.experiment.name, 18, "start");
  const std::size_t places = rankings.experiment.methods.size();
  drawLegend(drawing, places, 48);
  double top = kMargin + kLegendHeight;
  for (const RankingTable& table : rankings.tables) {
    drawing.text(kMargin, top + 22, captionOf(table), 14, "start");
    top += kTitleHeight;
    for (std::size_t i = 0; i < table.criteria.size(); ++i) {
      const double left = kMargin + kPanelWidth * static_cast<double>(i % kPanelsPerRow);
      const double panelTop = top + kPanelHeight * static_cast<double>(i / kPanelsPerRow);
      drawing.text(left + 0.5 * kPanelWidth, panelTop + 12, table.criteria[i].criterion, 13);
      drawBars(drawing, table.criteria[i], places, left, panelTop + 22);
      drawCriticalDifference(drawing, table.criteria[i], left, panelTop + 22 + kBarHeight + 50);
    }
    const std::size_t rows = (table.criteria.size() + kPanelsPerRow - 1) / kPanelsPerRow;
    top += kPanelHeight * static_cast<double>(rows);
  }
  return drawing.document(width, top + kMargin);
}

}  // namespace voroform::pipeline
