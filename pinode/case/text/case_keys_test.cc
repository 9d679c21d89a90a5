#include "pinode/case/text/case_keys.h"

#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/case/text/toml_table.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const char kBegin[] = "<!-- keys of ";
const char kEnd[] = "<!-- end of keys -->\n";

// Returns the page with its tables of keys printed anew. *paths are those of
// the tables, in their order.
std::string PrintedAnew(const std::string& page,
                        std::vector<std::string>* paths) {
  std::string text;
  size_t place = 0;
  while (true) {
    const size_t begin = page.find(kBegin, place);
    if (begin == std::string::npos) return text + page.substr(place);
    const size_t name = begin + sizeof(kBegin) - 1;
    const size_t line_end = page.find('\n', begin) + 1;
    const size_t end = page.find(kEnd, line_end);
    std::string path = page.substr(name, page.find(" -->", name) - name);
    if (path == "a case") path.clear();
    paths->push_back(path);
    const CaseTable* table = FindCaseTable(path);
    text += page.substr(place, line_end - place) + "\n" +
            (table == nullptr ? "no such table\n" : KeyReference(*table)) +
            "\n";
    place = end;
  }
}

// The reference of keys is what the reader has. With PINODE_PRINT_KEYS in the
// environment the page is written anew.
TEST(CaseKeysTest, ThePageHasTheTablesOfTheReader) {
  const std::string path =
      std::string(PINODE_SOURCE_DIR) + "/pinode/case/README.md";
  std::stringstream page;
  page << std::ifstream(path).rdbuf();
  std::vector<std::string> paths;
  const std::string expected = PrintedAnew(page.str(), &paths);
  if (std::getenv("PINODE_PRINT_KEYS") != nullptr) {
    std::ofstream(path) << expected;
  }
  EXPECT_EQ(page.str(), expected)
      << "run this test with PINODE_PRINT_KEYS=1 to print the tables anew";
  std::multiset<std::string> there(paths.begin(), paths.end());
  for (const CaseTable& table : CaseTables()) {
    EXPECT_EQ(there.count(table.path), 1u)
        << "of '" << table.path << "' in pinode/case/README.md";
  }
  EXPECT_EQ(paths.size(), CaseTables().size());
}

TEST(CaseKeysTest, EveryKeyIsDescribedOnce) {
  std::set<std::string> paths;
  for (const CaseTable& table : CaseTables()) {
    EXPECT_TRUE(paths.insert(table.path).second) << table.path;
    EXPECT_FALSE(table.keys.empty()) << table.path;
    std::set<std::string> names;
    for (const std::string& name : table.Names()) {
      EXPECT_TRUE(names.insert(name).second) << table.path << " " << name;
    }
    for (const CaseKey& key : table.keys) {
      const std::string place = std::string(table.path) + " " + key.name;
      const std::string meaning = key.meaning;
      ASSERT_FALSE(meaning.empty()) << place;
      EXPECT_EQ(meaning.back(), '.') << place;
      EXPECT_STRNE(key.absent, "") << place;
      for (const std::string& type : TypesOf(key)) {
        EXPECT_FALSE(type.empty()) << place;
      }
      for (const char* text : {key.type, key.unit, key.absent, key.meaning}) {
        EXPECT_EQ(std::string(text).find_first_of("|\n"), std::string::npos)
            << place << ": " << text << " breaks a row of a table";
      }
    }
  }
}

// Every table that another one holds is in the list, or has free names.
TEST(CaseKeysTest, TablesAreUnderTheirKeys) {
  for (const CaseTable& table : CaseTables()) {
    const std::string path = table.path;
    const size_t point = path.rfind('.');
    const bool is_shared = path == "unknown" || path == "matrix" ||
                           path == "matrix file" || path == "candidates";
    if (path.empty() || is_shared) continue;
    const CaseTable* above =
        FindCaseTable(point == std::string::npos ? "" : path.substr(0, point));
    ASSERT_NE(above, nullptr) << path;
    EXPECT_NE(above->Find(path.substr(point + 1)), nullptr) << path;
  }
}

