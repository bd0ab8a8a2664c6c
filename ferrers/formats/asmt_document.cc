#include "ferrers/formats/asmt_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "ferrers/io/source_text.h"

namespace ferrers {
namespace {

constexpr int kDeepest = 64;
constexpr std::string_view kSpace = " \t\r";

struct Line {
  std::string_view text;
  std::size_t offset = 0;
  int depth = 0;
  int parent = -1;
  std::vector<int> children;
  mutable bool read = false;
};

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpace) + 1 - begin);
}

}  // namespace

struct AsmtDocument::Contents {
  explicit Contents(std::string_view text) : source(text) {}

  SourceText source;
  std::vector<Line> lines;  ///< Each before those below it.
  std::vector<int> top;
  std::vector<int> open;  ///< By depth, the last line there.

  bool add(std::string_view raw, std::size_t offset, Diagnostics& diagnostics);
};

/// False where the line does not fit the lines before it.
bool AsmtDocument::Contents::add(std::string_view raw, std::size_t offset, Diagnostics& diagnostics) {
  const std::size_t tabs = std::min(raw.find_first_not_of('\t'), raw.size());
  Line line;
  line.text = trimmed(raw);
  line.depth = static_cast<int>(std::min<std::size_t>(tabs, kDeepest + 1));
  line.offset = line.text.empty() ? offset + tabs : offset + static_cast<std::size_t>(line.text.data() - raw.data());
  const int reached = static_cast<int>(open.size());
  if (line.text.empty() && (line.depth == 0 || line.depth != reached)) return true;  // nothing stands here
  if (line.depth > kDeepest) {
    diagnostics.error("F108", source.range(line.offset, 1),
                      fmt::format("lines are nested more than {} deep", kDeepest));
    return false;
  }
  if (!line.text.empty() && raw[tabs] == ' ') {
    diagnostics.error("F605", source.range(offset + tabs, line.offset - offset - tabs),
                      "spaces stand before a line, whose depth is told by tabs", "indent with one tab for each level");
    return false;
  }
  if (line.depth > reached) {
    diagnostics.error("F605", source.range(line.offset, line.text.size()),
                      fmt::format("'{}' stands {} tabs deep, but the line above it {}", line.text.substr(0, 40),
                                  line.depth, reached - 1),
                      "a line is at most one tab deeper than the line above");
    return false;
  }
  const int index = static_cast<int>(lines.size());
  open.resize(static_cast<std::size_t>(line.depth));
  if (open.empty()) {
    top.push_back(index);
  } else {
    line.parent = open.back();
    lines[static_cast<std::size_t>(line.parent)].children.push_back(index);
  }
  open.push_back(index);
  lines.push_back(std::move(line));
  return true;
}

AsmtDocument::AsmtDocument() = default;
AsmtDocument::~AsmtDocument() = default;

std::unique_ptr<const AsmtDocument> AsmtDocument::parse(std::string_view text, Diagnostics& diagnostics) {
  if (trimmed(text.substr(0, text.find_last_not_of(" \t\r\n") + 1)).empty()) {
    diagnostics.error("F103", {}, "the file is empty");
    return nullptr;
  }
  std::unique_ptr<AsmtDocument> document(new AsmtDocument());
  document->contents_ = std::make_unique<Contents>(text);
  Contents& contents = *document->contents_;
  if (!check_characters(contents.source, diagnostics)) return nullptr;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (!contents.add(text.substr(begin, end - begin), begin, diagnostics)) return nullptr;
    begin = end + 1;
  }
  return document;
}

std::vector<AsmtRecord> AsmtDocument::top() const {
  std::vector<AsmtRecord> all;
  for (const int index : contents_->top) all.push_back(AsmtRecord(this, index));
  return all;
}

void AsmtDocument::report_unread(Diagnostics& diagnostics) const {
  std::map<std::pair<std::string_view, std::string_view>, std::pair<SourceRange, int>> unread;
  std::vector<bool> told(contents_->lines.size(), false);  // or stands in what was told
  for (std::size_t i = 0; i < contents_->lines.size(); ++i) {
    const Line& line = contents_->lines[i];
    const bool in_told = line.parent >= 0 && told[static_cast<std::size_t>(line.parent)];
    if (in_told || line.read || line.text.empty()) {
      told[i] = in_told;
      continue;
    }
    told[i] = true;
    const std::string_view in =
        line.parent < 0 ? std::string_view("the file") : contents_->lines[static_cast<std::size_t>(line.parent)].text;
    const SourceRange at = contents_->source.range(line.offset, line.text.size());
    ++unread.try_emplace({line.text, in}, at, 0).first->second.second;
  }
  for (const auto& [what, where] : unread) {
    diagnostics.notice("F601", where.first,
                       fmt::format("'{}' in '{}' is not read{}", what.first.substr(0, 60), what.second.substr(0, 60),
                                   where.second > 1 ? fmt::format(", nor are {} more like it", where.second - 1) : ""));
  }
}

std::string_view AsmtRecord::name() const { return document_->contents_->lines[static_cast<std::size_t>(index_)].text; }

SourceRange AsmtRecord::at() const {
  const Line& line = document_->contents_->lines[static_cast<std::size_t>(index_)];
  return document_->contents_->source.range(line.offset, std::max<std::size_t>(line.text.size(), 1));
}

AsmtRecord AsmtRecord::child(std::string_view name) const {
  for (const AsmtRecord& one : children()) {
    if (one.name() != name) continue;
    one.mark_read();
    return one;
  }
  return {};
}

std::vector<AsmtRecord> AsmtRecord::children() const {
  std::vector<AsmtRecord> all;
  for (const int child : document_->contents_->lines[static_cast<std::size_t>(index_)].children) {
    all.push_back(AsmtRecord(document_, child));
  }
  return all;
}

std::vector<AsmtRecord> AsmtRecord::values() const {
  std::vector<AsmtRecord> all;
  for (const AsmtRecord& one : children()) {
    one.mark_read();
    if (!one.name().empty()) all.push_back(one);
  }
  return all;
}

bool AsmtRecord::empty() const {
  const std::vector<AsmtRecord> below = children();
  return std::all_of(below.begin(), below.end(), [](const AsmtRecord& one) { return one.name().empty(); });
}

std::string_view AsmtRecord::value(Diagnostics& diagnostics) const {
  const std::vector<AsmtRecord> all = values();
  if (all.empty()) return {};
  if (all.size() > 1) {
    diagnostics.error("F605", all[1].at(), fmt::format("'{}' has more than one value", name()));
  }
  return all.front().name();
}

SourceRange AsmtRecord::value_at() const {
  for (const AsmtRecord& one : children()) {
    if (!one.name().empty()) return one.at();
  }
  return at();
}

void AsmtRecord::mark_read() const { document_->contents_->lines[static_cast<std::size_t>(index_)].read = true; }

void AsmtRecord::mark_read_with_all() const {
  mark_read();
  for (const AsmtRecord& one : children()) one.mark_read_with_all();
}

}  // namespace ferrers
