#include "progress_bar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "terminal.h"

ProgressBar::ProgressBar() : shown_(is_terminal(stderr)) {}

ProgressBar::~ProgressBar() {
  if (drawn_) print(stderr, "\r\033[K");
}

void ProgressBar::draw(double done, std::string_view text) {
  next_ = Clock::now() + std::chrono::milliseconds(100);
  const int cells = static_cast<int>(std::min(1.0, std::max(0.0, done)) * 40);
  print(stderr,
        fmt::format("\r\033[K  [{:=<{}}{:<{}}] {}, Ctrl-C keeps what is done", "", cells, "", 40 - cells, text));
  std::fflush(stderr);
  drawn_ = true;
}
