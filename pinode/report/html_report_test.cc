#include "pinode/report/html_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

#include "pinode/base/file.h"
#include "pinode/report/figure.h"
#include "pinode/structure/model/geometry.h"
#include "pinode/study/picture/structure_picture.h"
#include "tests/support/identify_testing.h"
#include "tests/support/report_testing.h"

namespace pinode {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

HtmlReportOptions WithoutGnuplot() {
  HtmlReportOptions options;
  options.gnuplot.program = "/nowhere/gnuplot";
  return options;
}

int CountOf(const std::string& part, const std::string& text) {
  int count = 0;
  for (size_t at = text.find(part); at != std::string::npos;
       at = text.find(part, at + part.size())) {
    ++count;
  }
  return count;
}

void ExpectSelfContained(const std::string& html) {
  EXPECT_EQ(testing::FindHtmlFault(html), "");
  EXPECT_THAT(html, Not(HasSubstr("http")));
  EXPECT_THAT(html, Not(HasSubstr("src=")));
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, Not(HasSubstr("<link")));
  EXPECT_THAT(html, Not(HasSubstr("url(")));
  EXPECT_THAT(html, Not(HasSubstr("@import")));
  // No tag of the template is left over.
  EXPECT_THAT(html, Not(HasSubstr("{{")));
  EXPECT_THAT(html, Not(HasSubstr("}}")));
}

TEST(FindHtmlFault, FindsFaults) {
  EXPECT_EQ(testing::FindHtmlFault("<p class=\"a>b\">x<br>y</p>"), "");
  EXPECT_THAT(testing::FindHtmlFault("<p><b></p></b>"),
              HasSubstr("closes <b>"));
  EXPECT_THAT(testing::FindHtmlFault("<p>"), HasSubstr("never closed"));
  EXPECT_THAT(testing::FindHtmlFault("a < b"), HasSubstr("bare"));
  EXPECT_THAT(testing::FindHtmlFault("<p class=a></p>"), HasSubstr("unquoted"));
}

TEST(HtmlReport, IsOneWellFormedPageWithFigures) {
  const auto example = testing::MakeReportExample();
  std::string output, error;
  if (!RunGnuplot("set print '-'\nprint 1\n", GnuplotOptions(), &output,
                  &error)) {
    GTEST_SKIP() << error;
  }
  HtmlReportOptions options;
  options.num_threads = 2;
  const std::string html = RenderHtmlReport(example->input, options);
  ExpectSelfContained(html);
  // Parameters, modes, six channels, three loops, convergence.
  EXPECT_EQ(CountOf("<svg", html), 12);
  EXPECT_EQ(CountOf("<figure", html), 12);
  EXPECT_THAT(html, Not(HasSubstr("could not be drawn")));
  // No id is used twice.
  std::set<std::string> ids;
  for (const char* quote : {"\"", "'"}) {
    const std::string key = std::string(" id=") + quote;
    for (size_t at = html.find(key); at != std::string::npos;
         at = html.find(key, at + 1)) {
      const size_t begin = at + key.size();
      const std::string id =
          html.substr(begin, html.find(quote, begin) - begin);
      EXPECT_TRUE(ids.insert(id).second) << id;
    }
  }
  EXPECT_GT(ids.size(), 12u);
  // Drawing in parallel does not change a byte.
  EXPECT_EQ(html, RenderHtmlReport(example->input, HtmlReportOptions()));
}

TEST(HtmlReport, ComesInTheOrderOfImportance) {
  const auto example = testing::MakeReportExample();
  example->summary.records[1].nrmse = 0.0312;
  const std::string html = RenderHtmlReport(example->input, WithoutGnuplot());
  size_t at = 0;
  for (const char* part :
       {"Three-storey frame", "Good. The updated model", "What changed",
        "How well the model predicts", "3.12",
        "Modes of the initial and the updated model", ">Records<",
        "Restoring forces", "How it was solved",
        "What the data do not determine", "Remarks about the data",
        "To reproduce", "pinode_update --case="}) {
    const size_t found = html.find(part, at);
    ASSERT_NE(found, std::string::npos) << part;
    at = found;
  }
}

