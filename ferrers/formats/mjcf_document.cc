#include "ferrers/formats/mjcf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

namespace ferrers::mjcf {
namespace {

constexpr int kDeepest = 200;
constexpr std::size_t kMostFiles = 100;

}  // namespace

const XmlElement& Element::xml() const { return document_->nodes_[static_cast<std::size_t>(index_)].xml; }

std::vector<Element> Element::children() const {
  std::vector<Element> all;
  for (const int child : document_->nodes_[static_cast<std::size_t>(index_)].children) {
    all.push_back({document_, child});
  }
  return all;
}

std::vector<Element> Element::children(std::string_view name) const {
  std::vector<Element> found;
  for (const Element& one : children()) {
    if (one.name() != name) continue;
    one.mark_read();
    found.push_back(one);
  }
  return found;
}

void Element::mark_read_with_all() const {
  xml().mark_read_with_all();
  for (const Element& one : children()) one.mark_read_with_all();
}

SourceRange Element::main_at() const {
  const int file = document_->nodes_[static_cast<std::size_t>(index_)].file;
  return file == 0 ? at() : document_->files_[static_cast<std::size_t>(file)]->included_at;
}

Diagnostics& Element::diagnostics() const {
  const int file = document_->nodes_[static_cast<std::size_t>(index_)].file;
  return document_->files_[static_cast<std::size_t>(file)]->diagnostics;
}

std::unique_ptr<Document> Document::load(std::string_view text, const ImportContext& context) {
  std::unique_ptr<Document> document(new Document());
  document->load_ = &context.load;
  if (document->add_file("", {}, text)) document->add(document->files_[0]->xml->root(), 0, 1);
  if (!document->failed_) return document;
  document->flush(context.diagnostics);
  return nullptr;
}

bool Document::add_file(std::string name, SourceRange included_at, std::string_view text) {
  auto file = std::make_unique<File>();
  file->name = std::move(name);
  file->included_at = included_at;
  file->xml = XmlDocument::parse(text, file->diagnostics);
  const bool good = file->xml != nullptr;
  failed_ = failed_ || !good;
  files_.push_back(std::move(file));
  return good;
}

int Document::add(const XmlElement& xml, int file, int depth) {
  const int node = static_cast<int>(nodes_.size());
  nodes_.push_back({xml, file, {}});
  add_children(xml, file, depth, node);
  return node;
}

void Document::add_children(const XmlElement& xml, int file, int depth, int node) {
  if (depth > kDeepest) {
    files_[static_cast<std::size_t>(file)]->diagnostics.error(
        "F108", xml.at(), fmt::format("with what is included elements are nested more than {} deep", kDeepest));
    failed_ = true;
    return;
  }
  for (const XmlElement& child : xml.children()) {
    if (failed_) return;
    if (child.name() == "include") {
      include(child, file, depth, node);
    } else {
      const int added = add(child, file, depth + 1);
      nodes_[static_cast<std::size_t>(node)].children.push_back(added);
    }
  }
}

/// The children of the other file's root stand in place of the <include>.
void Document::include(const XmlElement& xml, int file, int depth, int node) {
  xml.mark_read();
  Diagnostics& diagnostics = files_[static_cast<std::size_t>(file)]->diagnostics;
  const std::string name(xml.attribute("file").value_or(""));
  const SourceRange at = xml.attribute_at("file");
  const bool again = std::any_of(files_.begin(), files_.end(),
                                 [&](const std::unique_ptr<File>& other) { return other->name == name; });
  if (name.empty()) {
    diagnostics.error("F202", xml.at(), "<include> does not name a 'file'");
  } else if (again) {
    diagnostics.error("F605", at, fmt::format("'{}' is included twice", name), "MuJoCo includes a file once at most");
  } else if (files_.size() > kMostFiles) {
    diagnostics.error("F605", at, fmt::format("more than {} files are included", kMostFiles));
  } else if (const std::optional<std::string> text = (*load_)(name); !text) {
    diagnostics.error("F606", at, fmt::format("the included file '{}' cannot be read", name),
                      "it is looked for in the folder of the model and below");
  } else {
    const SourceRange main_at = file == 0 ? xml.at() : files_[static_cast<std::size_t>(file)]->included_at;
    if (!add_file(name, main_at, *text)) return;
    const XmlElement root = files_.back()->xml->root();
    for (const std::string_view unused : root.attribute_names()) root.attribute(unused);
    return add_children(root, static_cast<int>(files_.size()) - 1, depth, node);
  }
  failed_ = true;
}

void Document::report_unread(std::span<const std::string_view> quiet) {
  for (const std::unique_ptr<File>& file : files_) file->xml->report_unread(file->diagnostics, quiet);
}

void Document::flush(Diagnostics& diagnostics) const {
  for (const std::unique_ptr<File>& file : files_) {
    std::set<std::tuple<int, int, std::string, std::string>> told;
    for (Diagnostic one : file->diagnostics.items()) {
      if (!told.insert({one.at.line, one.at.column, one.code, one.message}).second) continue;
      if (!file->name.empty()) {
        one.message += fmt::format(" (line {}, column {} of '{}')", one.at.line, one.at.column, file->name);
        one.at = file->included_at;
      }
      if (one.severity == Severity::kError) diagnostics.error(one.code, one.at, one.message, one.hint);
      if (one.severity == Severity::kWarning) diagnostics.warning(one.code, one.at, one.message, one.hint);
      if (one.severity == Severity::kNotice) diagnostics.notice(one.code, one.at, one.message, one.hint);
    }
  }
}

}  // namespace ferrers::mjcf
