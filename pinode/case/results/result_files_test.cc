#include "pinode/case/results/result_files.h"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/case/results/case_result.h"
#include "pinode/case/results/checkpoint_file.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/record/table.h"
#include "pinode/structure/matrices/matrix_io.h"
#include "tests/support/case_testing.h"
#include "tests/support/fitted_case_testing.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Json = nlohmann::json;

std::string WriteAll(const FittedCase& f, const std::string& name) {
  ResultFolder out;
  std::string error;
  EXPECT_TRUE(out.Open(f.folder.Path(name), false, false, &error)) << error;
  EXPECT_TRUE(WriteCaseResult(f.c, f.summary, f.model, out, &error)) << error;
  EXPECT_TRUE(out.Commit(&error)) << error;
  return f.folder.Path(name);
}

Matrix ReadMatrixOrFail(const std::string& path) {
  Matrix matrix;
  std::string error;
  EXPECT_TRUE(ReadMatrix(path, &matrix, &error)) << error;
  return matrix;
}

TEST(ResultFilesTest, EverythingIsThere) {
  const FittedCase f;
  const std::string out = WriteAll(f, "out");
  for (const char* name :
       {"result.json", "parameters.csv", "covariance.csv", "history.csv",
        "prediction_quake.csv", "initial_states.csv", "M.mtx", "C.mtx", "K.mtx",
        "K_folded.mtx", "C_folded.mtx", "K_folded_symmetric.mtx",
        "C_folded_symmetric.mtx", "model.toml", "network_nn.json",
        "checkpoint.json"}) {
    EXPECT_TRUE(fs::exists(fs::path(out) / name)) << name;
  }

  const Json json = Json::parse(f.folder.Read("out/result.json"));
  EXPECT_EQ(json["schema"], "pinode-result-1");
  EXPECT_EQ(json["usable"], true);
  const Json& channel = json["records"][0]["channels"][0];
  EXPECT_EQ(channel["name"], "a1");
  EXPECT_EQ(channel["dof"], "u1");
  EXPECT_EQ(channel["quantity"], "absolute_acceleration");
  EXPECT_DOUBLE_EQ(channel["rmse"].get<double>(), 1.0);  // in g
  EXPECT_EQ(channel["nrmse"], 0.5);
  EXPECT_TRUE(json["records"][0]["channels"][1]["nrmse"].is_null());
  EXPECT_EQ(json["records"][0]["role"], "train");
  EXPECT_EQ(json["parameters"][0]["name"], "k1");
  EXPECT_EQ(json["solver"]["final_cost"], 1.25);
  ASSERT_EQ(json["modes"].size(), 2u);
  EXPECT_NEAR(json["modes"][0]["initial_damping"].get<double>(), 0.02, 1e-9);
  EXPECT_GT(json["modes"][0]["updated_hz"].get<double>(), 0.0);
  double mass = 0.0;
  for (const auto& mode : json["modes"]) {
    mass += mode["updated_mass_share"]["x"].get<double>();
  }
  EXPECT_NEAR(mass, 1.0, 1e-9);
  EXPECT_NEAR(json["modes"][0]["mac"].get<double>(), 1.0, 0.1);

  // Predictions are in the units of the file, sign included.
  Table table;
  std::string error;
  ASSERT_TRUE(ReadCsvTable(out + "/prediction_quake.csv", {}, &table, &error))
      << error;
  EXPECT_THAT(table.columns,
              ::testing::ElementsAre("time", "a1_measured", "a1_predicted",
                                     "d2_measured", "d2_predicted"));
  EXPECT_NEAR(table.values(20, 0), 0.2, 1e-12);
  EXPECT_NEAR(table.values(20, 1), 0.1 * std::sin(1.5), 1e-8);
  EXPECT_NEAR(table.values(20, 3), 4.0 * std::sin(1.6) + 1.0, 1e-8);
  EXPECT_NEAR(table.values(20, 4), -2.0, 1e-12);
  EXPECT_THAT(f.folder.Read("out/initial_states.csv"),
              HasSubstr("record,x[u1],x[u2],v[u1],v[u2]\nquake,1,2,3,4\n"));
  EXPECT_THAT(f.folder.Read("out/covariance.csv"), HasSubstr("k1,1e-04"));
}

