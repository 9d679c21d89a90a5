#include "pinode/case/run/find_modes.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/strings.h"
#include "tests/support/modal_testing.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

// A chain of three masses: its two lower places, and its two upper ones.
constexpr char kTwoSetups[] = R"([units]
time = "s"
[[record]]
name = "low"
file = "low.csv"
sampling_rate_hz = 50
channel = [
  {column = "a", dof = "u1", quantity = "absolute_acceleration", unit = "m/s^2"},
  {column = "b", dof = "u2", quantity = "absolute_acceleration", unit = "m/s^2"},
]
[[record]]
name = "high"
file = "high.csv"
sampling_rate_hz = 50
channel = [
  {column = "a", dof = "u2", quantity = "absolute_acceleration", unit = "m/s^2"},
  {column = "b", dof = "u3", quantity = "absolute_acceleration", unit = "m/s^2"},
]
[modes]
)";

class FindModesTest : public ::testing::Test {
 protected:
  FindModesTest() {
    Write("low.csv", 1, 0);
    Write("high.csv", 2, 1);
  }

  // Columns of places `first` and the next.
  void Write(const std::string& name, unsigned seed, int first) {
    const ResponseRecord record =
        SimulateChain(TestChain(3, 400.0), 0.02, 12000, seed);
    std::string text = "a,b\n";
    for (Eigen::Index k = 0; k < record.num_samples(); ++k) {
      text += FormatNumber(record.samples(first, k), 12) + "," +
              FormatNumber(record.samples(first + 1, k), 12) + "\n";
    }
    folder_.Write(name, text);
  }

  bool Find(const std::string& text, std::string* error) {
    ModesCase c;
    return ReadModesCase(folder_.Write("case.toml", text), &c, error) &&
           FindModes(c, &found_, error);
  }

  std::string Error(const std::string& text) {
    std::string error;
    EXPECT_FALSE(Find(text, &error));
    return error;
  }

  TemporaryFolder folder_;
  FoundModes found_;
};

TEST_F(FindModesTest, OfTwoSetupsTogether) {
  std::string error;
  ASSERT_TRUE(Find(kTwoSetups, &error)) << error;
  EXPECT_THAT(found_.by_record, SizeIs(2));
  EXPECT_THAT(found_.result.setups, ElementsAre("low", "high"));
  EXPECT_THAT(found_.result.merged.places, ElementsAre("u1", "u2", "u3"));
  ASSERT_THAT(found_.result.merged.modes, SizeIs(3));
  // The chain's first shape grows upwards.
  const Eigen::VectorXcd& shape = found_.result.merged.modes[0].mode.shape;
  EXPECT_LT(shape[0].real(), shape[1].real());
  EXPECT_LT(shape[1].real(), shape[2].real());
  EXPECT_FALSE(found_.picture.has_value());
}

TEST_F(FindModesTest, NamesTheLineOfWhatIsAtFault) {
  const std::string order = std::string(kTwoSetups) + "max_order = 400\n";
  EXPECT_THAT(Error(order), HasSubstr("case.toml:20: [modes] max_order: record "
                                      "'low': models of order 400"));
  const std::string alone = std::string(kTwoSetups) + "references = [\"u1\"]\n";
  EXPECT_THAT(Error(alone),
              HasSubstr("case.toml:20: [modes] references: reference 'u1' is "
                        "not a channel of record 'high'"));
  std::string few = kTwoSetups;
  few.replace(few.find("file = \"high.csv\""), 17,
              "file = \"high.csv\"\nwindow = [0.0, 5.0]");
  EXPECT_THAT(Error(few), HasSubstr("case.toml:11: record 'high' has 251"));
  // Nothing in common.
  std::string apart = kTwoSetups;
  apart.replace(apart.rfind("dof = \"u2\""), 10, "dof = \"u9\"");
  EXPECT_THAT(Error(apart),
              HasSubstr("case.toml: the records have no common place"));
}

}  // namespace
}  // namespace pinode
