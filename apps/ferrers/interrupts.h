#pragma once

#include <atomic>

/// Set when the user asks to end: by SIGINT or SIGTERM after `catch_interrupts`, or by the command itself.
extern std::atomic<bool> stop_asked;

/// The first SIGINT or SIGTERM asks what runs to end after its step, the second one kills.
void catch_interrupts();
