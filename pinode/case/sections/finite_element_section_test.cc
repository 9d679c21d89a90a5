#include "pinode/case/sections/finite_element_section.h"

#include <cmath>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/case/results/finite_element_result.h"
#include "pinode/case/results/model_case.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/case/sections/named_dofs.h"
#include "pinode/record/table.h"
#include "pinode/structure/matrices/matrix_market.h"
#include "tests/support/case_testing.h"
#include "tests/support/rod_case_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using FiniteElementSectionTest = RodCaseTest;
constexpr const char* kCase = kRodCase;

TEST_F(FiniteElementSectionTest, KeepsWhatTheCaseNames) {
  const Case c = ReadOrFail(kCase);
  const StructuralModel& model = c.problem.dynamics->model();
  ASSERT_THAT(model.dof_names, ElementsAre("4.1", "8.1"));
  // Springs in a row: three below the first sensor, four between the two.
  Matrix stiffness(2, 2);
  stiffness << 1.0 / 3.0 + 1.0 / 4.0, -1.0 / 4.0, -1.0 / 4.0, 1.0 / 4.0;
  EXPECT_LT((model.stiffness - kSpring * stiffness).norm(), 1e-9 * kSpring);
  // Displacements go linearly from one to the next; the support is not in it.
  EXPECT_NEAR(model.mass(1, 1), 2.0 * (1 + 4 + 9 + 16) / 16.0, 1e-12);
  ASSERT_NE(c.finite_element, nullptr);
  EXPECT_THAT(c.finite_element->removed_dofs, ElementsAre(0));
  EXPECT_EQ(c.finite_element->exported.num_dofs(), kNodes);
  EXPECT_EQ(c.finite_element->expansion.row(0).norm(), 0.0);
  EXPECT_EQ(c.finite_element->expansion(3, 0), 1.0);

  // The ground moves all seven masses.
  ASSERT_THAT(model.directions, ElementsAre("x"));
  EXPECT_EQ(model.influence, Matrix::Ones(2, 1));
  const Vector force =
      model.mass * model.influence + model.support_mass_coupling;
  EXPECT_NEAR(force[0], 2.0 * (1 + 2 + 3) / 3.0 + 2.0 * (3 + 2 + 1) / 4.0,
              1e-12);
}

// lower: three springs below "4.1", one of the four between the two.
TEST_F(FiniteElementSectionTest, GroupsAreReducedAlong) {
  const Case c = ReadOrFail(kCase);
  const std::vector<GroupTerm>& groups = c.problem.dynamics->groups();
  ASSERT_EQ(groups.size(), 3u);
  Matrix lower(2, 2);
  lower << 1.0 / 3.0 + 1.0 / 16.0, -1.0 / 16.0, -1.0 / 16.0, 1.0 / 16.0;
  EXPECT_LT((groups[0].group.matrix - kSpring * lower).norm(), 1e-9 * kSpring);
  Matrix upper(2, 2);
  upper << 3.0 / 16.0, -3.0 / 16.0, -3.0 / 16.0, 3.0 / 16.0;
  EXPECT_LT((groups[1].group.matrix - kSpring * upper).norm(), 1e-9 * kSpring);
  Matrix brace(2, 2);
  brace << 100.0, -100.0, -100.0, 100.0;
  EXPECT_EQ(groups[2].group.matrix, brace);
  const auto& exported = c.finite_element->groups;
  ASSERT_EQ(exported.size(), 3u);
  EXPECT_LT((Matrix(exported[0].matrix) - Matrix(Rod(1.0, 0.0))).norm(), 1e-8);
  EXPECT_EQ(exported[2].matrix.coeff(3, 7), -100.0);
}

// A chain of four DOFs, of which only the last two have mass.
void WriteChain(const TemporaryFolder& folder, const std::string& group) {
  const std::string head = "%%MatrixMarket matrix coordinate real symmetric\n";
  folder.Write("M.mtx", head + "4 4 2\n3 3 2\n4 4 1\n");
  folder.Write("K.mtx", head +
                            "4 4 7\n1 1 300\n2 1 -100\n2 2 300\n3 2 -200\n"
                            "3 3 300\n4 3 -100\n4 4 100\n");
  folder.Write("set.mtx", head + "4 4 1\n1 1 200\n");
  folder.Write("case.toml", R"(
[model]
damping = "none"
[model.finite_element]
mass = "M.mtx"
stiffness = "K.mtx"
dofs = ["1.1", "2.1", "3.1", "4.1"]
[model.reduction]
method = "guyan"
[[group]]
name = "lowest"
adds_to = "stiffness"
)" + group + R"(
[[mode]]
frequency = 0.9
shape = {"3.1" = 0.6, "4.1" = 1.0}
)");
}

