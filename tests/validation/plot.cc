#include "plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ferrers::validation {
namespace {

constexpr int kLeft = 70, kTop = 40, kWidth = 430, kHeight = 320, kLegend = 230;
const char* const kColors[] = {"#1b6ca8", "#c0392b", "#2e8b57", "#8e44ad", "#b9770e",
                               "#5dade2", "#e59866", "#82c99a", "#c39bd3", "#7f8c8d"};

}  // namespace

void Plot::add(const std::string& series, double x, double y) {
  if (!series_.contains(series)) order_.push_back(series);
  series_[series].emplace_back(x, y);
}

std::string Plot::svg() const {
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
  for (const auto& [name, points] : series_) {
    for (const auto& [x, y] : points) {
      low[0] = std::min(low[0], std::floor(std::log10(x)));
      high[0] = std::max(high[0], std::ceil(std::log10(x)));
      low[1] = std::min(low[1], std::floor(std::log10(y)));
      high[1] = std::max(high[1], std::ceil(std::log10(y)));
    }
  }
  for (int i = 0; i < 2; ++i) high[i] = std::max(high[i], low[i] + 1);
  const auto at_x = [&](double x) { return kLeft + kWidth * (std::log10(x) - low[0]) / (high[0] - low[0]); };
  const auto at_y = [&](double y) { return kTop + kHeight * (high[1] - std::log10(y)) / (high[1] - low[1]); };
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"12\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"{}\" y=\"22\" font-size=\"15\">{}</text>\n",
      kLeft + kWidth + kLegend, kTop + kHeight + 50, kLeft, title_);
  for (int e = static_cast<int>(low[0]); e <= static_cast<int>(high[0]); ++e) {
    const double x = at_x(std::pow(10.0, e));
    out += fmt::format(
        "<path d=\"M{0:.1f} {1}V{2}\" stroke=\"#ddd\"/><text x=\"{0:.1f}\" y=\"{3}\" "
        "text-anchor=\"middle\">1e{4}</text>\n",
        x, kTop, kTop + kHeight, kTop + kHeight + 16, e);
  }
  for (int e = static_cast<int>(low[1]); e <= static_cast<int>(high[1]); e += 2) {
    const double y = at_y(std::pow(10.0, e));
    out += fmt::format(
        "<path d=\"M{0} {1:.1f}H{2}\" stroke=\"#ddd\"/><text x=\"{3}\" y=\"{4:.1f}\" "
        "text-anchor=\"end\">1e{5}</text>\n",
        kLeft, y, kLeft + kWidth, kLeft - 6, y + 4, e);
  }
  out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", kLeft + kWidth / 2,
                     kTop + kHeight + 36, x_);
  out += fmt::format("<text transform=\"translate(18 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                     kTop + kHeight / 2, y_);
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const char* color = kColors[i % std::size(kColors)];
    std::string path;
    for (const auto& [x, y] : series_.at(order_[i])) {
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", at_x(x), at_y(y));
      out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", at_x(x), at_y(y), color);
    }
    const bool fixed = order_[i].ends_with("fixed");
    out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"{}/>\n", path, color,
                       fixed ? " stroke-dasharray=\"5 3\"" : "");
    const double y = kTop + 12 + 18.0 * static_cast<double>(i);
    out += fmt::format(
        "<path d=\"M{} {:.1f}h22\" stroke=\"{}\" stroke-width=\"2\"{}/><text x=\"{}\" y=\"{:.1f}\">{}</text>\n",
        kLeft + kWidth + 14, y, color, fixed ? " stroke-dasharray=\"5 3\"" : "", kLeft + kWidth + 42, y + 4, order_[i]);
  }
  return out + "</svg>\n";
}

}  // namespace ferrers::validation
