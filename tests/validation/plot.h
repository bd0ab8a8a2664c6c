#pragma once

#include <map>
#include <string>
#include <vector>

namespace ferrers::validation {

/// A plot with logarithmic axes, as SVG.
class Plot {
 public:
  Plot(std::string title, std::string x, std::string y)
      : title_(std::move(title)), x_(std::move(x)), y_(std::move(y)) {}
  void add(const std::string& series, double x, double y);
  std::string svg() const;

 private:
  std::string title_, x_, y_;
  std::vector<std::string> order_;
  std::map<std::string, std::vector<std::pair<double, double>>> series_;
};

}  // namespace ferrers::validation
