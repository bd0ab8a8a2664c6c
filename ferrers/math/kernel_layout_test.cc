// Where numbers stand: neighbours where loops read and write them, and nowhere that a loop overwrites.

#include "ferrers/math/kernel_layout.h"

#include <gtest/gtest.h>

#include <set>

namespace ferrers {
namespace {

TEST(KernelLayoutTest, RowsThatAreReadTogetherBecomeNeighbours) {
  KernelLayout layout(12);
  for (int i = 0; i < 12; ++i) layout.add(i, -1);
  layout.read_together({3, 7, 1, 9}, {0, 1, 2, 3});
  layout.read_together({7, 1, 9, 5}, {0, 1, 2, 3});  // one place further
  layout.read_together({1, 3, 5, 7}, {0, 1, 2, 3});  // not as well
  layout.place();
  EXPECT_TRUE(layout.is_row({3, 7, 1, 9}, {0, 1, 2, 3}));
  EXPECT_TRUE(layout.is_row({7, 1, 9, 5}, {0, 1, 2, 3}));
  EXPECT_FALSE(layout.is_row({1, 3, 5, 7}, {0, 1, 2, 3}));
  std::set<int> places;
  for (int i = 0; i < 12; ++i) places.insert(layout.place_of(i));
  EXPECT_EQ(places.size(), 12U);
  EXPECT_GE(*places.begin(), 0);
  EXPECT_LT(*places.rbegin(), layout.size());
}

TEST(KernelLayoutTest, AGapBelongsToNumbersThatAreWrittenLaterOnly) {
  for (const int time : {-1, 0, 1}) {  // when number 9 is written; the row is at time 0
    KernelLayout layout(10);
    for (const int number : {0, 1, 2}) layout.add(number, 0);
    layout.add(9, time);
    layout.write_together({0, 1, 2}, {0, 1, 3});
    layout.read_together({0, 1, 9, 2}, {0, 1, 2, 3});
    layout.place();
    EXPECT_TRUE(layout.is_row({0, 1, 2}, {0, 1, 3}));
    EXPECT_EQ(layout.is_row({0, 1, 9, 2}, {0, 1, 2, 3}), time == 1) << time;
    const int first = layout.place_of(0), place = layout.place_of(9);
    EXPECT_EQ(place >= first && place < first + 4, time == 1) << time;
  }
}

TEST(KernelLayoutTest, NothingStandsBehindARowThatItsLastFourOverwrite) {
  for (const int time : {-1, 0, 1}) {
    KernelLayout layout(6);
    for (const int number : {0, 1, 2, 3, 4}) layout.add(number, 0);
    layout.add(5, time);
    layout.write_together({0, 1, 2, 3, 4}, {0, 1, 2, 3, 4});
    layout.read_together({4, 5}, {0, 1});
    layout.place();
    const int behind = layout.place_of(5) - layout.place_of(4);
    if (time == 1) {
      EXPECT_EQ(behind, 1);
    } else {
      EXPECT_TRUE(behind > 3 || behind < -4) << time;
    }
  }
}

TEST(KernelLayoutTest, RingsAreCutAtTheBeginningOfARow) {
  KernelLayout layout(5);
  for (const int number : {0, 1, 2, 3}) layout.add(number, 0);
  layout.add(4, 1);
  layout.write_together({0, 1, 2, 3}, {0, 1, 3, 4});
  layout.read_together({1, 4, 2}, {0, 1, 2});        // 4 fills the gap
  layout.read_together({2, 3, 0, 1}, {0, 1, 2, 3});  // the row bites its tail
  layout.place();
  EXPECT_TRUE(layout.is_row({0, 1, 2, 3}, {0, 1, 3, 4}));
  EXPECT_TRUE(layout.is_row({0, 1, 4, 2, 3}, {0, 1, 2, 3, 4}));
  EXPECT_FALSE(layout.is_row({2, 3, 0, 1}, {0, 1, 2, 3}));
}

TEST(KernelLayoutTest, PositionsHaveTheGapsThatTheRowsHave) {
  KernelLayout layout(8);
  for (int i = 0; i < 8; ++i) layout.add(i, -1);
  layout.read_together({0, 1, 2, 3}, {0, 1, 2, 3});
  layout.read_together({4, 5, 6, 7}, {0, 1, 2, 3});
  EXPECT_EQ(layout.find_positions({{0, 1, 3}, {4, 5, 7}, {6, 6, 6}}, 3), (KernelLayout::Positions{0, 1, 3}));
}

}  // namespace
}  // namespace ferrers
