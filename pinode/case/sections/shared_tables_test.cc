#include "pinode/case/sections/shared_tables.h"

#include <algorithm>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/record/files/array_table.h"
#include "tests/support/case_testing.h"
#include "tests/support/ranks_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

class SharedTablesTest : public ::testing::Test {
 protected:
  SharedTablesTest() {
    const std::vector<std::string> texts = {
        "t,a,\"b,\nc\"\n0,1,2\n1,3,nan\n", "t,a\n0,1\n1,oops\n",
        "# a remark\nt,x,y\n0,0.1,7\n\n1,0.2,8\n2,0.3,9\n"};
    const std::vector<std::vector<std::string>> columns = {
        {}, {"a"}, {"y", "t"}};
    for (size_t i = 0; i < texts.size(); ++i) {
      wanted_.push_back({folder_.Write(std::to_string(i) + ".csv", texts[i]),
                         columns[i],
                         {}});
    }
    // The same once more, and one that is not there.
    wanted_.push_back(wanted_[0]);
    wanted_.push_back({folder_.Path("none.csv"), {}, {}});
    // A file of a logger, with all that is read beside the numbers.
    TextFormat format;
    format.time_column = "Zeit";
    wanted_.push_back(
        {folder_.Write("logger.csv",
                       "Logger\nZeit;a [mg]\n2024-03-01 12:00:00,5;1,5\n"
                       "2024-03-01 12:00:01,5;2,5\n"),
         {"Zeit", "a"},
         format});
  }

  // Compares planned tables with those that a single process reads.
  void ExpectAsAlone(SharedTables* shared) const {
    for (const SharedTables::Wanted& wanted : wanted_) {
      Table alone, table;
      std::string error_alone, error;
      const bool ok = ReadTable(wanted.path, wanted.columns, wanted.format,
                                &alone, &error_alone);
      EXPECT_EQ(shared->Read(wanted, &table, &error), ok);
      EXPECT_EQ(error, error_alone);
      EXPECT_EQ(table.path, alone.path);
      EXPECT_EQ(table.columns, alone.columns);
      EXPECT_EQ(table.line_numbers, alone.line_numbers);
      EXPECT_EQ(table.units, alone.units);
      EXPECT_EQ(table.reading, alone.reading);
      EXPECT_EQ(table.time_unit, alone.time_unit);
      EXPECT_EQ(table.time_origin.kind, alone.time_origin.kind);
      EXPECT_EQ(table.time_origin.seconds, alone.time_origin.seconds);
      ASSERT_EQ(table.values.rows(), alone.values.rows());
      EXPECT_TRUE((table.values.array() == alone.values.array() ||
                   alone.values.array().isNaN())
                      .all());
      EXPECT_EQ(table.values.array().isNaN().count(),
                alone.values.array().isNaN().count());
    }
  }

  TemporaryFolder folder_;
  std::vector<SharedTables::Wanted> wanted_;
};

TEST_F(SharedTablesTest, EachIsReadByOneRank) {
  for (const int size : {1, 2, 3, 7}) {
    std::vector<int> read(static_cast<size_t>(size));
    testing::ThreadRanks(size).Run([&](Communicator* communicator) {
      SharedTables shared(communicator);
      shared.Plan(wanted_);
      ExpectAsAlone(&shared);
      shared.Finish();
      read[static_cast<size_t>(communicator->rank())] = shared.num_read();
    });
    int total = 0;
    for (const int count : read) {
      total += count;
      EXPECT_LE(count, (6 + size - 1) / size);
    }
    EXPECT_EQ(total, 6) << size << " ranks";
  }
}

TEST_F(SharedTablesTest, EachReadsForItselfWhereTheyDoNotAgree) {
  testing::ThreadRanks(3).Run([&](Communicator* communicator) {
    SharedTables shared(communicator);
    if (communicator->rank() == 1) {
      shared.Finish();  // has found something wrong before it came so far
      return;
    }
    shared.Plan(wanted_);
    ExpectAsAlone(&shared);
    shared.Finish();
    EXPECT_EQ(shared.num_read(), 6);
  });
  testing::ThreadRanks(2).Run([&](Communicator* communicator) {
    SharedTables shared(communicator);
    std::vector<SharedTables::Wanted> own = wanted_;
    if (communicator->rank() == 1) std::swap(own[0], own[1]);
    shared.Plan(own);
    ExpectAsAlone(&shared);
    EXPECT_EQ(shared.num_read(), 6);
  });
}

TEST_F(SharedTablesTest, CaseOfTwoRecords) {
  folder_.Write("quake.csv", SmallRecord());
  folder_.Write("other.csv", SmallRecord(300));
  std::string record = SmallCase().substr(SmallCase().find("[[record]]"));
  record = Replaced(record, "name = \"quake\"", "name = \"other\"");
  record = Replaced(record, "quake.csv", "other.csv");
  const std::string path =
      folder_.Write("case.toml", SmallCase() + "\n" + record);
  const Case alone = ReadOrFail(path);
  testing::ThreadRanks(2).Run([&](Communicator* communicator) {
    SharedTables shared(communicator);
    Case c;
    std::string error;
    ASSERT_TRUE(ReadCase(path, &shared, &c, &error)) << error;
    EXPECT_EQ(shared.num_read(), 1);
    ASSERT_EQ(c.problem.records.size(), 2u);
    for (size_t r = 0; r < 2; ++r) {
      const IdentificationRecord& own = c.problem.records[r];
      const IdentificationRecord& expected = alone.problem.records[r];
      EXPECT_EQ(own.excitation->samples(), expected.excitation->samples());
      ASSERT_EQ(own.channels.size(), expected.channels.size());
      for (size_t i = 0; i < own.channels.size(); ++i) {
        EXPECT_EQ(own.channels[i].values, expected.channels[i].values);
        EXPECT_EQ(own.channels[i].sigma, expected.channels[i].sigma);
      }
    }
  });

  // An error found by one rank is the message of all.
  folder_.Write("other.csv", Replaced(SmallRecord(300), "ag", "gone"));
  testing::ThreadRanks(2).Run([&](Communicator* communicator) {
    SharedTables shared(communicator);
    Case c;
    std::string error;
    EXPECT_FALSE(ReadCase(path, &shared, &c, &error));
    EXPECT_THAT(error, HasSubstr("other.csv"));
    EXPECT_THAT(error, HasSubstr("'ag'"));
  });
}

}  // namespace
}  // namespace pinode
