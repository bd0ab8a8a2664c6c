#pragma once

#include <span>
#include <string_view>

/// A model file of the examples folder, embedded when the command is built.
struct EmbeddedExample {
  std::string_view name, title, text;
};

std::span<const EmbeddedExample> embedded_examples();