// An element set leaves DOFs of others empty, those without mass among them.
// In a case of measured modes alone, their shapes say which DOFs stay.
TEST(FiniteElementSets, LeaveDofsOfOthersEmpty) {
  const TemporaryFolder folder;
  WriteChain(folder, "set_export = \"set.mtx\"");
  const Case c = ReadOrFail(folder.Path("case.toml"));
  ASSERT_NE(c.problem.dynamics, nullptr);
  EXPECT_THAT(c.problem.dynamics->model().dof_names, ElementsAre("3.1", "4.1"));
  // Springs of 200, 100 and 200 in a row below 3.1 are one of 50; above it
  // there is one of 100.
  const Matrix& stiffness = c.problem.dynamics->model().stiffness;
  EXPECT_NEAR(stiffness(0, 0), 100.0 + 50.0, 1e-9);
  EXPECT_NEAR(stiffness(0, 1), -100.0, 1e-9);
  ASSERT_EQ(c.problem.dynamics->groups().size(), 1u);
  EXPECT_GT(c.problem.dynamics->groups()[0].group.matrix(0, 0), 0.0);
}

// The whole model is still checked.
TEST(FiniteElementSets, WholeModelsHaveMassOrStiffnessEverywhere) {
  const TemporaryFolder folder;
  WriteChain(folder, "set_export = \"set.mtx\"");
  folder.Write("K.mtx",
               "%%MatrixMarket matrix coordinate real symmetric\n4 4 3\n"
               "3 3 300\n4 3 -100\n4 4 100\n");
  Case c;
  std::string error;
  EXPECT_FALSE(ReadCase(folder.Path("case.toml"), &c, &error));
  EXPECT_THAT(error, HasSubstr("without mass and without stiffness"));
}

TEST_F(FiniteElementSectionTest, ResultGoesBackToTheWholeModel) {
  const Case c = ReadOrFail(kCase);
  IdentifiedModel model;
  model.parameters = c.problem.dynamics->Parameters();
  ASSERT_EQ(model.parameters.size(), 3);
  model.parameters << -0.1, 0.2, 0.0;
  IdentificationSummary summary;
  ParameterEstimate lower;
  lower.name = "lower";
  lower.value = -0.1;
  lower.sigma = 0.01;
  lower.lower95 = -0.12;
  lower.upper95 = -0.08;
  lower.free = true;
  summary.parameters = {lower};
  std::string error;
  const std::string out = folder_.Path("");
  ASSERT_TRUE(WriteFiniteElementResult(c, summary, model, out, &error))
      << error;
  SparseMatrix stiffness;
  ASSERT_TRUE(ReadMatrixMarket(folder_.Path("K_full.mtx"), &stiffness, &error))
      << error;
  const SparseMatrix expected = Rod(0.9, 1.2);
  EXPECT_LT((Matrix(stiffness) - Matrix(expected)).norm(), 1e-8);
  EXPECT_EQ(Matrix(stiffness), Matrix(stiffness).transpose());
  // The brace, at 0, adds its places.
  EXPECT_EQ(stiffness.nonZeros(), expected.nonZeros() + 2);
  EXPECT_THAT(folder_.Read("K_full.mtx"), HasSubstr("symmetric"));
  SparseMatrix mass;
  ASSERT_TRUE(ReadMatrixMarket(folder_.Path("M_full.mtx"), &mass, &error));
  EXPECT_EQ(mass.nonZeros(), kNodes);
  EXPECT_EQ(folder_.Read("dofs_full.txt"), DofList());
  const std::string factors = folder_.Read("element_factors.csv");
  EXPECT_THAT(
      factors,
      StartsWith("group,property,factor,sigma,lower95,upper95,free,export\n"
                 "lower,stiffness,0.9,0.01,0.88,0.92,1,\"K_lower.mtx\"\n"
                 "upper,stiffness,1.1,"));
  EXPECT_THAT(factors, Not(HasSubstr("brace")));
}