TEST(HtmlReport, HoldsTheNumbers) {
  const auto example = testing::MakeReportExample();
  IdentificationSummary& summary = example->summary;
  summary.parameters[0].value = 0.1994;
  summary.parameters[0].lower95 = 0.1974;
  summary.parameters[0].upper95 = 0.2014;
  summary.seconds = 3.217;
  summary.undetermined = {"k2 - 0.98 k3"};
  summary.parameters[3].at_bound = true;
  const std::string html = RenderHtmlReport(example->input, WithoutGnuplot());
  for (const char* part :
       {"0.1994", "0.0020", "3.22 s", "block sandwich", "linear",
        "Not determined by these records: k2 - 0.98 k3.",
        "c stopped at its bound", "k1 and spring1.k3 can hardly be told apart",
        "correlation -0.970", "0.01 s is used", "24 iterations", "19 weights",
        "2.7433"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
}

TEST(HtmlReport, KeepsEverythingElseWithoutGnuplot) {
  const auto example = testing::MakeReportExample();
  const std::string html = RenderHtmlReport(example->input, WithoutGnuplot());
  ExpectSelfContained(html);
  EXPECT_EQ(CountOf("<svg", html), 0);
  EXPECT_EQ(
      CountOf("This figure could not be drawn: &#39;/nowhere/gnuplot&#39;",
              html) +
          CountOf("This figure could not be drawn: "
                  "&apos;/nowhere/gnuplot&apos;",
                  html),
      12);
  EXPECT_EQ(CountOf("<figcaption>", html), 12);
}

TEST(HtmlReport, EscapesWhatTheUserWrote) {
  const auto example = testing::MakeReportExample();
  const std::string evil = "<script>alert(\"x\")</script> & {{title}}";
  example->problem.description.title = evil;
  example->input.origin.case_path = evil;
  example->input.origin.command_line = evil;
  example->problem.description.remarks = {evil};
  example->problem.records[0].name = evil;
  example->problem.records[0].channels[0].observation.name = evil;
  example->summary.records[0].name = evil;
  example->summary.records[0].channels[0].name = evil;
  example->summary.parameters[0].name = evil;
  example->summary.undetermined = {evil};
  example->summary.verdict = testing::NotUsable(evil);
  example->summary.termination = Termination::kFailure;
  example->summary.message = evil;
  const std::string html =
      RenderHtmlReport(example->input, HtmlReportOptions());
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, HasSubstr("&lt;script"));
  // A user's braces are text.
  EXPECT_THAT(html, HasSubstr("{{title}}"));
  EXPECT_EQ(testing::FindHtmlFault(html), "");
}

TEST(HtmlReport, LimitsTheNumberOfFiguresAndSaysSo) {
  const auto example = testing::MakeReportExample();
  // The worst channel is the one to see.
  example->summary.records[0].channels[1].nrmse = 0.9;
  example->summary.records[1].channels[2].nrmse =
      std::numeric_limits<double>::quiet_NaN();
  HtmlReportOptions options = WithoutGnuplot();
  options.max_channels_per_record = 1;
  options.max_loops = 2;
  const std::string html = RenderHtmlReport(example->input, options);
  EXPECT_EQ(CountOf("<figure", html), 7);
  EXPECT_THAT(html, ContainsRegex("a2 in record .{1,6}north_quake"));
  EXPECT_THAT(html, ContainsRegex("a3 in record .{1,6}south_quake"));
  EXPECT_EQ(CountOf("The 2 channels with smaller errors are not drawn", html),
            2);
  EXPECT_THAT(html, HasSubstr("Not drawn: 1 more term."));
}

TEST(HtmlReport, OfAFailureSaysWhy) {
  const auto example = testing::MakeReportExample();
  example->summary = IdentificationSummary();
  example->input.summary = &example->summary;
  example->input.model = nullptr;
  example->input.prior = PriorComparison();
  example->problem.description.remarks.clear();
  const std::string html =
      RenderHtmlReport(example->input, HtmlReportOptions());
  ExpectSelfContained(html);
  EXPECT_THAT(html, HasSubstr("class=\"verdict bad\""));
  EXPECT_THAT(html, HasSubstr("the identification has not been started"));
  EXPECT_THAT(html, HasSubstr("There is no covariance"));
  EXPECT_EQ(CountOf("<figure", html), 0);
  for (const char* heading : {"What changed", "Modes of the initial",
                              ">Records<", "Restoring", "Remarks about"}) {
    EXPECT_THAT(html, Not(HasSubstr(heading)));
  }
}

TEST(HtmlReport, IsWrittenAllOrNothing) {
  const auto example = testing::MakeReportExample();
  const std::string path = ::testing::TempDir() + "pinode_report_" +
                           std::to_string(getpid()) + ".html";
  std::string error, content;
  ASSERT_TRUE(WriteHtmlReport(example->input, WithoutGnuplot(), path, &error))
      << error;
  ASSERT_TRUE(ReadTextFile(path, &content, &error)) << error;
  EXPECT_EQ(content, RenderHtmlReport(example->input, WithoutGnuplot()));
  std::remove(path.c_str());
  EXPECT_FALSE(WriteHtmlReport(example->input, WithoutGnuplot(),
                               "/nowhere/report.html", &error));
  EXPECT_THAT(error, HasSubstr("/nowhere/report.html"));
}

TEST(HtmlReport, ShowsEquations) {
  const auto example = testing::MakeReportExample();
  EXPECT_THAT(RenderHtmlReport(example->input, WithoutGnuplot()),
              Not(HasSubstr("Equations")));
  DiscoveredEquation equation;
  equation.output = "u<1>";
  equation.network = "nn1";
  equation.num_candidates = 34;
  equation.terms = {
      testing::MakeTerm("x[u1]^3", "1/m^2/s^2", -2.5, kNaN, -1.75),
      testing::MakeTerm("v[u1]", "1/s", -0.5, 0.03, -0.52)};
  DiscoveredEquation empty;
  empty.output = "u2";
  empty.network = "nn1";
  std::vector<DiscoveredEquation> equations = {equation, empty};
  example->input.equations = &equations;
  std::string html = RenderHtmlReport(example->input, WithoutGnuplot());
  ExpectSelfContained(html);
  for (const char* text :
       {"<h2>Equations</h2>", "u&lt;1&gt;", "x[u1]^3", "-1.75", "0.030",
        "from 34 candidates", "No term replaces network nn1"}) {
    EXPECT_THAT(html, HasSubstr(text));
  }
  EXPECT_THAT(html, Not(HasSubstr("inclusion probability")));
  EXPECT_LT(html.find("Equations"), html.find("What changed"));
  EXPECT_LT(html.find("Equations"), html.find("How well the model predicts"));
  equations[0].terms[0].inclusion_probability = 0.875;
  html = RenderHtmlReport(example->input, WithoutGnuplot());
  ExpectSelfContained(html);
  EXPECT_THAT(html, HasSubstr("inclusion probability"));
  equations[0].terms[0].probability = 0.8642;
  html = RenderHtmlReport(example->input, WithoutGnuplot());
  EXPECT_THAT(html, HasSubstr(">probability<"));
  EXPECT_THAT(html, HasSubstr("0.86"));
}

TEST(HtmlReport, ShowsForcesThatNobodyMeasured) {
  const auto example = testing::MakeReportExample();
  const char* heading = "Unmeasured forces";
  EXPECT_THAT(RenderHtmlReport(example->input, WithoutGnuplot()),
              Not(HasSubstr(heading)));
  ForceEstimate force;
  force.name = "<blow>";
  force.record = 0;
  force.times = Vector::LinSpaced(50, 0.0, 2.0);
  force.value = force.times.array().sin();
  force.sigma = Vector::Constant(50, 0.1);
  force.lower95 = force.value - 2.0 * force.sigma;
  force.upper95 = force.value + 2.0 * force.sigma;
  example->summary.forces = {force};
  const std::string html = RenderHtmlReport(example->input, WithoutGnuplot());
  ExpectSelfContained(html);
  EXPECT_THAT(html, HasSubstr(heading));
  EXPECT_THAT(html, HasSubstr("&lt;blow&gt;, the force identified in"));
  // It is what was asked for.
  EXPECT_LT(html.find(heading), html.find("What changed"));
  EXPECT_LT(html.find(heading), html.find("How well the model predicts"));
}

TEST(HtmlReport, ShowsProfiles) {
  const auto example = testing::MakeReportExample();
  const char* heading = "How far the data determine each parameter";
  EXPECT_THAT(RenderHtmlReport(example->input, WithoutGnuplot()),
              Not(HasSubstr(heading)));
  ParameterProfile profile;
  profile.name = "<gap>";
  profile.estimate = 2.0;
  profile.points = {{1.0, 9.0}, {2.0, 0.0}, {40.0, 0.0}};
  profile.lower95 = 1.25;
  profile.threshold95 = 3.84;
  profile.threshold99 = 6.63;
  profile.determination = Determination::kOneSided;
  profile.combinations = {"a * b"};
  example->summary.profiles = {profile};
  const std::string html = RenderHtmlReport(example->input, WithoutGnuplot());
  ExpectSelfContained(html);
  EXPECT_THAT(html, HasSubstr(heading));
  EXPECT_THAT(html, HasSubstr(" to -"));
  EXPECT_THAT(html, HasSubstr("one-sided; determined together: a * b"));
  const Figure figure = MakeProfileFigure(profile, 3);
  EXPECT_EQ(figure.id, "profile3");
  EXPECT_THAT(figure.caption, HasSubstr("one-sided"));
  profile.points.resize(2);
  EXPECT_TRUE(MakeProfileFigure(profile, 3).empty());
}

TEST(HtmlReport, BeginsWithWhatHasChanged) {
  auto example = testing::MakeReportExample();
  EXPECT_THAT(RenderHtmlReport(example->input, WithoutGnuplot()),
              Not(HasSubstr("Change since the baseline")));
  DamageResult damage;
  damage.judgement.sentence = "Damage: k<2> (-10 %) lost stiffness.";
  damage.judgement.verdict = DamageVerdict::kDamage;
  damage.options.threshold = 0.05;
  testing::AddChange("k2", ChangeKind::kStiffness, -0.1, -0.12, -0.08, 1.0,
                     true, &damage);
  testing::AddChange("c_mass", ChangeKind::kDamping, 0.01, -0.02, 0.04, 0.375,
                     false, &damage);
  // Changes that were sought and not found are not shown.
  testing::AddChange("mass.u1", ChangeKind::kMass, 0.02, -0.1, 0.14, 0.5, false,
                     &damage);
  damage.subjects[2].place = "mass at u1";
  damage.baselines = {"results/last_year"};
  damage.places = {"mass at u1"};
  damage.remarks = {"Something to know."};
  example->input.damage = &damage;
  const std::string page = RenderHtmlReport(example->input, WithoutGnuplot());
  ExpectSelfContained(page);
  for (const char* text :
       {"<p class=\"verdict bad\">Damage: k&lt;2&gt; (-10 %) lost stiffness.",
        "Change since the baseline", "P(loss &gt; 5 %)", "-12 to -8",
        "Compared with results/last_year.", "looked for: mass at u1.",
        "<li>Something to know.</li>", "Colour: probability of a loss"}) {
    EXPECT_THAT(page, HasSubstr(text));
  }
  EXPECT_THAT(page, Not(HasSubstr("mass.u1")));
  EXPECT_THAT(page, Not(HasSubstr("0.375")));
  EXPECT_LT(page.find("Change since the baseline"),
            page.find("How well the model predicts"));
  // Two tables of changes are of two things.
  EXPECT_THAT(page, HasSubstr("<h2>Compared with the initial model</h2>"));
  EXPECT_THAT(page, Not(HasSubstr("What changed")));
}

// Verdicts, then the structure, then how well the model fits.
TEST(HtmlReport, DrawsTheStructureBelowTheVerdicts) {
  auto example = testing::MakeReportExample();
  DamageResult damage;
  damage.judgement.sentence = "Damage: k2 (-10 %) lost stiffness.";
  damage.judgement.verdict = DamageVerdict::kDamage;
  testing::AddChange("k2", ChangeKind::kStiffness, -0.1, -0.12, -0.08, 1.0,
                     true, &damage);
  damage.baselines = {"results/last_year"};
  example->input.damage = &damage;
  StructurePicture picture;
  picture.geometry.node_names = {"g", "a"};
  picture.geometry.positions = Matrix::Zero(2, 3);
  picture.geometry.positions(1, 2) = 3.0;
  picture.geometry.elements = {{ElementShape::kLine, {0, 1}}};
  example->input.structure = &picture;
  const std::string page = RenderHtmlReport(example->input, WithoutGnuplot());
  size_t before = 0;
  for (const char* part :
       {"Damage: k2 (-10 %) lost stiffness.", "<p class=\"verdict\">",
        "<h2>The structure</h2>", "class=\"scene\"",
        "Change since the baseline", "How well the model predicts"}) {
    const size_t place = page.find(part);
    ASSERT_NE(place, std::string::npos) << part;
    EXPECT_GT(place, before) << part;
    before = place;
  }
}

}  // namespace
}  // namespace pinode
