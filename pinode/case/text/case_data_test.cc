// Cases whose matrices and records are arrays in memory.

#include "pinode/case/text/case_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <memory>
#include <string>

#include "pinode/base/file.h"
#include "pinode/case/results/model_case.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/case/sections/case_folder.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/support/case_testing.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// The small case of testing.h with its matrices and its record in memory.
class CaseDataTest : public ::testing::Test {
 protected:
  CaseDataTest() {
    WriteOrFail("small.toml", SmallCase());
    WriteOrFail("quake.csv", SmallRecord());
    from_files_ = ReadOrFail(folder_.Path("small.toml"));

    tree_ = *from_files_.source;
    tree_.Find("model")->Set("stiffness", TomlValue::String("<stiffness>"));
    tree_.Find("record")->elements[0].Set("file", TomlValue::String("<quake>"));
    Matrix stiffness(2, 2);
    stiffness << 300.0, -100.0, -100.0, 100.0;
    data_.matrices["<stiffness>"] = stiffness;
    Table table;
    std::string error;
    EXPECT_TRUE(ReadCsvTable(folder_.Path("quake.csv"), {}, &table, &error));
    table.path = "<quake>";
    data_.tables["<quake>"] = table;
  }

  void WriteOrFail(const std::string& name, const std::string& text) {
    std::string error;
    EXPECT_TRUE(WriteFileAtomically(folder_.Path(name), text, &error)) << error;
  }

  bool Read(Case* c) {
    return ReadCaseTree(tree_, "", std::make_shared<const CaseData>(data_),
                        CasePurpose::kFit, c, &error_);
  }

  TemporaryFolder folder_;
  Case from_files_;
  TomlValue tree_;
  CaseData data_;
  std::string error_;
};

void ExpectSameProblem(const Case& a, const Case& b) {
  EXPECT_EQ(a.problem.dynamics->model().stiffness,
            b.problem.dynamics->model().stiffness);
  ASSERT_EQ(a.problem.records.size(), b.problem.records.size());
  const IdentificationRecord& first = a.problem.records[0];
  const IdentificationRecord& second = b.problem.records[0];
  EXPECT_EQ(first.excitation->samples(), second.excitation->samples());
  for (size_t i = 0; i < first.channels.size(); ++i) {
    EXPECT_EQ(first.channels[i].values, second.channels[i].values);
  }
}

TEST_F(CaseDataTest, ArraysAreReadAsFilesAre) {
  Case c;
  ASSERT_TRUE(Read(&c)) << error_;
  ExpectSameProblem(from_files_, c);
}

TEST_F(CaseDataTest, CasesAreWrittenWithTheirArrays) {
  ASSERT_TRUE(WriteCaseFolder(tree_, data_, "", folder_.Path("out"), &error_))
      << error_;
  ExpectSameProblem(from_files_, ReadOrFail(folder_.Path("out/case.toml")));
}

TEST_F(CaseDataTest, FilesOfACaseThatIsWrittenStayWhereTheyAre) {
  ASSERT_TRUE(WriteCaseFolder(*from_files_.source, CaseData(), from_files_.path,
                              folder_.Path("deep/out"), &error_))
      << error_;
  const std::string path = folder_.Path("deep/out/case.toml");
  ExpectSameProblem(from_files_, ReadOrFail(path));
  std::string text;
  ASSERT_TRUE(ReadTextFile(path, &text, &error_)) << error_;
  EXPECT_THAT(text, HasSubstr("file = \"../../quake.csv\""));
  // Not in place of itself.
  EXPECT_FALSE(WriteCaseFolder(*from_files_.source, CaseData(), path,
                               folder_.Path("deep/out"), &error_));
  EXPECT_THAT(error_, HasSubstr("would overwrite the case itself"));
}

TEST_F(CaseDataTest, ModelCasesHaveTheirRecordsBesideThem) {
  Case c;
  ASSERT_TRUE(Read(&c)) << error_;
  IdentifiedModel model;
  model.parameters = ParameterLayout(c.problem).InitialValues();
  std::filesystem::create_directory(folder_.Path("result"));
  ASSERT_TRUE(WriteModelCase(c, model, folder_.Path("result"),
                             folder_.Path("result"), &error_))
      << error_;
  ExpectSameProblem(from_files_, ReadOrFail(folder_.Path("result/model.toml")));
}

TEST_F(CaseDataTest, MessagesNameTheArray) {
  Case c;
  data_.matrices["<stiffness>"] = Matrix::Identity(3, 3);
  EXPECT_FALSE(Read(&c));
  EXPECT_EQ(error_,
            "<stiffness>: the stiffness matrix is 3 x 3, expected 2 x 2, one "
            "row and column per DOF");
  data_.matrices["<stiffness>"] = Matrix::Identity(2, 2);
  data_.tables["<quake>"].columns[1] = "an";
  EXPECT_FALSE(Read(&c));
  EXPECT_THAT(error_, HasSubstr("<quake>: there is no column 'ag'"));
  EXPECT_THAT(error_, HasSubstr("an"));
  data_.tables["<quake>"].columns[1] = "ag";
  data_.tables["<quake>"].values(5, 2) =
      std::numeric_limits<double>::infinity();
  EXPECT_FALSE(Read(&c));
  EXPECT_EQ(error_,
            "<quake>: column 'a1' has an infinite number, expected finite "
            "ones, or NaN where one is missing");
}

TEST_F(CaseDataTest, FiniteElementModelsMayBeInMemory) {
  const std::shared_ptr<const SparseMatrix> mass =
      std::make_shared<SparseMatrix>(
          Matrix(from_files_.problem.dynamics->model().mass).sparseView());
  data_.sparse_matrices["<M>"] = mass;
  data_.sparse_matrices["<K>"] = std::make_shared<SparseMatrix>(
      Matrix(data_.matrices["<stiffness>"]).sparseView());
  TomlValue model = TomlValue::Table();
  TomlValue exported = TomlValue::Table();
  exported.Set("mass", TomlValue::String("<M>"));
  exported.Set("stiffness", TomlValue::String("<K>"));
  exported.Set("dofs", TomlValue::Strings({"u1", "u2"}));
  model.Set("finite_element", exported);
  model.Set("damping", *tree_.Find("model")->Find("damping"));
  tree_.Set("model", model);
  TomlValue& record = tree_.Find("record")->elements[0];
  record.Erase("ground");
  TomlValue force = TomlValue::Table();
  force.Set("dof", TomlValue::String("u1"));
  force.Set("column", TomlValue::String("ag"));
  force.Set("unit", TomlValue::String("kN"));
  record.Set("force", TomlValue::Array({force}));
  Case c;
  ASSERT_TRUE(Read(&c)) << error_;
  EXPECT_EQ(c.problem.dynamics->model().dof_names,
            (std::vector<std::string>{"u1", "u2"}));
  // Named once too often.
  tree_.Find("model")
      ->Find("finite_element")
      ->Set("dofs", TomlValue::Strings({"u1", "u2", "u3"}));
  EXPECT_FALSE(Read(&c));
  EXPECT_EQ(
      error_,
      "<M>: the mass matrix is 2 x 2, expected 3 x 3 by the list of DOFs");
}

}  // namespace
}  // namespace pinode
