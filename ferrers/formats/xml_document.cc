#include "ferrers/formats/xml_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <pugixml.hpp>
#include <set>
#include <utility>

#include "ferrers/io/source_text.h"

namespace ferrers {
namespace {

constexpr int kDeepest = 200;
constexpr std::string_view kSpace = " \t\r\n";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return text.substr(0, 0);
  return text.substr(begin, text.find_last_not_of(kSpace) + 1 - begin);
}

}  // namespace

struct XmlDocument::Attribute {
  std::string_view name, value;
  std::size_t offset = 0, length = 0;  ///< Of the value as written.
  bool read = false;
};

struct XmlDocument::Node {
  std::string_view name;
  std::size_t offset = 0;
  int parent = -1;
  std::vector<int> children;
  std::vector<Attribute> attributes;
  std::string text;
  std::size_t text_offset = 0;
  bool read = false;
};

struct XmlDocument::Contents {
  std::string original;  ///< For places; `parsed` is changed by the parser.
  std::string parsed;
  pugi::xml_document xml;
  std::unique_ptr<SourceText> source;
  std::vector<Node> nodes;  ///< Root first, each before its children.

  std::size_t offset(const char* in_parsed) const { return static_cast<std::size_t>(in_parsed - parsed.data()); }
  bool add(const pugi::xml_node& xml_node, int parent, int depth, Diagnostics& diagnostics);
  void add_attributes(const pugi::xml_node& xml_node, Node& node, Diagnostics& diagnostics) const;
};

void XmlDocument::Contents::add_attributes(const pugi::xml_node& xml_node, Node& node, Diagnostics& diagnostics) const {
  for (const pugi::xml_attribute& one : xml_node.attributes()) {
    Attribute attribute;
    attribute.name = one.name();
    attribute.value = one.value();
    attribute.offset = *one.value() != '\0' ? offset(one.value()) : offset(one.name());
    const char quote = attribute.offset > 0 ? original[attribute.offset - 1] : '"';
    const std::size_t end = original.find(quote == '\'' ? '\'' : '"', attribute.offset);
    attribute.length =
        *one.value() != '\0' && end != std::string::npos ? end - attribute.offset : attribute.name.size();
    const bool twice = std::any_of(node.attributes.begin(), node.attributes.end(),
                                   [&](const Attribute& other) { return other.name == attribute.name; });
    if (twice) {
      diagnostics.error("F109", source->range(offset(one.name()), attribute.name.size()),
                        fmt::format("'{}' stands twice in <{}>", attribute.name, node.name), "keep one of the two");
    }
    node.attributes.push_back(attribute);
  }
}

bool XmlDocument::Contents::add(const pugi::xml_node& xml_node, int parent, int depth, Diagnostics& diagnostics) {
  const int index = static_cast<int>(nodes.size());
  Node node;
  node.name = xml_node.name();
  node.offset = offset(xml_node.name());
  node.parent = parent;
  if (depth > kDeepest) {
    diagnostics.error("F108", source->range(node.offset, node.name.size()),
                      fmt::format("elements are nested more than {} deep", kDeepest));
    return false;
  }
  add_attributes(xml_node, node, diagnostics);
  for (const pugi::xml_node& part : xml_node.children()) {
    if (part.type() != pugi::node_pcdata && part.type() != pugi::node_cdata) continue;
    const std::string_view piece = part.value();
    const std::string_view own = trimmed(piece);
    if (own.empty()) continue;
    if (node.text.empty()) {
      node.text_offset = offset(part.value()) + static_cast<std::size_t>(own.data() - piece.data());
    } else {
      node.text += ' ';
    }
    node.text += own;
  }
  nodes.push_back(std::move(node));
  if (parent >= 0) nodes[static_cast<std::size_t>(parent)].children.push_back(index);
  for (const pugi::xml_node& child : xml_node.children()) {
    if (child.type() == pugi::node_element && !add(child, index, depth + 1, diagnostics)) return false;
  }
  return true;
}

XmlDocument::XmlDocument() : contents_(std::make_unique<Contents>()) {}
XmlDocument::~XmlDocument() = default;

std::unique_ptr<const XmlDocument> XmlDocument::parse(std::string_view text, Diagnostics& diagnostics) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);  // as editors on Windows write it
  if (trimmed(text).empty()) {
    diagnostics.error("F103", {}, "the file is empty");
    return nullptr;
  }
  std::unique_ptr<XmlDocument> document(new XmlDocument());
  Contents& contents = *document->contents_;
  contents.original = text;
  contents.parsed = text;
  contents.source = std::make_unique<SourceText>(contents.original);
  if (!check_characters(*contents.source, diagnostics)) return nullptr;
  const pugi::xml_parse_result parsed = contents.xml.load_buffer_inplace(contents.parsed.data(), contents.parsed.size(),
                                                                         pugi::parse_default, pugi::encoding_utf8);
  const auto place = [&](std::size_t offset) { return contents.source->range(offset, 1); };
  if (!parsed) {
    diagnostics.error("F107", place(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, parsed.offset))),
                      fmt::format("this is no XML: {}", parsed.description()));
    return nullptr;
  }
  pugi::xml_node root;
  for (const pugi::xml_node& one : contents.xml.children()) {
    if (one.type() != pugi::node_element) continue;
    if (root) {
      diagnostics.error("F110", place(contents.offset(one.name())), "the file holds a second root element");
      return nullptr;
    }
    root = one;
  }
  if (!root || !contents.add(root, -1, 1, diagnostics) || diagnostics.has_errors()) return nullptr;
  contents.nodes[0].read = true;
  return document;
}

std::string_view XmlElement::name() const { return document_->contents_->nodes[static_cast<std::size_t>(index_)].name; }

