#pragma once

#include "ferrers/formats/asmt_assembly.h"
#include "ferrers/formats/asmt_joints.h"

namespace ferrers {

/// Reads `Motions` into drives, and `Limits` into limits of joints.
void read_asmt_motions(const AsmtRecord& constraint_sets, const AsmtJoints& joints, AsmtImport& import);
void read_asmt_limits(const AsmtRecord& constraint_sets, const AsmtJoints& joints, AsmtImport& import);

}  // namespace ferrers