TEST_F(FiniteElementSectionTest, RayleighDampingGoesBackToo) {
  const std::string ratios = "damping = {ratios = [0.02]}";
  const std::string damper =
      "[[group]]\nname = \"c\"\nadds_to = \"damping\"\n"
      "proportional_to = \"stiffness\"\nscale = 0.002\n[[record]]\nname";
  const auto write = [&](const std::string& damping) {
    const Case c = ReadOrFail(
        Replaced(Replaced(kCase, ratios, damping), "[[record]]\nname", damper));
    IdentifiedModel model;
    model.parameters = c.problem.dynamics->Parameters();
    EXPECT_EQ(model.parameters.size(), 4);
    model.parameters[3] = 0.5;
    std::string error;
    EXPECT_TRUE(WriteFiniteElementResult(c, IdentificationSummary(), model,
                                         folder_.Path(""), &error))
        << error;
  };
  write(ratios);
  std::string error;
  SparseMatrix damping;
  EXPECT_FALSE(ReadMatrixMarket(folder_.Path("C_full.mtx"), &damping, &error));
  write("damping = {rayleigh = [0.3, 0.001]}");
  ASSERT_TRUE(ReadMatrixMarket(folder_.Path("C_full.mtx"), &damping, &error))
      << error;
  const Matrix expected = 0.3 * 2.0 * Matrix::Identity(kNodes, kNodes) +
                          0.002 * Matrix(Rod(1.0, 1.0));
  EXPECT_LT((Matrix(damping) - expected).norm(), 1e-12 * expected.norm());
  write("damping = \"none\"");
  ASSERT_TRUE(ReadMatrixMarket(folder_.Path("C_full.mtx"), &damping, &error))
      << error;
  EXPECT_LT((Matrix(damping) - 0.001 * Matrix(Rod(1.0, 1.0))).norm(), 1e-12);
}

TEST_F(FiniteElementSectionTest, DoesNotWriteAllOfAVeryLargeModel) {
  constexpr int kSize = 5001;
  SparseMatrix diagonal(kSize, kSize);
  diagonal.setIdentity();
  std::string error;
  ASSERT_TRUE(WriteMatrixMarket(folder_.Path("large.mtx"), diagonal, &error));
  std::string names;
  for (int i = 1; i <= kSize; ++i) names += std::to_string(i) + ".1\n";
  folder_.Write("large.txt", names);
  const std::string large =
      Replaced(Replaced(Replaced(kCase, "\"M.mtx\"", "\"large.mtx\""),
                        "{file = \"K.mtx\"}", "\"large.mtx\""),
               "dofs.txt", "large.txt");
  Case c;
  EXPECT_FALSE(
      ReadCase(folder_.Write("case.toml", Replaced(large, "method = \"guyan\"",
                                                   "method = \"guyan\"\n"
                                                   "expand = \"all\"")),
               &c, &error));
  EXPECT_THAT(error, HasSubstr(":12: [model.reduction]: 'expand' is \"all\" of "
                               "5001 DOFs, expected at most 5000"));
}

// Springs in a row deflect evenly between the two that are kept.
TEST_F(FiniteElementSectionTest, ResponsesAndShapesReachAllDofs) {
  const Case c =
      ReadOrFail(Replaced(kCase, "method = \"guyan\"",
                          "method = \"guyan\"\nexpand = [\"2.1\", \"6.1\"]"));
  IdentifiedModel model;
  model.parameters = c.problem.dynamics->Parameters();
  IdentificationSummary summary;
  RecordScore score;
  score.name = "quake";
  const Eigen::Index samples = c.problem.records[0].num_samples();
  score.states = Matrix::Zero(4, samples);
  score.states.row(0).setConstant(3.0);
  score.states.row(1).setConstant(7.0);
  summary.records = {score};
  std::string error;
  ASSERT_TRUE(
      WriteFiniteElementResult(c, summary, model, folder_.Path(""), &error))
      << error;
  Table table;
  ASSERT_TRUE(ReadCsvTable(folder_.Path("response_full_quake.csv"),
                           {"time", "2.1", "6.1"}, &table, &error))
      << error;
  EXPECT_EQ(table.values.rows(), samples);
  EXPECT_LT((table.values.col(1).array() - 1.0).abs().maxCoeff(), 1e-12);
  EXPECT_LT((table.values.col(2).array() - 5.0).abs().maxCoeff(), 1e-12);

  ASSERT_TRUE(ReadCsvTable(folder_.Path("modes_full.csv"), {"mode_1", "mode_2"},
                           &table, &error))
      << error;
  // Frequencies, the support, three springs to the first of the kept DOFs.
  ASSERT_EQ(table.values.rows(), 1 + kNodes);
  EXPECT_NEAR(table.values(0, 0),
              c.finite_element->reduced.whole_modes.frequency_hz[0], 0.05);
  EXPECT_EQ(table.values.row(1).norm(), 0.0);
  EXPECT_NEAR(table.values(2, 0), table.values(4, 0) / 3.0, 1e-12);
}

