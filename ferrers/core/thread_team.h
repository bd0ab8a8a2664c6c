#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <thread>
#include <vector>

namespace ferrers {

/// Threads that wait for work and share it in equal parts: a call costs microseconds, where starting threads would cost
/// tens of them.
class ThreadTeam {
 public:
  /// `count` ≥ 1, the caller's thread among them.
  explicit ThreadTeam(int count);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  int count() const { return static_cast<int>(threads_.size()) + 1; }
  /// Calls `work(part)` for part = 0 … count − 1, each on a thread of its own, and returns when all have returned; what
  /// one of them threw is thrown then. Not to be called from several threads at once.
  void run(const std::function<void(int part)>& work);

 private:
  void serve(int part);
  void attempt(int part);

  const std::function<void(int)>* work_ = nullptr;  ///< Null: go home.
  std::atomic<unsigned> round_ = 0, left_ = 0;
  std::atomic_flag has_thrown_;
  std::exception_ptr thrown_;  ///< The first.
  std::vector<std::thread> threads_;
};

}  // namespace ferrers
