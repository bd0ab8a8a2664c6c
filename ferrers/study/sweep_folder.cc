#include "ferrers/study/sweep_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <system_error>

#include "ferrers/core/checks.h"
#include "ferrers/io/csv_file.h"

namespace ferrers {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 4> kBefore = {"status", "rank", "mobility", "redundant"};
constexpr std::array<std::string_view, 7> kBehind = {"energy_start", "energy_end", "balance_error", "steps",
                                                     "evaluations",  "notices",    "message"};

template <class T>
bool is_number(const std::string& cell, T wanted) {
  T value{};
  const auto [end, code] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return code == std::errc() && end == cell.data() + cell.size() && value == wanted;
}

// A row is one line.
std::string on_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

}  // namespace

struct SweepFolder::File {
  CsvFile csv;
};

SweepFolder::SweepFolder(const ParameterTable& table, const std::vector<std::string>& columns)
    : table_(table), columns_(columns), file_(std::make_unique<File>()) {}

SweepFolder::~SweepFolder() { close(); }

std::string SweepFolder::header() const {
  fmt::memory_buffer out;
  append_text(out, "index");
  const auto add = [&out](std::string_view name) {
    out.push_back(',');
    append_cell(out, name);
  };
  for (const std::string& name : table_.names) add(name);
  for (const std::string_view name : kBefore) add(name);
  for (const std::string& name : columns_) add(name);
  for (const std::string_view name : kBehind) add(name);
  return fmt::to_string(out);
}

std::string SweepFolder::begin(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (!fs::is_directory(folder, failed)) return fmt::format("the folder '{}' cannot be made", folder.string());
  fs::remove(folder / "sweep.json", failed);  // of an earlier sweep
  if (std::string error = file_->csv.open(folder / "sweep.csv"); !error.empty()) return error;
  append_text(file_->csv.buffer(), header() + "\n");
  file_->csv.flush();
  rows_ = 0;
  return "";
}

std::string SweepFolder::check_row(const std::string& line, SweepTally& tally) const {
  const std::vector<std::string> cells = read_cells(line);
  const std::size_t n = table_.names.size();
  if (cells.size() != 1 + n + kBefore.size() + columns_.size() + kBehind.size()) return "has another number of cells";
  if (tally.count() >= table_.rows()) return fmt::format("is beyond the {} rows of the table", table_.rows());
  if (!is_number(cells[0], tally.count())) return fmt::format("is not that of variant {}", tally.count());
  for (std::size_t i = 0; i < n; ++i) {
    const double wanted = table_.row(tally.count())[i];
    if (!is_number(cells[1 + i], wanted)) {
      return fmt::format("has {} = {} where the table has {}", table_.names[i], cells[1 + i], wanted);
    }
  }
  tally.add(tally.count(), cells[1 + n], cells.back());
  return "";
}

std::string SweepFolder::go_on(const fs::path& folder, SweepTally& tally) {
  const fs::path path = folder / "sweep.csv";
  std::ifstream in(path, std::ios::binary);
  if (!in) return fmt::format("'{}' cannot be read", path.string());
  std::string line;
  if (!std::getline(in, line) || in.eof()) return fmt::format("'{}' has no header", path.string());
  if (line != header()) return fmt::format("the columns of '{}' are not those of this model and table", path.string());
  std::uintmax_t whole = line.size() + 1;
  for (int number = 2; std::getline(in, line) && !in.eof(); ++number) {  // a last line without an end is no row
    if (const std::string wrong = check_row(line, tally); !wrong.empty()) {
      return fmt::format("{}:{}: this row {}", path.string(), number, wrong);
    }
    whole += line.size() + 1;
  }
  in.close();
  std::error_code failed;
  fs::resize_file(path, whole, failed);
  if (failed) return fmt::format("'{}' cannot be written", path.string());
  rows_ = tally.count();
  return file_->csv.open(path, CsvFile::Mode::kGoOn);
}

void SweepFolder::add(const VariantResult& result) {
  require(result.index == rows_ && rows_ < table_.rows(), "SweepFolder::add: not the next variant");
  require(result.values.empty() || result.values.size() == columns_.size(), "SweepFolder::add: other columns");
  fmt::memory_buffer& out = file_->csv.buffer();
  const auto number = [&out](double value) {
    out.push_back(',');
    append_number(out, value);
  };
  const auto count = [&out](long value) { append_text(out, fmt::format(",{}", value)); };
  append_text(out, fmt::format("{}", result.index));
  for (const double value : table_.row(result.index)) number(value);
  append_text(out, fmt::format(",{}", variant_status_name(result)));
  if (result.decision) {
    for (const int value : {result.decision->rank, result.decision->mobility, result.decision->redundant}) count(value);
  } else {
    append_text(out, ",,,");
  }
  const bool known = !result.values.empty();
  for (const double value : result.values) number(value);
  if (!known) append_text(out, std::string(columns_.size(), ','));
  for (const double value : {result.energy_start, result.energy_end, result.balance_error}) {
    known ? number(value) : out.push_back(',');
  }
  for (const long value : {result.steps, result.evaluations, static_cast<long>(result.notices.size())}) count(value);
  out.push_back(',');
  append_cell(out, on_one_line(result.message));
  out.push_back('\n');
  file_->csv.flush();
  ++rows_;
}

bool SweepFolder::is_good() const { return file_->csv.is_good(); }

std::string SweepFolder::close() { return file_->csv.close(); }

}  // namespace ferrers
