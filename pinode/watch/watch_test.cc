#include "pinode/watch/watch.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>

namespace pinode {
namespace {

namespace fs = std::filesystem;

// A folder of files that are no records: they are refused at once, and stored
// as refused.
class WatchFolderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "watchXXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    ASSERT_TRUE(Store::Open(folder_ + "/w.db", Store::Access::kReadAndWrite,
                            &store_, &error_));
    ASSERT_TRUE(store_->OpenStructure("bridge", "", &id_, &error_));
    structure_.name = "bridge";
    structure_.records.time_in_name = "r%Y%m%d";
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Writes a file, and gives it a time that is long past, or of now.
  void Write(const std::string& name, const std::string& content,
             bool is_old = true) {
    const std::string path = folder_ + "/" + name;
    std::ofstream(path) << content;
    if (is_old) {
      fs::last_write_time(
          path, fs::file_time_type::clock::now() - std::chrono::hours(1));
    }
  }
  WatchCounts Look(bool skip_growing = false) {
    WatchCounts counts;
    EXPECT_TRUE(StoreNewRecords(structure_, folder_, skip_growing, id_, {},
                                store_.get(), &counts, &error_))
        << error_;
    return counts;
  }

  std::string folder_, error_;
  std::unique_ptr<Store> store_;
  int64_t id_ = 0;
  WatchedStructure structure_;
};

TEST_F(WatchFolderTest, KnownFilesAreNotReadAgain) {
  Write("r20240101.csv", "one");
  Write("r20240102.csv", "two");
  WatchCounts counts = Look();
  EXPECT_EQ(counts.read, 2);
  EXPECT_EQ(counts.stored, 2);
  // Another process, such as the next run of cron.
  store_.reset();
  ASSERT_TRUE(Store::Open(folder_ + "/w.db", Store::Access::kReadAndWrite,
                          &store_, &error_));
  counts = Look();
  EXPECT_EQ(counts.read, 0);
  EXPECT_EQ(counts.known, 2);
  // Another content of the same size, and a new name of a known content.
  Write("r20240102.csv", "owt");
  Write("r20240103.csv", "one");
  counts = Look();
  EXPECT_EQ(counts.read, 2);
  EXPECT_EQ(counts.stored, 1);
  EXPECT_EQ(counts.known, 2);
  EXPECT_EQ(Look().read, 0);
}

TEST_F(WatchFolderTest, AFileThatIsReplacedWithItsOldTimeIsRead) {
  Write("r20240101.csv", "one");
  const auto time = fs::last_write_time(folder_ + "/r20240101.csv");
  EXPECT_EQ(Look().stored, 1);
  Write("r20240101.csv", "eno");
  fs::last_write_time(folder_ + "/r20240101.csv", time);
  EXPECT_EQ(Look().stored, 1);
}

TEST_F(WatchFolderTest, AFileOfThisMomentIsLeftOrReadAgain) {
  Write("r20240101.csv", "one", false);
  EXPECT_EQ(Look(true).growing, 1);
  EXPECT_EQ(Look().stored, 1);
  // It may change within the resolution of its times.
  const WatchCounts counts = Look();
  EXPECT_EQ(counts.read, 1);
  EXPECT_EQ(counts.known, 1);
}

TEST_F(WatchFolderTest, AFileWhoseRecordIsGoneIsRead) {
  Write("r20240101.csv", "one");
  EXPECT_EQ(Look().stored, 1);
  // Only refused records, so that other settings start anew.
  ASSERT_TRUE(store_->OpenStructure("bridge", "others", &id_, &error_));
  EXPECT_EQ(Look().stored, 1);
}

TEST_F(WatchFolderTest, TheStateOfCovariatesChangesWithTheirFile) {
  EXPECT_EQ(CovariateFilesState(structure_), "");
  WatchedCovariate covariate;
  covariate.file = folder_ + "/weather.csv";
  structure_.covariates.push_back(covariate);
  EXPECT_EQ(CovariateFilesState(structure_), "");
  Write("weather.csv", "t,T\n");
  const std::string first = CovariateFilesState(structure_);
  EXPECT_NE(first, "");
  EXPECT_EQ(CovariateFilesState(structure_), first);
  Write("weather.csv", "t,T\n2024-01-01,3\n");
  EXPECT_NE(CovariateFilesState(structure_), first);
}

}  // namespace
}  // namespace pinode
