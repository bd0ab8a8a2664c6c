#include "ferrers/io/document.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <istream>
#include <streambuf>
#include <unordered_map>
#include <utility>

#include "ferrers/io/source_text.h"

namespace ferrers {
namespace {

using Kind = DocumentNode::Kind;

/// Thrown by the event handler to leave the parser; what is wrong is in the diagnostics already.
struct Stop {};

/// Reads from a string without copying it.
class ViewBuffer : public std::streambuf {
 public:
  explicit ViewBuffer(std::string_view text) {
    char* begin = const_cast<char*>(text.data());  // NOLINT: a get area is never written to
    setg(begin, begin, begin + text.size());
  }
};

/// Builds the tree from the parser's events. Invariant: `frames_` are the open collections, outermost first.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(const SourceText& source, const DocumentLimits& limits, Diagnostics& diagnostics)
      : source_(source), limits_(limits), diagnostics_(diagnostics) {}

  std::optional<DocumentNode> root;
  /// Lists and maps as keys. The parser takes a bracket that never closes for one, so these count only when it is done.
  Diagnostics key_errors;

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_++ == 0) return;
    const std::size_t offset = offset_of(mark);
    const bool marked = source_.text().substr(offset, 3) == "---";
    diagnostics_.error("F110", source_.range(offset, marked ? 3 : 1),
                       marked ? "a second document starts here" : "text after the end of the model",
                       marked ? "one file describes one mechanism: put the other into a file of its own"
                              : "a key needs ': ' with a space behind it, and a text may need quotes");
    throw Stop{};
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    const std::size_t offset = offset_of(mark);
    const std::string_view rest = source_.text().substr(offset);
    const bool written = rest.substr(0, 1) == "~" || rest.substr(0, 4) == "null" || rest.substr(0, 4) == "Null" ||
                         rest.substr(0, 4) == "NULL";
    DocumentNode node;
    node.at = source_.range(offset, rest.substr(0, 1) == "~" ? 1 : 4);
    if (!written || is_key_position()) {
      node.at = source_.range(offset, 1);
      if (!frames_.empty() && frames_.back().has_key) node.at = frames_.back().key_at;
    }
    if (refuse_key("an empty key", node.at)) return;
    attach(std::move(node));
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    const std::size_t offset = offset_of(mark);
    DocumentNode node = broken(offset);
    diagnostics_.error("F111", source_.range(offset, word_length(offset)), "an alias ('*name') is not read",
                       "write the value out, or make it a parameter and use '= name'");
    if (refuse_key({}, node.at)) return;
    attach(std::move(node));
  }

  void OnAnchor(const YAML::Mark& mark, const std::string& name) override {
    const std::size_t offset = offset_of(mark);
    diagnostics_.error("F111", source_.range(offset, source_.text().substr(offset, 1) == "&" ? name.size() + 1 : 1),
                       fmt::format("an anchor ('&{}') is not read", name),
                       "make the shared value a parameter and use '= name'");
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t /*anchor*/,
                const std::string& value) override {
    const std::size_t offset = offset_of(mark);
    DocumentNode node = scalar(offset, tag, value);
    check_indentation(offset);
    if (is_key_position()) {
      start_entry(node, value);
    } else {
      attach(std::move(node));
    }
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value style) override {
    open(Kind::kSequence, mark, tag, style == YAML::EmitterStyle::Flow);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value style) override {
    open(Kind::kMap, mark, tag, style == YAML::EmitterStyle::Flow);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Frame {
    DocumentNode node;
    bool flow = false;
    bool is_key = false;   // This collection stands where a key is wanted: it is read and dropped.
    bool has_key = false;  // A map that waits for the value of `key`.
    bool drop_entry = false;
    std::string key;
    SourceRange key_at;
    std::unordered_map<std::string, int> lines;  // Of the keys so far.
  };

  std::size_t offset_of(const YAML::Mark& mark) const {
    return std::min(static_cast<std::size_t>(std::max(mark.pos, 0)), source_.text().size());  // it counts bytes
  }
  bool is_key_position() const {
    return !frames_.empty() && frames_.back().node.kind == Kind::kMap && !frames_.back().has_key;
  }
  std::size_t word_length(std::size_t offset) const {
    const std::size_t end = source_.text().find_first_of(" \t\r\n,[]{}", offset);
    return std::max<std::size_t>(std::min(end, source_.text().size()) - offset, 1);
  }
  DocumentNode broken(std::size_t offset) const {
    DocumentNode node;
    node.kind = Kind::kBroken;
    node.at = source_.range(offset, word_length(offset));
    return node;
  }

  void check_tag(const std::string& tag, std::size_t offset) {
    if (tag == "?" || tag.empty() || (tag == "!" && source_.text().substr(offset, 1) != "!")) return;
    diagnostics_.error("F112", source_.range(offset, word_length(offset)), "a tag ('!name') is not read",
                       "the keys tell what a value is: take the tag out");
  }

  /// A tab before the first thing of a line, in block style, where columns decide what belongs to what.
  void check_indentation(std::size_t offset) {
    if (!frames_.empty() && frames_.back().flow) return;
    const std::string_view before = source_.before_on_line(offset);
    const std::size_t tab = before.find('\t');
    if (tab == std::string_view::npos || before.find_first_not_of(" \t-?:") != std::string_view::npos) return;
    diagnostics_.error("F115", source_.range(offset - before.size() + tab, 1), "a tab in the indentation",
                       "indent with spaces: how wide a tab is, nobody knows");
  }

  DocumentNode scalar(std::size_t offset, const std::string& tag, const std::string& value) {
    DocumentNode node;
    node.text = value;
    const char first = offset < source_.text().size() ? source_.text()[offset] : ' ';
    if (tag != "?" &&
        (first == '!' || first == '&' || (first != '"' && first != '\'' && first != '|' && first != '>'))) {
      check_tag(tag == "!" ? "!!" : tag, offset);
      node = broken(offset);
    } else if (first == '"' || first == '\'') {
      node.kind = Kind::kQuoted;
      const std::size_t end = end_of_quoted(offset, first);
      node.at = source_.range(offset, end - offset);
      node.text_at = source_.range(offset + 1, value.size());
      node.verbatim = source_.text().substr(offset + 1, value.size()) == value;
      if (!node.verbatim) node.raw = source_.text().substr(offset + 1, end - offset - 2);
      if (node.raw.find_first_of("\\\r'\"") != std::string::npos) node.raw.clear();  // escapes: not the text
    } else {
      const bool block = tag == "!";
      node.kind = block ? Kind::kQuoted : Kind::kPlain;
      node.verbatim = !block && source_.text().substr(offset, value.size()) == value;
      node.at = source_.range(offset, block ? 1 : node.verbatim ? value.size() : source_.text().size());
      node.text_at = node.at;
      if (!node.verbatim && !block) node.raw = unfolded(offset, value);
    }
    if (first == '&') node.kind = Kind::kBroken;
    return node;
  }

  /// The lines of a plain scalar as they stand in the file: every run of white space for one in `folded`.
  std::string unfolded(std::size_t offset, std::string_view folded) const {
    const auto is_space = [](char c) { return c == ' ' || c == '\n' || c == '\t'; };
    const std::string_view text = source_.text();
    std::size_t i = offset;
    for (std::size_t j = 0; j < folded.size();) {
      if (i >= text.size() || is_space(text[i]) != is_space(folded[j])) return {};
      if (!is_space(text[i])) {
        if (text[i++] != folded[j++]) return {};
        continue;
      }
      while (i < text.size() && is_space(text[i])) ++i;
      while (j < folded.size() && is_space(folded[j])) ++j;
    }
    return std::string(text.substr(offset, i - offset));
  }

  /// Behind the closing quote. The parser takes the end of the file for one; here it is an error.
  std::size_t end_of_quoted(std::size_t offset, char quote) {
    const std::string_view text = source_.text();
    for (std::size_t i = offset + 1; i < text.size(); ++i) {
      if (quote == '"' && text[i] == '\\') {
        ++i;
      } else if (text[i] == quote) {
        if (quote == '"' || text.substr(i + 1, 1) != "'") return i + 1;
        ++i;
      }
    }
    diagnostics_.error("F107", source_.range(offset, 1), "a quote opens here and never closes", "close the quote");
    throw Stop{};
  }

  /// Reports what cannot be a key and takes its value out; false when no key is wanted here.
  bool refuse_key(std::string_view what, SourceRange at) {
    if (!is_key_position()) return false;
    if (!what.empty()) diagnostics_.error("F113", at, fmt::format("{}: a key is a plain word", what));
    Frame& frame = frames_.back();
    frame.has_key = frame.drop_entry = true;
    frame.key_at = at;
    return true;
  }

  void start_entry(const DocumentNode& node, const std::string& value) {
    Frame& frame = frames_.back();
    frame.has_key = true;
    frame.key = value;
    frame.key_at = node.at;
    frame.drop_entry = node.kind == Kind::kBroken;
    if (node.kind == Kind::kPlain && value == "<<") {
      diagnostics_.error("F111", node.at, "a merge key ('<<') is not read", "write the keys out");
      frame.drop_entry = true;
    } else if (!frame.drop_entry) {
      const auto [known, is_new] = frame.lines.emplace(value, node.at.line);
      if (is_new) return;
      diagnostics_.error("F109", node.at, fmt::format("'{}' stands twice", value),
                         fmt::format("it stands at line {} already", known->second));
      frame.drop_entry = true;
    }
  }

  void open(Kind kind, const YAML::Mark& mark, const std::string& tag, bool flow) {
    const std::size_t offset = offset_of(mark);
    check_tag(tag, offset);
    if (!flow) check_indentation(offset);
    Frame frame;
    frame.node.kind = kind;
    frame.node.at = source_.range(offset, 1);
    if (frames_.size() >= static_cast<std::size_t>(limits_.depth)) {
      diagnostics_.error("F108", frame.node.at, fmt::format("nested more than {} deep", limits_.depth));
      throw Stop{};
    }
    frame.flow = flow;
    if (is_key_position()) {
      key_errors.error("F113", frame.node.at, "a list or map as a key: a key is a plain word");
      frame.is_key = true;
    }
    frames_.push_back(std::move(frame));
  }

  void close() {
    Frame frame = std::move(frames_.back());
    frames_.pop_back();
    if (frame.is_key) {
      refuse_key({}, frame.node.at);
    } else {
      attach(std::move(frame.node));
    }
  }

  void attach(DocumentNode node) {
    if (++values_ > limits_.values) {
      diagnostics_.error("F102", node.at, fmt::format("more than {} values in one file", limits_.values));
      throw Stop{};
    }
    if (frames_.empty()) {
      root = std::move(node);
      return;
    }
    Frame& frame = frames_.back();
    if (frame.node.kind == Kind::kSequence) {
      frame.node.items.push_back(std::move(node));
      return;
    }
    if (!frame.drop_entry) frame.node.entries.push_back({std::move(frame.key), frame.key_at, std::move(node)});
    frame.has_key = frame.drop_entry = false;
  }

  const SourceText& source_;
  const DocumentLimits& limits_;
  Diagnostics& diagnostics_;
  std::vector<Frame> frames_;
  std::size_t values_ = 0;
  int documents_ = 0;
};

