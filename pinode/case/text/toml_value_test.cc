#include "pinode/case/text/toml_value.h"

#include <limits>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

TomlValue Parse(const std::string& text) {
  TomlValue root;
  std::string error;
  EXPECT_TRUE(ParseToml(text, "a.toml", &root, &error)) << error;
  return root;
}

TEST(TomlValueTest, KeepsOrderAndLines) {
  const TomlValue root = Parse(
      "zeta = 1\n"
      "alpha = [1.5,\n"
      "  'two']\n"
      "[table]\n"
      "b.c = true\n"
      "[[list]]\n"
      "x = 1\n"
      "[[list]]\n"
      "y = 2\n");
  ASSERT_EQ(root.entries.size(), 4u);
  EXPECT_EQ(root.entries[0].first, "zeta");
  EXPECT_EQ(root.entries[1].first, "alpha");
  EXPECT_EQ(root.entries[2].first, "table");
  EXPECT_EQ(root.entries[3].first, "list");
  EXPECT_EQ(root.Find("alpha")->line, 2);
  EXPECT_EQ(root.Find("alpha")->elements[1].line, 3);
  EXPECT_EQ(root.Find("table")->line, 4);
  EXPECT_TRUE(root.Find("table")->Find("b")->Find("c")->boolean);
  const TomlValue& list = *root.Find("list");
  ASSERT_TRUE(list.IsArrayOfTables());
  EXPECT_EQ(list.elements[1].line, 8);
  EXPECT_EQ(list.elements[1].Find("y")->line, 9);
  EXPECT_EQ(root.Find("nothing"), nullptr);
}

TEST(TomlValueTest, SaysWhereTheTextIsWrong) {
  TomlValue root;
  std::string error;
  EXPECT_FALSE(ParseToml("a = 1\nb = = 2\n", "a.toml", &root, &error));
  EXPECT_THAT(error, HasSubstr("a.toml:2: "));
  EXPECT_FALSE(ParseToml("a = 1\na = 2\n", "a.toml", &root, &error));
  EXPECT_THAT(error, HasSubstr("a.toml:2: "));
}

// Written values are read back, bit for bit and in the same order.
TEST(TomlValueTest, RoundTrip) {
  TomlValue root = TomlValue::Table();
  root.Set("text",
           TomlValue::String("a \"quoted\" \\ text\n\twith\x01 more ü"));
  root.Set("numbers",
           TomlValue::Numbers({0.1, -1e-300, 3.0, 1.0 / 3.0,
                               std::numeric_limits<double>::infinity()}));
  root.Set("odd key", TomlValue::Integer(-7));
  TomlValue table = TomlValue::Table();
  TomlValue inner = TomlValue::Table();
  inner.Set("yes", TomlValue::Boolean(true));
  table.Set("inner", inner);
  table.Set("names", TomlValue::Strings({"u1", "u2"}));
  root.Set("table", table);
  TomlValue first = TomlValue::Table();
  first.Set("name", TomlValue::String("one"));
  TomlValue nested = TomlValue::Table();
  nested.Set("column", TomlValue::String("c"));
  first.Set("channel", TomlValue::Array({nested, nested}));
  // After the nested tables in the tree, before them in the text.
  first.Set("last", TomlValue::Float(2.0));
  root.Set("list", TomlValue::Array({first, first}));

  const TomlValue read = Parse(FormatToml(root));
  EXPECT_EQ(read.Find("text")->text, root.Find("text")->text);
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(read.Find("numbers")->elements[i].number,
              root.Find("numbers")->elements[i].number);
    EXPECT_EQ(read.Find("numbers")->elements[i].type, TomlValue::Type::kFloat);
  }
  EXPECT_EQ(read.Find("odd key")->integer, -7);
  EXPECT_TRUE(read.Find("table")->Find("inner")->Find("yes")->boolean);
  ASSERT_EQ(read.Find("list")->elements.size(), 2u);
  for (const TomlValue& element : read.Find("list")->elements) {
    EXPECT_EQ(element.Find("channel")->elements.size(), 2u);
    EXPECT_EQ(element.Find("last")->number, 2.0);
  }
  // Once in that order, writing again changes nothing.
  EXPECT_EQ(FormatToml(read), FormatToml(Parse(FormatToml(read))));
}

// A parser that recurses once a level ends by a signal at some 10,000 levels.
TEST(TomlValueTest, DeepNestingIsRefused) {
  const auto repeated = [](const std::string& part, int times) {
    std::string text;
    for (int i = 0; i < times; ++i) text += part;
    return text;
  };
  const std::string deep = repeated("a.", 20000) + "a";
  const std::string hidden = "a = [\"\"\"x\"\"\"\"\", {" + deep + " = 1}]\n";
  for (const std::string& text :
       {"x = 1\n" + deep + " = 1\n", "\n[" + deep + "]\n",
        "\n[[" + deep + "]]\n", "\na = " + repeated("[", 20000) + "\n",
        "\n" + repeated("{a=", 20000) + "\n",
        "\nb = " + repeated("{a.b.c.d=", 200) + "1\n", "\n" + hidden,
        "\n\"x\"" + repeated(".\"y\"", 20000) + " = 1\n"}) {
    TomlValue root;
    std::string error;
    ASSERT_FALSE(ParseToml(text, "deep.toml", &root, &error))
        << text.substr(0, 40);
    EXPECT_THAT(error, HasSubstr("deep.toml:2: more than 100 levels"));
  }
}

TEST(TomlValueTest, MuchTextIsNotDeep) {
  // Numbers, texts, comments and many tables in turn add no level.
  std::string text = "title = \"\"\"a.b.c\n[[[\"\"\"\nb = [";
  for (int i = 0; i < 500; ++i) text += "1.5, ";
  text += "]\n";
  for (int i = 0; i < 500; ++i) {
    text += "[[a.b]] # ....[[[[\nc.d = 1.5\ne = [[1.5], '...', {f.g = 2}]\n";
  }
  const TomlValue root = Parse(text);
  EXPECT_EQ(root.Find("b")->elements.size(), 500u);
  EXPECT_EQ(root.Find("a")->Find("b")->elements.size(), 500u);
}

TEST(TomlValueTest, SetAndErase) {
  TomlValue table = TomlValue::Table();
  table.Set("a", TomlValue::Integer(1));
  table.Set("b", TomlValue::Integer(2));
  table.Set("a", TomlValue::Integer(3));
  ASSERT_EQ(table.entries.size(), 2u);
  EXPECT_EQ(table.entries[0].second.integer, 3);
  table.Erase("a");
  table.Erase("c");
  ASSERT_EQ(table.entries.size(), 1u);
  EXPECT_EQ(table.entries[0].first, "b");
}

}  // namespace
}  // namespace pinode
