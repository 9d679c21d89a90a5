#include "pinode/watch/store.h"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>

namespace pinode {
namespace {

class StoreTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name =
        (std::filesystem::temp_directory_path() / "storeXXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    path_ = folder_ + "/watch.db";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::unique_ptr<Store> Open(
      Store::Access access = Store::Access::kReadAndWrite) {
    std::unique_ptr<Store> store;
    EXPECT_TRUE(Store::Open(path_, access, &store, &error_)) << error_;
    return store;
  }
  bool Refuses() {
    std::unique_ptr<Store> store;
    return !Store::Open(path_, Store::Access::kReadAndWrite, &store, &error_);
  }
  int64_t Structure(Store* store, const std::string& settings = "s") {
    int64_t id = -1;
    EXPECT_TRUE(store->OpenStructure("bridge", settings, &id, &error_))
        << error_;
    return id;
  }
  void Execute(const std::string& sql) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr),
              SQLITE_OK);
    sqlite3_close(database);
  }

  std::string folder_, path_, error_;
};

StoredRecord MakeRecord(const std::string& content, double time) {
  StoredRecord record;
  record.content = content;
  record.name = content + ".csv";
  record.time = time;
  record.duration = 600.0;
  record.channels = {{"a1", ""}, {"a2", "is dead."}};
  StoredMode mode;
  mode.frequency_hz = 2.5;
  mode.frequency_sigma = 0.01;
  mode.damping_ratio = 0.02;
  mode.damping_sigma = 0.003;
  mode.shape = ComplexVector(2);
  mode.shape << std::complex<double>(1.0, -0.5),
      std::complex<double>(0.0, 1e-9);
  record.modes = {mode, mode};
  record.covariates = {{"temperature", -3.25}};
  return record;
}

TEST_F(StoreTest, ReturnsWhatItWasGiven) {
  {
    auto store = Open();
    bool added = false;
    ASSERT_TRUE(store->Add(Structure(store.get()), MakeRecord("x", 1.5e9),
                           &added, &error_));
    EXPECT_TRUE(added);
  }
  auto store = Open();
  std::vector<StoredRecord> records;
  ASSERT_TRUE(store->Records(Structure(store.get()), &records, &error_));
  ASSERT_EQ(records.size(), 1u);
  const StoredRecord expected = MakeRecord("x", 1.5e9);
  const StoredRecord& record = records[0];
  EXPECT_EQ(record.name, expected.name);
  EXPECT_EQ(record.time, expected.time);
  EXPECT_EQ(record.duration, expected.duration);
  EXPECT_EQ(record.refusal, "");
  ASSERT_EQ(record.channels.size(), 2u);
  EXPECT_EQ(record.channels[1].fault, "is dead.");
  ASSERT_EQ(record.modes.size(), 2u);
  EXPECT_EQ(record.modes[1].damping_sigma, 0.003);
  EXPECT_EQ(record.modes[1].shape, expected.modes[1].shape);
  EXPECT_EQ(record.Covariate("temperature"), -3.25);
  EXPECT_TRUE(std::isnan(record.Covariate("wind")));
}

TEST_F(StoreTest, TakesAContentOnce) {
  auto store = Open();
  auto other = Open();
  const int64_t id = Structure(store.get());
  bool added = false;
  ASSERT_TRUE(store->Add(id, MakeRecord("x", 1.0), &added, &error_));
  ASSERT_TRUE(other->Add(id, MakeRecord("x", 2.0), &added, &error_));
  EXPECT_FALSE(added);
  bool has = false;
  ASSERT_TRUE(other->Has(id, "x", &has, &error_));
  EXPECT_TRUE(has);
  ASSERT_TRUE(other->Has(id, "y", &has, &error_));
  EXPECT_FALSE(has);
  std::vector<StoredRecord> records;
  ASSERT_TRUE(other->Records(id, &records, &error_));
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].time, 1.0);
  EXPECT_EQ(records[0].modes.size(), 2u);
}