// Without the FE program's files, and counting nothing twice.
TEST_F(FiniteElementSectionTest, ModelCaseIsTheReducedOne) {
  const Case c = ReadOrFail(kCase);
  IdentifiedModel model;
  model.parameters = c.problem.dynamics->Parameters();
  model.parameters << -0.1, 0.2, 0.0;
  std::string error;
  const std::string out = folder_.Path("");
  ASSERT_TRUE(WriteModelCase(c, model, out, out, &error)) << error;
  Case again;
  ASSERT_TRUE(ReadCase(folder_.Path("model.toml"), &again, &error)) << error;
  EXPECT_EQ(again.finite_element, nullptr);
  const StructuralModel updated =
      c.problem.dynamics->CorrectedModel(model.parameters);
  const StructuralModel& read = again.problem.dynamics->model();
  EXPECT_EQ(read.dof_names, updated.dof_names);
  EXPECT_EQ(read.stiffness, updated.stiffness);
  EXPECT_EQ(read.mass, updated.mass);
  EXPECT_EQ(read.influence, updated.influence);
  EXPECT_EQ(read.support_mass_coupling, updated.support_mass_coupling);
  EXPECT_EQ(again.problem.dynamics->groups()[0].alpha.value, 0.0);
}

TEST_F(FiniteElementSectionTest, CraigBamptonAddsCoordinates) {
  const Case c = ReadOrFail(Replaced(
      kCase, "method = \"guyan\"",
      "method = \"craig_bampton\"\nmodes = 2\nkeep = [\"8.1\", \"4.1\"]\n"
      "compare = 3"));
  EXPECT_THAT(c.problem.dynamics->model().dof_names,
              ElementsAre("4.1", "8.1", "q1", "q2"));
  ASSERT_EQ(c.finite_element->reduced.mac.size(), 3);
  EXPECT_LT(c.finite_element->reduced.frequency_error.maxCoeff(), 0.02);
}

// A baseline and a later case often list their sensors in different orders.
TEST_F(FiniteElementSectionTest, OrderOfNamesIsWithoutMeaning) {
  const std::string craig_bampton =
      Replaced(kCase, "method = \"guyan\"",
               "method = \"craig_bampton\"\nmodes = 2\nkeep = [KEPT]");
  const auto matrices = [this](const std::string& text) {
    const Case c = ReadOrFail(text);
    const StructuralModel& model = c.problem.dynamics->model();
    Matrix all(3 * model.num_dofs(), model.num_dofs());
    all << model.mass, model.stiffness,
        c.problem.dynamics->groups()[0].group.matrix;
    return all;
  };
  const Matrix kept =
      matrices(Replaced(craig_bampton, "KEPT", "\"4.1\", \"6.1\", \"8.1\""));
  for (const char* order :
       {"\"8.1\", \"4.1\", \"6.1\"", "\"6.1\", \"8.1\", \"4.1\""}) {
    const Matrix other = matrices(Replaced(craig_bampton, "KEPT", order));
    EXPECT_LT((other - kept).norm(), 1e-12 * kept.norm()) << order;
  }
  // Without `keep`, groups and sensors name the DOFs.
  EXPECT_EQ(matrices(kCase),
            matrices(Replaced(kCase, "between = [\"4.1\", \"8.1\"]",
                              "between = [\"8.1\", \"4.1\"]")));
}

// A matrix over the coordinates counts them in the order of `keep`.
TEST_F(FiniteElementSectionTest, MatricesOfCoordinatesKeepTheOrder) {
  const std::string reversed =
      Replaced(kCase, "method = \"guyan\"",
               "method = \"guyan\"\nkeep = [\"8.1\", \"4.1\"]");
  const std::string between = "between = [\"4.1\", \"8.1\"]\nscale = 100.0";
  const Case of_group =
      ReadOrFail(Replaced(reversed, between, "matrix = [[0, 0], [0, 50]]"));
  EXPECT_THAT(of_group.problem.dynamics->model().dof_names,
              ElementsAre("8.1", "4.1"));
  const Case of_damping = ReadOrFail(Replaced(
      reversed, "damping = {ratios = [0.02]}", "damping = [[1, 0], [0, 3]]"));
  EXPECT_THAT(of_damping.problem.dynamics->model().dof_names,
              ElementsAre("8.1", "4.1"));
  EXPECT_EQ(of_damping.problem.dynamics->model().damping(1, 1), 3.0);
}

