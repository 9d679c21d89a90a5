#include "pinode/record/universal_file.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/file.h"
#include "pinode/base/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

UniversalFile Example() {
  UniversalFile file;
  file.nodes = {{3, {0.5, -1.25, 2.0}, 0, 0}, {12, {1.0, 2.0, 3.0}, 0, 0}};
  file.lines = {{"outline", {3, 12, 0, 12, 3, 12, 3, 12, 3}}};
  for (int k = 0; k < 2; ++k) {
    UniversalFunction f;
    f.texts[0] = "deck";
    f.response_node = 3;
    f.response_direction = k == 0 ? 2 : -3;
    f.abscissa_start = 0.0;
    f.abscissa_step = 0.01;
    f.ordinate_type = 12;
    f.ordinate_label = "Acceleration";
    f.ordinate_unit = "m/s^2";
    f.values.resize(7);
    for (int i = 0; i < 7; ++i) f.values[i] = std::sin(i + k) / 3.0;
    file.functions.push_back(f);
  }
  UniversalShape shape;
  shape.mode = 2;
  shape.frequency = 3.5;
  shape.viscous_damping = 0.01;
  shape.nodes = {3, 12};
  shape.values = Eigen::MatrixXcd::Constant(2, 3, 0.25);
  shape.values(1, 2) = -1.5;
  file.shapes.push_back(shape);
  return file;
}

TEST(UniversalFileTest, WhatIsWrittenIsReadBack) {
  const UniversalFile file = Example();
  const std::string text = FormatUniversalFile(file);
  UniversalFile read;
  std::string error;
  ASSERT_TRUE(ParseUniversalFile(text, "x.uff", &read, &error)) << error;
  EXPECT_THAT(read.set_types, ElementsAre(15, 82, 58, 58, 55));
  ASSERT_THAT(read.nodes, SizeIs(2));
  EXPECT_EQ(read.nodes[0].label, 3);
  EXPECT_EQ(read.nodes[0].position, file.nodes[0].position);
  ASSERT_THAT(read.lines, SizeIs(1));
  EXPECT_EQ(read.lines[0].nodes, file.lines[0].nodes);
  ASSERT_THAT(read.functions, SizeIs(2));
  for (size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(read.functions[k].response_node, 3);
    EXPECT_EQ(read.functions[k].response_direction,
              file.functions[k].response_direction);
    EXPECT_EQ(read.functions[k].ordinate_unit, "m/s^2");
    EXPECT_EQ(read.functions[k].abscissa_step, 0.01);
    EXPECT_LT((read.functions[k].values - file.functions[k].values).norm(),
              1e-12);
  }
  ASSERT_THAT(read.shapes, SizeIs(1));
  EXPECT_EQ(read.shapes[0].frequency, 3.5);
  EXPECT_EQ(read.shapes[0].mode, 2);
  EXPECT_EQ(read.shapes[0].values, file.shapes[0].values);
  // And once more, to the byte.
  EXPECT_EQ(FormatUniversalFile(read), text);
}

TEST(UniversalFileTest, HistoriesAreATable) {
  const TemporaryFolder folder;
  const std::string path =
      folder.Write("x.UFF", FormatUniversalFile(Example()));
  Table table;
  std::string error;
  ASSERT_TRUE(ReadUniversalTable(path, {"t", "3:-z"}, &table, &error)) << error;
  EXPECT_THAT(table.columns, ElementsAre("t", "3:-z"));
  ASSERT_EQ(table.num_rows(), 7);
  EXPECT_NEAR(table.values(3, 0), 0.03, 1e-12);
  EXPECT_NEAR(table.values(3, 1), std::sin(4.0) / 3.0, 1e-12);
  ASSERT_TRUE(ReadUniversalTable(path, {}, &table, &error)) << error;
  EXPECT_THAT(table.columns, ElementsAre("t", "3:y", "3:-z"));
  EXPECT_FALSE(ReadUniversalTable(path, {"3:x"}, &table, &error));
  EXPECT_THAT(error, HasSubstr("'3:x'"));
}

