#include "ferrers/io/schema.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <memory>

#include "exit_code.h"
#include "terminal.h"
#include "verbs.h"

void add_schema(CLI::App& command, Job& job) {
  auto json = std::make_shared<bool>(true);
  CLI::App* verb = command.add_subcommand("schema", "the JSON Schema of the model file");
  verb->add_flag("--json", *json, "the schema is JSON in any case");
  verb->footer("Example:\n  ferrers schema > ferrers-model.schema.json");
  verb->callback([json, &job] {
    job = [] {
      print(stdout, ferrers::model_schema_json());
      return static_cast<int>(kExitDone);
    };
  });
}
