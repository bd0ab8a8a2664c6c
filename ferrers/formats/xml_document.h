#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/core/diagnostics.h"

namespace ferrers {

class XmlDocument;

/// An element of an XML document: its attributes, children and text, each with its place. A light handle, valid as long
/// as its document. Asking for an attribute or a child by name notes that it was read; `XmlDocument::report_unread`
/// tells what nobody asked for.
class XmlElement {
 public:
  XmlElement() = default;

  bool exists() const { return document_ != nullptr; }
  explicit operator bool() const { return exists(); }
  bool operator==(const XmlElement&) const = default;

  std::string_view name() const;
  SourceRange at() const;  ///< Of the name in the start tag.

  std::optional<std::string_view> attribute(std::string_view name) const;
  SourceRange attribute_at(std::string_view name) const;  ///< Of the value; of the element where it has no such.
  std::vector<std::string_view> attribute_names() const;  ///< Does not count as reading.

  XmlElement parent() const;                                      ///< Does not exist for the root.
  XmlElement child(std::string_view name) const;                  ///< The first of that name.
  std::vector<XmlElement> children(std::string_view name) const;  ///< All of that name.
  std::vector<XmlElement> children() const;                       ///< All, which counts as reading none of them.
  void mark_read() const;           ///< This element; its attributes and children stay as they are.
  void mark_read_with_all() const;  ///< This element and everything in it.

  std::string_view text() const;  ///< Without white space around it.
  SourceRange text_at() const;

 private:
  friend class XmlDocument;
  XmlElement(const XmlDocument* document, int index) : document_(document), index_(index) {}

  const XmlDocument* document_ = nullptr;
  int index_ = 0;
};

/// An XML file in memory, with places: what pugixml parsed, in arrays.
///
/// Refused, with diagnostics: text that is no XML (F107), elements nested deeper than 200 (F108), an attribute that
/// stands twice (F109), more than one root or none (F110, F103), bytes that are no UTF-8 or control characters
/// (F104, F106). A document type is skipped; entities other than XML's five stay as they are written. Cost: linear.
class XmlDocument {
 public:
  /// Nothing where there is an error. `text` is copied.
  static std::unique_ptr<const XmlDocument> parse(std::string_view text, Diagnostics& diagnostics);
  ~XmlDocument();
  XmlDocument(const XmlDocument&) = delete;
  XmlDocument& operator=(const XmlDocument&) = delete;

  XmlElement root() const { return {this, 0}; }

  /// A notice (F601) for every kind of element and attribute that was not read, with its first place and how often it
  /// occurs; what stands in an unread element is not told again. `quiet`: names of elements and attributes
  /// ("element@attribute") that nobody misses.
  void report_unread(Diagnostics& diagnostics, std::span<const std::string_view> quiet = {}) const;

 private:
  friend class XmlElement;
  struct Attribute;
  struct Node;
  struct Contents;
  XmlDocument();

  std::unique_ptr<Contents> contents_;
};

/// Numbers of an attribute or a text, separated by white space; read the same in every locale.
///
/// Given: `text`, its place, what it is called in messages ("'xyz' of <origin>"), and how many numbers are wanted
/// (0: any number of them). Errors: F206 for what is no finite decimal number, F208 for a wrong count; then nothing is
/// returned.
std::optional<std::vector<double>> read_numbers(std::string_view text, SourceRange at, std::string_view what,
                                                std::size_t wanted, Diagnostics& diagnostics);

}  // namespace ferrers
