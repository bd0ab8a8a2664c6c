#include "ferrers/formats/name_map.h"

#include <algorithm>
#include <array>

#include "ferrers/math/expression.h"

namespace ferrers {
namespace {

// The fixed body, and columns of the results.
constexpr std::array<std::string_view, 6> kReserved = {"ground", "t", "energy", "null", "true", "false"};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string allowed(std::string_view original, std::string_view kind) {
  std::string name;
  for (const char c : original) name += is_letter(c) || is_digit(c) ? c : '_';
  if (name.empty()) name = kind;
  if (is_digit(name.front())) name.insert(name.begin(), '_');
  const bool reserved = std::find(kReserved.begin(), kReserved.end(), name) != kReserved.end();
  if (reserved || is_expression_keyword(name)) name += '_';
  return name;
}

}  // namespace

void NameMap::keep(std::string_view space, std::string_view original) {
  if (!original.empty() && allowed(original, {}) == original)
    spaces_[std::string(space)].kept.insert(std::string(original));
}

std::string NameMap::add(std::string_view space, std::string_view kind, std::string_view original) {
  Space& own = spaces_[std::string(space)];
  const std::string wanted = allowed(original, kind);
  std::string name = wanted;
  const auto take = [&] { return (name == original || own.kept.count(name) == 0) && own.taken.insert(name).second; };
  if (!take()) {
    int& number = own.numbers.try_emplace(wanted, 2).first->second;  // those below are taken
    do {
      name = wanted + "_" + std::to_string(number++);
    } while (!take());
  }
  if (name != original) renamed_.push_back({std::string(kind), std::string(original), name});
  return name;
}

}  // namespace ferrers
