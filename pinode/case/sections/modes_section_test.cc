#include "pinode/case/sections/modes_section.h"

#include <cmath>
#include <complex>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/arrays/matlab_writer.h"
#include "pinode/base/constants.h"
#include "pinode/base/file.h"
#include "pinode/case/results/modes_files.h"
#include "pinode/case/sections/modes_data_file.h"
#include "pinode/modal/stabilisation.h"
#include "pinode/record/files/universal_file.h"
#include "pinode/study/picture/structure_picture.h"
#include "tests/support/case_testing.h"
#include "tests/support/modal_testing.h"

namespace pinode {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::string ModesText() {
  return R"(title = "Chain"
[units]
time = "ms"
[modes]
lowest_hz = 0.5
references = ["u1"]
threads = 1
[[record]]
name = "wind"
file = "wind.csv"
sampling_rate_hz = 50
  [[record.channel]]
  column = "a1"
  dof = "u1"
  quantity = "absolute_acceleration"
  unit = "g"
  [[record.channel]]
  column = "v2"
  quantity = "velocity"
  unit = "mm/s"
  sign = -1
)";
}

std::string WindFile(const ResponseRecord& record) {
  std::string text = "a1,v2\n";
  for (Eigen::Index k = 0; k < record.num_samples(); ++k) {
    text += FormatNumber(record.samples(0, k), 12) + "," +
            FormatNumber(record.samples(1, k), 12) + "\n";
  }
  return text;
}

class ModesSectionTest : public ::testing::Test {
 protected:
  ModesSectionTest()
      : chain_(2, 400.0),
        record_(SimulateChain(chain_, 0.02, 8000, 1, {2, 1})) {
    folder_.Write("wind.csv", WindFile(record_));
  }

  std::string Error(const std::string& text) {
    ModesCase c;
    std::string error;
    EXPECT_FALSE(ReadModesCase(folder_.Write("case.toml", text), &c, &error));
    return error;
  }

  TestChain chain_;
  ResponseRecord record_;
  TemporaryFolder folder_;
};

TEST_F(ModesSectionTest, NeedsNoModel) {
  ModesCase c;
  std::string error;
  ASSERT_TRUE(
      ReadModesCase(folder_.Write("case.toml", ModesText()), &c, &error))
      << error;
  ASSERT_THAT(c.records, SizeIs(1));
  const ResponseRecord& record = c.records[0];
  // Seconds, whatever the model's time is.
  EXPECT_NEAR(record.sampling_step, 0.02, 1e-12);
  ASSERT_THAT(record.channels, SizeIs(2));
  EXPECT_EQ(record.channels[0].name, "u1");
  EXPECT_EQ(record.channels[0].derivative, 2);
  EXPECT_EQ(record.channels[1].name, "v2");
  EXPECT_EQ(record.channels[1].derivative, 1);
  const double ratio = record.samples(1, 7) / record_.samples(1, 7);
  EXPECT_LT(ratio, 0.0);
  EXPECT_NEAR(record.samples(1, 99) / record_.samples(1, 99), ratio,
              1e-6 * std::abs(ratio));
  EXPECT_THAT(c.options.references, ElementsAre("u1"));
  EXPECT_EQ(c.options.lowest_hz, 0.5);
}

// Kind of a record, which determines its analysis. Meaning and position of
// places.
TEST_F(ModesSectionTest, PlacesAndGeometry) {
  std::string text = Replaced(ModesText(), "dof = \"u1\"",
                              "combination = {\"5.1\" = 0.8, \"5.2\" = -0.6}");
  text = Replaced(text, "references = [\"u1\"]\n", "");
  ModesCase c;
  std::string error;
  ASSERT_TRUE(ReadModesCase(
      folder_.Write("case.toml", text + "[geometry]\nnodes = {5 = [0, 0, 1]}\n"
                                        "dofs = {v2 = \"5.3\"}\n"),
      &c, &error))
      << error;
  ASSERT_THAT(c.places, SizeIs(2));
  EXPECT_EQ(c.places[0].channel, "a1");
  EXPECT_EQ(c.places[0].place, c.records[0].channels[0].name);
  EXPECT_EQ(c.places[0].dofs.at("5.1"), 0.8);
  EXPECT_EQ(c.places[0].dofs.at("5.2"), -0.6);
  EXPECT_EQ(c.places[1].dofs.at("v2"), 1.0);
  ASSERT_NE(c.geometry, nullptr);
  EXPECT_THAT(c.geometry->geometry.node_names, ElementsAre("5"));
  EXPECT_THAT(Error(text + "[geometry]\nnodes = {5 = [0, 0]}\n"),
              HasSubstr("coordinate"));
  EXPECT_THAT(Error(text + "[geometry]\nnodes = {5 = [0, 0, 1]}\n"
                           "dofs = {v3 = \"5.3\"}\n"),
              HasSubstr("'v3' is not a DOF"));
}

