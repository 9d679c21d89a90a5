#include "pinode/case/sections/modal_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "pinode/case/results/checkpoint_file.h"
#include "pinode/case/results/model_case.h"
#include "pinode/case/results/result_files.h"
#include "pinode/case/sections/case_file.h"
#include "tests/support/case_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The two storeys of SmallCase, modes in place of the record.
std::string Modes() {
  return SmallCase().substr(0, SmallCase().find("[[record]]")) + R"([modal]
form = "eigenvector_difference"
[[mode]]
frequency = 1.0
frequency_sigma = 0.01
shape = {u2 = 2.0, u1 = 0.9}
shape_sigma = 0.02
[[mode]]
name = "second"
frequency = 2.5
frequency_weight = 40
)";
}

struct ReadResult {
  bool ok = false;
  Case c;
  std::string error;
};

ReadResult ReadText(const std::string& text) {
  const TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  folder.Write("shapes.csv", "u1,u2\n0.5,1\n,2\n");
  ReadResult result;
  result.ok =
      ReadCase(folder.Write("case.toml", text), &result.c, &result.error);
  return result;
}

// The covariance s^2 I of the entries weighs as the sigma s does.
TEST(ModalSection, CovarianceOfAShapeIsItsSigma) {
  const ReadResult sigma = ReadText(Modes());
  const ReadResult covariance =
      ReadText(Replaced(Modes(), "shape_sigma = 0.02",
                        "shape_covariance = [[4e-4, 0], [0, 4e-4]]"));
  ASSERT_TRUE(sigma.ok) << sigma.error;
  ASSERT_TRUE(covariance.ok) << covariance.error;
  IdentificationSummary first, second;
  IdentifiedModel model, other;
  testing::FitAndJudge(sigma.c.problem, sigma.c.options, nullptr, &first,
                       &model);
  testing::FitAndJudge(covariance.c.problem, covariance.c.options, nullptr,
                       &second, &other);
  EXPECT_NEAR(first.final_modal_cost, second.final_modal_cost,
              1e-9 * (1.0 + first.final_modal_cost));
  EXPECT_NEAR(model.parameters[0], other.parameters[0], 1e-9);
  const ReadResult singular =
      ReadText(Replaced(Modes(), "shape_sigma = 0.02",
                        "shape_covariance = [[1e-4, 1e-4], [1e-4, 1e-4]]"));
  EXPECT_FALSE(singular.ok);
  EXPECT_THAT(singular.error, HasSubstr("positive definite"));
}

// Deviations of single entries are a covariance without correlation, in the
// order of the shape, which is u2, u1 here.
TEST(ModalSection, DeviationsOfSingleEntries) {
  const auto read = [](const std::string& sigmas) {
    return ReadText(Replaced(Modes(), "shape_sigma = 0.02", sigmas));
  };
  const ReadResult good = read("shape_sigma = {u1 = 0.05, u2 = 0.02}");
  ASSERT_TRUE(good.ok) << good.error;
  const MeasuredMode& mode = good.c.problem.modal.modes[0];
  EXPECT_THAT(mode.dofs, ElementsAre(1, 0));
  Matrix expected = Matrix::Zero(2, 2);
  expected.diagonal() << 0.02 * 0.02, 0.05 * 0.05;
  EXPECT_LT((mode.shape_covariance - expected).norm(), 1e-18);
  EXPECT_THAT(read("shape_sigma = {u1 = 0.05}").error,
              HasSubstr("no deviation of 'u2'"));
  EXPECT_THAT(read("shape_sigma = {u1 = 0.05, u2 = 0}").error,
              HasSubstr("'u2' is the number 0"));
  EXPECT_THAT(read("shape_sigma = {u1 = 0.05, u9 = 1}").error, HasSubstr("u9"));
  EXPECT_THAT(
      read("shape_sigma = {u1 = 0.05, u2 = 0.02}\nshape_weight = 2").error,
      HasSubstr("expected one of 'shape_sigma' and 'shape_weight'"));
}

