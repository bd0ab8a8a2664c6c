#include "ferrers/core/diagnostics.h"

namespace ferrers {

const std::vector<DiagnosticCode>& diagnostic_codes() {
  // One line per code, sorted by code (tested). The first digit tells what is wrong: F1 the text of a file, F2 a value,
  // F3 the mechanism, F4 a formula.
  static const std::vector<DiagnosticCode> codes = {
      {"F101", "file cannot be read"},
      {"F102", "file too large"},
      {"F103", "file is empty"},
      {"F104", "file is no UTF-8"},
      {"F105", "byte order mark"},
      {"F106", "character that does not belong in a model file"},
      {"F107", "text cannot be read as YAML"},
      {"F108", "nested too deeply"},
      {"F109", "key stands twice"},
      {"F110", "more than one document in a file"},
      {"F111", "anchor, alias or merge key"},
      {"F112", "tag"},
      {"F113", "key is not a plain word"},
      {"F114", "directive"},
      {"F115", "tab in an indentation"},
      {"F201", "unknown key"},
      {"F202", "missing key"},
      {"F203", "wrong type of value"},
      {"F204", "wrong dimension"},
      {"F205", "unknown unit"},
      {"F206", "number not written as a decimal number"},
      {"F207", "number too large"},
      {"F208", "wrong number of entries in a list"},
      {"F209", "unknown choice"},
      {"F210", "not a name"},
      {"F211", "format version"},
      {"F212", "keys that exclude each other"},
      {"F213", "value is empty"},
      {"F214", "law file cannot be read"},
      {"F215", "law file outside the folder of the model"},
      {"F216", "content of a law file"},
      {"F217", "parameter set from outside"},
      {"F218", "field set from outside"},
      {"F219", "too many errors"},
      {"F401", "formula cannot be read"},
      {"F402", "unknown function in a formula"},
      {"F403", "unknown name in a formula"},
      {"F404", "wrong number of arguments"},
      {"F405", "formula too long or too deep"},
      {"F406", "number out of range in a formula"},
      {"F407", "unknown unit in a formula"},
      {"F408", "formula has no finite value"},
  };
  return codes;
}

}  // namespace ferrers