TEST_F(ModesSectionTest, MeasuredLoadsAndFreeDecays) {
  ModesCase c;
  std::string error;
  const std::string force = R"(  [[record.force]]
  dof = "u1"
  column = "v2"
  unit = "N"
  [[record.channel]])";
  std::string text = ModesText();
  text.replace(text.find("  [[record.channel]]"), 20, force);
  text = Replaced(text, "file = \"wind.csv\"",
                  "file = \"wind.csv\"\ninterpolation = \"held\"");
  ASSERT_TRUE(ReadModesCase(folder_.Write("case.toml", text), &c, &error))
      << error;
  ASSERT_EQ(c.records[0].inputs.rows(), 1);
  EXPECT_NEAR(c.records[0].inputs(0, 9) / c.records[0].inputs(0, 5),
              record_.samples(1, 9) / record_.samples(1, 5), 1e-6);
  EXPECT_EQ(c.options.method, ModalMethod::kAutomatic);

  const std::string decay =
      Replaced(Replaced(ModesText(), "file = \"wind.csv\"",
                        "file = \"wind.csv\"\nexcitation = \"none\""),
               "lowest_hz = 0.5", "lowest_hz = 0.5\nmethod = \"ring_down\"");
  ASSERT_TRUE(ReadModesCase(folder_.Write("case.toml", decay), &c, &error))
      << error;
  EXPECT_TRUE(c.records[0].free_decay);
  EXPECT_EQ(c.records[0].inputs.rows(), 0);
  EXPECT_EQ(c.options.method, ModalMethod::kRingDown);
  EXPECT_THAT(Error(Replaced(text, "file = \"wind.csv\"",
                             "file = \"wind.csv\"\nexcitation = \"none\"")),
              HasSubstr("expected only responses"));
  EXPECT_THAT(Error(Replaced(decay, "ring_down", "wishful")),
              HasSubstr("wishful"));
}

TEST_F(ModesSectionTest, DataFileIsEnough) {
  ModesDataFile file;
  file.path = folder_.Path("wind.csv");
  file.columns = {"all"};
  file.quantities = {"acceleration", "velocity"};
  file.sampling_rate_hz = 50.0;
  ModesCase c;
  std::string error;
  ASSERT_TRUE(ReadModesDataFile(file, &c, &error)) << error;
  ASSERT_THAT(c.records, SizeIs(1));
  const ResponseRecord& record = c.records[0];
  EXPECT_NEAR(record.sampling_step, 0.02, 1e-12);
  ASSERT_THAT(record.channels, SizeIs(2));
  EXPECT_EQ(record.channels[0].name, "a1");
  EXPECT_EQ(record.channels[0].derivative, 2);
  EXPECT_EQ(record.channels[1].name, "v2");
  EXPECT_EQ(record.channels[1].derivative, 1);
  EXPECT_NEAR(record.samples(1, 7), record_.samples(1, 7),
              1e-9 * std::abs(record_.samples(1, 7)));

  // No record may be called as this file is.
  folder_.Write("Messung 1 (neu).csv", "t,a1\n0,1\n0.02,3\n0.04,2\n0.06,4\n");
  file.path = folder_.Path("Messung 1 (neu).csv");
  file.quantities = {};
  file.columns = {"all"};
  ASSERT_TRUE(ReadModesDataFile(file, &c, &error)) << error;
  EXPECT_EQ(c.records[0].name, "Messung_1__neu_.csv");

  // Columns behind a second clock may be its own.
  folder_.Write("two.csv",
                "t1,a1,t2,a2\n0,1,5,3\n0.02,3,5.02,1\n0.04,2,5.04,7\n");
  file.path = folder_.Path("two.csv");
  file.sampling_rate_hz = 0.0;
  EXPECT_FALSE(ReadModesDataFile(file, &c, &error));
  EXPECT_THAT(error, HasSubstr("the times of 't1' and 't2' differ"));
  file.sampling_rate_hz = 50.0;

  // A column that is called as times are is no channel, and that is said.
  folder_.Write("both.csv",
                "Time [s],t,a1\n0,3,1\n0.02,1,3\n0.04,2,2\n0.06,7,4\n");
  file.path = folder_.Path("both.csv");
  file.quantities = {};
  ASSERT_TRUE(ReadModesDataFile(file, &c, &error)) << error;
  ASSERT_THAT(c.records[0].channels, SizeIs(1));
  EXPECT_EQ(c.records[0].channels[0].name, "a1");
  EXPECT_THAT(
      c.remarks,
      ::testing::Contains(::testing::HasSubstr("names are those of times: ")));

  folder_.Write("timed.csv", "time,a1,remark\n0,1,x\n0.1,3,y\n0.2,2,z\n");
  file = ModesDataFile();
  file.path = folder_.Path("timed.csv");
  file.columns = {"a1"};
  ASSERT_TRUE(ReadModesDataFile(file, &c, &error)) << error;
  EXPECT_EQ(c.records[0].sampling_step, 0.1);
  EXPECT_EQ(c.records[0].num_channels(), 1);
}

