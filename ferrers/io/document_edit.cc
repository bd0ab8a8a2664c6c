#include "ferrers/io/document_edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "ferrers/core/closest_name.h"
#include "ferrers/io/fields.h"
#include "ferrers/io/value_reader.h"

namespace ferrers {
namespace {

using Kind = DocumentNode::Kind;

void relocate(DocumentNode& node, SourceRange at) {
  node.at = node.text_at = at;
  node.verbatim = false;
  for (DocumentNode& item : node.items) relocate(item, at);
  for (DocumentEntry& entry : node.entries) {
    entry.key_at = at;
    relocate(entry.value, at);
  }
}

/// "bodies.crank.com[0]" in steps; empty when it is no path.
std::vector<std::string> steps_of(std::string_view path) {
  std::vector<std::string> steps;
  while (true) {
    const std::size_t end = path.find_first_of(".[");
    const std::string_view step = path.substr(0, end);
    if (step.empty()) return {};
    steps.emplace_back(step);
    if (end == std::string_view::npos) return steps;
    bool bracket = path[end] == '[';
    path.remove_prefix(end + 1);
    while (bracket) {
      const std::size_t close = path.find(']');
      if (close == std::string_view::npos || close == 0) return {};
      steps.emplace_back(path.substr(0, close));
      path.remove_prefix(close + 1);
      if (path.empty()) return steps;
      bracket = path.front() == '[';
      if (!bracket && path.front() != '.') return {};
      path.remove_prefix(1);
    }
  }
}

bool holds_names(const std::vector<std::string>& steps, std::size_t depth) {
  if (depth != 1) return false;
  const FieldInfo* section = object_family(Family::kModel).types.front().find(steps[0]);
  return section != nullptr && (section->kind == ValueKind::kNamedObjects || section->kind == ValueKind::kNamedLists);
}

/// One edit; what goes wrong in it.
struct Failure {
  std::string message, hint;
};

DocumentNode* step_into(DocumentNode& node, const std::string& step) {
  if (node.kind == Kind::kSequence) {
    std::size_t index = 0;
    const auto scanned = std::from_chars(step.data(), step.data() + step.size(), index);
    const bool whole = scanned.ec == std::errc() && scanned.ptr == step.data() + step.size();
    return whole && index < node.items.size() ? &node.items[index] : nullptr;
  }
  for (DocumentEntry& entry : node.entries) {
    if (entry.key == step) return &entry.value;
  }
  return nullptr;
}

Failure no_step(const DocumentNode& node, const std::string& step) {
  Failure failure;
  if (node.kind == Kind::kSequence) {
    failure.message = fmt::format("the list has {} entries, and {} is none of them", node.items.size(), step);
    failure.hint = "entries count from 0";
  } else if (node.kind == Kind::kMap) {
    failure.message = fmt::format("there is no {}", quoted_in_message(step));
    std::vector<std::string_view> keys;
    for (const DocumentEntry& entry : node.entries) keys.push_back(entry.key);
    failure.hint = did_you_mean(step, keys);
  } else {
    failure.message = fmt::format("there is nothing inside the value before {}", quoted_in_message(step));
  }
  return failure;
}

std::optional<Failure> apply(DocumentNode& root, std::string_view edit, int number) {
  const std::size_t equals = edit.find('=');
  const std::vector<std::string> steps = steps_of(edit.substr(0, equals));
  if (equals == std::string_view::npos || steps.empty()) {
    return Failure{"this is not path=value", "for instance bodies.crank.mass=2"};
  }
  Diagnostics found;
  std::optional<DocumentNode> value = parse_document(edit.substr(equals + 1), found);
  if (!value || found.has_errors()) {
    return Failure{"the value cannot be read: " + found.items().front().message, found.items().front().hint};
  }
  relocate(*value, {0, -number, 0});
  DocumentNode* node = &root;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    DocumentNode* next = step_into(*node, steps[i]);
    const bool last = i + 1 == steps.size();
    if (next == nullptr && last && node->kind == Kind::kMap && !holds_names(steps, i)) {
      node->entries.push_back({steps[i], {0, -number, 0}, std::move(*value)});
      return std::nullopt;
    }
    if (next == nullptr) return no_step(*node, steps[i]);
    node = next;
  }
  *node = std::move(*value);
  return std::nullopt;
}

}  // namespace

void edit_document(DocumentNode& root, const std::vector<std::string>& edits, Diagnostics& diagnostics) {
  for (std::size_t i = 0; i < edits.size(); ++i) {
    const std::optional<Failure> failure = apply(root, edits[i], static_cast<int>(i) + 1);
    if (failure) {
      diagnostics.error("F217", {}, fmt::format("--set {}: {}", quoted_in_message(edits[i]), failure->message),
                        failure->hint);
    }
  }
}

Diagnostics name_edits(const Diagnostics& diagnostics, const std::vector<std::string>& edits) {
  Diagnostics named(diagnostics.file());
  for (Diagnostic one : diagnostics.items()) {
    if (one.at.line == 0 && one.at.column < 0) {
      const std::size_t edit = static_cast<std::size_t>(-one.at.column) - 1;
      if (edit < edits.size()) one.message = fmt::format("--set {}: {}", quoted_in_message(edits[edit]), one.message);
      one.at = {};
    }
    if (one.severity == Severity::kError) named.error(one.code, one.at, one.message, one.hint);
    if (one.severity == Severity::kWarning) named.warning(one.code, one.at, one.message, one.hint);
    if (one.severity == Severity::kNotice) named.notice(one.code, one.at, one.message, one.hint);
  }
  return named;
}

}  // namespace ferrers
