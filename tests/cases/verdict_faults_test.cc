// Measured and simulated inputs that are wrong in one place: the verdict must
// name it, or refuse.

#include <cmath>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/study/identify/identify.h"
#include "tests/support/measured_data_testing.h"

namespace pinode {
namespace testing {
namespace {

struct Fault {
  std::string file;
  Grade grade;
  // Kind that is among the first two explanations, or a check among the
  // findings; where the value is known, that of the explanation.
  std::string cause;
  double value = kNaN;
};

std::string NameOf(const ::testing::TestParamInfo<Fault>& info) {
  std::string name = info.param.file.substr(0, info.param.file.find('.'));
  for (char& c : name) {
    if (c == '/') c = '_';
  }
  return name;
}

class VerdictFaults : public ::testing::TestWithParam<Fault> {};

TEST_P(VerdictFaults, AreNamed) {
  const Fault& fault = GetParam();
  PINODE_FIND_MEASURED_DATA(path, "faults/verdict/" + fault.file);
  Case c;
  std::string error;
  ASSERT_TRUE(ReadCase(path, &c, &error)) << error;
  const Identification run =
      Identify(std::move(c.problem), c.options, ExtrasOf(c), nullptr);
  EXPECT_EQ(run.summary.verdict.grade(), fault.grade) << run.summary.message;
  std::vector<std::string> causes;
  for (const Finding& finding : run.summary.verdict.findings()) {
    causes.push_back(finding.check);
  }
  const std::vector<Explanation>& explanations = run.summary.explanations;
  for (size_t i = 0; i < explanations.size() && i < 2; ++i) {
    causes.push_back(explanations[i].kind);
    if (explanations[i].kind != fault.cause || !std::isfinite(fault.value)) {
      continue;
    }
    EXPECT_NEAR(explanations[i].value, fault.value, 0.02)
        << explanations[i].what;
  }
  EXPECT_THAT(causes, ::testing::Contains(::testing::HasSubstr(fault.cause)));
}

// The truth of each is in the text that comes with the data. Masses twice as
// large have the exact equivalent of half the damping, and so has a time base
// twice as long.
INSTANTIATE_TEST_SUITE_P(
    All, VerdictFaults,
    ::testing::Values(
        Fault{"mass_doubled/case.toml", Grade::kWithCare, "mass", -0.5},
        Fault{"time_doubled/case.toml", Grade::kWithCare, "damping", -0.5},
        Fault{"ground_30ms_late/case.toml", Grade::kWithCare,
              "excitation_delay", -0.03},
        Fault{"bound_wrong/case.toml", Grade::kWithCare, "bound"},
        Fault{"five_storeys/w10.toml", Grade::kWithCare, "mass", -0.231},
        Fault{"five_storeys/w10h.toml", Grade::kWithCare, "mass", -0.231},
        Fault{"scale_of_ground_motion/s.toml", Grade::kWithCare,
              "told_apart_by_damping"},
        Fault{"sigma_too_small/case.toml", Grade::kNotUsable,
              "given_noise_contradicted"},
        Fault{"duplicated_sensor/case.toml", Grade::kNotUsable,
              "copied_channel"},
        Fault{"predicted_channels/a.toml", Grade::kNotUsable,
              "unexplained_motion"},
        Fault{"predicted_channels/b.toml", Grade::kNotUsable,
              "unexplained_motion"},
        Fault{"predicted_channels/c.toml", Grade::kNotUsable,
              "unexplained_motion"},
        Fault{"zero_ground/case.toml", Grade::kNotUsable,
              "no_better_than_no_motion"},
        Fault{"coarse_steps/coarse2.toml", Grade::kNotUsable, "long_steps"}),
    NameOf);

}  // namespace
}  // namespace testing
}  // namespace pinode
