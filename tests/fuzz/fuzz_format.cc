// Any bytes as a file of another program; FERRERS_FUZZ_FORMAT, an enumerator of ModelFormat, chooses the reader.
// Whatever they are, reading ends in a model or in reasons, without an exception, and every model that was read can be
// laid out for evaluation. What follows the first form feed is the text of every further file that the model names.

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include "ferrers/formats/formats.h"
#include "ferrers/kinematics/system.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t cut = bytes.find('\f');
  const std::string text = bytes.substr(0, cut);
  const ferrers::FileLoader load = [&](const std::string&) -> std::optional<std::string> {
    if (cut == std::string::npos) return std::nullopt;
    return bytes.substr(cut + 1);
  };
  ferrers::ImportOptions import;
  if (cut != std::string::npos) import.closures = "closures.yaml";  // URDF alone asks for it
  ferrers::ModelFile file =
      ferrers::read_any_model_text(text, "fuzzed", ferrers::ModelFormat::FERRERS_FUZZ_FORMAT, load, {}, import);
  if (file.read.model.has_value() == file.read.diagnostics.has_errors()) std::abort();
  for (const ferrers::Diagnostic& one : file.read.diagnostics.items()) {
    if (ferrers::format_diagnostic(one, "fuzzed", file.read.source).empty()) std::abort();
  }
  if (file.read.model && ferrers::make_system(std::move(*file.read.model)) == nullptr) std::abort();
  return 0;
}
