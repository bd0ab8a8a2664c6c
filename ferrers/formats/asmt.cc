#include "ferrers/formats/asmt.h"

namespace ferrers {

ImportedModel read_asmt(std::string_view, const ImportContext& context) {
  context.diagnostics.error("F602", {}, "ASMT is not read yet");
  return {};
}

}  // namespace ferrers
