#include "pinode/case/results/checkpoint_file.h"

#include <chrono>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/file.h"
#include "pinode/study/problem/checkpoint.h"
#include "tests/support/case_testing.h"
#include "tests/support/fitted_case_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

Checkpoint WrittenAndRead(const FittedCase& f, const Checkpoint& checkpoint) {
  const std::string path = f.folder.Path("checkpoint.json");
  std::string error;
  EXPECT_TRUE(
      WriteCheckpoint(path, ProblemHash(f.c.problem), checkpoint, &error))
      << error;
  Checkpoint read;
  EXPECT_TRUE(ReadCheckpoint(path, f.c.problem, &read, &error)) << error;
  return read;
}

TEST(CheckpointTest, RoundTrip) {
  const FittedCase f;
  Checkpoint checkpoint;
  checkpoint.iteration = 12;
  checkpoint.cost = 1.0 / 3.0;
  checkpoint.model = f.model;
  checkpoint.model.resume_stage = 3;
  Checkpoint read = WrittenAndRead(f, checkpoint);
  EXPECT_EQ(read.iteration, 12);
  EXPECT_EQ(read.model.resume_stage, 3);
  EXPECT_EQ(read.cost, 1.0 / 3.0);
  EXPECT_EQ(read.model.parameters, f.model.parameters);
  ASSERT_EQ(read.model.sigmas.size(), 1u);
  EXPECT_EQ(read.model.sigmas[0], f.model.sigmas[0]);
  EXPECT_EQ(read.model.starts[0], f.model.starts[0]);
  EXPECT_EQ(read.model.decays, f.model.decays);
}

TEST(CheckpointTest, KeepsProfiles) {
  const FittedCase f;
  Checkpoint checkpoint;
  checkpoint.model = f.model;
  ParameterProfile profile;
  profile.name = "k1";
  profile.unit = "N/m";
  profile.estimate = 1.0 / 3.0;
  profile.points = {{0.25, 4.5}, {1.0 / 3.0, 0.0}};
  profile.lower95 = 0.1;
  profile.linear_upper95 = 0.7;
  profile.threshold95 = 3.84;
  profile.determination = Determination::kOneSided;
  profile.combinations = {"k1 * c1"};
  profile.unsettled = true;
  profile.linearizations = 7;
  checkpoint.profiles = {profile, ParameterProfile()};
  Checkpoint read = WrittenAndRead(f, checkpoint);
  ASSERT_EQ(read.profiles.size(), 2u);
  const ParameterProfile& again = read.profiles[0];
  EXPECT_EQ(again.name, "k1");
  EXPECT_EQ(again.unit, "N/m");
  EXPECT_EQ(again.estimate, 1.0 / 3.0);
  ASSERT_EQ(again.points.size(), 2u);
  EXPECT_EQ(again.points[0].ratio, 4.5);
  EXPECT_EQ(again.lower95, 0.1);
  EXPECT_EQ(again.upper95, kInfinity);
  EXPECT_EQ(again.linear_lower95, -kInfinity);
  EXPECT_EQ(again.linear_upper95, 0.7);
  EXPECT_EQ(again.threshold95, 3.84);
  EXPECT_EQ(again.determination, Determination::kOneSided);
  EXPECT_EQ(again.combinations, profile.combinations);
  EXPECT_TRUE(again.unsettled);
  EXPECT_FALSE(again.found_lower);
  EXPECT_EQ(again.linearizations, 7);

  const std::string text = f.folder.Read("checkpoint.json");
  std::string error;
  EXPECT_FALSE(
      ReadCheckpoint(f.folder.Write("checkpoint.json",
                                    Replaced(text, "one-sided", "sideways")),
                     f.c.problem, &read, &error));
  EXPECT_THAT(error, HasSubstr("has a wrong value"));
}

TEST(CheckpointTest, OfAnotherCaseIsRefused) {
  const FittedCase f;
  const std::string path = f.folder.Path("checkpoint.json");
  std::string error;
  Checkpoint checkpoint;
  checkpoint.model = f.model;
  ASSERT_TRUE(
      WriteCheckpoint(path, ProblemHash(f.c.problem), checkpoint, &error));
  Checkpoint read;
  FittedCase changed;
  changed.c.problem.records[0].channels[0].values[7] += 1e-9;
  EXPECT_FALSE(ReadCheckpoint(path, changed.c.problem, &read, &error));
  EXPECT_THAT(error, HasSubstr("belongs to another case"));
  EXPECT_EQ(read.model.parameters.size(), 0);
  for (const char* text : {"", "{}", "{\"schema\": 1}", "[1, 2"}) {
    f.folder.Write("checkpoint.json", text);
    EXPECT_FALSE(ReadCheckpoint(path, f.c.problem, &read, &error)) << text;
    EXPECT_THAT(error, HasSubstr("is not a checkpoint"));
  }
  EXPECT_FALSE(ReadCheckpoint(path + "x", f.c.problem, &read, &error));
}

TEST(CheckpointTest, WriterIsThrottled) {
  const FittedCase f;
  const std::string path = f.folder.Path("checkpoint.json");
  CheckpointWriter writer(ProblemHash(f.c.problem), path,
                          std::chrono::hours(1));
  IdentificationProgress progress;
  IdentifiedModel model = f.model;
  progress.model = &model;
  std::string error;
  ASSERT_TRUE(writer.Update(progress, &error)) << error;
  model.parameters[0] += 1.0;
  ASSERT_TRUE(writer.Update(progress, &error)) << error;
  Checkpoint read;
  ASSERT_TRUE(ReadCheckpoint(path, f.c.problem, &read, &error)) << error;
  EXPECT_EQ(read.model.parameters[0], f.model.parameters[0]);

  CheckpointWriter eager(ProblemHash(f.c.problem), path,
                         std::chrono::milliseconds(0));
  ASSERT_TRUE(eager.Update(progress, &error));
  ASSERT_TRUE(ReadCheckpoint(path, f.c.problem, &read, &error)) << error;
  EXPECT_EQ(read.model.parameters[0], model.parameters[0]);
  EXPECT_TRUE(read.profiles.empty());

  // What a fit goes on from is not lost while it runs.
  ParameterProfile profile;
  profile.name = "k1";
  eager.set_profiles({profile});
  ASSERT_TRUE(eager.Update(progress, &error)) << error;
  ASSERT_TRUE(ReadCheckpoint(path, f.c.problem, &read, &error)) << error;
  ASSERT_EQ(read.profiles.size(), 1u);
  EXPECT_EQ(read.profiles[0].name, "k1");
}

}  // namespace
}  // namespace pinode
