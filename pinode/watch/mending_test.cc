#include "pinode/watch/mending.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "pinode/watch/watch.h"

namespace pinode {
namespace {

class MendingTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name =
        (std::filesystem::temp_directory_path() / "mendXXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    ASSERT_TRUE(Store::Open(folder_ + "/w.db", Store::Access::kReadAndWrite,
                            &store_, &error_));
    ASSERT_TRUE(store_->OpenStructure("bridge", "", &id_, &error_));
    for (int r = 0; r < 40; ++r) {
      StoredRecord record;
      record.content = "c" + std::to_string(r);
      record.name = "r" + std::to_string(r) + ".csv";
      record.time = 86400.0 * r;
      record.channels = {{"a", ""}};
      StoredMode mode;
      mode.frequency_hz = 2.0 + 0.001 * (r % 5);
      mode.frequency_sigma = 0.002;
      mode.shape = ComplexVector::Ones(1);
      record.modes = {mode};
      bool added = false;
      ASSERT_TRUE(store_->Add(id_, record, &added, &error_));
    }
    structure_.reference.num_records = 35;
    structure_.chart.most_simulated = 2000;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  bool Try(const std::string& text, const std::string& person = "N. N.",
           const std::string& reason = "crane") {
    StoredMend mend;
    mend.time = 1e6;
    return ParseDecision(text, person, reason, &mend, &error_) &&
           Mend(mend, id_, store_.get(), &message_, &error_);
  }
  WatchAnalysis Analyse() {
    WatchAnalysis analysis;
    EXPECT_TRUE(AnalyseStore(structure_, id_, store_.get(), &analysis, &error_))
        << error_;
    return analysis;
  }

  std::string folder_, error_, message_;
  std::unique_ptr<Store> store_;
  int64_t id_ = 0;
  WatchedStructure structure_;
};

TEST_F(MendingTest, ARejectedRecordIsLeftOutAndComesBack) {
  EXPECT_EQ(Analyse().records.size(), 40u);
  ASSERT_TRUE(Try("reject:r7.csv")) << error_;
  WatchAnalysis analysis = Analyse();
  EXPECT_EQ(analysis.records.size(), 39u);
  EXPECT_EQ(analysis.num_rejected, 1);
  EXPECT_EQ(analysis.records[7].name, "r8.csv");
  // The record itself stays in the store, and so does the decision.
  std::vector<StoredRecord> records;
  ASSERT_TRUE(store_->Records(id_, &records, &error_));
  EXPECT_EQ(records.size(), 40u);
  ASSERT_TRUE(Try("accept:r7.csv", "M. M.", "no crane")) << error_;
  analysis = Analyse();
  EXPECT_EQ(analysis.records.size(), 40u);
  ASSERT_EQ(analysis.mends.size(), 2u);
  EXPECT_EQ(analysis.mends[0].person, "N. N.");
  EXPECT_EQ(analysis.mends[0].reason, "crane");
  EXPECT_EQ(analysis.mends[0].time, 1e6);
  EXPECT_EQ(analysis.mends[0].subject, "c7");
  EXPECT_EQ(DecisionText(analysis.mends[0]), "reject r7.csv");
}

TEST_F(MendingTest, ANameIsInTheNameOfTheMode) {
  ASSERT_TRUE(Try("name:2.01=bending")) << error_;
  ASSERT_TRUE(Try("name:7=far away")) << error_;
  const WatchAnalysis analysis = Analyse();
  EXPECT_EQ(analysis.series.names,
            std::vector<std::string>{"mode 1 (2.002 Hz, bending)"});
  EXPECT_EQ(DecisionText(analysis.mends[0]), "name 2.01 Hz: bending");
}

TEST_F(MendingTest, TheLastNameOfAModeCounts) {
  ASSERT_TRUE(Try("name:2.002=bending")) << error_;
  ASSERT_TRUE(Try("name:2.05=torsion")) << error_;
  EXPECT_EQ(Analyse().series.names,
            std::vector<std::string>{"mode 1 (2.002 Hz, torsion)"});
}

TEST_F(MendingTest, AnAlarmIsAcknowledgedOnce) {
  EXPECT_FALSE(Try("acknowledge:1970-01-02 00:00"));
  EXPECT_NE(error_.find("it has none"), std::string::npos) << error_;
  const StoredEvent alarm = {86400.25, "alarm", "x"};
  const StoredEvent notice = {86400.25, "notice", "x"};
  ASSERT_TRUE(store_->SetEvents(id_, {alarm, notice}, {}, &error_));
  ASSERT_TRUE(Try("acknowledge:1970-01-02 00:00")) << error_;
  const WatchAnalysis analysis = Analyse();
  EXPECT_EQ(Acknowledgement(analysis.mends, alarm),
            "N. N., 1970-01-12 13:46: crane");
  EXPECT_EQ(Acknowledgement(analysis.mends, notice), "");
  EXPECT_EQ(Acknowledgement(analysis.mends, {1.0, "alarm", "y"}), "");
}

TEST_F(MendingTest, RefusesInOneLine) {
  for (const char* text :
       {"", "reject", "reject:", "reject:none.csv", "lose:r1.csv", "name:2",
        "name:x=y", "name:-1=y", "name:2=", "acknowledge:yesterday"}) {
    error_.clear();
    EXPECT_FALSE(Try(text)) << text;
    EXPECT_NE(error_, "") << text;
    EXPECT_EQ(error_.find('\n'), std::string::npos);
  }
  EXPECT_FALSE(Try("reject:r1.csv", "", "crane"));
  EXPECT_FALSE(Try("reject:r1.csv", "N. N.", ""));
  EXPECT_NE(error_.find("--by"), std::string::npos);
  std::vector<StoredMend> mends;
  ASSERT_TRUE(store_->Mends(id_, &mends, &error_));
  EXPECT_TRUE(mends.empty());
}

}  // namespace
}  // namespace pinode
