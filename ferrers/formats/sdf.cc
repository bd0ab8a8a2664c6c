#include "ferrers/formats/sdf.h"

namespace ferrers {

ImportedModel read_sdf(std::string_view, const ImportContext& context) {
  context.diagnostics.error("F602", {}, "SDF is not read yet");
  return {};
}

}  // namespace ferrers
