// For tests only, hence not installed: a case and its result.

#ifndef TESTS_SUPPORT_FITTED_CASE_TESTING_H_
#define TESTS_SUPPORT_FITTED_CASE_TESTING_H_

#include <cmath>
#include <string>

#include "gtest/gtest.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/support/case_testing.h"
#include "tests/support/identify_testing.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {

// The small case with one term of every kind, and a hand-made fit of it.
struct FittedCase {
  FittedCase() {
    folder.Write("quake.csv", SmallRecord());
    std::string text = SmallCase();
    text = Replaced(text, "lower = -0.9",
                    "lower = -0.9\nupper = 2.0\nprior_mean = 0.1\n"
                    "prior_sigma = 0.5");
    const size_t at = text.find("[[record]]");
    text.insert(at, R"([[group]]
name = "m2"
adds_to = "mass"
between = ["ground", "u2"]
[[group]]
name = "ageing"
adds_to = "stiffness"
between = ["u1", "u2"]
follows = {time = "linear"}
[[element]]
name = "spring"
type = "cubic"
between = ["u1", "u2"]
parameters.k3 = {initial = 1.0, prior_sigma = 2.0}
[[network]]
name = "nn"
inputs = ["x[u1]", "x[u2]", "v[u2]"]
input_scale = [0.5, 2.0, 4.0]
outputs = ["u2"]
layers = [3]
gauge = "off"
)");
    text = Replaced(text, "unit = \"mm\"",
                    "unit = \"mm\"\n  sign = -1\n  offset = {initial = 1.5, "
                    "free = true}");
    std::string error;
    EXPECT_TRUE(ReadCase(folder.Write("case.toml", text), &c, &error)) << error;

    model.parameters = ParameterLayout(c.problem).InitialValues();
    for (Eigen::Index i = 0; i < model.parameters.size(); ++i) {
      model.parameters[i] += 0.1 + 0.01 * std::sin(static_cast<double>(i));
    }
    model.sigmas = {Vector::Constant(2, 0.01)};
    model.starts = {Vector::Zero(4)};
    model.decays = Vector::Constant(1, 2.0);

    summary.termination = Termination::kConverged;
    summary.message = "done";
    summary.verdict = testing::Good();
    RecordScore score;
    score.name = "quake";
    score.finite = true;
    score.start = Vector::LinSpaced(4, 1.0, 4.0);
    score.prediction = Matrix::Constant(2, 200, 0.002);
    score.channels.resize(2);
    score.channels[0].name = "a1";
    score.channels[0].rmse = 9.80665;
    score.channels[0].nrmse = 0.5;
    score.channels[1].name = "d2";
    score.channels[1].nrmse = std::nan("");
    summary.records = {score};
    ParameterEstimate estimate;
    estimate.name = "k1";
    estimate.unit = "1";
    estimate.value = model.parameters[0];
    estimate.sigma = 0.01;
    estimate.free = true;
    summary.parameters = {estimate};
    summary.covariance_names = {"k1"};
    summary.covariance = Matrix::Constant(1, 1, 1e-4);
    summary.iterations.resize(3);
    summary.final_cost = 1.25;
  }

  TemporaryFolder folder;
  Case c;
  IdentificationSummary summary;
  IdentifiedModel model;
};

}  // namespace pinode

#endif  // TESTS_SUPPORT_FITTED_CASE_TESTING_H_
