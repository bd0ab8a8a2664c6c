#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

/// The command as a process of its own: its exit code and what it wrote where.
namespace ferrers::command_testing {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

inline const fs::path kExamples = fs::path(FERRERS_SOURCE_DIR) / "examples";

/// Two mistakes.
inline constexpr const char* kWrongModel = R"(ferrers: 1
name: wrong
bodies:
  a: {mass: 1 m, com: [0, 0, 0]}
joints:
  j: {type: revolut, bodies: [ground, a], at: [0, 0, 0], axis: z}
)";

inline std::string read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

struct Result {
  int exit_code = -1;  ///< -1 when a signal ended it.
  int signal = 0;
  std::string output, errors;
  ordered_json json() const { return ordered_json::parse(output, nullptr, /*allow_exceptions=*/false); }
};

/// Becomes the command, in a child process.
[[noreturn]] inline void become_command(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {FERRERS_COMMAND};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(pointers[0], pointers.data());
  _exit(127);
}

/// A scratch folder, in which the command runs.
class CommandTest : public testing::Test {
 protected:
  CommandTest()
      : folder_(fs::temp_directory_path() / ("ferrers-command-" + std::to_string(getpid())) /
                testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~CommandTest() override {
    std::error_code ignored;
    if (!HasFailure()) fs::remove_all(folder_, ignored);
    fs::remove(folder_.parent_path(), ignored);
  }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  pid_t start(const std::vector<std::string>& arguments) const {
    const pid_t child = fork();
    if (child != 0) return child;
    const auto redirect = [&](const char* name, int descriptor) {
      const int file = open((folder_ / name).c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
      dup2(file, descriptor);
    };
    redirect("stdout", STDOUT_FILENO);
    redirect("stderr", STDERR_FILENO);
    if (chdir(folder_.c_str()) != 0) _exit(126);
    become_command(arguments);
  }

  Result wait_for(pid_t child) const {
    int status = 0;
    waitpid(child, &status, 0);
    Result result;
    if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
    result.output = read_text(folder_ / "stdout");
    result.errors = read_text(folder_ / "stderr");
    return result;
  }

  Result run(const std::vector<std::string>& arguments) const { return wait_for(start(arguments)); }

  /// Starts a run of many hours and waits until some of its rows are in the file.
  pid_t start_long_run() const {
    const pid_t child =
        start({"simulate", (kExamples / "pendulum-a01/model.yaml").string(), "--end", "50000", "-o", "run"});
    for (int i = 0; i < 600 && lines_of(folder_ / "run/result.csv").size() < 20; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return child;
  }

  fs::path folder_;
};

inline std::string bricard() { return (kExamples / "bricard-a04/model.yaml").string(); }

}  // namespace ferrers::command_testing
