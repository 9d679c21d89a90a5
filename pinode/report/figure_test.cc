#include "pinode/report/figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "pinode/report/report_figures.h"
#include "tests/support/report_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr size_t kMaxBytes = 150 * 1024;

class FigureTest : public ::testing::Test {
 protected:
  void SetUp() override {
    example_ = testing::MakeReportExample();
    std::string output, error;
    if (!RunGnuplot("set print '-'\nprint 1\n", GnuplotOptions(), &output,
                    &error)) {
      GTEST_SKIP() << error;
    }
  }

  // Draws the figure and checks what holds for all of them.
  std::string Draw(const Figure& figure) {
    std::vector<std::string> svgs;
    std::string error;
    EXPECT_FALSE(figure.empty());
    EXPECT_TRUE(DrawSvgs({&figure}, GnuplotOptions(), &svgs, &error)) << error;
    if (svgs.size() != 1) return "";
    const std::string& svg = svgs[0];
    EXPECT_EQ(svg.find("<svg"), 0u);
    EXPECT_EQ(testing::FindHtmlFault(svg), "");
    EXPECT_LT(svg.size(), kMaxBytes);
    EXPECT_THAT(svg, Not(HasSubstr("http")));
    EXPECT_THAT(svg, Not(HasSubstr("id='gp")));
    EXPECT_THAT(svg, HasSubstr("<path"));
    return svg;
  }

  Vector Prior(int record, int channel) {
    return example_->input.run_prior(record, {channel}).row(0);
  }

  std::unique_ptr<testing::ReportExample> example_;
};

TEST_F(FigureTest, DrawsSeveralAtOnceAsItDrawsEach) {
  const Figure channel = MakeChannelFigure(example_->input, 1, 2);
  const Figure convergence = MakeConvergenceFigure(example_->input);
  std::vector<std::string> svgs;
  std::string error;
  ASSERT_TRUE(DrawSvgs({&channel, &convergence, &channel}, GnuplotOptions(),
                       &svgs, &error))
      << error;
  ASSERT_EQ(svgs.size(), 3u);
  EXPECT_EQ(svgs[0], Draw(channel));
  // The colour of gnuplot's empty first group is that of what came before.
  EXPECT_NEAR(static_cast<double>(svgs[1].size()),
              static_cast<double>(Draw(convergence).size()), 300.0);
  EXPECT_THAT(svgs[1], Not(HasSubstr("id='channel_1_2_gp")));
  // Neither ranges nor labels nor panels are left of the one before.
  const auto count = [](const std::string& text, const std::string& what) {
    size_t found = 0;
    for (size_t at = text.find(what); at != std::string::npos;
         at = text.find(what, at + 1)) {
      ++found;
    }
    return found;
  };
  for (const char* what : {"<path", "<text", "<g "}) {
    EXPECT_NEAR(static_cast<double>(count(svgs[2], what)),
                static_cast<double>(count(svgs[0], what)), 1.0)
        << what;
  }
}

TEST_F(FigureTest, OneThatCannotBeDrawnTakesNoOtherWithIt) {
  ReportFigures figures;
  figures.pictures.resize(3);
  figures.pictures[0].figure = MakeChannelFigure(example_->input, 1, 2);
  figures.pictures[1].figure = MakeConvergenceFigure(example_->input);
  figures.pictures[1].figure.script += "plot undefined_name\n";
  figures.pictures[2].figure = MakeConvergenceFigure(example_->input);
  DrawFigures(HtmlReportOptions(), &figures);
  EXPECT_EQ(figures.pictures[0].svg, Draw(figures.pictures[0].figure));
  EXPECT_EQ(figures.pictures[1].svg, "");
  EXPECT_THAT(figures.pictures[1].error, HasSubstr("undefined_name"));
  EXPECT_EQ(figures.pictures[2].svg, Draw(figures.pictures[2].figure));
}

