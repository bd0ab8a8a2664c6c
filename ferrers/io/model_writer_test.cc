#include "ferrers/io/model_writer.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "ferrers/io/document.h"
#include "ferrers/io/fields.h"
#include "ferrers/io/model_reader.h"

namespace ferrers {
namespace {

namespace fs = std::filesystem;

const fs::path kModels = fs::path(FERRERS_SOURCE_DIR) / "tests" / "models";

ModelReadResult read_back(const std::string& text) {
  ReadModelOptions options;
  options.folder = kModels;
  return read_model_text(text, "written.yaml", options);
}

void collect_keys(const DocumentNode& node, std::set<std::string>& keys) {
  for (const DocumentNode& item : node.items) collect_keys(item, keys);
  for (const DocumentEntry& entry : node.entries) {
    keys.insert(entry.key);
    collect_keys(entry.value, keys);
  }
}

TEST(ModelWriterTest, WhatIsWrittenReadsBackAndIsWrittenTheSame) {
  const ModelReadResult original = read_model_file(kModels / "every_field.yaml");
  ASSERT_TRUE(original.model.has_value());
  const std::string written = write_model(original.spec);
  const ModelReadResult again = read_back(written);
  ASSERT_TRUE(again.model.has_value()) << written;
  EXPECT_EQ(write_model(again.spec), written);
}

TEST(ModelWriterTest, NoKeyOfTheTableIsLost) {
  const ModelReadResult original = read_model_file(kModels / "every_field.yaml");
  Diagnostics diagnostics;
  std::set<std::string> keys;
  collect_keys(*parse_document(write_model(original.spec), diagnostics), keys);
  // What is written in another way: gears as linear couplings, the joint's coordinate behind a dot. A kinetic energy
  // excludes the mass matrix: it is in the examples below.
  const std::set<std::string_view> otherwise = {"ratio", "kinetic_energy"};
  for (const ObjectFamily& family : object_families()) {
    for (const ObjectType& type : family.types) {
      for (const FieldInfo& field : type.fields) {
        if (otherwise.count(field.key) > 0) continue;
        EXPECT_TRUE(keys.count(std::string(field.key)) > 0) << family.name << " " << field.key;
      }
    }
  }
}

TEST(ModelWriterTest, SystemsByFormulasReadBackAndAreWrittenTheSame) {
  for (const char* name : {"andrews-angles", "four-bar-angles", "four-bar-points", "cranks-in-plane", "rolling-disk",
                           "watt-curve", "cam-lift"}) {
    const ModelReadResult original = read_model_file(fs::path(FERRERS_SOURCE_DIR) / "examples" / name / "model.yaml");
    ASSERT_TRUE(original.model.has_value()) << name;
    const std::string written = write_model(original.spec);
    const ModelReadResult again = read_back(written);
    ASSERT_TRUE(again.model.has_value()) << written;
    EXPECT_EQ(write_model(again.spec), written);
    ASSERT_EQ(again.model->couplings().size(), original.model->couplings().size());
    for (std::size_t i = 0; i < again.model->couplings().size(); ++i) {
      const Coupling& a = original.model->couplings()[i];
      const Coupling& b = again.model->couplings()[i];
      ASSERT_TRUE(a.relation && b.relation);
      EXPECT_EQ(a.name, b.name);
      EXPECT_EQ(a.relation->on_velocities, b.relation->on_velocities);
      EXPECT_EQ(a.relation->residual.to_string(), b.relation->residual.to_string());
    }
    EXPECT_EQ(again.model->lagrangian().kinetic.to_string(), original.model->lagrangian().kinetic.to_string());
    EXPECT_EQ(again.model->lagrangian().potential.to_string(), original.model->lagrangian().potential.to_string());
  }
}

TEST(ModelWriterTest, TheModelBuiltFromItHasTheSameNumbers) {
  const ModelReadResult original = read_model_file(kModels / "every_field.yaml");
  const ModelReadResult again = read_back(write_model(original.spec));
  ASSERT_TRUE(original.model && again.model);
  ASSERT_EQ(again.model->bodies().size(), original.model->bodies().size());
  for (std::size_t i = 0; i < original.model->bodies().size(); ++i) {
    const Body& a = original.model->bodies()[i];
    const Body& b = again.model->bodies()[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.mass_kg, b.mass_kg) << a.name;
    EXPECT_TRUE(a.com_m.isApprox(b.com_m, 1e-15) || a.com_m == b.com_m) << a.name;
    EXPECT_TRUE(a.inertia_kgm2.isApprox(b.inertia_kgm2, 1e-14) || a.inertia_kgm2 == b.inertia_kgm2) << a.name;
    EXPECT_TRUE(a.X_WB.R.isApprox(b.X_WB.R, 1e-15)) << a.name;
  }
  ASSERT_EQ(again.model->joints().size(), original.model->joints().size());
  for (std::size_t i = 0; i < original.model->joints().size(); ++i) {
    const Joint& a = original.model->joints()[i];
    const Joint& b = again.model->joints()[i];
    EXPECT_EQ(a.type, b.type);
    EXPECT_TRUE(a.X_1F.R.isApprox(b.X_1F.R, 1e-15) && a.X_2M.R.isApprox(b.X_2M.R, 1e-15)) << a.name;
    EXPECT_EQ(a.drawn, b.drawn) << a.name;
    EXPECT_EQ(a.limits, b.limits) << a.name;
    EXPECT_EQ(a.stiffness.has_value(), b.stiffness.has_value()) << a.name;
  }
  ASSERT_EQ(again.model->couplings().size(), 6U);
  EXPECT_EQ(again.model->couplings()[0].coefficients, original.model->couplings()[0].coefficients);
  EXPECT_EQ(again.model->forces().size(), original.model->forces().size());
  EXPECT_EQ(again.model->drives().size(), original.model->drives().size());
  EXPECT_EQ(again.model->initial().size(), original.model->initial().size());
}

TEST(ModelWriterTest, FormulasAndUnitsOfParametersStay) {
  const ModelReadResult original = read_model_file(kModels / "every_field.yaml");
  const ModelReadResult again = read_back(write_model(original.spec));
  ASSERT_EQ(again.spec.parameters.size(), original.spec.parameters.size());
  for (std::size_t i = 0; i < original.spec.parameters.size(); ++i) {
    const ParameterSpec& a = original.spec.parameters[i];
    const ParameterSpec& b = again.spec.parameters[i];
    EXPECT_EQ(a.value.value, b.value.value) << a.name.name;
    EXPECT_EQ(a.dimension, b.dimension) << a.name.name;
    EXPECT_EQ(a.value.expression.has_value(), b.value.expression.has_value()) << a.name.name;
    EXPECT_EQ(a.doc, b.doc);
  }
}

TEST(ModelWriterTest, TextsWithQuotesAndLineEndsReadBack) {
  ModelSpec spec;
  spec.name = "a \"b\" \\ 'c': # {d}\n\xC3\xA9\t%";
  EXPECT_EQ(read_back(write_model(spec)).spec.name, spec.name);
}

TEST(ModelWriterTest, EveryExampleReadsBackTheSame) {
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(FERRERS_SOURCE_DIR) / "examples")) {
    if (entry.path().extension() != ".yaml") continue;
    const ModelReadResult original = read_model_file(entry.path());
    EXPECT_TRUE(original.model.has_value()) << entry.path();
    const std::string written = write_model(original.spec);
    ReadModelOptions options;
    options.folder = entry.path().parent_path();
    const ModelReadResult again = read_model_text(written, "written.yaml", options);
    EXPECT_TRUE(again.model.has_value()) << written;
    EXPECT_EQ(write_model(again.spec), written) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace ferrers