TEST(ResultFilesTest, ProfilesHaveTheirPointsAndTheirEnds) {
  FittedCase f;
  EXPECT_FALSE(fs::exists(fs::path(WriteAll(f, "none")) / "profiles.csv"));
  ParameterProfile profile;
  profile.name = "k1";
  profile.unit = "1";
  profile.points = {{0.5, 4.0}, {0.75, 0.0}};
  profile.lower95 = 0.51;
  profile.determination = Determination::kOneSided;
  f.summary.profiles = {profile};
  WriteAll(f, "out");
  EXPECT_EQ(f.folder.Read("out/profiles.csv"),
            "parameter,unit,value,likelihood_ratio\nk1,1,0.5,4\n"
            "k1,1,0.75,0\n");
  const Json json = Json::parse(f.folder.Read("out/result.json"));
  EXPECT_EQ(json["profiles"][0]["lower95"], 0.51);
  EXPECT_TRUE(json["profiles"][0]["upper95"].is_null());
  EXPECT_EQ(json["profiles"][0]["determination"], "one-sided");
}

TEST(ResultFilesTest, ForcesHaveTheirHistoryAndTheirSize) {
  FittedCase f;
  ForceEstimate force;
  force.name = "blow";
  force.record = 0;
  force.times = Vector::LinSpaced(5, 0.0, 0.4);
  force.value.resize(5);
  force.value << 0.0, 3.0, -8.0, 1.0, 0.0;
  force.sigma = Vector::Constant(5, 0.5);
  force.lower95 = force.value.array() - 1.0;
  force.upper95 = force.value.array() + 1.0;
  f.summary.forces = {force};
  WriteAll(f, "out");
  const Json json = Json::parse(f.folder.Read("out/result.json"));
  ASSERT_EQ(json["forces"].size(), 1u);
  const Json& entry = json["forces"][0];
  EXPECT_EQ(entry["name"], "blow");
  EXPECT_EQ(entry["record"], "quake");
  EXPECT_EQ(entry["unit"], "kN");
  EXPECT_EQ(entry["peak"], -8.0);
  EXPECT_EQ(entry["peak_lower95"], -9.0);
  EXPECT_NEAR(entry["peak_time"].get<double>(), 0.2, 1e-12);
  EXPECT_NEAR(entry["impulse"].get<double>(), -0.4, 1e-12);
  Table table;
  std::string error;
  ASSERT_TRUE(
      ReadCsvTable(f.folder.Path("out/" + entry["file"].get<std::string>()), {},
                   &table, &error))
      << error;
  EXPECT_THAT(table.columns,
              ::testing::ElementsAre("time", "force", "lower95", "upper95"));
  EXPECT_EQ(table.num_rows(), 5);
}

