#include "ferrers/core/thread_team.h"

#include "ferrers/core/checks.h"

namespace ferrers {

ThreadTeam::ThreadTeam(int count) {
  require(count >= 1, "ThreadTeam: at least one thread");
  for (int part = 1; part < count; ++part) threads_.emplace_back(&ThreadTeam::serve, this, part);
}

ThreadTeam::~ThreadTeam() {
  work_ = nullptr;
  ++round_;
  round_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ThreadTeam::serve(int part) {
  constexpr int kPatience = 20000;  // some tens of microseconds: to be woken takes longer
  for (unsigned seen = 0;; ++seen) {
    for (int look = 0; look < kPatience && round_ == seen; ++look) {
    }
    round_.wait(seen);
    if (work_ == nullptr) return;
    attempt(part);
    --left_;
  }
}

void ThreadTeam::attempt(int part) {
  try {
    (*work_)(part);
  } catch (...) {
    if (!has_thrown_.test_and_set()) thrown_ = std::current_exception();
  }
}

void ThreadTeam::run(const std::function<void(int)>& work) {
  work_ = &work;
  left_ = static_cast<unsigned>(threads_.size());
  has_thrown_.clear();
  thrown_ = nullptr;
  ++round_;
  round_.notify_all();
  attempt(0);
  while (left_ != 0) std::this_thread::yield();  // the others had as much to do: soon
  if (thrown_) std::rethrow_exception(thrown_);
}

}  // namespace ferrers