TEST(UniversalFileTest, DamagedFilesAreRefused) {
  const std::string text = FormatUniversalFile(Example());
  UniversalFile file;
  std::string error;
  EXPECT_FALSE(ParseUniversalFile("", "x.uff", &file, &error));
  EXPECT_FALSE(ParseUniversalFile("just a text\n", "x.uff", &file, &error));
  EXPECT_THAT(error, HasSubstr("no data set"));
  // Cut off anywhere: read as far as it goes, or refused, never more.
  for (size_t size = 0; size < text.size(); size += 7) {
    UniversalFile part;
    if (ParseUniversalFile(text.substr(0, size), "x.uff", &part, &error)) {
      EXPECT_LE(part.functions.size(), 2u);
    } else {
      EXPECT_THAT(error, HasSubstr("x.uff: "));
    }
  }
  EXPECT_FALSE(ParseUniversalFile("    -1\n    58b 1 2 11 4000000 0 0\n" +
                                      std::string(400, '\n') + "    -1\n",
                                  "x.uff", &file, &error));
}

// Headers that end early, and labels that are no integers.
TEST(UniversalFileTest, OddNumbersAreRefused) {
  UniversalFile file;
  std::string error;
  for (const char* header : {"   58b", "   58b   ", "58B"}) {
    EXPECT_FALSE(ParseUniversalFile("    -1\n" + std::string(header) + "\n" +
                                        std::string(5, '\n') + "    1\n" +
                                        "         2         3         1\n" +
                                        std::string(4, '\n') + "    -1\n",
                                    "x.uff", &file, &error));
    EXPECT_THAT(error, HasSubstr("not IEEE numbers")) << header;
  }
  for (const char* label : {"1e300", "nan", "1.5", "-inf", "3e9"}) {
    EXPECT_FALSE(ParseUniversalFile(
        "    -1\n    15\n" + std::string(label) + " 0 0 1 0. 0. 0.\n    -1\n",
        "x.uff", &file, &error));
    EXPECT_THAT(error, HasSubstr("is no node")) << label;
    EXPECT_FALSE(ParseUniversalFile(
        "    -1\n    15\n1 0 " + std::string(label) + " 1 0. 0. 0.\n    -1\n",
        "x.uff", &file, &error));
  }
}

TEST(UniversalFileTest, CoordinateSystems) {
  const std::string text =
      "    -1\n    18\n"
      "         1         0         0         1         1\nsame\n"
      " 0.0 0.0 0.0 2.0 0.0 0.0\n 0.0 0.0 3.0\n"
      "         2         0         0         1         1\nturned\n"
      " 0.0 0.0 0.0 -1.0 0.0 0.0\n 0.0 0.0 1.0\n"
      "         3         1         0         1         1\nround\n"
      " 0.0 0.0 0.0 1.0 0.0 0.0\n 0.0 0.0 1.0\n"
      "         4         0         2         1         1\nof another\n"
      " 0.0 0.0 0.0 1.0 0.0 0.0\n 0.0 0.0 1.0\n"
      "    -1\n    -1\n  2420\n         1\npart\n"
      "         7         0         0\nsame\n"
      " 1.0D+0 0.0 0.0\n 0.0 1.0 0.0\n 0.0 0.0 1.0\n 0.0 0.0 0.0\n"
      "         8         0         0\nmoved\n"
      " 1.0 0.0 0.0\n 0.0 1.0 0.0\n 0.0 0.0 1.0\n 0.0 0.0 5.0\n"
      "    -1\n    -1\n    15\n"
      "         9         7         2         1 0.0 1.0 2.0\n    -1\n";
  UniversalFile file;
  std::string error;
  ASSERT_TRUE(ParseUniversalFile(text, "x.uff", &file, &error)) << error;
  for (const int system : {0, 1, 7}) EXPECT_TRUE(file.IsGlobal(system));
  for (const int system : {2, 3, 4, 8, 5}) {
    EXPECT_FALSE(file.IsGlobal(system)) << system;
  }
  ASSERT_THAT(file.nodes, SizeIs(1));
  EXPECT_EQ(file.nodes[0].system, 7);
  EXPECT_EQ(file.nodes[0].displacement_system, 2);
  EXPECT_TRUE(UniversalFile().IsGlobal(1));
  EXPECT_FALSE(UniversalFile().IsGlobal(2));
}

// Files of many programs, held against what another reader made of them.
class MeasuredUniversalFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("PINODE_MEASURED_DATA");
    folder_ = (folder != nullptr
                   ? std::string(folder)
                   : std::string(PINODE_SOURCE_DIR) + "/../shared/data") +
              "/uff";
    if (!std::filesystem::exists(folder_)) {
      GTEST_SKIP() << "no measured data; set PINODE_MEASURED_DATA to the "
                      "folder that holds uff/";
    }
  }

  static double Real(const nlohmann::json& value) {
    return value.is_array() ? value[0].get<double>() : value.get<double>();
  }

  std::string folder_;
};

