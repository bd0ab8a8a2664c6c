#include "ferrers/io/run_folder.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <fstream>
#include <memory>
#include <system_error>

#include "ferrers/core/checks.h"
#include "ferrers/io/csv_file.h"
#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kFullBuffer = std::size_t{1} << 16U;
constexpr std::chrono::milliseconds kLongestDelay{100};

constexpr std::array<std::string_view, 1> kMultiplier = {"multiplier"};

}  // namespace

struct RunFolder::Files {
  CsvFile result, reactions;
  std::vector<std::vector<std::string>> cells;  ///< ",joint,component," of every joint and coupling.
  std::size_t columns = 0;
  bool with_ranges = false;
  Clock::time_point last_flush = Clock::now();
  long rows = 0;

  void flush() {
    result.flush();
    reactions.flush();
    last_flush = Clock::now();
  }
};

RunFolder::RunFolder() = default;

RunFolder::~RunFolder() { close(); }

bool RunFolder::is_open() const { return files_ != nullptr; }

long RunFolder::rows() const { return files_ != nullptr ? files_->rows : 0; }

std::string RunFolder::open(const fs::path& folder, const std::vector<std::string>& columns,
                            const ReactionNames& reactions, bool with_ranges) {
  require(files_ == nullptr, "RunFolder::open: open already");
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (!fs::is_directory(folder, failed)) return fmt::format("the folder '{}' cannot be made", folder.string());
  for (const char* name : {"summary.json", "result.csv", "reactions.csv"}) fs::remove(folder / name, failed);

  auto files = std::make_unique<Files>();
  if (std::string error = files->result.open(folder / "result.csv"); !error.empty()) return error;
  files->columns = columns.size();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (i > 0) files->result.buffer().push_back(',');
    append_cell(files->result.buffer(), columns[i]);
  }
  files->result.buffer().push_back('\n');
  if (!reactions.joints.empty() || !reactions.couplings.empty()) {
    if (std::string error = files->reactions.open(folder / "reactions.csv"); !error.empty()) return error;
    files->with_ranges = with_ranges;
    append_text(files->reactions.buffer(), "t,joint,component,value,status");
    append_text(files->reactions.buffer(), with_ranges ? ",low,high\n" : "\n");
    const auto add = [&files](const std::string& owner, std::span<const std::string_view> components) {
      fmt::memory_buffer name;
      append_cell(name, owner);
      std::vector<std::string>& cells = files->cells.emplace_back();
      for (const std::string_view one : components) cells.push_back(fmt::format(",{},{},", fmt::to_string(name), one));
    };
    for (const std::string& joint : reactions.joints) add(joint, kComponentNames);
    for (const std::string& coupling : reactions.couplings) add(coupling, kMultiplier);
  }
  files->flush();
  files_ = std::move(files);
  return "";
}

void RunFolder::add(const RunSample& sample) {
  require(files_ != nullptr, "RunFolder::add: not open");
  require_size(static_cast<long>(sample.values.size()), static_cast<long>(files_->columns), "RunFolder::add");
  fmt::memory_buffer& row = files_->result.buffer();
  for (std::size_t i = 0; i < sample.values.size(); ++i) {
    if (i > 0) row.push_back(',');
    append_number(row, sample.values[i]);
  }
  row.push_back('\n');
  if (files_->reactions.is_open() && !sample.reactions.empty()) {
    require_size(static_cast<long>(sample.reactions.size()), static_cast<long>(files_->cells.size()),
                 "RunFolder::add: reactions");
    fmt::memory_buffer time;
    append_number(time, sample.t);
    fmt::memory_buffer& out = files_->reactions.buffer();
    for (std::size_t joint = 0; joint < sample.reactions.size(); ++joint) {
      const JointReaction& reaction = sample.reactions[joint];
      for (std::size_t i = 0; i < files_->cells[joint].size(); ++i) {
        append_text(out, {time.data(), time.size()});
        append_text(out, files_->cells[joint][i]);
        const bool known = reaction.status[i] != ReactionStatus::kUndetermined;
        if (known) append_number(out, reaction.value[i]);
        out.push_back(',');
        append_text(out, to_string(reaction.status[i]));
        if (files_->with_ranges) {
          for (const double end : {reaction.low[i], reaction.high[i]}) {
            out.push_back(',');
            if (known) append_number(out, end);
          }
        }
        out.push_back('\n');
      }
    }
  }
  ++files_->rows;
  if (files_->result.buffer().size() + files_->reactions.buffer().size() > kFullBuffer) {
    files_->flush();
  } else {
    flush_if_due();
  }
}

void RunFolder::flush_if_due() {
  if (files_ != nullptr && Clock::now() - files_->last_flush >= kLongestDelay) files_->flush();
}

std::string RunFolder::close() {
  if (files_ == nullptr) return "";
  const std::string first = files_->result.close();
  const std::string second = files_->reactions.close();
  files_.reset();
  return first.empty() ? second : first;
}

std::string write_file_whole(const fs::path& file, std::string_view text) {
  fs::path part = file;
  part += ".part";
  std::error_code failed;
  {
    std::ofstream out(part, std::ios::binary | std::ios::trunc);
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    out.close();
    if (!out) {
      fs::remove(part, failed);
      return fmt::format("'{}' cannot be written", file.string());
    }
  }
  fs::rename(part, file, failed);
  if (!failed) return "";
  const std::string reason = failed.message();
  fs::remove(part, failed);
  return fmt::format("'{}' cannot be written: {}", file.string(), reason);
}

}  // namespace ferrers
