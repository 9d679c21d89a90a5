#include "pinode/case/sections/reference_curve_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "pinode/case/results/model_case.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

const char kCurve[] = R"toml([[element]]
name = "spring1"
type = "cubic"
between = ["ground", "u1"]
[[network]]
name = "nn1"
inputs = ["x[u1]"]
outputs = ["u1"]
[[network]]
name = "nn2"
inputs = ["x[u1]"]
outputs = ["u1-u2"]
[[reference_curve]]
term = "spring1"
name = "data sheet"
file = "curve.csv"
deformation = "d"
force = "f"
)toml";

class ReferenceCurveSection : public SectionInSmallCase {
 protected:
  ReferenceCurveSection() : SectionInSmallCase(kCurve) {}

  void SetUp() override {
    SectionInSmallCase::SetUp();
    folder_.Write("curve.csv", "f,d\n-2,-1\n0,0\n2,1\n");
  }
};

TEST_F(ReferenceCurveSection, ReadsTheCurve) {
  for (const std::string term : {"spring1", "nn1"}) {
    Case c;
    ASSERT_TRUE(Read(
        Replaced(kCurve, "term = \"spring1\"", "term = \"" + term + "\""), &c))
        << error_;
    ASSERT_EQ(c.problem.description.reference_curves.size(), 1u);
    const ReferenceCurve& curve = c.problem.description.reference_curves[0];
    EXPECT_EQ(curve.term, term);
    EXPECT_EQ(curve.name, "data sheet");
    EXPECT_EQ(curve.deformation, Vector::LinSpaced(3, -1.0, 1.0));
    EXPECT_EQ(curve.force, Vector::LinSpaced(3, -2.0, 2.0));
  }
}

TEST_F(ReferenceCurveSection, RefusesWhatItCannotDraw) {
  EXPECT_THAT(
      Refusal("\"spring1\"\nname = \"data", "\"sprng1\"\nname = \"data"),
      HasSubstr("there is no element, library or network 'sprng1'"));
  EXPECT_THAT(Refusal("term = \"spring1\"", "term = \"nn2\""),
              HasSubstr("'nn2' is an acceleration of coupled masses"));
  EXPECT_THAT(Refusal("curve.csv", "curv.csv"), HasSubstr("curv.csv"));
  EXPECT_THAT(Refusal("deformation = \"d\"", "deformation = \"drift\""),
              HasSubstr("drift"));
  EXPECT_THAT(Refusal("force = \"f\"", "forces = \"f\""), HasSubstr("'force'"));
  folder_.Write("curve.csv", "f,d\n-2,-1\n,0\n2,1\n");
  EXPECT_THAT(Refusal("data sheet", "sheet"), HasSubstr("is not a curve"));
  folder_.Write("curve.csv", "f,d\n-2,-1\n");
  EXPECT_THAT(Refusal("data sheet", "sheet"), HasSubstr("is not a curve"));
}

TEST_F(ReferenceCurveSection, GoesOnWithTheModel) {
  Case c;
  ASSERT_TRUE(Read(kCurve, &c)) << error_;
  IdentifiedModel model;
  model.parameters = ParameterLayout(c.problem).InitialValues();
  const TemporaryFolder out;
  ASSERT_TRUE(WriteModelCase(c, model, out.Path(""), out.Path(""), &error_))
      << error_;
  Case again;
  ASSERT_TRUE(ReadCase(out.Path("model.toml"), &again, &error_)) << error_;
  ASSERT_EQ(again.problem.description.reference_curves.size(), 1u);
  EXPECT_EQ(again.problem.description.reference_curves[0].force,
            c.problem.description.reference_curves[0].force);
}

}  // namespace
}  // namespace pinode