TEST_F(FigureTest, ShowsAChannelWithLabelsAndLegend) {
  const Figure figure = MakeChannelFigure(example_->input, 1, 2, Prior(1, 2));
  const std::string svg = Draw(figure);
  for (const char* text : {"a3, m/s\u00b2", "time, s", "residual, m/s\u00b2",
                           "measured", "updated model", "initial model"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  EXPECT_THAT(figure.caption,
              HasSubstr("a3 in record 'south_quake' (hold-out)"));
}

TEST_F(FigureTest, DrawsAChannelThatThePriorAndTheUpdatedModelMiss) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  example_->summary.records[0].prediction.rightCols(1500).setConstant(nan);
  example_->problem.records[0].channels[0].values.head(200).setConstant(nan);
  Draw(MakeChannelFigure(example_->input, 0, 0, 1e30 * Prior(0, 0)));
  example_->summary.records[0].prediction.setConstant(nan);
  Draw(MakeChannelFigure(example_->input, 0, 0));
  example_->problem.records[0].channels[0].values.setZero();
  Draw(MakeChannelFigure(example_->input, 0, 0));
}

TEST_F(FigureTest, ShadesWhereMeasurementsAreExpected) {
  RecordScore& score = example_->summary.records[0];
  score.deviations.resize(0, 0);
  EXPECT_THAT(MakeChannelFigure(example_->input, 0, 0).script,
              Not(HasSubstr("filledcurves")));
  score.deviations =
      Matrix::Constant(score.prediction.rows(), score.prediction.cols(), 0.1);
  const Figure figure = MakeChannelFigure(example_->input, 0, 0);
  EXPECT_THAT(figure.script, HasSubstr("filledcurves"));
  EXPECT_THAT(figure.caption, HasSubstr("Shaded"));
  Draw(figure);
  score.deviations(0, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(MakeChannelFigure(example_->input, 0, 0).script,
              Not(HasSubstr("filledcurves")));
}

TEST_F(FigureTest, MarksWhereScoringBegins) {
  EXPECT_THAT(MakeChannelFigure(example_->input, 0, 0).script,
              Not(HasSubstr("scored from here")));
  example_->summary.records[0].first_scored_sample = 150;
  const Figure figure = MakeChannelFigure(example_->input, 0, 0);
  EXPECT_THAT(figure.script, HasSubstr("set arrow 1 from 1.5, graph 0"));
  EXPECT_THAT(Draw(figure), HasSubstr("scored from here"));
}

TEST_F(FigureTest, StaysSmallForLongRecords) {
  const int samples = 200000;
  IdentificationRecord& record = example_->problem.records[0];
  const Vector time = Vector::LinSpaced(samples, 0.0, 2000.0);
  const Vector values =
      (20.0 * time.array()).sin() * (0.3 * time.array()).cos();
  record.excitation.emplace(0.0, 0.01, Matrix::Zero(1, samples),
                            Interpolation::kLinear);
  record.channels[0].values = values;
  example_->summary.records[0].prediction =
      Matrix(values.transpose()).replicate(3, 1) * 0.9;
  Draw(MakeChannelFigure(example_->input, 0, 0, 1.2 * values));
}

TEST_F(FigureTest, ShowsLoopsOfLawsAndNetworks) {
  const auto loops = ComputeRestoringForceLoops(example_->input);
  ASSERT_EQ(loops.size(), 3u);
  const Figure cubic = MakeLoopFigure(example_->input, loops[0], 0);
  EXPECT_TRUE(cubic.half_width);
  std::string svg = Draw(cubic);
  EXPECT_THAT(svg, HasSubstr("d[ground,u1], m<"));
  EXPECT_THAT(svg, HasSubstr("force, N<"));
  const Figure network = MakeLoopFigure(example_->input, loops[2], 2);
  EXPECT_FALSE(network.half_width);
  svg = Draw(network);
  EXPECT_THAT(svg, HasSubstr("acceleration, m/s\u00b2<"));
  EXPECT_THAT(svg, HasSubstr("v[u3], m/s<"));
}

TEST_F(FigureTest, ShowsKnownCurvesBesideLoops) {
  example_->problem.description.reference_curves.push_back(
      {"spring1", "data sheet", Vector::LinSpaced(2, -1.0, 1.0),
       Vector::LinSpaced(2, -2.0, 2.0)});
  const auto loops = ComputeRestoringForceLoops(example_->input);
  const std::string svg = Draw(MakeLoopFigure(example_->input, loops[0], 0));
  EXPECT_THAT(svg, HasSubstr("data sheet<"));
  EXPECT_THAT(svg, HasSubstr("identified<"));
  // Others are drawn as ever.
  EXPECT_THAT(Draw(MakeLoopFigure(example_->input, loops[2], 2)),
              Not(HasSubstr("identified<")));
}

TEST_F(FigureTest, ShowsParameterChangesInPerCent) {
  const Figure figure = MakeParameterFigure(example_->input);
  // Groups in per cent of their matrix, elements of their initial value.
  EXPECT_THAT(figure.script, ContainsRegex("\n19\\.94 5 19\\.[0-9]+ 20\\."));
  EXPECT_THAT(figure.script, ContainsRegex("\n100\\.6 1 "));
  EXPECT_THAT(figure.caption,
              HasSubstr("the initial value is zero: spring1.k3."));
  EXPECT_THAT(Draw(figure), HasSubstr("change, %"));
  for (ParameterEstimate& parameter : example_->summary.parameters) {
    parameter.lower95 = -std::numeric_limits<double>::infinity();
    parameter.upper95 = std::numeric_limits<double>::infinity();
  }
  Draw(MakeParameterFigure(example_->input));
  example_->summary.parameters.clear();
  EXPECT_TRUE(MakeParameterFigure(example_->input).empty());
}

TEST_F(FigureTest, ShowsModeShapesThatAgreeInSign) {
  const std::string before = MakeModeShapeFigure(example_->input).script;
  for (ModePair& mode : example_->input.prior.modes) mode.initial_shape *= -3.0;
  const Figure figure = MakeModeShapeFigure(example_->input);
  EXPECT_EQ(figure.script, before);
  EXPECT_THAT(Draw(figure), HasSubstr("mode 3:"));
  for (ModePair& mode : example_->input.prior.modes)
    mode.initial_shape.resize(0);
  EXPECT_TRUE(MakeModeShapeFigure(example_->input).empty());
}

TEST_F(FigureTest, ShowsConvergenceByStages) {
  const std::string svg = Draw(MakeConvergenceFigure(example_->input));
  for (const char* text : {"cost", "simulation error, %", "iteration",
                           "rejected", ">25<", ">2.07<"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  // Rejected steps do not flatten the rest.
  for (IterationRecord& iteration : example_->summary.iterations) {
    if (!iteration.accepted) iteration.cost = 3e82;
  }
  EXPECT_THAT(MakeConvergenceFigure(example_->input).script,
              Not(HasSubstr("e+82")));
  example_->summary.stages.clear();
  EXPECT_THAT(Draw(MakeConvergenceFigure(example_->input)),
              Not(HasSubstr("simulation")));
  example_->summary.iterations.clear();
  EXPECT_TRUE(MakeConvergenceFigure(example_->input).empty());
}

// The close-up is some periods of the first mode, in whatever unit time is.
TEST_F(FigureTest, CloseUpsAreAsLongInMilliseconds) {
  const size_t size = MakeChannelFigure(example_->input, 0, 0).script.size();
  example_->problem.description.units.time = "ms";
  EXPECT_NEAR(static_cast<double>(
                  MakeChannelFigure(example_->input, 0, 0).script.size()),
              static_cast<double>(size), 0.02 * static_cast<double>(size));
}

TEST_F(FigureTest, TakesAnyName) {
  Observation& observation =
      example_->problem.records[0].channels[0].observation;
  observation.name = "a'1 `id` \"x\" <b> & $d0 \u03b1_2^3";
  const std::string svg = Draw(MakeChannelFigure(example_->input, 0, 0));
  EXPECT_THAT(svg,
              HasSubstr("a\u20191 `id` \"x\" &lt;b> &amp; $d0 \u03b1_2^3"));
}

DiscoveredEquation CubicEquation() {
  DiscoveredEquation equation;
  equation.output = "u1";
  equation.network = "nn1";
  equation.num_candidates = 34;
  equation.num_regressed_terms = 1;
  equation.pareto = {{0, 0.5, 0.0}, {1, 0.01, 0.0}, {2, 0.009, 0.0}};
  equation.terms = {testing::MakeTerm("x[u1]^3", "1/m^2/s^2", -2.0, 0.1, -1.8),
                    testing::MakeTerm("v[u1]", "1/s", -0.3, 0.1, -0.3)};
  const Vector x = Vector::LinSpaced(1500, -1.0, 1.0);
  const Vector v = x.reverse();
  equation.features.resize(3);
  equation.features[0].kind = Feature::Kind::kDisplacement;
  equation.features[1].kind = Feature::Kind::kVelocity;
  equation.features[2].kind = Feature::Kind::kTime;
  equation.feature_names = {"x[u1]", "v[u1]", "t"};
  equation.sample_features.resize(1500, 3);
  equation.sample_features << x, v, 2.0 * x;
  equation.sample_outputs = -2.0 * x.array().cube() - 0.3 * v.array() + 0.01;
  return equation;
}

TEST_F(FigureTest, ShowsAnEquationOverEachFeature) {
  const Figure figure = MakeEquationFigure(CubicEquation(), UnitSystem(), 3);
  const std::string svg = Draw(figure);
  for (const char* text : {"x[u1], m", "v[u1], m/s", "u1, m/s\u00b2"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  EXPECT_THAT(figure.caption, HasSubstr("network nn1 minus the other terms"));
  // At the first sample: -2 x^3 = 2 and -0.3 v = -0.3, each by itself, beside
  // what the network has beyond the other, 0.01 more.
  for (const char* text :
       {"\n-1 2\n", "\n-1 2.01\n", "\n1 -0.3\n", "\n1 -0.29\n"}) {
    EXPECT_THAT(figure.script, HasSubstr(text));
  }
  // Nothing depends on the time.
  EXPECT_THAT(figure.caption, Not(HasSubstr("not drawn")));
  EXPECT_THAT(figure.script, Not(HasSubstr("t, s")));
  DiscoveredEquation nothing = CubicEquation();
  nothing.terms.clear();
  EXPECT_TRUE(MakeEquationFigure(nothing, UnitSystem(), 0).empty());
}

TEST_F(FigureTest, ShowsTheParetoCurve) {
  const Figure figure = MakeParetoFigure(CubicEquation(), 0);
  EXPECT_THAT(Draw(figure), HasSubstr("number of terms"));
  EXPECT_THAT(figure.caption, HasSubstr("34 candidates"));
  EXPECT_THAT(figure.caption, HasSubstr("Circled"));
  DiscoveredEquation nothing = CubicEquation();
  nothing.pareto.resize(1);
  EXPECT_TRUE(MakeParetoFigure(nothing, 0).empty());
}

ForceEstimate MakeForce(int count) {
  ForceEstimate force;
  force.name = "blow";
  force.record = 0;
  force.times = Vector::LinSpaced(count, 0.0, 2.0);
  force.value = (-((force.times.array() - 0.5) / 0.02).square()).exp() * 1e4;
  force.sigma = Vector::Constant(count, 100.0);
  force.lower95 = force.value - 1.96 * force.sigma;
  force.upper95 = force.value + 1.96 * force.sigma;
  return force;
}

TEST_F(FigureTest, ShowsAForceWithItsBandAndTheTruth) {
  example_->summary.forces = {MakeForce(5001)};
  const ForceEstimate& force = example_->summary.forces[0];
  example_->problem.description.force_truths = {
      {"blow", force.times, 1.01 * force.value}};
  const Figure figure = MakeForceFigure(example_->input, 0);
  const std::string svg = Draw(figure);
  for (const char* text :
       {"force, N", "time, s", "95 % band", "truth", "identified"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  EXPECT_THAT(figure.caption,
              AllOf(HasSubstr("blow"), HasSubstr("Right: its largest part.")));
  // The close-up is about the blow: 2 s are no part of its axis.
  EXPECT_THAT(figure.script, HasSubstr("set xrange [0:2]"));
  EXPECT_THAT(figure.script, HasSubstr("set xrange [0.4"));
  EXPECT_THAT(figure.caption, Not(HasSubstr("Dots")));
  // A truth of few samples there says nothing of what is between them.
  const Vector times = Vector::LinSpaced(201, 0.0, 2.0);
  example_->problem.description.force_truths = {
      {"blow", times, Vector::Ones(201)}};
  const Figure coarse = MakeForceFigure(example_->input, 0);
  EXPECT_THAT(coarse.caption,
              HasSubstr("Dots: the true force at its samples."));
  EXPECT_THAT(coarse.script, HasSubstr("with points"));
  EXPECT_THAT(Draw(coarse), HasSubstr("truth"));
}

// No covariance, no band; the truth of another force is not shown.
TEST_F(FigureTest, ShowsAForceWithoutABand) {
  ForceEstimate force = MakeForce(50);
  force.sigma.setConstant(std::numeric_limits<double>::infinity());
  force.lower95 = -force.sigma;
  force.upper95 = force.sigma;
  example_->summary.forces = {force};
  example_->problem.description.force_truths = {
      {"other", force.times, force.value}};
  const std::string svg = Draw(MakeForceFigure(example_->input, 0));
  EXPECT_THAT(svg, Not(HasSubstr("band")));
  EXPECT_THAT(svg, Not(HasSubstr("truth")));
  force.value[3] = std::numeric_limits<double>::quiet_NaN();
  example_->summary.forces = {force};
  EXPECT_TRUE(MakeForceFigure(example_->input, 0).empty());
}

TEST_F(FigureTest, ColoursChangesByTheirProbability) {
  DamageResult damage;
  damage.options.threshold = 0.05;
  const ChangeKind kind = ChangeKind::kStiffness;
  testing::AddChange("k1", kind, 0.002, -0.01, 0.014, 0.0, false, &damage);
  testing::AddChange("k2", kind, -0.1, -0.12, -0.08, 1.0, true, &damage);
  testing::AddChange("k3", kind, -0.05, -0.1, 0.0, 0.5, false, &damage);
  const Figure figure = MakeChangeFigure(damage);
  const std::string svg = Draw(figure);
  EXPECT_THAT(figure.caption, HasSubstr("a loss of more than 5"));
  // Grey, red and orange.
  for (const char* text : {"k1", "k2", "k3", "change, %", "rgb(190, 190, 190)",
                           "rgb(213,  40,   0)", "rgb(240, 180,  60)"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  // Changes that the data do not determine have no bar.
  damage = DamageResult();
  testing::AddChange("k1", kind, 3e6, -1e12, 1e12, 0.5, false, &damage);
  EXPECT_TRUE(MakeChangeFigure(damage).empty());
  EXPECT_TRUE(MakeChangeFigure(DamageResult()).empty());
}

}  // namespace
}  // namespace pinode