TEST_F(ModesSectionTest, DataFileRefusedInOneLine) {
  const auto refused = [](const ModesDataFile& file) {
    ModesCase c;
    std::string error;
    EXPECT_FALSE(ReadModesDataFile(file, &c, &error));
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    return error;
  };
  ModesDataFile file;
  file.path = folder_.Path("wind.csv");
  file.columns = {"a1", "v2"};
  EXPECT_THAT(refused(file), HasSubstr("sampling rate"));
  file.sampling_rate_hz = 50.0;
  file.quantities = {"acceleration", "velocity", "velocity"};
  EXPECT_THAT(refused(file), HasSubstr("3 quantities"));
  file.quantities = {"heat"};
  EXPECT_THAT(refused(file), HasSubstr("'heat'"));
  file.quantities = {};
  file.columns = {"a1", "w2"};
  EXPECT_THAT(refused(file), HasSubstr("w2"));
  file.columns = {"a1", ""};
  EXPECT_THAT(refused(file), HasSubstr("'column' is empty"));
  file.columns = {"a1", "a1"};
  EXPECT_THAT(refused(file), HasSubstr("a1"));
  file.columns = {"a1"};
  file.sampling_rate_hz = -1.0;
  refused(file);
  file.time_column = "t";
  EXPECT_THAT(refused(file), HasSubstr("one of them"));
  file.path = folder_.Path("none.csv");
  EXPECT_THAT(refused(file), HasSubstr("none.csv"));
}

TEST_F(ModesSectionTest, RefusesInOneLine) {
  EXPECT_THAT(Error(Replaced(ModesText(), "lowest_hz", "lowest")),
              HasSubstr("case.toml:5"));
  EXPECT_THAT(
      Error(Replaced(ModesText(), "references = [\"u1\"]", "max_order = 7")),
      HasSubstr("odd"));
  EXPECT_THAT(Error(Replaced(ModesText(), "quantity = \"velocity\"",
                             "quantity = \"force\"")),
              HasSubstr("case.toml"));
  EXPECT_THAT(
      Error(Replaced(ModesText(), "column = \"v2\"", "column = \"v3\"")),
      HasSubstr("v3"));
  EXPECT_THAT(Error("title = \"none\"\n"), HasSubstr("[[record]]"));
  // Keys without an effect on frequency response functions, and no motions.
  EXPECT_THAT(
      Error(Replaced(ModesText(), "references", "frf = {}\nreferences")),
      HasSubstr("does not use 'references'"));
  const std::string frf =
      Replaced(ModesText(), "references = [\"u1\"]", "frf = {}");
  EXPECT_THAT(Error(Replaced(frf, "sampling_rate_hz",
                             "excitation = \"none\"\nsampling_rate_hz")),
              HasSubstr("needs a measured force"));
  EXPECT_THAT(Error(Replaced(frf, "quantity = \"velocity\"\n  unit = \"mm/s\"",
                             "quantity = \"strain\"\n  gauge_length = 1.0\n  "
                             "unit = \"1\"\n  dof = \"u2\"")),
              HasSubstr("are of motions"));
}