// Whatever a test of this program reads, it reads as CaseTables() says.
class NoKeyMistakes : public ::testing::Environment {
 public:
  void TearDown() override {
    for (const std::string& mistake : TakeKeyMistakes()) {
      ADD_FAILURE() << mistake << ", and the table of keys says otherwise";
    }
  }
};

const ::testing::Environment* const kNoKeyMistakes =
    ::testing::AddGlobalTestEnvironment(new NoKeyMistakes());

class ReaderTest : public ::testing::Test {
 protected:
  // Reads `text` as the table [options].
  TomlTable Options(const std::string& text) {
    EXPECT_TRUE(ParseToml(text, "case.toml", &tree_, &error_)) << error_;
    return TomlTable(tree_, "[options]", &errors_, "options");
  }

  TomlValue tree_;
  std::string error_;
  CaseErrors errors_{"case.toml", &error_};
};

TEST_F(ReaderTest, KeysThatAreNotListedAreRefused) {
  const TomlTable options = Options("max_iteration = 3\n");
  EXPECT_FALSE(options.AllowKeys());
  EXPECT_EQ(error_,
            "case.toml:1: [options]: unknown key 'max_iteration'; did you "
            "mean 'max_iterations'?");
}

TEST_F(ReaderTest, ReadingAKeyThatIsNotListedIsAMistake) {
  const TomlTable options = Options("seed = 3\n");
  EXPECT_TRUE(options.Takes("seed"));
  EXPECT_FALSE(options.Takes("sead"));
  EXPECT_THAT(TakeKeyMistakes(), IsEmpty());
  EXPECT_FALSE(options.Has("sead"));
  EXPECT_THAT(TakeKeyMistakes(),
              ElementsAre("'options': 'sead' is read as a key"));
}

TEST_F(ReaderTest, ReadingAnotherTypeIsAMistake) {
  Options("").Strings("seed");
  EXPECT_THAT(TakeKeyMistakes(),
              ElementsAre("'options': 'seed' is read as texts"));
}

TEST_F(ReaderTest, ReadingWithAnotherDefaultIsAMistake) {
  const TomlTable options = Options("seed = 3\n");
  options.Integer("seed", 7, 0, 1000);  // It is not absent.
  options.Integer("max_iterations", 2000, 0, 100000);
  options.Choice("robust_loss", {"none", "huber", "cauchy"}, "none");
  EXPECT_THAT(TakeKeyMistakes(), IsEmpty());
  options.Integer("max_iterations", 1000, 0, 100000);
  EXPECT_THAT(
      TakeKeyMistakes(),
      ElementsAre(
          "'options': 'max_iterations' is read as 1000 where it is absent"));
}

TEST_F(ReaderTest, ReadingOtherChoicesIsAMistake) {
  Options("").Choice("robust_loss", {"none", "huber"}, "none");
  EXPECT_THAT(TakeKeyMistakes(),
              ElementsAre("'options': 'robust_loss' is read as never "
                          "\"cauchy\""));
}

TEST_F(ReaderTest, FreeNamesAreNotChecked) {
  EXPECT_TRUE(ParseToml("u1 = 2.0", "case.toml", &tree_, &error_));
  const TomlTable shares(tree_, "areas", &errors_, "record.ambient.areas");
  EXPECT_EQ(shares.Number("u1", 0.0), 2.0);
  EXPECT_THAT(TakeKeyMistakes(), IsEmpty());
}

TEST_F(ReaderTest, SharedTablesAreFoundByTheTypeOfTheirKey) {
  EXPECT_TRUE(ParseToml("gain = {initial = 1.0, fre = true}", "case.toml",
                        &tree_, &error_));
  const TomlTable channel(tree_, "channel", &errors_, "record.channel");
  EXPECT_FALSE(channel.Table("gain", "channel, gain").AllowKeys());
  EXPECT_THAT(error_, HasSubstr("unknown key 'fre'; did you mean 'free'?"));
}

}  // namespace
}  // namespace pinode
