#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/formats/imported_model.h"
#include "ferrers/formats/xml_document.h"

/// Readers of MJCF share these parts; only `read_mjcf` (mjcf.h) is for others.
namespace ferrers::mjcf {

class Document;

/// An element of the model, from the main file or from an included one. A light handle, valid as long as its document.
class Element {
 public:
  Element() = default;

  bool exists() const { return document_ != nullptr; }
  explicit operator bool() const { return exists(); }

  std::string_view name() const { return xml().name(); }
  std::optional<std::string_view> attribute(std::string_view name) const { return xml().attribute(name); }
  SourceRange attribute_at(std::string_view name) const { return xml().attribute_at(name); }
  std::vector<Element> children() const;  ///< In their order, <include> replaced; counts as reading none of them.
  std::vector<Element> children(std::string_view name) const;
  void mark_read() const { xml().mark_read(); }
  void mark_read_with_all() const;

  SourceRange at() const { return xml().at(); }  ///< In its own file, for `diagnostics`.
  SourceRange main_at() const;                   ///< In the main file: where it stands, or what included it.
  Diagnostics& diagnostics() const;              ///< Of its own file.
  std::string text_of(std::string_view attribute) const { return std::string(this->attribute(attribute).value_or("")); }

  const XmlElement& xml() const;

 private:
  friend class Document;
  Element(Document* document, int index) : document_(document), index_(index) {}

  Document* document_ = nullptr;
  int index_ = 0;
};

/// An MJCF file with all that it includes, as one tree of elements.
///
/// Errors: those of `XmlDocument` for each file; F606 for a file that cannot be read; F605 for one that is included
/// twice, an <include> without a file, or more than 100 of them; F108 for elements nested deeper than 200 together.
class Document {
 public:
  /// Nothing where there is an error, which is then in `context.diagnostics`.
  static std::unique_ptr<Document> load(std::string_view text, const ImportContext& context);

  Element root() { return {this, 0}; }

  /// Tells of each file what nobody read (see `XmlDocument::report_unread`).
  void report_unread(std::span<const std::string_view> quiet);

  /// Hands over what was told, each thing once; what is about an included file names it and stands at its <include>.
  void flush(Diagnostics& diagnostics) const;

 private:
  friend class Element;
  struct File {
    std::string name;  ///< Empty: the main file.
    SourceRange included_at;
    std::unique_ptr<const XmlDocument> xml;
    Diagnostics diagnostics;
  };
  struct Node {
    XmlElement xml;
    int file = 0;
    std::vector<int> children;
  };

  bool add_file(std::string name, SourceRange included_at, std::string_view text);
  int add(const XmlElement& xml, int file, int depth);
  void add_children(const XmlElement& xml, int file, int depth, int node);
  void include(const XmlElement& xml, int file, int depth, int node);

  const FileLoader* load_ = nullptr;
  std::vector<std::unique_ptr<File>> files_;
  std::vector<Node> nodes_;
  bool failed_ = false;
};

}  // namespace ferrers::mjcf
