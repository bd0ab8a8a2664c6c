#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/core/diagnostics.h"

/// A text in YAML 1.2 core or JSON as a tree, every value with its place.
///
/// Problem: a YAML library is generous where a model must be exact. Read here: mappings, sequences, plain and quoted
/// scalars of exactly one document. Refused, each with its place: duplicate keys, anchors, aliases, merge keys, tags,
/// directives but `%YAML 1.2`, keys that are not text, tabs as indentation, a second document, bytes that are not
/// printable UTF-8, depth above 64, files above 16 MiB or 2 million values. Scalars stay text here: what is a number
/// is decided where a number is wanted (value_reader.h).
/// Cost: O(size), never recursing deeper than the limit, whatever the bytes.
namespace ferrers {

struct DocumentEntry;

struct DocumentNode {
  enum class Kind {
    kNull,    ///< Nothing, `~` or `null`.
    kPlain,   ///< A scalar without quotes.
    kQuoted,  ///< A scalar in quotes, or a block of text.
    kSequence,
    kMap,
    kBroken,  ///< Reported already: readers pass over it in silence.
  };
  Kind kind = Kind::kNull;
  bool verbatim = false;               ///< The text stands in the file byte by byte, from `text_at`.
  SourceRange at;                      ///< Scalars with their quotes; collections from their first byte.
  SourceRange text_at;                 ///< Scalars: behind the opening quote.
  std::string text;                    ///< Scalars.
  std::string raw;                     ///< As written from `text_at` on, line ends and all, where that is not `text`.
  std::vector<DocumentNode> items;     ///< Sequences.
  std::vector<DocumentEntry> entries;  ///< Maps, in the order of the file, keys unique.

  bool is_scalar() const { return kind == Kind::kPlain || kind == Kind::kQuoted; }
  const DocumentNode* find(std::string_view key) const;  ///< Null when absent. Cost: O(entries).
};

struct DocumentEntry {
  std::string key;
  SourceRange key_at;
  DocumentNode value;
};

struct DocumentLimits {
  std::size_t bytes = std::size_t{16} << 20U;
  std::size_t values = 2'000'000;
  int depth = 64;
};

/// The tree of `text`; empty when its structure cannot be told (the reasons are in `diagnostics`). A tree may come with
/// errors too, for instance of a duplicate key: the first one stands.
std::optional<DocumentNode> parse_document(std::string_view text, Diagnostics& diagnostics,
                                           const DocumentLimits& limits = {});

}  // namespace ferrers