// Covariance of frequency and shape, in Hz and the shape's unit.
TEST(ModalSection, CovarianceOfFrequencyAndShape) {
  const std::string shape = "shape_covariance = [[4e-4, 0], [0, 4e-4]]\n";
  const auto read = [&shape](const std::string& shared) {
    return ReadText(Replaced(Modes(), "shape_sigma = 0.02", shape + shared));
  };
  const ReadResult good = read("frequency_shape_covariance = [1e-4, -2e-5]");
  ASSERT_TRUE(good.ok) << good.error;
  EXPECT_THAT(good.c.problem.modal.modes[0].frequency_shape_covariance,
              ElementsAre(1e-4, -2e-5));
  EXPECT_THAT(read("frequency_shape_covariance = [1e-4]").error,
              HasSubstr("entry of the shape"));
  EXPECT_THAT(read("frequency_shape_covariance = [3e-4, 0]").error,
              HasSubstr("covariance of frequency and shape is too large"));
  EXPECT_THAT(
      ReadText(Replaced(Modes(), "shape_sigma = 0.02",
                        "shape_sigma = 0.02\n"
                        "frequency_shape_covariance = [1e-4, 0]"))
          .error,
      HasSubstr("'frequency_shape_covariance' needs 'shape_covariance'"));
  EXPECT_THAT(ReadText(Replaced(Replaced(Modes(), "frequency_sigma = 0.01\n",
                                         "frequency_weight = 50\n"),
                                "shape_sigma = 0.02",
                                shape + "frequency_shape_covariance = [0, 0]"))
                  .error,
              HasSubstr("needs 'frequency_sigma'"));
}

TEST(ModalSection, StandsWithoutARecord) {
  const ReadResult result = ReadText(Modes());
  ASSERT_TRUE(result.ok) << result.error;
  const ModalData& modal = result.c.problem.modal;
  EXPECT_EQ(modal.form, ModalForm::kEigenvectorDifference);
  ASSERT_EQ(modal.modes.size(), 2u);
  EXPECT_EQ(modal.modes[0].name, "1");
  EXPECT_EQ(modal.modes[0].frequency, 1.0);
  EXPECT_EQ(modal.modes[0].frequency_sigma, 0.01);
  EXPECT_THAT(modal.modes[0].dofs, ElementsAre(1, 0));
  EXPECT_THAT(modal.modes[0].shape, ElementsAre(2.0, 0.9));
  EXPECT_EQ(modal.modes[0].shape_sigma, 0.02);
  EXPECT_EQ(modal.modes[1].name, "second");
  EXPECT_EQ(modal.modes[1].frequency_weight, 40.0);
  EXPECT_FALSE(modal.modes[1].HasShape());
  EXPECT_TRUE(result.c.problem.records.empty());
  EXPECT_TRUE(result.c.problem.description.remarks.empty());
}

// A measurement may have more modes than a coarse model.
TEST(ModalSection, MoreModesThanTheModelHas) {
  const ReadResult result =
      ReadText(Replaced(Modes(), "[[mode]]\nname = \"second\"",
                        "[[mode]]\nname = \"high\"\nfrequency = 9.0\n"
                        "[[mode]]\nname = \"second\""));
  ASSERT_TRUE(result.ok) << result.error;
  const ReadResult without = ReadText(Modes());
  IdentificationSummary summary, expected;
  IdentifiedModel model, other;
  testing::FitAndJudge(result.c.problem, result.c.options, nullptr, &summary,
                       &model);
  testing::FitAndJudge(without.c.problem, without.c.options, nullptr, &expected,
                       &other);
  ASSERT_EQ(summary.modes.size(), 3u);
  EXPECT_TRUE(summary.modes[0].InUse() && summary.modes[2].InUse());
  EXPECT_FALSE(summary.modes[1].InUse());
  EXPECT_THAT(summary.remarks, Contains(HasSubstr("does not use 'high'")));
  EXPECT_EQ(model.parameters, other.parameters);
  EXPECT_EQ(summary.usable(), expected.usable());
}

