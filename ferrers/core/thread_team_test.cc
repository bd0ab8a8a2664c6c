#include "ferrers/core/thread_team.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace ferrers {
namespace {

TEST(ThreadTeamTest, EveryPartIsDoneOnceInEveryCall) {
  for (int count = 1; count <= 5; ++count) {
    ThreadTeam team(count);
    EXPECT_EQ(team.count(), count);
    std::vector<int> done(static_cast<std::size_t>(count), 0);
    for (int call = 1; call <= 300; ++call) {
      team.run([&](int part) { ++done[static_cast<std::size_t>(part)]; });
      for (const int times : done) ASSERT_EQ(times, call);
    }
  }
}

TEST(ThreadTeamTest, PartsRunAtTheSameTime) {
  ThreadTeam team(2);
  std::atomic<int> arrived = 0;
  team.run([&](int) {  // each waits for the other
    ++arrived;
    while (arrived < 2) std::this_thread::yield();
  });
  EXPECT_EQ(arrived, 2);
}

TEST(ThreadTeamTest, WhatAPartThrowsComesBackWhenAllAreDone) {
  ThreadTeam team(3);
  for (int thrower = 0; thrower < 3; ++thrower) {
    std::atomic<int> done = 0;
    const auto work = [&](int part) {
      if (part == thrower) throw std::runtime_error("a law without a value");
      ++done;
    };
    EXPECT_THROW(team.run(work), std::runtime_error);
    EXPECT_EQ(done, 2);
  }
  team.run([](int) {});
}

TEST(ThreadTeamTest, NobodyIsNoTeam) { EXPECT_THROW(ThreadTeam(0), std::invalid_argument); }

}  // namespace
}  // namespace ferrers
