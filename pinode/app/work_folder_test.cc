#include "pinode/app/work_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;

class WorkFolderTest : public ::testing::Test {
 protected:
  WorkFolderTest() : work_(folder_.Path(""), "work_1") {
    EXPECT_TRUE(work_.Create(&error_)) << error_;
    state_.files = {{"a.csv", FileUse::kBaseline},
                    {"b.csv", FileUse::kLater},
                    {"frame.inp", FileUse::kDeck}};
    for (const WorkFile& file : state_.files) {
      std::ofstream(work_.PathOf(file)) << "t,a\n";
    }
  }

  TemporaryFolder folder_;
  std::string error_;
  WorkFolder work_;
  WorkState state_;
};

TEST_F(WorkFolderTest, IsReadBackAsItWasSaved) {
  state_.answers = {{"storeys", "5"}, {"time", "Zeit"}};
  state_.places = {{"a", "-3"}, {"<b>", "base"}};
  state_.is_result_old = true;
  state_.remarks = {"one", "two"};
  ASSERT_TRUE(work_.Save(state_, &error_)) << error_;
  WorkState read;
  ASSERT_TRUE(work_.Load(&read, &error_)) << error_;
  EXPECT_EQ(read.files.size(), 3u);
  EXPECT_EQ(read.answers, state_.answers);
  EXPECT_EQ(read.places, state_.places);
  EXPECT_TRUE(read.is_result_old);
  EXPECT_EQ(read.remarks, state_.remarks);

  // A file that is gone is not listed, and a case that is gone not checked.
  state_.is_checked = true;
  ASSERT_TRUE(work_.Save(state_, &error_)) << error_;
  fs::remove(work_.PathOf(state_.files[1]));
  ASSERT_TRUE(work_.Load(&read, &error_)) << error_;
  ASSERT_EQ(read.files.size(), 2u);
  EXPECT_EQ(read.files[1].name, "frame.inp");
  EXPECT_FALSE(read.is_checked);
}

TEST_F(WorkFolderTest, RefusesOtherFiles) {
  WorkState read;
  for (const std::string text : {"", "{", "[]", "{\"schema\": \"other\"}"}) {
    folder_.Write("work_1/work.json", text);
    EXPECT_FALSE(work_.Load(&read, &error_)) << text;
    EXPECT_NE(error_.find("work.json"), std::string::npos) << error_;
  }
  // Entries of the wrong type are left out.
  folder_.Write("work_1/work.json",
                "{\"schema\": \"pinode-app-1\", \"files\": [{\"name\": "
                "\"a.csv\", \"use\": \"other\"}], \"answers\": {\"storeys\": "
                "5, \"unknown\": \"x\"}, \"places\": []}");
  ASSERT_TRUE(work_.Load(&read, &error_)) << error_;
  EXPECT_TRUE(read.files.empty());
  EXPECT_TRUE(read.answers.empty());
}

TEST_F(WorkFolderTest, MakesTheRequest) {
  state_.files.pop_back();
  state_.answers = {
      {"storeys", "5"}, {"weights", "900 kN"}, {"sampling_rate_hz", "200"}};
  DraftRequest request = RequestOf(work_, state_);
  EXPECT_EQ(request.logs, std::vector<std::string>{work_.At("records/a.csv")});
  EXPECT_EQ(request.later_logs,
            std::vector<std::string>{work_.At("later/b.csv")});
  EXPECT_EQ(request.storeys, "5");
  EXPECT_EQ(request.weights, "900 kN");
  EXPECT_EQ(request.damping_ratio, "0.02");
  EXPECT_EQ(request.time.sampling_rate_hz, 200.0);
  EXPECT_EQ(request.base + request.sensors + request.force, "")
      << "found by names";

  state_.places = {{"g", "base"},
                   {"s1", "1"},
                   {"s2", "-2"},
                   {"T", "none"},
                   {"F", "force:2"}};
  request = RequestOf(work_, state_);
  EXPECT_EQ(request.base, "g");
  EXPECT_EQ(request.sensors, "s1=1,s2=-2");
  EXPECT_EQ(request.force, "F=2");
  EXPECT_EQ(request.ignore, "T");
  EXPECT_EQ(CommandOf(work_, state_),
            "pinode_new 'records/a.csv' --later='later/b.csv' --storeys='5' "
            "--weights='900 kN' --damping_ratio='0.02' --base='g' "
            "--sensors='s1=1,s2=-2' --force='F=2' --ignore='T' "
            "--sampling_rate_hz='200'");

  state_.places.erase("g");
  EXPECT_EQ(RequestOf(work_, state_).base, "none")
      << "all columns have a place";
}

TEST_F(WorkFolderTest, ADeckIsInPlaceOfStoreys) {
  state_.answers = {{"storeys", "5"}, {"deck_units", "N, mm"}};
  const DraftRequest request = RequestOf(work_, state_);
  EXPECT_EQ(request.deck, work_.At("deck/frame.inp"));
  EXPECT_EQ(request.deck_units, "N, mm");
  EXPECT_EQ(request.storeys, "");
}

TEST_F(WorkFolderTest, SpeaksToReaders) {
  EXPECT_EQ(work_.ForReader(work_.At("records/a.csv") +
                            ": give --storeys=5, --unit or --force_unit"),
            "a.csv: give \"Storeys\"=5, \"Unit of the columns\" or \"Unit of "
            "the forces\"");
}

TEST_F(WorkFolderTest, KnowsFitsThatWereCutOff) {
  EXPECT_FALSE(work_.HasUnfinishedFit("result"));
  fs::create_directories(work_.At("result.partial-7"));
  EXPECT_FALSE(work_.HasUnfinishedFit("result"));
  folder_.Write("work_1/result.partial-7/checkpoint.json", "{}");
  EXPECT_TRUE(work_.HasUnfinishedFit("result"));
  EXPECT_FALSE(work_.HasUnfinishedFit("damage"));
}

TEST(ListWorks, IsInTheOrderOfNumbers) {
  const TemporaryFolder folder;
  EXPECT_EQ(NextWork(folder.Path("")), "work_1");
  for (const char* name : {"work_2", "work_10", "work_x", "other", "work_0"}) {
    fs::create_directories(folder.Path(name));
  }
  EXPECT_EQ(ListWorks(folder.Path("")),
            (std::vector<std::string>{"work_2", "work_10"}));
  EXPECT_EQ(NextWork(folder.Path("")), "work_11");
}

}  // namespace
}  // namespace pinode
