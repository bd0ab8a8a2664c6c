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
  for (int seen = 0;; ++seen) {
    for (int look = 0; look < kPatience && round_ == seen; ++look) {
    }
    round_.wait(seen);
    if (work_ == nullptr) return;
    (*work_)(part);
    --left_;
  }
}

void ThreadTeam::run(const std::function<void(int)>& work) {
  work_ = &work;
  left_ = static_cast<int>(threads_.size());
  ++round_;
  round_.notify_all();
  work(0);
  while (left_ != 0) std::this_thread::yield();  // the others had as much to do: soon
}

}  // namespace ferrers