TEST(ModalSection, ConvertsHzToTheModelsTime) {
  const ReadResult result = ReadText(
      Replaced(Modes(), "length = \"m\"\n", "length = \"m\"\ntime = \"ms\"\n"));
  ASSERT_TRUE(result.ok) << result.error;
  EXPECT_DOUBLE_EQ(result.c.problem.modal.modes[0].frequency, 1e-3);
  EXPECT_DOUBLE_EQ(result.c.problem.modal.modes[0].frequency_sigma, 1e-5);
}

TEST(ModalSection, ReadsShapesFromAFile) {
  const std::string from = "shape = {u2 = 2.0, u1 = 0.9}";
  ReadResult result = ReadText(
      Replaced(Modes(), from, "shape = \"shapes.csv\"\nshape_row = 1"));
  ASSERT_TRUE(result.ok) << result.error;
  EXPECT_THAT(result.c.problem.modal.modes[0].dofs, ElementsAre(0, 1));
  EXPECT_THAT(result.c.problem.modal.modes[0].shape, ElementsAre(0.5, 1.0));

  // An empty cell was not measured; here that leaves a single DOF.
  result = ReadText(
      Replaced(Modes(), from, "shape = \"shapes.csv\"\nshape_row = 2"));
  EXPECT_FALSE(result.ok);
  EXPECT_THAT(result.error, HasSubstr("a shape needs at least two DOFs"));
}

TEST(ModalSection, RefusesWhatDoesNotBelong) {
  struct Bad {
    std::string from, to, message;
  };
  const std::string shape = "shape = {u2 = 2.0, u1 = 0.9}";
  const std::string sigma = "frequency_sigma = 0.01";
  const std::vector<Bad> cases = {
      {"frequency = 1.0", "frequenzy = 1.0", "did you mean 'frequency'"},
      {"frequency = 1.0\n", "", "the measured frequency in Hz"},
      {"frequency = 1.0", "frequency = 0", "case.toml:19: mode '1'"},
      {"form =", "shape =", "case.toml:17: [modal]: unknown key 'shape'"},
      {"\"eigenvector_difference\"", "\"eigen\"", "'form' is 'eigen'"},
      {sigma, "frequency_sigma = -1", "positive"},
      {sigma, sigma + "\nfrequency_weight = 3", "expected one of"},
      {shape, "shape = {u2 = 2.0, u3 = 0.9}", "'u3'"},
      {shape, "shape = {u2 = 2.0, u1 = \"x\"}", "u1"},
      {shape, "shape = {}", "is empty"},
      {shape, "shape = 3", "expected {dof = value, ...} or a CSV"},
      {shape, "shape = \"none.csv\"", "none.csv"},
      {shape, "shape = \"shapes.csv\"\nshape_row = 3", "has 2 rows"},
      {shape, shape + "\nshape_row = 1", "needs a 'shape' in a file"},
      {shape, "shape_row = 1", "needs 'shape'"},
      {shape, "", "'shape_sigma' without 'shape'"},
      {"name = \"second\"", "name = \"1\"", "used twice"},
      {"\"eigenvector_difference\"", "\"mac\"", "not used in form 'mac'"},
      {"\"eigenvector_difference\"", "\"dynamic_residual\"",
       "expected 'residual_weight'"},
      {sigma, "residual_weight = 1.0", "not used in form"},
  };
  for (const Bad& bad : cases) {
    const ReadResult result = ReadText(Replaced(Modes(), bad.from, bad.to));
    EXPECT_FALSE(result.ok) << bad.to;
    EXPECT_THAT(result.error, HasSubstr(bad.message));
    EXPECT_THAT(result.error,
                AnyOf(HasSubstr(".csv"), HasSubstr("case.toml:")));
  }
  const std::string groups =
      SmallCase().substr(0, SmallCase().find("[[record]]"));
  EXPECT_THAT(ReadText(groups + "[modal]\nform = \"mac\"\n").error,
              HasSubstr("needs at least one [[mode]]"));
  EXPECT_THAT(ReadText(SmallCase() + "[modal]\nform = \"mac\"\n").error,
              HasSubstr("needs at least one [[mode]]"));
  // Nothing to simulate.
  const TemporaryFolder folder;
  Case c;
  std::string error;
  EXPECT_FALSE(
      ReadCaseForSimulation(folder.Write("case.toml", Modes()), &c, &error));
  EXPECT_THAT(error, HasSubstr("[[record]]"));
}

