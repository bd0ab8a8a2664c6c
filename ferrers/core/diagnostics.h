#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ferrers {

/// Where something stands in a text file. Lines and columns count from 1; line 0 means "not from a file".
struct SourceRange {
  int line = 0;
  int column = 0;  ///< In bytes of the line, as compilers count.
  int length = 0;  ///< Bytes to underline; 0 underlines one.

  bool known() const { return line > 0; }
  bool operator==(const SourceRange&) const = default;
};

enum class Severity { kError, kWarning, kNotice };

/// One thing to tell the user about a file or model: code, place, what, and what to do about it.
struct Diagnostic {
  Severity severity = Severity::kError;
  std::string code;  ///< For example "F204"; every code stands in `diagnostic_codes()`.
  SourceRange at;
  std::string message;  ///< One sentence without a full stop, names in 'single quotes'.
  std::string hint;     ///< What to do; may be empty.
};

/// The diagnostics of one file or model, in the order found. The library never prints: callers format.
class Diagnostics {
 public:
  Diagnostics() = default;
  explicit Diagnostics(std::string file) : file_(std::move(file)) {}

  void error(std::string_view code, SourceRange at, std::string message, std::string hint = {});
  void warning(std::string_view code, SourceRange at, std::string message, std::string hint = {});
  void notice(std::string_view code, SourceRange at, std::string message, std::string hint = {});
  void append(const Diagnostics& other);

  bool has_errors() const;
  bool empty() const { return items_.empty(); }
  const std::vector<Diagnostic>& items() const { return items_; }
  const std::string& file() const { return file_; }
  void set_file(std::string file) { file_ = std::move(file); }

  /// Sorts by line and column; things without a place come last, in the order found.
  void sort_by_place();

 private:
  std::string file_;
  std::vector<Diagnostic> items_;
};

/// What a code means, for the reference page and `ferrers doctor`.
struct DiagnosticCode {
  std::string_view code;
  std::string_view title;
};

/// Every documented code, sorted. A diagnostic with any other code is a bug (tested).
const std::vector<DiagnosticCode>& diagnostic_codes();

/// The text a user reads: `file:line:column: error[F204]: what`, the line with the range underlined, the hint.
/// `source` is the whole text of the file (may be empty: then no excerpt). No line end at the end; control bytes and
/// broken UTF-8 are shown as '?', lines wider than 120 characters are cut around the place. Cost: O(size of `source`).
std::string format_diagnostic(const Diagnostic& diagnostic, std::string_view file, std::string_view source);

}  // namespace ferrers
