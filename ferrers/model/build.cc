#include <utility>

#include "ferrers/model/build_internal.h"

namespace ferrers {

ModelAssembler::ModelAssembler(std::shared_ptr<const ModelSpec> spec, std::map<std::string, double> overrides)
    : whole_spec_(spec), spec_(std::move(spec)), overrides_(std::move(overrides)) {}

ModelBuildResult ModelAssembler::build() {
  static const NameRef kModel("the model");
  model_.name_ = spec_->name;
  index_names();
  build_parameters();
  model_.gravity_ = vector(spec_->gravity, kAcceleration, {"gravity", kModel});
  build_bodies();
  merge_welded_parts();
  build_joints();
  build_coordinates();
  build_meshes();
  check_bodies_have_joints();
  build_records();
  build_couplings();
  build_constraints();
  build_lagrangian();
  build_forces();
  build_recorded_formulas();
  build_drives();
  build_motions();
  build_initial();
  build_events();
  put_groups_together();
  ModelBuildResult result;
  result.diagnostics = std::move(diagnostics_);
  if (result.diagnostics.has_errors()) return result;
  model_.spec_ = std::move(whole_spec_);
  model_.overrides_ = std::move(overrides_);
  result.model = std::move(model_);
  return result;
}

ModelBuildResult build_model(ModelSpec spec, const std::map<std::string, double>& parameter_values) {
  return ModelAssembler(std::make_shared<const ModelSpec>(std::move(spec)), parameter_values).build();
}

ModelBuildResult Model::with_parameters(const std::map<std::string, double>& values) const {
  std::map<std::string, double> merged = overrides_;
  for (const auto& [name, value] : values) merged[name] = value;
  return ModelAssembler(spec_, std::move(merged)).build();
}

}  // namespace ferrers
