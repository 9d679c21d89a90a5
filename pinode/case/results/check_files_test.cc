#include "pinode/case/results/check_files.h"

#include <nlohmann/json.hpp>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/file.h"
#include "pinode/case/text/json_table.h"
#include "pinode/structure/matrices/matrix_market.h"
#include "tests/support/case_testing.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using OrderedJson = nlohmann::ordered_json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// Two storeys of 1 kg: K of eigenvalues 100 and 600, damped by a fiftieth.
constexpr char kModel[] = R"(title = "Two storeys"
[model]
dofs = ["u1", "u2"]
mass = {diagonal = [1, 1]}
stiffness = [[500, -200], [-200, 200]]
damping = {ratios = [0.02]}
expected_hz = [1.6]
)";

constexpr char kModes[] = R"([[group]]
name = "k1"
adds_to = "stiffness"
between = ["ground", "u1"]
scale = 300
[modal]
[[mode]]
name = "first"
frequency = 1.5915494309189535
frequency_sigma = 0.01
)";

class CheckFilesTest : public ::testing::Test {
 protected:
  void Check(const std::string& text) {
    std::string error;
    ASSERT_TRUE(ReadCaseForCheck(folder_.Write("case.toml", text), &c_, &error))
        << error;
    check_ = CheckCase(c_);
    ASSERT_TRUE(WriteCheckFiles(c_, check_, folder_.Path("."), &error))
        << error;
    json_ = OrderedJson::parse(Content("check.json"));
  }

  std::string Content(const std::string& name) {
    std::string text, error;
    EXPECT_TRUE(ReadTextFile(folder_.Path(name), &text, &error)) << error;
    return text;
  }

  Matrix MatrixOf(const std::string& name) {
    SparseMatrix matrix;
    std::string error;
    EXPECT_TRUE(ReadMatrixMarket(folder_.Path(name), &matrix, &error)) << error;
    return Matrix(matrix);
  }

  bool Exists(const std::string& name) {
    std::string text, error;
    return ReadTextFile(folder_.Path(name), &text, &error);
  }

  TemporaryFolder folder_;
  Case c_;
  CaseCheck check_;
  OrderedJson json_;
};

