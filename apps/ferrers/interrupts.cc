#include "interrupts.h"

#include <signal.h>

std::atomic<bool> stop_asked{false};  // the one thing that a signal handler may touch

extern "C" {
static void ask_to_stop(int) { stop_asked = true; }
}

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = ask_to_stop;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}
