// Compares universal files of many programs with another reader's results, and
// with themselves after writing and reading.

#include <Eigen/LU>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/record/files/universal_file.h"
#include "tests/support/measured_data_testing.h"
#include "tests/support/universal_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

class MeasuredUniversalFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    PINODE_FIND_MEASURED_DATA(folder, "uff");
    folder_ = folder;
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
    // A truncated file: it contains 42 of 2508876 numbers.
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
  }
  EXPECT_GT(functions, 8);
}

// Equal to the last bit. Functions as text may lose the last digits of binary
// ones.
TEST_F(MeasuredUniversalFileTest, WhatIsWrittenIsReadBackEqual) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    const std::string path = entry.path().string();
    UniversalFile file;
    std::string error;
    if (!IsUniversalFile(path) || !ReadUniversalFile(path, &file, &error)) {
      continue;
    }
    SCOPED_TRACE(path);
    ++files;
    Eigen::Index numbers = 0;
    for (const UniversalFunction& f : file.functions) numbers += f.size();
    for (const UniversalEncoding encoding :
         {UniversalEncoding::kBinary, UniversalEncoding::kText}) {
      const bool text = encoding == UniversalEncoding::kText;
      if (text && numbers > 100000) continue;
      UniversalFile again;
      ASSERT_TRUE(ParseUniversalFile(FormatUniversalFile(file, encoding), path,
                                     &again, &error))
          << error;
      ExpectEqualFiles(again, file, {0.0, text ? 5e-12 : 0.0}, {});
    }
  }
  EXPECT_EQ(files, 15);
}

// Each of its nodes has its own directions: the first has x and z reversed.
TEST_F(MeasuredUniversalFileTest, DirectionsAtNodes) {
  UniversalFile file;
  std::string error;
  ASSERT_TRUE(ReadUniversalFile(folder_ + "/TestLab_161_164_18_15_82.uff",
                                &file, &error))
      << error;
  EXPECT_EQ(file.systems.size(), file.nodes.size());
  for (const UniversalNode& node : file.nodes) {
    EXPECT_EQ(node.displacement_system, node.label);
    Eigen::Matrix3d axes;
    ASSERT_TRUE(file.AxesAt(node, &axes)) << node.label;
    EXPECT_NEAR(axes.determinant(), 1.0, 1e-6);
    if (node.label != 1) continue;
    EXPECT_TRUE(axes.isApprox(
        Eigen::Vector3d(-1.0, 1.0, -1.0).asDiagonal().toDenseMatrix(), 1e-6))
        << axes;
  }
}

}  // namespace
}  // namespace pinode