// The model case is the same structure, and counts nothing twice.
TEST(ResultFilesTest, ModelCaseReadsBack) {
  const FittedCase f;
  const std::string out = WriteAll(f, "deep/er/out");
  Case read;
  std::string error;
  ASSERT_TRUE(ReadCase(out + "/model.toml", &read, &error)) << error;
  const StructuralDynamics& before = *f.c.problem.dynamics;
  const StructuralDynamics& after = *read.problem.dynamics;
  const Vector theta = f.model.parameters.head(before.num_parameters());
  const StructuralModel expected = before.CorrectedModel(theta);
  const StructuralModel found = after.CorrectedModel(after.Parameters());
  EXPECT_EQ(found.mass, expected.mass);
  EXPECT_EQ(found.damping, expected.damping);
  EXPECT_EQ(found.stiffness, expected.stiffness);

  ASSERT_EQ(after.groups().size(), before.groups().size());
  const Parameter& k1 = after.groups()[0].alpha;
  EXPECT_EQ(k1.value, 0.0);
  EXPECT_EQ(k1.lower, -0.9 - theta[0]);
  EXPECT_EQ(k1.upper, 2.0 - theta[0]);
  EXPECT_EQ(k1.prior_mean, 0.1 - theta[0]);
  EXPECT_EQ(after.groups()[0].group.matrix, before.groups()[0].group.matrix);
  // Follows time: stays where it is.
  EXPECT_EQ(after.groups()[2].alpha.value, theta[2]);
  EXPECT_EQ(after.laws()[0].parameters.parameters[0].value, theta[3]);
  EXPECT_EQ(after.laws()[0].parameters.parameters[0].prior_mean, 1.0);
  const NetworkTerm& network = after.networks()[0];
  EXPECT_EQ(network.weights.Values(), theta.tail(network.weights.size()));
  EXPECT_EQ(network.network->architecture().input_scale[1], 2.0);
  EXPECT_EQ(network.network->architecture().output_scale,
            before.networks()[0].network->architecture().output_scale);
  EXPECT_NEAR(read.problem.sensors.Values()[0], f.model.parameters.tail(1)[0],
              1e-15);
  EXPECT_EQ(read.problem.records[0].channels[1].values,
            f.c.problem.records[0].channels[1].values);

  // The right-hand sides agree at a point.
  StructuralDynamics updated = before;
  updated.SetParameters(theta);
  const Vector state = Vector::LinSpaced(4, -0.3, 0.4);
  const double input = 0.7;
  Vector rates[2] = {Vector(4), Vector(4)};
  const StructuralDynamics* both[2] = {&updated, &after};
  for (int i = 0; i < 2; ++i) {
    StructuralDynamics::Prepared prepared;
    ASSERT_TRUE(both[i]->Prepare(both[i]->Parameters(), &prepared, &error));
    auto stage = both[i]->MakeLinearization();
    both[i]->Rate(prepared, 1.5, &input, state.data(), rates[i].data(), &stage);
  }
  EXPECT_LT((rates[0] - rates[1]).norm(), 1e-12 * rates[0].norm());

  // And once more, from the model case itself.
  FittedCase again;
  again.c = read;
  again.model.parameters = ParameterLayout(read.problem).InitialValues();
  const std::string second = WriteAll(again, "second");
  EXPECT_EQ(ReadMatrixOrFail(second + "/K.mtx"), expected.stiffness);
  ASSERT_TRUE(ReadCase(second + "/model.toml", &read, &error)) << error;
  EXPECT_EQ(read.problem.dynamics->model().stiffness, expected.stiffness);
}

// The same files from a problem that no case file has described.
TEST(ResultFilesTest, NeedNoCaseFile) {
  const FittedCase f;
  IdentificationProblem problem = f.c.problem;
  problem.description = ProblemDescription();
  IdentificationRecord& record = problem.records[0];
  record.description = RecordDescription();
  for (MeasuredChannel& channel : record.channels) {
    channel.description = ChannelDescription();
  }
  const std::string out = f.folder.Path("of/memory");
  std::string error;
  ASSERT_TRUE(WriteResultFiles(problem, f.summary, f.model, out, &error))
      << error;
  WriteAll(f, "of_case");
  for (const char* name :
       {"parameters.csv", "covariance.csv", "history.csv", "M.mtx", "C.mtx",
        "K.mtx", "K_folded.mtx", "network_nn.json", "initial_states.csv",
        "checkpoint.json"}) {
    EXPECT_EQ(f.folder.Read(std::string("of/memory/") + name),
              f.folder.Read(std::string("of_case/") + name))
        << name;
  }
  // It would have to name files of records.
  EXPECT_FALSE(fs::exists(out + "/model.toml"));
  // In SI units, at the DOFs of the observations.
  const Json json = Json::parse(f.folder.Read("of/memory/result.json"));
  EXPECT_EQ(json["units"]["force"], "N");
  const Json& channel = json["records"][0]["channels"][0];
  EXPECT_EQ(channel["unit"], "m/s^2");
  EXPECT_EQ(channel["dof"], "u1");
  EXPECT_EQ(channel["rmse"], 9.80665);
  Checkpoint checkpoint;
  EXPECT_TRUE(
      ReadCheckpoint(out + "/checkpoint.json", problem, &checkpoint, &error))
      << error;
}