TEST_F(StoreTest, OrdersByTimeAndKeepsRefusals) {
  auto store = Open();
  const int64_t id = Structure(store.get());
  bool added = false;
  StoredRecord refused = MakeRecord("r", kNaN);
  refused.refusal = "no time";
  ASSERT_TRUE(store->Add(id, MakeRecord("b", 2.0), &added, &error_));
  ASSERT_TRUE(store->Add(id, refused, &added, &error_));
  ASSERT_TRUE(store->Add(id, MakeRecord("a", 1.0), &added, &error_));
  std::vector<StoredRecord> records;
  ASSERT_TRUE(store->Records(id, &records, &error_));
  ASSERT_EQ(records.size(), 3u);
  EXPECT_TRUE(std::isnan(records[0].time));
  EXPECT_EQ(records[0].refusal, "no time");
  EXPECT_EQ(records[1].content, "a");
  EXPECT_EQ(records[2].content, "b");
}

// A process that is killed at any step of adding a record.
TEST_F(StoreTest, HoldsARecordAsAWholeWhateverDies) {
  { Structure(Open().get()); }
  int whole = 0;
  for (int delay = 0; delay < 10; ++delay) {
    const pid_t child = fork();
    if (child == 0) {
      std::unique_ptr<Store> store;
      std::string error;
      if (!Store::Open(path_, Store::Access::kReadAndWrite, &store, &error)) {
        _exit(1);
      }
      bool added = false;
      for (int i = 0;; ++i) {
        const std::string content =
            std::to_string(delay) + "-" + std::to_string(i);
        if (!store->Add(1, MakeRecord(content, i), &added, &error)) _exit(1);
      }
    }
    // A slow machine must have stored one, or the test shows nothing.
    for (int i = 0; delay == 9 && i < 500; ++i) {
      std::vector<StoredRecord> stored;
      ASSERT_TRUE(Open()->Records(1, &stored, &error_)) << error_;
      if (!stored.empty()) break;
      usleep(20000);
    }
    usleep(static_cast<useconds_t>(2000 + 2100 * delay));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    auto store = Open();
    std::vector<StoredRecord> records;
    ASSERT_TRUE(store->Records(Structure(store.get()), &records, &error_))
        << error_;
    for (const StoredRecord& record : records) {
      ASSERT_EQ(record.channels.size(), 2u);
      ASSERT_EQ(record.modes.size(), 2u);
      ASSERT_EQ(record.covariates.size(), 1u);
    }
    ASSERT_GE(static_cast<int>(records.size()), whole);
    whole = static_cast<int>(records.size());
  }
  EXPECT_GT(whole, 0);
}

TEST_F(StoreTest, RefusesOtherSettings) {
  auto store = Open();
  int64_t id = Structure(store.get(), "columns x");
  bool added = false;
  // A record that was refused may be so because of the settings.
  StoredRecord refused = MakeRecord("r", 1.0);
  refused.refusal = "none of the columns";
  ASSERT_TRUE(store->Add(id, refused, &added, &error_));
  ASSERT_TRUE(store->OpenStructure("bridge", "columns a", &id, &error_))
      << error_;
  bool has = true;
  ASSERT_TRUE(store->Has(id, "r", &has, &error_));
  EXPECT_FALSE(has);
  ASSERT_TRUE(store->Add(id, MakeRecord("x", 1.0), &added, &error_));
  EXPECT_FALSE(store->OpenStructure("bridge", "columns b", &id, &error_));
  EXPECT_NE(error_.find("other settings"), std::string::npos) << error_;
  EXPECT_TRUE(store->OpenStructure("tower", "columns b", &id, &error_));
}

TEST_F(StoreTest, UsesTheLogAgainAfterAKill) {
  { Open(); }
  Execute("PRAGMA journal_mode = DELETE");
  { Open(); }
  // The version of the format in the header: 2 with the log.
  std::ifstream file(path_, std::ios::binary);
  std::string header(20, '\0');
  file.read(header.data(), 20);
  EXPECT_EQ(header[18], 2);
}