// modes.toml is what a case with a model reads.
TEST_F(ModesSectionTest, ModesEnterACase) {
  ModesOfRecord modes;
  std::string error;
  ASSERT_TRUE(IdentifyModes(record_, {}, &modes, &error)) << error;
  ASSERT_THAT(modes.modes, SizeIs(2));
  ModesResult result;
  result.setups = {"wind"};
  SetupModes setup;
  setup.name = "wind";
  setup.places = {"u1", "u2"};
  setup.modes = modes.modes;
  ASSERT_TRUE(MergeSetups({setup}, {}, &result.merged, &error)) << error;
  ASSERT_TRUE(WriteModesFiles(result, folder_.Path("."), &error)) << error;

  std::string text;
  ASSERT_TRUE(ReadTextFile(folder_.Path("modes.toml"), &text, &error));
  const Case c = ReadOrFail(folder_.Write("update.toml", R"([model]
dofs = ["u1", "u2"]
mass = {diagonal = [1.0, 1.0]}
stiffness = [[800.0, -400.0], [-400.0, 400.0]]
[[group]]
name = "k1"
adds_to = "stiffness"
between = ["ground", "u1"]
)" + text));
  ASSERT_THAT(c.problem.modal.modes, SizeIs(2));
  const MeasuredMode& first = c.problem.modal.modes[0];
  EXPECT_NEAR(first.frequency, chain_.frequency_hz[0], 0.02);
  EXPECT_NEAR(first.frequency_sigma, modes.modes[0].frequency_sigma, 1e-8);
  ASSERT_EQ(first.shape_covariance.rows(), 2);
  // Largest one, as real as it can be.
  EXPECT_EQ(first.shape.cwiseAbs().maxCoeff(), 1.0);
  EXPECT_GT(first.shape_covariance(0, 0), 0.0);
  // With the frequency as the identification has it, turned, over the largest
  // entry, and shrunk as the shape's own covariance is.
  const IdentifiedMode& source = result.merged.modes[0].mode;
  const std::complex<double> turn = TurnToReal(source.shape);
  const double scale = (turn * source.shape[1]).real();
  const double share = 3.0 / (3.0 + source.degrees_of_freedom);
  ASSERT_EQ(first.shape[1], 1.0);
  ASSERT_EQ(first.frequency_shape_covariance.size(), 2);
  const double shared = (1.0 - share) *
                        (turn.real() * source.covariance(0, 2) -
                         turn.imag() * source.covariance(0, 4)) /
                        scale;
  EXPECT_NEAR(first.frequency_shape_covariance[0], shared,
              1e-8 * std::abs(shared));
  EXPECT_NE(shared, 0.0);

  ASSERT_TRUE(ReadTextFile(folder_.Path("modes.json"), &text, &error));
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["schema"], "pinode-modes-1");
  EXPECT_EQ(json["modes"].size(), 2u);
  EXPECT_EQ(json["modes"][0]["shape"].size(), 2u);
  ASSERT_TRUE(ReadTextFile(folder_.Path("modes.csv"), &text, &error));
  EXPECT_THAT(text, HasSubstr("frequency_hz"));

  UniversalFile shapes;
  ASSERT_TRUE(ReadUniversalFile(folder_.Path("modes.uff"), &shapes, &error))
      << error;
  ASSERT_THAT(shapes.shapes, SizeIs(2));
  EXPECT_THAT(shapes.shapes[0].nodes, ElementsAre(1, 2));
  const IdentifiedMode& mode = modes.modes[0];
  const std::complex<double> s = shapes.shapes[0].eigenvalue;
  EXPECT_NEAR(std::abs(s), kTwoPi * mode.frequency_hz, 1e-7);
  EXPECT_NEAR(-s.real() / std::abs(s), mode.damping_ratio, 1e-9);
  EXPECT_LT(std::abs(shapes.shapes[0].values(1, 0) - mode.shape[1]), 1e-9);

  // Places of a universal file keep node and direction.
  result.merged.places = {"7:-z", "3:rx"};
  ASSERT_TRUE(ParseUniversalFile(ModesAsUniversalFile(result), "memory",
                                 &shapes, &error))
      << error;
  EXPECT_THAT(shapes.shapes[0].nodes, ElementsAre(3, 7));
  EXPECT_LT(std::abs(shapes.shapes[0].values(1, 2) + mode.shape[0]), 1e-9);
  EXPECT_LT(std::abs(shapes.shapes[0].values(0, 3) - mode.shape[1]), 1e-9);

  // With a geometry its nodes and lines, and shapes there.
  PlacedGeometry placed;
  placed.geometry.node_names = {"10", "12", "15"};
  placed.geometry.positions = Matrix::Zero(3, 3);
  placed.geometry.positions.col(2) << 0.0, 3.0, 6.5;
  placed.geometry.elements = {{ElementShape::kLine, {0, 1}},
                              {ElementShape::kLine, {1, 2}}};
  placed.dofs["u1"] = {{"12", 2, -1.0}};
  placed.dofs["u2"] = {{"15", 2, 1.0}};
  result.merged.places = {"u1", "u2"};
  result.geometry = placed.geometry;
  result.motions = MotionsOfNodes(
      placed, {{"u1", "v1", {{"u1", 1.0}}}, {"u2", "v2", {{"u2", 1.0}}}},
      result.merged);
  ASSERT_TRUE(ParseUniversalFile(ModesAsUniversalFile(result), "memory",
                                 &shapes, &error))
      << error;
  ASSERT_THAT(shapes.nodes, SizeIs(3));
  EXPECT_EQ(shapes.nodes[2].label, 15);
  EXPECT_EQ(shapes.nodes[2].position[2], 6.5);
  ASSERT_THAT(shapes.lines, SizeIs(1));
  EXPECT_THAT(shapes.lines[0].nodes, ElementsAre(10, 12, 0, 12, 15, 0));
  EXPECT_THAT(shapes.shapes[0].nodes, ElementsAre(10, 12, 15));
  const std::complex<double> ratio =
      shapes.shapes[0].values(1, 1) / shapes.shapes[0].values(2, 1);
  EXPECT_LT(std::abs(ratio + mode.shape[0] / mode.shape[1]), 1e-5);
  EXPECT_EQ(shapes.shapes[0].values.row(0).norm(), 0.0);
  // One that is nowhere in it.
  EXPECT_THAT(
      MotionsOfNodes(placed, {{"u9", "v9", {{"u9", 1.0}}}}, result.merged),
      IsEmpty());
}

