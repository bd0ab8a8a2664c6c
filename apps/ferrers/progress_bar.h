#pragma once

#include <chrono>
#include <string_view>

/// A bar on stderr, only on a terminal, only for what takes longer than half a second.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Whether it is time to draw again; asking costs next to nothing where there is no bar.
  bool is_due() const { return shown_ && Clock::now() >= next_; }
  /// `done`: from 0 to 1, what is outside is taken as the nearer end.
  void draw(double done, std::string_view text);

 private:
  using Clock = std::chrono::steady_clock;
  bool shown_, drawn_ = false;
  Clock::time_point next_ = Clock::now() + std::chrono::milliseconds(500);
};