TEST_F(StoreTest, RefusesWhatIsNoStore) {
  std::ofstream(path_) << "not a database, but some text that is long enough";
  EXPECT_TRUE(Refuses());
  EXPECT_NE(error_.find("not a store"), std::string::npos) << error_;
  std::filesystem::remove(path_);
  Execute("CREATE TABLE other (x)");
  EXPECT_TRUE(Refuses());
  EXPECT_NE(error_.find("not a store"), std::string::npos) << error_;
}

TEST_F(StoreTest, RefusesAnotherSchema) {
  { Open(); }
  Execute("PRAGMA user_version = 2");
  EXPECT_TRUE(Refuses());
  EXPECT_NE(error_.find("schema 2"), std::string::npos) << error_;
}

TEST_F(StoreTest, RefusesAMissingFolder) {
  path_ = folder_ + "/none/watch.db";
  EXPECT_TRUE(Refuses());
  EXPECT_NE(error_.find("cannot be opened"), std::string::npos) << error_;
}

TEST_F(StoreTest, SaysThatItIsReadOnly) {
  int64_t id = 0;
  {
    auto store = Open();
    id = Structure(store.get());
  }
  auto store = Open(Store::Access::kReadOnly);
  bool added = false;
  EXPECT_FALSE(store->Add(id, MakeRecord("x", 1.0), &added, &error_));
  EXPECT_NE(error_.find("cannot be written"), std::string::npos) << error_;
  std::vector<StoredRecord> records;
  EXPECT_TRUE(store->Records(id, &records, &error_)) << error_;
}

TEST_F(StoreTest, ReadsWhileAnotherProcessWrites) {
  auto store = Open();
  const int64_t id = Structure(store.get());
  sqlite3* writer = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &writer), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(writer, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr),
            SQLITE_OK);
  std::vector<StoredRecord> records;
  EXPECT_TRUE(store->Records(id, &records, &error_)) << error_;
  sqlite3_exec(writer, "ROLLBACK", nullptr, nullptr, nullptr);
  sqlite3_close(writer);
}

// A store of an earlier program lacks the tables that came later.
TEST_F(StoreTest, AnEarlierStoreGetsTheLaterTables) {
  Structure(Open().get());
  Execute("DROP TABLE file; DROP TABLE mend; DROP TABLE history");
  auto store = Open();
  const int64_t id = Structure(store.get());
  StoredMend mend;
  mend.time = 5.0;
  mend.person = "N. N.";
  mend.kind = "name";
  ASSERT_TRUE(store->AddMend(id, mend, &error_)) << error_;
  ASSERT_TRUE(store->RememberFiles(id, {{"/a.csv", 1, 2, 3, "c"}}, &error_));
  ASSERT_TRUE(
      store->SetEvents(id, {}, {{"time", Vector::Ones(3)}, {"x", {}}}, &error_))
      << error_;
  std::vector<StoredFile> files;
  ASSERT_TRUE(store->Files(id, &files, &error_));
  EXPECT_TRUE(files.empty());  // without its record
  bool added = false;
  ASSERT_TRUE(store->Add(id, MakeRecord("c", 1.0), &added, &error_));
  ASSERT_TRUE(store->Files(id, &files, &error_));
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(files[0].changed, 3);
  std::vector<StoredMend> mends;
  ASSERT_TRUE(store->Mends(id, &mends, &error_));
  ASSERT_EQ(mends.size(), 1u);
  EXPECT_EQ(mends[0].person, "N. N.");
}

TEST_F(StoreTest, ReplacesEvents) {
  auto store = Open();
  const int64_t id = Structure(store.get());
  ASSERT_TRUE(store->SetEvents(id, {{1.0, "alarm", "x"}, {2.0, "notice", "y"}},
                               {}, &error_));
  ASSERT_TRUE(store->SetEvents(id, {{3.0, "alarm", "z"}}, {}, &error_));
  std::vector<StoredEvent> events;
  ASSERT_TRUE(store->Events(id, &events, &error_));
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].text, "z");
}

TEST(ContentIdentity, IsThatOfFnv) {
  // The published value of FNV-1a for "foobar".
  EXPECT_EQ(ContentIdentity("foobar"), "6-85944171f73967e8");
}

}  // namespace
}  // namespace pinode