// A data file by itself may be any that has columns.
TEST_F(ModesSectionTest, DataFilesThatAreNoText) {
  const Eigen::Index samples = record_.samples.cols();
  Matrix columns(samples, 3);
  columns.col(0) = Vector::LinSpaced(
      samples, 0.0, record_.sampling_step * static_cast<double>(samples - 1));
  columns.rightCols(2) = record_.samples.transpose();
  const std::string path = folder_.Path("wind.mat");
  std::string error;
  MatlabWriter writer(path);
  writer.AddMatrix("t", columns.col(0));
  writer.AddMatrix("a1", columns.col(1));
  writer.AddMatrix("a2", columns.col(2));
  ASSERT_TRUE(writer.Close(&error)) << error;
  ModesDataFile file;
  file.path = path;
  file.columns = {"all"};
  ModesCase c;
  ASSERT_TRUE(ReadModesDataFile(file, &c, &error)) << error;
  ASSERT_THAT(c.records, SizeIs(1));
  EXPECT_EQ(c.records[0].samples, record_.samples);

  // The time of a structure, also beside a sampling rate.
  file.path = folder_.Path("structure.mat");
  MatlabWriter structure(file.path);
  structure.AddStructure("run", {{"time", columns.col(0), {}},
                                 {"a1", columns.col(1), {}},
                                 {"a2", columns.col(2), {}}});
  ASSERT_TRUE(structure.Close(&error)) << error;
  for (const double rate : {0.0, 1.0 / record_.sampling_step}) {
    file.sampling_rate_hz = rate;
    c = ModesCase();
    ASSERT_TRUE(ReadModesDataFile(file, &c, &error)) << error;
    ASSERT_THAT(c.records, SizeIs(1));
    EXPECT_EQ(c.records[0].samples, record_.samples) << rate;
  }
}

// Channels of two clocks in one file of arrays, and a sensor called T.
TEST_F(ModesSectionTest, ArraysOfTwoClocks) {
  const Vector times = Vector::LinSpaced(
      record_.samples.cols(), 0.0,
      record_.sampling_step * static_cast<double>(record_.samples.cols() - 1));
  ModesDataFile file;
  file.path = folder_.Path("clocks.mat");
  std::string error;
  for (const double factor : {0.5, 1.0}) {
    MatlabWriter writer(file.path);
    writer.AddMatrix("t", times);
    writer.AddMatrix("T", record_.samples.row(0).transpose());
    writer.AddStructure(
        "b", {{"t", Vector(factor * times), {}},
              {"x", Vector(record_.samples.row(1).transpose()), {}}});
    ASSERT_TRUE(writer.Close(&error)) << error;
    for (const double rate : {0.0, 1.0 / record_.sampling_step}) {
      file.sampling_rate_hz = rate;
      file.columns = {"all"};
      ModesCase c;
      ASSERT_EQ(ReadModesDataFile(file, &c, &error), factor == 1.0) << error;
      if (factor < 1.0) {
        EXPECT_THAT(error, HasSubstr("the times of 't' and 'b.t' differ"));
        file.columns = {"T"};
        EXPECT_TRUE(ReadModesDataFile(file, &c, &error)) << error;
        continue;
      }
      ASSERT_THAT(c.records, SizeIs(1));
      EXPECT_EQ(c.records[0].samples, record_.samples);
      EXPECT_THAT(c.remarks,
                  Contains(HasSubstr(rate > 0.0 ? "of times: t, b.t."
                                                : "of times: b.t.")));
    }
  }
}

}  // namespace
}  // namespace pinode