TEST(ResultFilesTest, OfAnotherProblemAreRefused) {
  const FittedCase f;
  const std::string out = f.folder.Path("refused");
  std::string error;
  const auto refused = [&](const IdentificationProblem& problem,
                           const IdentificationSummary& summary) {
    EXPECT_FALSE(WriteResultFiles(problem, summary, f.model, out, &error));
    EXPECT_FALSE(fs::exists(out));
    return error;
  };
  IdentificationProblem problem = f.c.problem;
  problem.records[0].substeps = 0;
  EXPECT_THAT(refused(problem, f.summary), HasSubstr("PrepareProblem"));
  IdentificationSummary summary = f.summary;
  summary.records.resize(2);
  EXPECT_THAT(refused(f.c.problem, summary), HasSubstr("not of this problem"));
  summary = f.summary;
  summary.records[0].prediction.conservativeResize(3, 200);
  EXPECT_THAT(refused(f.c.problem, summary), HasSubstr("not of this problem"));
  summary = f.summary;
  summary.covariance_names.push_back("k2");
  EXPECT_THAT(refused(f.c.problem, summary), HasSubstr("not of this problem"));
  summary = f.summary;
  summary.forces.resize(1);
  EXPECT_THAT(refused(f.c.problem, summary), HasSubstr("not of this problem"));
  // And a folder that cannot be.
  EXPECT_FALSE(WriteResultFiles(f.c.problem, f.summary, f.model,
                                f.folder.Path("quake.csv") + "/out", &error));
  EXPECT_THAT(error, HasSubstr("quake.csv"));
}

// More unknowns than data have no covariance, and a result nevertheless.
TEST(ResultFilesTest, WithoutACovariance) {
  FittedCase f;
  f.summary.covariance.resize(0, 0);
  WriteAll(f, "out");
  EXPECT_EQ(f.folder.Read("out/covariance.csv"), "name,k1\n");
}

// A fit that never began is written as such.
TEST(ResultFilesTest, FailedFit) {
  FittedCase f;
  f.summary = IdentificationSummary();
  f.model = IdentifiedModel();
  WriteAll(f, "out");
  const Json json = Json::parse(f.folder.Read("out/result.json"));
  EXPECT_EQ(json["usable"], false);
  EXPECT_TRUE(json["records"].empty());
  EXPECT_FALSE(fs::exists(f.folder.Path("out/prediction_quake.csv")));
}

// Folding against the Jacobian of the dynamics: a linear network leaves nothing
// else in it.
TEST(SimulationSummaryTest, ReadsBack) {
  const TemporaryFolder folder;
  SimulationSummary summary;
  summary.case_path = "frame.toml";
  summary.noise_percent = 2.5;
  summary.seed = 18446744073709551615u;
  summary.records = {{"north", 300, true}, {"south", 200, false}};
  std::string error;
  ASSERT_TRUE(
      WriteSimulationSummary(folder.Path("simulate.json"), summary, &error))
      << error;
  const Json json = Json::parse(folder.Read("simulate.json"));
  EXPECT_EQ(json["schema"], "pinode-simulate-1");
  EXPECT_EQ(json["case"], "frame.toml");
  EXPECT_EQ(json["noise_percent"], 2.5);
  EXPECT_EQ(json["seed"], 18446744073709551615u);
  ASSERT_EQ(json["records"].size(), 2u);
  EXPECT_EQ(json["records"][1]["name"], "south");
  EXPECT_EQ(json["records"][1]["samples"], 200);
  EXPECT_EQ(json["records"][0]["finite"], true);
  EXPECT_EQ(json["records"][1]["finite"], false);

  EXPECT_FALSE(WriteSimulationSummary(folder.Path("no/such/simulate.json"),
                                      summary, &error));
  EXPECT_THAT(error, HasSubstr("simulate.json"));
}

}  // namespace
}  // namespace pinode