TEST_F(CheckFilesTest, AModelAlone) {
  Check(kModel);
  EXPECT_TRUE(check_.ok());
  EXPECT_EQ(json_["schema"], "pinode-check-1");
  EXPECT_EQ(json_["assessed"], false);
  EXPECT_EQ(json_["message"], "nothing was measured");
  EXPECT_EQ(json_["dofs"], OrderedJson({"u1", "u2"}));
  EXPECT_TRUE(json_["no_modes"].is_null());
  EXPECT_TRUE(json_["free_parameters"].is_null());
  EXPECT_TRUE(json_["finite_element"].is_null());
  EXPECT_FALSE(Exists("expected.csv"));
  EXPECT_FALSE(Exists("measured_modes.csv"));

  // (K - w^2 M) phi = 0 of what the files have, phi' M phi = I, and the ratio.
  const Matrix mass = MatrixOf("M.mtx"), stiffness = MatrixOf("K.mtx");
  const Matrix shapes = MatrixOf("mode_shapes.mtx");
  EXPECT_LT(
      (shapes.transpose() * mass * shapes - Matrix::Identity(2, 2)).norm(),
      1e-12);
  const double rates[] = {100.0, 600.0};
  for (int i = 0; i < 2; ++i) {
    const double frequency = std::sqrt(rates[i]) / (2.0 * M_PI);
    EXPECT_LT(
        (stiffness * shapes.col(i) - rates[i] * mass * shapes.col(i)).norm(),
        1e-9);
    const OrderedJson& mode = json_["modes"][static_cast<size_t>(i)];
    EXPECT_NEAR(mode["frequency_hz"].get<double>(), frequency, 1e-12);
    EXPECT_NEAR(mode["damping_ratio"].get<double>(), 0.02, 1e-12);
    EXPECT_NEAR(shapes.col(i).dot(MatrixOf("C.mtx") * shapes.col(i)),
                2.0 * 0.02 * std::sqrt(rates[i]), 1e-9);
  }
  EXPECT_EQ(json_["modes"][0]["expected_hz"], 1.6);
  EXPECT_TRUE(json_["modes"][1]["expected_hz"].is_null());
  EXPECT_THAT(
      Content("modes.csv"),
      StartsWith("mode,frequency_hz,damping_ratio,expected_hz,"
                 "participation_x,effective_mass_x,mass_share_x\n1,1.59"));
  // Gamma = phi' M r, and the effective masses of all modes are r' M r.
  double sum = 0.0;
  for (int i = 0; i < 2; ++i) {
    const OrderedJson& mode = json_["modes"][static_cast<size_t>(i)];
    const double gamma = shapes.col(i).dot(mass * Vector::Ones(2));
    EXPECT_NEAR(mode["participation_x"].get<double>(), gamma, 1e-12);
    EXPECT_NEAR(mode["effective_mass_x"].get<double>(), gamma * gamma, 1e-12);
    sum += mode["mass_share_x"].get<double>();
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
}

TEST_F(CheckFilesTest, MeasuredModesAndWhatTheyTell) {
  Check(std::string(kModel) + kModes);
  EXPECT_EQ(json_["assessed"], true);
  EXPECT_EQ(json_["free_parameters"], 1);
  ASSERT_EQ(json_["measured_modes"].size(), 1u);
  EXPECT_EQ(json_["measured_modes"][0]["name"], "first");
  EXPECT_EQ(json_["measured_modes"][0]["mode"], 1);
  EXPECT_THAT(Content("measured_modes.csv"),
              HasSubstr("\nfirst,1.59154943091895"));

  // dw^2/dalpha = phi_1' K_1 phi_1 with phi = (1, 2) / sqrt(5): 60, over
  // 2 w (2 pi) a frequency of 0.01 Hz.
  const double sigma = 0.01 * 2.0 * M_PI * 2.0 * 10.0 / 60.0;
  ASSERT_EQ(json_["expected"].size(), 1u);
  EXPECT_EQ(json_["expected"][0]["name"], "k1");
  EXPECT_NEAR(json_["expected"][0]["sigma"].get<double>(), sigma, 1e-9);
  EXPECT_THAT(Content("expected.csv"),
              StartsWith("name,unit,initial,sigma\nk1,1,0,0.0209"));
}

TEST(MayGiveWayToCheck, AnEarlierCheckAndNoFit) {
  const TemporaryFolder temporary;
  const std::string folder = temporary.Path("");
  std::string error;
  EXPECT_TRUE(MayGiveWayToCheck(folder, &error));
  temporary.Write("check.json", "{}");
  EXPECT_TRUE(MayGiveWayToCheck(folder, &error));
  temporary.Write("result.json", "{}");
  EXPECT_FALSE(MayGiveWayToCheck(folder, &error));
  EXPECT_EQ(error, folder +
                       ": has result.json, which a check does not replace; "
                       "give another folder");
}

// Unknown values are null in JSON and an empty cell in a table.
TEST(TableOfEntries, QuotesTextsAndLeavesOutWhatIsNotKnown) {
  const OrderedJson entries = {
      {{"name", "a,b"}, {"value", 0.5}, {"used", true}, {"of", {"x", "y"}}},
      {{"name", "c"}, {"value", nullptr}, {"used", false}, {"of", {"z"}}}};
  EXPECT_EQ(TableOfEntries(entries),
            "name,value,used,of\n\"a,b\",0.5,1,x y\nc,,0,z\n");
  EXPECT_EQ(TableOfEntries({{{"value", std::nan("")}}}), "value\n\n");
}

}  // namespace
}  // namespace pinode