TEST_F(FiniteElementSectionTest, ModalTruncationHasSensorsToo) {
  const std::string text = Replaced(
      kCase, "method = \"guyan\"",
      "method = \"modal\"\nmodes = 4\nkeep = [\"8.1\", \"4.1\"]\ncompare = 4");
  Case c = ReadOrFail(text);
  EXPECT_THAT(c.problem.dynamics->model().dof_names,
              ElementsAre("4.1", "8.1", "q1", "q2"));
  ASSERT_EQ(c.finite_element->reduced.mac.size(), 4);
  EXPECT_LT(c.finite_element->reduced.frequency_error.cwiseAbs().maxCoeff(),
            1e-9);
  // There are four coordinates, and not four more.
  const std::string path = folder_.Write(
      "case.toml", Replaced(text, "dof = \"8.1\"", "dof = \"q3\""));
  std::string error;
  EXPECT_FALSE(ReadCase(path, &c, &error));
  EXPECT_THAT(error, HasSubstr("'q3'"));
}

TEST_F(FiniteElementSectionTest, SmallModelsMayStayWhole) {
  const Case c = ReadOrFail(
      Replaced(kCase, "[model.reduction]\nmethod = \"guyan\"\n", ""));
  EXPECT_EQ(c.problem.dynamics->num_dofs(), kNodes - 1);
  EXPECT_FALSE(c.finite_element->is_reduced);
  EXPECT_LT(c.finite_element->reduced.frequency_error.cwiseAbs().maxCoeff(),
            1e-9);
}

// The rod's lowest frequency is 2 sin(pi / 4 / 7.5) sqrt(k / m) / (2 pi) with
// its end free.
TEST_F(FiniteElementSectionTest, ComparesExpectedFrequencies) {
  const double pi = std::acos(-1.0);
  const double exact =
      2.0 * std::sin(pi / 30.0) * std::sqrt(kSpring / 2.0) / (2.0 * pi);
  const std::string key = "remove_dofs = [\"1.1\"]";
  const Case c = ReadOrFail(Replaced(kCase, key,
                                     key + "\nexpected_frequencies = [" +
                                         FormatNumber(exact, 8) +
                                         "]\nfrequency_tolerance = 1e-6"));
  EXPECT_NEAR(c.finite_element->reduced.whole_modes.frequency_hz[0], exact,
              1e-9);
  EXPECT_THAT(Refusal(key, key + "\nexpected_frequencies = [" +
                               FormatNumber(1.1 * exact, 8) + "]"),
              HasSubstr(":10: [model.finite_element]: mode 1 above 0 Hz"));
}

TEST_F(FiniteElementSectionTest, SaysWhereASensorIsNowhere) {
  EXPECT_THAT(Refusal("dof = \"8.1\"", "dof = \"9.1\""),
              HasSubstr("case.toml:42: '9.1' is not a DOF of the "
                        "finite-element model; did you mean"));
  EXPECT_THAT(Refusal("dof = \"8.1\"", "dof = \"1.1\""),
              AllOf(HasSubstr(":42: "), HasSubstr("removes it")));
  EXPECT_THAT(
      Refusal("between = [\"4.1\", \"8.1\"]", "between = [\"4.1\", \"8.3\"]"),
      HasSubstr(":26: '8.3' is not a DOF"));
  EXPECT_THAT(
      Refusal("method = \"guyan\"", "method = \"guyan\"\nkeep = [\"8.1\"]"),
      AllOf(HasSubstr(":27: '4.1'"), HasSubstr("keeps")));
}

TEST_F(FiniteElementSectionTest, RefusesMapsThatDoNotMatch) {
  folder_.Write("short.txt", "1.1\n2.1\n");
  EXPECT_THAT(Refusal("dofs.txt", "short.txt"), HasSubstr("short.txt"));
  std::string error;
  const SparseMatrix smaller =
      Matrix(Rod(1.0, 1.0)).topLeftCorner(7, 7).sparseView();
  ASSERT_TRUE(WriteMatrixMarket(folder_.Path("K7.mtx"), smaller, &error));
  EXPECT_THAT(Refusal("K_lower.mtx", "K7.mtx"), HasSubstr("7 x 7"));
  EXPECT_THAT(Refusal("K_lower.mtx", "none.mtx"),
              HasSubstr(":15: group 'lower': 'changed_export' names the file "
                        "'none.mtx', which does not exist"));
  EXPECT_THAT(Refusal("K_lower.mtx", "K.mtx"),
              HasSubstr("two exports are equal"));
  // The difference of a quarter is no tenth.
  EXPECT_THAT(Refusal("factor = 1.25", "factor = 1.1"),
              AllOf(HasSubstr(":16: "), HasSubstr("check the factor")));
  EXPECT_THAT(Refusal("factor = 1.25", "factor = 1"),
              HasSubstr("changes nothing"));
  EXPECT_THAT(Refusal("factor = 1.25\n", ""), HasSubstr("'factor'"));
}