TEST(ModalSection, WantsKnownErrorsBesideRecords) {
  const std::string mode = "[[mode]]\nfrequency = 1.0\n";
  EXPECT_THAT(ReadText(SmallCase() + mode).error,
              HasSubstr("expected 'frequency_sigma'"));
  EXPECT_TRUE(ReadText(SmallCase() + mode + "frequency_sigma = 0.1\n").ok);
  EXPECT_THAT(ReadText(SmallCase() + mode +
                       "frequency_sigma = 0.1\nshape = {u1 = 1, u2 = 2}\n")
                  .error,
              HasSubstr("expected 'shape_sigma'"));
  EXPECT_THAT(ReadText(SmallCase() + "[modal]\nform = \"dynamic_residual\"\n" +
                       mode + "shape = {u1 = 1, u2 = 2}\n")
                  .error,
              HasSubstr("expected 'residual_weight'"));
}

TEST(ModalSection, SaysThatElementsTakeNoPart) {
  const ReadResult result =
      ReadText(Modes() +
               "[[element]]\nname = \"s\"\ntype = \"cubic\"\nbetween = "
               "[\"ground\", \"u1\"]\nparameters.k3 = 5.0\n");
  ASSERT_TRUE(result.ok) << result.error;
  ASSERT_EQ(result.c.problem.description.remarks.size(), 1u);
  EXPECT_THAT(result.c.problem.description.remarks[0],
              HasSubstr("without elements, libraries and networks"));
  EXPECT_THAT(
      ReadText(Modes() +
               "[[element]]\nname = \"s\"\ntype = \"cubic\"\nbetween = "
               "[\"ground\", \"u1\"]\nparameters.k3 = {initial = 5.0}\n")
          .error,
      HasSubstr("'s' cannot be free without a training record"));
}

// K1 (1 + k1) + slope (T - 20) K1: at 10 degrees a slope of -0.01 is 0.1.
TEST(ModalSection, ModesAreOfTheirTemperature) {
  const std::string follows =
      "[[group]]\nname = \"slope\"\nadds_to = \"stiffness\"\nbetween = "
      "[\"ground\", \"u1\"]\nscale = 200.0\ninitial = -0.01\nfollows = "
      "{covariate = \"T\", reference = 20.0}\n";
  const std::string cold =
      Replaced(Modes(), "[modal]\n", "[modal]\ncovariates = {T = 10.0}\n") +
      follows;
  ReadResult result = ReadText(
      Replaced(cold, "initial = -0.01", "initial = -0.01\nfree = false"));
  ASSERT_TRUE(result.ok) << result.error;
  EXPECT_THAT(result.c.problem.description.remarks, IsEmpty());
  const ReadResult plain = ReadText(Modes());
  ASSERT_TRUE(plain.ok) << plain.error;
  IdentificationSummary of_plain, of_cold;
  IdentifiedModel model;
  testing::FitAndJudge(plain.c.problem, plain.c.options, nullptr, &of_plain,
                       &model);
  const double alpha = model.parameters[0];
  testing::FitAndJudge(result.c.problem, result.c.options, nullptr, &of_cold,
                       &model);
  EXPECT_NEAR(model.parameters[0], alpha - 0.1, 1e-6);
  ASSERT_EQ(of_cold.modes.size(), of_plain.modes.size());
  for (size_t i = 0; i < of_cold.modes.size(); ++i) {
    EXPECT_NEAR(of_cold.modes[i].updated.frequency,
                of_plain.modes[i].updated.frequency, 1e-6);
  }
  // One temperature does not tell the two apart.
  result = ReadText(cold);
  ASSERT_TRUE(result.ok) << result.error;
  IdentificationSummary both;
  testing::FitAndJudge(result.c.problem, result.c.options, nullptr, &both,
                       &model);
  ASSERT_EQ(both.undetermined.size(), 1u);
  EXPECT_THAT(both.undetermined[0], HasSubstr("slope"));
  EXPECT_NE(
      ProblemHash(result.c.problem),
      ProblemHash(ReadText(Replaced(cold, "T = 10.0", "T = 11.0")).c.problem));

  EXPECT_THAT(ReadText(Modes() + follows).error,
              HasSubstr("no record has a covariate 'T'"));
  EXPECT_THAT(ReadText(Replaced(cold, "{T = 10.0}", "{t = 10.0}")).error,
              HasSubstr("no record has a covariate 'T'; did you mean 't'?"));
  EXPECT_THAT(ReadText(Replaced(cold, "{T = 10.0}", "10.0")).error,
              HasSubstr("covariates"));
  EXPECT_THAT(ReadText(Replaced(cold, "{T = 10.0}", "{T = \"warm\"}")).error,
              HasSubstr("'T'"));
}

