// Compares finite-element models of others with their published results.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/structure/sparse/finite_element_model.h"
#include "pinode/structure/sparse/sparse_modes.h"
#include "tests/support/finite_element_files_testing.h"
#include "tests/support/measured_data_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Pairs of matrices from public collections, with eigenvalues computed by
// another program.
class MeasuredModelsTest : public FiniteElementFilesTest {
 protected:
  void SetUp() override {
    PINODE_FIND_MEASURED_DATA(folder, "matrices");
    folder_ = folder;
  }

  MatrixSource Source(const std::string& name) const {
    return {(folder_ / name).string(), ""};
  }

  std::filesystem::path folder_;
};

TEST_F(MeasuredModelsTest, LowestEigenvaluesAgreeWithTheReference) {
  nlohmann::json reference;
  std::ifstream(folder_ / "reference_eigenvalues.json") >> reference;
  for (const auto& [stiffness, mass, massless] :
       {std::tuple("bcsstk01", "bcsstm01", 24),
        std::tuple("bcsstk02", "bcsstm02", 0),
        std::tuple("lunda", "lundb", 0)}) {
    const std::string key = std::string(stiffness) + "/" + mass;
    SCOPED_TRACE(key);
    const FiniteElementModel model =
        ReadOrFail(Files(Source(std::string(mass) + ".mtx"),
                         Source(std::string(stiffness) + ".mtx")));
    EXPECT_EQ(FindSpecialDofs(model).massless.size(),
              static_cast<size_t>(massless));
    SparseModes modes;
    std::string error;
    ASSERT_TRUE(
        ComputeLowestModes(model.mass, model.stiffness, 10, &modes, &error))
        << error;
    const auto expected =
        reference.at(key).at("lowest_eigenvalues").get<std::vector<double>>();
    ASSERT_EQ(expected.size(), 10u);
    double worst = 0.0;
    for (Eigen::Index i = 0; i < 10; ++i) {
      const double wanted = expected[static_cast<size_t>(i)];
      EXPECT_NEAR(modes.eigenvalues[i], wanted, 1e-6 * wanted);
      worst = std::max(worst, std::abs(modes.eigenvalues[i] / wanted - 1.0));
    }
    RecordProperty(key, std::to_string(worst));
    std::printf("%s: worst relative difference %.2g\n", key.c_str(), worst);
  }
}

TEST_F(MeasuredModelsTest, AllModesOfBcsstk01) {
  const FiniteElementModel model =
      ReadOrFail(Files(Source("bcsstm01.mtx"), Source("bcsstk01.mtx")));
  SparseModes modes;
  std::string error;
  ASSERT_TRUE(
      ComputeLowestModes(model.mass, model.stiffness, 48, &modes, &error))
      << error;
  EXPECT_EQ(modes.eigenvalues.size(), 24);
  EXPECT_THAT(modes.notes, ElementsAre(HasSubstr("24 modes, 48 were asked")));
}

TEST_F(MeasuredModelsTest, CalculixCantilever) {
  const FiniteElementModel model = ReadOrFail(Files(
      Source("ccx_cantilever/cantm.mas"), Source("ccx_cantilever/cantm.sti")));
  ASSERT_EQ(model.num_dofs(), 288);
  EXPECT_EQ(model.dof_names[0], "2.1");
  EXPECT_EQ(model.dof_names[287], "104.3");
  EXPECT_THAT(model.notes, ElementsAre());
  SparseModes modes;
  std::string error;
  ASSERT_TRUE(
      ComputeLowestModes(model.mass, model.stiffness, 10, &modes, &error))
      << error;
  // The table of eigenvalues in CalculiX's own output, seven digits.
  std::ifstream output(folder_ / "ccx_cantilever" / "cant.dat");
  std::string line;
  double worst = 0.0;
  int compared = 0;
  while (compared < 10 && std::getline(output, line)) {
    std::istringstream words(line);
    int mode = 0;
    double eigenvalue = 0.0;
    if (!(words >> mode >> eigenvalue) || mode != compared + 1) continue;
    const double found = modes.eigenvalues[compared];
    EXPECT_NEAR(found, eigenvalue, 1e-6 * eigenvalue) << "mode " << mode;
    worst = std::max(worst, std::abs(found / eigenvalue - 1.0));
    ++compared;
  }
  EXPECT_EQ(compared, 10);
  std::printf("CalculiX cantilever: worst relative difference %.2g\n", worst);
  EXPECT_TRUE(CheckExpectedFrequencies(
      modes, {17.0420, 42.2637, 108.090, 263.467, 309.589, 559.969}, 1e-5,
      &error))
      << error;
}

}  // namespace
}  // namespace pinode