TEST_F(FiniteElementSectionTest, RefusesKeysThatDoNotFit) {
  EXPECT_THAT(Refusal("method = \"guyan\"", "method = \"modal\""),
              HasSubstr("expected at least 1"));
  EXPECT_THAT(Refusal("method = \"guyan\"", "method = \"modal\"\nmodes = 1"),
              HasSubstr("more DOFs are kept (2) than modes are taken (1)"));
  EXPECT_THAT(
      Refusal("method = \"guyan\"", "method = \"guyan\"\nexpand = [\"9.1\"]"),
      HasSubstr(":12: [model.reduction]: '9.1' is not a DOF"));
  EXPECT_THAT(
      Refusal("method = \"guyan\"", "method = \"guyan\"\nexpand = \"some\""),
      HasSubstr("expected \"all\""));
  EXPECT_THAT(Refusal("method = \"guyan\"", "method = \"irons\""),
              HasSubstr("craig_bampton"));
  EXPECT_THAT(Refusal("method = \"guyan\"", "method = \"guyan\"\nmodes = 2"),
              HasSubstr("expected none"));
  EXPECT_THAT(Refusal("remove_dofs = [\"1.1\"]", "remove_dofs = [\"0.1\"]"),
              HasSubstr(":9: [model.finite_element]: '0.1' is not a DOF"));
  EXPECT_THAT(Refusal("remove_dofs", "removed_dofs"), HasSubstr("remove_dofs"));
  EXPECT_THAT(Refusal("damping = {ratios = [0.02]}\n", ""),
              HasSubstr("'damping'"));
  EXPECT_THAT(Refusal("damping = {ratios = [0.02]}",
                      "damping = \"none\"\ndofs = [\"8.1\"]"),
              HasSubstr("'dofs' and [model.finite_element] are both given"));
  EXPECT_THAT(Refusal("[model.finite_element]", "[model.finite_elements]"),
              HasSubstr("finite_element"));
  EXPECT_THAT(Refusal("direction = \"x\"", "direction = \"y\""),
              HasSubstr("not a direction"));
}

TEST_F(FiniteElementSectionTest, NamesOfDirectionsOfTheGround) {
  const std::string key = "remove_dofs = [\"1.1\"]";
  const Case c = ReadOrFail(
      Replaced(Replaced(kCase, key, key + "\nground_directions = {along = 1}"),
               "direction = \"x\"", "direction = \"along\""));
  EXPECT_THAT(c.problem.dynamics->model().directions, ElementsAre("along"));
  EXPECT_THAT(Refusal(key, key + "\nground_directions = {x = 4}"),
              HasSubstr("expected 1, 2 or 3"));
}

TEST(NamedDofs, FindsThemWhereverTheyAre) {
  TomlValue root;
  std::string error;
  ASSERT_TRUE(ParseToml(R"([model]
dofs = ["none"]
[[element]]
between = ["ground", "a"]
[[network]]
inputs = ["x[b]", "w[c, d]", "t", "input[none]"]
outputs = ["e-1-f"]
[[record]]
  [[record.force]]
  dof = "g"
  [[record.channel]]
  combination = {a = 1, h = -1}
[discover]
features = ["v[i]"]
  [[discover.output]]
  name = "none"
)",
                        "case.toml", &root, &error))
      << error;
  const auto is_dof = [](const std::string& name) {
    return name == "e-1" || name == "f";
  };
  std::vector<std::string> names;
  std::vector<int> lines;
  for (const NamedDof& dof : NamedDofs(root.entries, is_dof)) {
    names.push_back(dof.name);
    lines.push_back(dof.line);
  }
  EXPECT_THAT(names,
              ElementsAre("a", "b", "c", "d", "e-1", "f", "g", "h", "i"));
  EXPECT_THAT(lines, ElementsAre(4, 6, 6, 6, 7, 7, 10, 12, 14));
}

}  // namespace
}  // namespace pinode
