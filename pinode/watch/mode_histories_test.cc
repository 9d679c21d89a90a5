#include "pinode/watch/mode_histories.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <set>

namespace pinode {
namespace {

StoredMode Mode(double hz, const std::vector<double>& shape,
                double turn = 0.0) {
  StoredMode mode;
  mode.frequency_hz = hz;
  mode.frequency_sigma = 0.001 * hz;
  mode.shape.resize(static_cast<Eigen::Index>(shape.size()));
  for (size_t i = 0; i < shape.size(); ++i) {
    mode.shape[static_cast<Eigen::Index>(i)] = shape[i] * std::polar(1.0, turn);
  }
  return mode;
}

StoredRecord RecordOf(const std::vector<StoredMode>& modes,
                      const std::string& faulty = "") {
  StoredRecord record;
  for (const char* name : {"a", "b", "c"}) {
    record.channels.push_back({name, name == faulty ? "is dead." : ""});
  }
  record.modes = modes;
  return record;
}

// The history that a record's mode is in; -1: none.
int HistoryOf(const std::vector<ModeHistory>& histories, int record, int mode) {
  for (size_t h = 0; h < histories.size(); ++h) {
    for (const ModeHistory::Point& point : histories[h].points) {
      if (point.record == record && point.mode == mode) {
        return static_cast<int>(h);
      }
    }
  }
  return -1;
}

TEST(ModeHistories, FollowsShapesThroughACrossing) {
  const std::vector<double> bending = {0.5, 1.0, 0.5};
  const std::vector<double> torsion = {1.0, 0.1, -1.0};
  std::vector<StoredRecord> records;
  for (int r = 0; r < 60; ++r) {
    const double f1 = 5.0 + 0.01 * r;
    const double f2 = 5.6 - 0.01 * r;
    // Phase and sign of a shape mean nothing.
    const StoredMode b = Mode(f1, bending, 0.7 * r);
    const StoredMode t = Mode(f2, torsion, 1.3 * r);
    records.push_back(RecordOf(f1 < f2 ? std::vector<StoredMode>{b, t}
                                       : std::vector<StoredMode>{t, b}));
  }
  const auto histories = JoinModes(records, TrackingOptions());
  ASSERT_EQ(histories.size(), 2u);
  const int bending_history = HistoryOf(histories, 0, 0);
  EXPECT_EQ(HistoryOf(histories, 59, 1), bending_history);
  EXPECT_EQ(histories[0].points.size(), 60u);
  EXPECT_EQ(histories[1].points.size(), 60u);
}

TEST(ModeHistories, NothingIsJoinedTwice) {
  std::vector<StoredRecord> records;
  for (int r = 0; r < 40; ++r) {
    std::vector<StoredMode> modes = {Mode(3.0, {1.0, 1.0, 1.0})};
    // A second pole of the same mode, and a mode that comes and goes.
    if (r % 3 == 0) modes.push_back(Mode(3.02, {1.0, 1.0, 0.9}));
    if (r % 4 != 0) modes.push_back(Mode(9.0, {1.0, -1.0, 0.3}));
    records.push_back(RecordOf(modes));
  }
  const auto histories = JoinModes(records, TrackingOptions());
  std::set<std::pair<int, int>> seen;
  size_t count = 0;
  for (const ModeHistory& history : histories) {
    int last = -1;
    for (const ModeHistory::Point& point : history.points) {
      EXPECT_GT(point.record, last);
      last = point.record;
      seen.emplace(point.record, point.mode);
      ++count;
    }
  }
  EXPECT_EQ(seen.size(), count);
  size_t modes = 0;
  for (const StoredRecord& record : records) modes += record.modes.size();
  EXPECT_EQ(count, modes);
  EXPECT_EQ(histories.size(), 3u);
}

TEST(ModeHistories, ComparesTheChannelsThatBothHave) {
  std::vector<StoredRecord> records;
  for (int r = 0; r < 20; ++r) {
    records.push_back(r % 2 == 0 ? RecordOf({Mode(3.0, {1.0, -1.0, 0.5})})
                                 : RecordOf({Mode(3.0, {-1.0, 0.5})}, "a"));
  }
  EXPECT_EQ(JoinModes(records, TrackingOptions()).size(), 1u);
}

TEST(ModeHistories, AJumpBeginsAHistory) {
  std::vector<StoredRecord> records(10, RecordOf({Mode(3.0, {1.0, 1.0, 1.0})}));
  records.resize(20, RecordOf({Mode(3.5, {1.0, 1.0, 1.0})}));
  EXPECT_EQ(JoinModes(records, TrackingOptions()).size(), 2u);
  TrackingOptions wide;
  wide.largest_step = 0.2;
  EXPECT_EQ(JoinModes(records, wide).size(), 1u);
}

}  // namespace
}  // namespace pinode