SourceRange XmlElement::at() const {
  const XmlDocument::Node& node = document_->contents_->nodes[static_cast<std::size_t>(index_)];
  return document_->contents_->source->range(node.offset, node.name.size());
}

std::optional<std::string_view> XmlElement::attribute(std::string_view name) const {
  for (XmlDocument::Attribute& one : document_->contents_->nodes[static_cast<std::size_t>(index_)].attributes) {
    if (one.name != name) continue;
    one.read = true;
    return one.value;
  }
  return std::nullopt;
}

SourceRange XmlElement::attribute_at(std::string_view name) const {
  for (const XmlDocument::Attribute& one : document_->contents_->nodes[static_cast<std::size_t>(index_)].attributes) {
    if (one.name == name) return document_->contents_->source->range(one.offset, one.length);
  }
  return at();
}

std::vector<std::string_view> XmlElement::attribute_names() const {
  std::vector<std::string_view> names;
  for (const XmlDocument::Attribute& one : document_->contents_->nodes[static_cast<std::size_t>(index_)].attributes) {
    names.push_back(one.name);
  }
  return names;
}

XmlElement XmlElement::parent() const {
  const int parent = document_->contents_->nodes[static_cast<std::size_t>(index_)].parent;
  return parent < 0 ? XmlElement() : XmlElement(document_, parent);
}

XmlElement XmlElement::child(std::string_view name) const {
  for (const XmlElement& one : children()) {
    if (one.name() != name) continue;
    one.mark_read();
    return one;
  }
  return {};
}

std::vector<XmlElement> XmlElement::children(std::string_view name) const {
  std::vector<XmlElement> found;
  for (const XmlElement& one : children()) {
    if (one.name() != name) continue;
    one.mark_read();
    found.push_back(one);
  }
  return found;
}

std::vector<XmlElement> XmlElement::children() const {
  std::vector<XmlElement> all;
  for (const int child : document_->contents_->nodes[static_cast<std::size_t>(index_)].children) {
    all.push_back(XmlElement(document_, child));
  }
  return all;
}

void XmlElement::mark_read() const { document_->contents_->nodes[static_cast<std::size_t>(index_)].read = true; }

void XmlElement::mark_read_with_all() const {
  mark_read();
  for (XmlDocument::Attribute& one : document_->contents_->nodes[static_cast<std::size_t>(index_)].attributes) {
    one.read = true;
  }
  for (const XmlElement& one : children()) one.mark_read_with_all();
}

std::string_view XmlElement::text() const { return document_->contents_->nodes[static_cast<std::size_t>(index_)].text; }

SourceRange XmlElement::text_at() const {
  const XmlDocument::Node& node = document_->contents_->nodes[static_cast<std::size_t>(index_)];
  return node.text.empty() ? at() : document_->contents_->source->range(node.text_offset, node.text.size());
}

void XmlDocument::report_unread(Diagnostics& diagnostics, std::span<const std::string_view> quiet) const {
  struct Unread {
    SourceRange at;
    int count = 0;
  };
  std::map<std::string, Unread> unread;
  std::vector<std::string> order;
  const auto note = [&](const std::string& what, std::string_view plain, SourceRange at) {
    if (std::find(quiet.begin(), quiet.end(), plain) != quiet.end()) return;
    const auto [place, is_new] = unread.try_emplace(what, Unread{at, 0});
    if (is_new) order.push_back(what);
    ++place->second.count;
  };
  std::vector<bool> told(contents_->nodes.size(), false);  // or stands in what was told
  for (std::size_t i = 0; i < contents_->nodes.size(); ++i) {
    const Node& node = contents_->nodes[i];
    const XmlElement element(this, static_cast<int>(i));
    if (node.parent >= 0 && told[static_cast<std::size_t>(node.parent)]) {
      told[i] = true;
    } else if (!node.read) {
      told[i] = true;
      note(fmt::format("<{}> in <{}>", node.name, contents_->nodes[static_cast<std::size_t>(node.parent)].name),
           node.name, element.at());
    } else {
      for (const Attribute& one : node.attributes) {
        if (one.read) continue;
        note(fmt::format("'{}' of <{}>", one.name, node.name), fmt::format("{}@{}", node.name, one.name),
             contents_->source->range(one.offset, one.length));
      }
    }
  }
  for (const std::string& what : order) {
    const Unread& one = unread.at(what);
    diagnostics.notice("F601", one.at,
                       fmt::format("{} is not read{}", what,
                                   one.count > 1 ? fmt::format(", nor are {} more like it", one.count - 1) : ""));
  }
}

std::optional<std::vector<double>> read_numbers(std::string_view text, SourceRange at, std::string_view what,
                                                std::size_t wanted, Diagnostics& diagnostics) {
  std::vector<double> numbers;
  std::size_t begin = text.find_first_not_of(kSpace);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(text.find_first_of(kSpace, begin), text.size());
    std::string_view word = text.substr(begin, end - begin);
    if (word.size() > 1 && word.front() == '+') word.remove_prefix(1);
    double value = 0;
    const std::from_chars_result result = std::from_chars(word.data(), word.data() + word.size(), value);
    if (result.ec != std::errc() || result.ptr != word.data() + word.size() || !std::isfinite(value)) {
      diagnostics.error("F206", at, fmt::format("{} is no list of finite numbers: '{}'", what, word.substr(0, 40)));
      return std::nullopt;
    }
    numbers.push_back(value);
    begin = text.find_first_not_of(kSpace, end);
  }
  if (wanted != 0 && numbers.size() != wanted) {
    diagnostics.error("F208", at, fmt::format("{} has {} numbers, not {}", what, numbers.size(), wanted));
    return std::nullopt;
  }
  return numbers;
}

}  // namespace ferrers
