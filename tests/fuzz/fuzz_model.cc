// Any bytes as a model file: whatever they are, reading ends in a model or in reasons, without an exception, and every
// model that was read can be laid out for evaluation.

#include <cstdint>
#include <cstdlib>
#include <string>
#include <utility>

#include "ferrers/io/model_reader.h"
#include "ferrers/kinematics/system.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  ferrers::ModelReadResult result = ferrers::read_model_text(text, "fuzzed.yaml");
  if (result.model.has_value() == result.diagnostics.has_errors()) std::abort();
  for (const ferrers::Diagnostic& one : result.diagnostics.items()) {
    if (ferrers::format_diagnostic(one, "fuzzed.yaml", result.source).empty()) std::abort();
  }
  if (result.model && ferrers::make_system(std::move(*result.model)) == nullptr) std::abort();
  return 0;
}