TEST_F(MeasuredUniversalFileTest, AllAreReadAsByOthers) {
  std::ifstream stream(folder_ + "/reference.json");
  nlohmann::json reference;
  stream >> reference;
  int functions = 0;
  for (const auto& [name, expected] : reference.items()) {
    UniversalFile file;
    std::string error;
    // Cut off: 42 of 2508876 numbers are left of it.
    if (name == "dataset_milestone_in_header.uff") {
      EXPECT_FALSE(ReadUniversalFile(folder_ + "/" + name, &file, &error));
      EXPECT_THAT(error, HasSubstr("it has 42 numbers"));
      continue;
    }
    ASSERT_TRUE(ReadUniversalFile(folder_ + "/" + name, &file, &error))
        << error;
    EXPECT_EQ(file.set_types, expected["set_types"].get<std::vector<int>>())
        << name;
    size_t function = 0;
    size_t shape = 0;
    for (const auto& set : expected["sets"]) {
      const int type = set["type"];
      if (type == 58 && set.contains("n")) {
        ASSERT_LT(function, file.functions.size()) << name;
        const UniversalFunction& f = file.functions[function++];
        ++functions;
        EXPECT_EQ(f.size(), set["n"].get<int>()) << name;
        EXPECT_EQ(f.function_type, set["func_type"].get<int>()) << name;
        EXPECT_EQ(f.response_node, set["rsp_node"].get<int>()) << name;
        EXPECT_EQ(f.response_direction, set["rsp_dir"].get<int>()) << name;
        if (set["abscissa_spacing"].get<int>() == 1) {
          EXPECT_NEAR(f.abscissa_step, set["dx"].get<double>(),
                      1e-12 + 1e-6 * f.abscissa_step)
              << name;
          EXPECT_EQ(f.abscissa_start, set["x0"].get<double>()) << name;
        }
        for (size_t i = 0; i < set["first"].size(); ++i) {
          const double value = Real(set["first"][i]);
          EXPECT_NEAR(f.values[static_cast<Eigen::Index>(i)].real(), value,
                      1e-8 + 1e-6 * std::abs(value))
              << name;
        }
        const double mean = Real(set["mean"]);
        EXPECT_NEAR(f.values.real().mean(), mean, 1e-8 + 1e-5 * std::abs(mean))
            << name;
      }
      if (type == 55) {
        ASSERT_LT(shape, file.shapes.size()) << name;
        const UniversalShape& s = file.shapes[shape++];
        EXPECT_EQ(s.analysis_type, set["analysis_type"].get<int>()) << name;
        EXPECT_EQ(static_cast<int>(s.nodes.size()), set["n_nodes"].get<int>())
            << name;
        if (set.contains("freq")) {
          EXPECT_EQ(s.frequency, set["freq"].get<double>()) << name;
        }
        for (size_t i = 0; i < set["r1_first"].size(); ++i) {
          EXPECT_NEAR(s.values(static_cast<Eigen::Index>(i), 0).real(),
                      Real(set["r1_first"][i]), 1e-9)
              << name;
        }
      }
      if ((type == 15 || type == 2411) && set.contains("n_nodes") &&
          set["n_nodes"].is_number()) {
        EXPECT_EQ(static_cast<int>(file.nodes.size()),
                  set["n_nodes"].get<int>())
            << name;
      }
    }
    // What is written is read back equal.
    UniversalFile again;
    ASSERT_TRUE(
        ParseUniversalFile(FormatUniversalFile(file), name, &again, &error) ||
        file.nodes.size() + file.lines.size() + file.functions.size() +
                file.shapes.size() ==
            0)
        << error;
    ASSERT_EQ(again.functions.size(), file.functions.size());
    for (size_t i = 0; i < file.functions.size(); ++i) {
      EXPECT_LT((again.functions[i].values - file.functions[i].values).norm(),
                1e-5 * file.functions[i].values.norm())
          << name;
    }
    EXPECT_EQ(again.nodes.size(), file.nodes.size()) << name;
    EXPECT_EQ(again.shapes.size(), file.shapes.size()) << name;
  }
  EXPECT_GT(functions, 8);
}

}  // namespace
}  // namespace pinode