TEST(ModalSection, TellsProblemsApart) {
  const std::string hash = ProblemHash(ReadText(Modes()).c.problem);
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{
           {"frequency = 2.5", "frequency = 2.6"},
           {"u1 = 0.9", "u1 = 0.8"},
           {"frequency_weight = 40", "frequency_weight = 41"},
           {"shape_sigma = 0.02", "shape_weight = 3"}}) {
    EXPECT_NE(ProblemHash(ReadText(Replaced(Modes(), from, to)).c.problem),
              hash);
  }
}

TEST(ModalSection, LeavesItsMarkInTheResult) {
  const TemporaryFolder folder;
  folder.Write("shapes.csv", "u1,u2\n0.5,1\n");
  Case c;
  std::string error;
  ASSERT_TRUE(
      ReadCase(folder.Write("case.toml",
                            Replaced(Modes(), "shape = {u2 = 2.0, u1 = 0.9}",
                                     "shape = \"shapes.csv\"")),
               &c, &error))
      << error;
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(c.problem, c.options, nullptr, &summary, &model);
  ASSERT_EQ(summary.termination, Termination::kConverged) << summary.message;
  std::string text;
  ASSERT_TRUE(FormatResultJson(c.problem, summary, model, &text, &error))
      << error;
  const auto json = nlohmann::json::parse(text);
  ASSERT_EQ(json["modes"].size(), 2u);
  EXPECT_EQ(json["modes"][0]["measured_hz"], 1.0);
  EXPECT_EQ(json["modes"][0]["measured_mac"], summary.modes[0].updated.mac);
  EXPECT_EQ(json["modes"][1]["measured_hz"], 2.5);
  EXPECT_TRUE(json["modes"][1]["measured_mac"].is_null());
  EXPECT_EQ(json["measured_modes"][1]["name"], "second");
  EXPECT_EQ(json["measured_modes"][0]["updated_hz"],
            json["modes"][0]["updated_hz"]);
  EXPECT_EQ(json["measured_modes"][0]["initial_hz"],
            json["modes"][0]["initial_hz"]);
  EXPECT_TRUE(json["records"].empty());

  // The updated model is a case that finds itself again.
  std::filesystem::create_directory(folder.Path("out"));
  ASSERT_TRUE(
      WriteModelCase(c, model, folder.Path("out"), folder.Path("out"), &error))
      << error;
  Case again;
  ASSERT_TRUE(ReadCase(folder.Path("out/model.toml"), &again, &error)) << error;
  testing::FitAndJudge(again.problem, again.options, nullptr, &summary, &model);
  EXPECT_NEAR(model.parameters[0], 0.0, 1e-6);
  EXPECT_EQ(again.problem.modal.modes[0].shape, c.problem.modal.modes[0].shape);
}

}  // namespace
}  // namespace pinode
