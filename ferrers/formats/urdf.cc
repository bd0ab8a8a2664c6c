#include "ferrers/formats/urdf.h"

namespace ferrers {

ImportedModel read_urdf(std::string_view, const ImportContext& context) {
  context.diagnostics.error("F602", {}, "URDF is not read yet");
  return {};
}

}  // namespace ferrers
