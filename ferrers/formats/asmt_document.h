#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "ferrers/core/diagnostics.h"

namespace ferrers {

class AsmtDocument;

/// A line of an ASMT file with all lines that stand deeper below it: a record where it names something, a value where
/// it does not. A light handle, valid as long as its document. Asking for a record by name notes that it was read;
/// `AsmtDocument::report_unread` tells what nobody asked for.
class AsmtRecord {
 public:
  AsmtRecord() = default;

  bool exists() const { return document_ != nullptr; }
  explicit operator bool() const { return exists(); }

  std::string_view name() const;  ///< The line, without white space around it.
  SourceRange at() const;

  AsmtRecord child(std::string_view name) const;  ///< The first of that name, read; or none.
  std::vector<AsmtRecord> children() const;       ///< All, which counts as reading none of them.
  std::vector<AsmtRecord> values() const;         ///< All that are not empty, which reads them.
  bool empty() const;                             ///< Nothing but empty lines below.

  /// The one value below, empty where there is none. More than one is an error (F605).
  std::string_view value(Diagnostics& diagnostics) const;
  SourceRange value_at() const;  ///< Of the first value below; of the record where it has none.

  void mark_read() const;           ///< This line; those below stay as they are.
  void mark_read_with_all() const;  ///< This line and all below.

 private:
  friend class AsmtDocument;
  AsmtRecord(const AsmtDocument* document, int index) : document_(document), index_(index) {}

  const AsmtDocument* document_ = nullptr;
  int index_ = 0;
};

/// An ASMT file in memory: lines whose depth is the number of tabs before them.
///
/// Refused, with diagnostics: an empty file (F103), bytes that are no UTF-8 or control characters (F104, F106), lines
/// deeper than 64 (F108), spaces before a line and lines more than one level deeper than the one above (F605). An empty
/// line counts as an empty value where it stands one level below the line above, else as nothing. Cost: linear.
class AsmtDocument {
 public:
  /// Nothing where there is an error. `text` outlives the document.
  static std::unique_ptr<const AsmtDocument> parse(std::string_view text, Diagnostics& diagnostics);
  ~AsmtDocument();
  AsmtDocument(const AsmtDocument&) = delete;
  AsmtDocument& operator=(const AsmtDocument&) = delete;

  std::vector<AsmtRecord> top() const;  ///< The lines without a tab, the first line of the file among them.

  /// A notice (F601) for every kind of record that was not read, with its first place and how often it occurs; what
  /// stands in an unread record is not told again.
  void report_unread(Diagnostics& diagnostics) const;

 private:
  friend class AsmtRecord;
  struct Contents;
  AsmtDocument();

  std::unique_ptr<Contents> contents_;
};

}  // namespace ferrers
