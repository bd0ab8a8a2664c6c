#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ferrers/formats/imported_model.h"
#include "ferrers/formats/xml_document.h"

/// The files of an SDF model, and the values in them.
namespace ferrers {

/// One file of a model: the main one, or one that an <include> names. Places in messages point into the main file: to
/// the <include>, with the line of the included file in words.
class SdfFile {
 public:
  SdfFile(const XmlDocument& document, std::string path, const SdfFile* includer, SourceRange included_at,
          Diagnostics& diagnostics)
      : document_(&document),
        path_(std::move(path)),
        includer_(includer),
        included_at_(included_at),
        diagnostics_(&diagnostics) {}

  const XmlDocument& document() const { return *document_; }
  const std::string& path() const { return path_; }  ///< As given to the loader; empty for the main file.
  const SdfFile* includer() const { return includer_; }

  /// The minor number: 7 of '1.7'. Errors (F202, F210) for what is missing or not among those that are read.
  bool read_version();
  int version() const { return version_; }

  SourceRange place(SourceRange own) const { return includer_ ? included_at_ : own; }
  void tell(Diagnostic one) const;  ///< Its place is one of this file.

 private:
  const XmlDocument* document_;
  std::string path_;
  const SdfFile* includer_;
  SourceRange included_at_;
  Diagnostics* diagnostics_;
  int version_ = 0;
};

/// An element together with its file. As light as XmlElement; reading by name counts as there.
class SdfElement {
 public:
  SdfElement() = default;
  SdfElement(const SdfFile& file, XmlElement xml) : file_(&file), xml_(xml) {}

  explicit operator bool() const { return xml_.exists(); }
  const XmlElement& xml() const { return xml_; }
  const SdfFile& file() const { return *file_; }
  int version() const { return file_->version(); }
  std::string name() const { return std::string(xml_.name()); }

  SdfElement child(std::string_view name) const { return {*file_, xml_.child(name)}; }
  std::vector<SdfElement> children(std::string_view name) const;
  std::string attribute(std::string_view name) const;  ///< Empty where there is none.
  std::string text() const { return std::string(xml_.text()); }

  SourceRange at() const { return file_->place(xml_.at()); }
  SourceRange text_at() const { return file_->place(xml_.text_at()); }
  SourceRange attribute_at(std::string_view name) const { return file_->place(xml_.attribute_at(name)); }

  /// The attribute 'name', which must be there and not empty (F202 else).
  std::optional<NameRef> required_name() const;

  /// Of a child with one number, one truth value, three numbers; `fallback` where there is no such child or, told, no
  /// such value.
  Number number(std::string_view child_name, double fallback) const;
  bool flag(std::string_view child_name, bool fallback) const;
  std::optional<Eigen::Vector3d> vector(std::string_view child_name) const;
  /// This element's own text as a pose: 'rotation_format' and 'degrees' are obeyed, an empty one is the identity.
  Pose pose() const;
  bool flag_attribute(std::string_view name, bool fallback) const;

  /// Messages at this element, its text, or one of its attributes.
  void error(std::string_view code, std::string message, std::string hint = {}) const;
  void warning(std::string_view code, std::string message, std::string hint = {}) const;
  void notice(std::string_view code, std::string message, std::string hint = {}) const;
  void text_error(std::string_view code, std::string message, std::string hint = {}) const;
  void attribute_error(std::string_view attribute, std::string_view code, std::string message,
                       std::string hint = {}) const;

 private:
  std::optional<std::vector<double>> numbers(std::size_t wanted) const;
  std::optional<bool> truth(std::string_view word, SourceRange own) const;

  const SdfFile* file_ = nullptr;
  XmlElement xml_;
};

/// All files of a model: reads included ones on demand, each text once.
class SdfLibrary {
 public:
  explicit SdfLibrary(const ImportContext& context) : context_(context) {}

  /// Nothing where it is no XML (told).
  const SdfFile* open_main(std::string_view text);

  /// The file that the <uri> of an <include> names, found beside the including file or (model://) beside the main one.
  /// Nothing, told with F605 or F606, where there is none, it includes itself, or there are too many.
  const SdfFile* open_included(const SdfElement& include, const SdfElement& uri);

  /// A notice for every kind of element and attribute that was not read.
  void report_unread() const;

 private:
  struct Loaded {
    std::string path;
    std::optional<std::string> text;
    std::unique_ptr<const XmlDocument> document;
  };
  Loaded& loaded(const std::string& path);
  std::string file_of_folder(const std::string& folder);
  const SdfFile* open(const std::string& path, const SdfElement& include, const SdfElement& uri);

  const ImportContext& context_;
  std::unique_ptr<const XmlDocument> main_;
  std::map<std::string, Loaded, std::less<>> loaded_;
  std::vector<std::unique_ptr<SdfFile>> files_;
};

}  // namespace ferrers
