#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>

/// Files that others made and that are no part of the project: their tests run where FERRERS_THIRD_PARTY_MODELS names a
/// folder that holds them, and are skipped by name elsewhere.
namespace ferrers::witness {

constexpr const char* kNoThirdPartyModels = "FERRERS_THIRD_PARTY_MODELS names no folder of models";

/// Nothing where no folder is named. In a folder that is named, what is not there is a failure.
inline std::optional<std::filesystem::path> third_party(const std::filesystem::path& file) {
  const char* const folder = std::getenv("FERRERS_THIRD_PARTY_MODELS");
  if (folder == nullptr) return std::nullopt;
  const std::filesystem::path path = folder / file;
  EXPECT_TRUE(std::filesystem::exists(path)) << path << " is not there";
  return path;
}

}  // namespace ferrers::witness