/// The parser's short messages in words that help.
void report_syntax(const YAML::Exception& exception, const SourceText& source, Diagnostics& diagnostics) {
  struct Text {
    const char* parser;
    const char* message;
    const char* hint;
  };
  static const Text kTexts[] = {
      {YAML::ErrorMsg::END_OF_MAP, "a key of this map, or its end, is expected here",
       "keys of one map start in one column, 'key: value'"},
      {YAML::ErrorMsg::END_OF_MAP_FLOW, "',' or '}' is expected here", "'{' opens a map: {key: value, key: value}"},
      {YAML::ErrorMsg::END_OF_SEQ, "an item of this list ('- '), or its end, is expected here",
       "items of one list start in one column"},
      {YAML::ErrorMsg::END_OF_SEQ_FLOW, "',' or ']' is expected here", "'[' opens a list: [1, 2, 3]"},
      {YAML::ErrorMsg::FLOW_END, "a ']' or '}' that closes nothing", "take it out, or open the bracket before"},
      {YAML::ErrorMsg::MAP_VALUE, "a ':' where no value can start",
       "put a text that has ': ' into quotes; keys of one map start in one column"},
      {YAML::ErrorMsg::MAP_KEY, "a key cannot start here", "keys of one map start in one column"},
      {YAML::ErrorMsg::BLOCK_ENTRY, "a list item ('- ') cannot start here", "start lists on a line of their own"},
      {YAML::ErrorMsg::UNKNOWN_TOKEN, "no value starts with this character", "put a text with it into quotes"},
      {YAML::ErrorMsg::TAB_IN_INDENTATION, "a tab in the indentation", "indent with spaces"},
      {YAML::ErrorMsg::EOF_IN_SCALAR, "the file ends inside quotes", "close the quote"},
      {YAML::ErrorMsg::DOC_IN_SCALAR, "the document ends inside quotes", "close the quote"},
  };
  const std::size_t offset = static_cast<std::size_t>(std::max(exception.mark.pos, 0));
  const SourceRange at = source.range(offset, 1);
  for (const Text& text : kTexts) {
    if (exception.msg == text.parser) return diagnostics.error("F107", at, text.message, text.hint);
  }
  if (exception.msg.rfind(YAML::ErrorMsg::INVALID_ESCAPE, 0) == 0) {
    return diagnostics.error("F107", source.range(offset < 2 ? 0 : offset - 2, 2),  // the parser stands behind it
                             "unknown escape in a text in double quotes",
                             "a backslash is written '\\\\'; in single quotes it stands for itself");
  }
  for (const char* anchor :
       {YAML::ErrorMsg::UNKNOWN_ANCHOR, YAML::ErrorMsg::ALIAS_NOT_FOUND, YAML::ErrorMsg::ANCHOR_NOT_FOUND,
        YAML::ErrorMsg::CHAR_IN_ALIAS, YAML::ErrorMsg::CHAR_IN_ANCHOR, YAML::ErrorMsg::ALIAS_CONTENT}) {
    if (exception.msg == anchor) {
      return diagnostics.error("F111", at, "anchors and aliases are not read",
                               "put a text with '&' or '*' into quotes");
    }
  }
  diagnostics.error("F107", at, exception.msg.empty() ? "this is no YAML" : exception.msg);
}

/// Allows `%YAML 1.2` before the first content, and nothing else that starts with '%'.
bool check_directives(const SourceText& source, Diagnostics& diagnostics) {
  const std::string_view text = source.text();
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::string_view line = text.substr(start, end - start);
    line = line.substr(0, line.find_last_not_of(" \t\r") + 1);
    if (!line.empty() && line.front() != '#' && line.front() != '%') return true;
    if (!line.empty() && line.front() == '%' && line != "%YAML 1.2") {
      diagnostics.error("F114", source.range(start, line.size()), "a directive is not read", "take this line out");
      return false;
    }
    start = end + 1;
  }
  return true;
}

}  // namespace

const DocumentNode* DocumentNode::find(std::string_view key) const {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const DocumentEntry& e) { return e.key == key; });
  return found == entries.end() ? nullptr : &found->value;
}

std::optional<DocumentNode> parse_document(std::string_view text, Diagnostics& diagnostics,
                                           const DocumentLimits& limits) {
  if (text.size() > limits.bytes) {
    diagnostics.error("F102", {}, fmt::format("{} bytes; a model file has at most {}", text.size(), limits.bytes),
                      "put long tables into CSV files and name them as laws");
    return std::nullopt;
  }
  const SourceText source(text);
  if (!check_characters(source, diagnostics) || !check_directives(source, diagnostics)) return std::nullopt;
  ViewBuffer buffer(text);
  std::istream stream(&buffer);
  TreeBuilder builder(source, limits, diagnostics);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& exception) {
    const auto is_tab = [](const Diagnostic& one) { return one.code == "F115"; };
    const bool follows_from_tab = std::any_of(diagnostics.items().begin(), diagnostics.items().end(), is_tab);
    if (!follows_from_tab) report_syntax(exception, source, diagnostics);
    return std::nullopt;
  } catch (const Stop&) {
    return std::nullopt;
  }
  diagnostics.append(builder.key_errors);
  if (!builder.root || builder.root->kind == Kind::kNull) {
    diagnostics.error("F103", source.range(0, 0), "the file is empty",
                      "a model starts with 'ferrers: 1'; 'ferrers new' writes an example");
    return std::nullopt;
  }
  return std::move(builder.root);
}

}  // namespace ferrers
