// For tests only, hence not installed: small models in the files of many
// programs.

#ifndef TESTS_SUPPORT_FINITE_ELEMENT_FILES_TESTING_H_
#define TESTS_SUPPORT_FINITE_ELEMENT_FILES_TESTING_H_

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/structure/decks/finite_element_files.h"

namespace pinode {

// Fixture for tests of files, with the model that all samples contain.
class FiniteElementFilesTest : public ::testing::Test {
 public:
  // Returns a file that tests/generators/matrix_files.py wrote.
  static std::string Sample(const std::string& name) {
    return std::string(PINODE_SOURCE_DIR) + "/tests/fuzz/corpus/" + name;
  }

  // Return the matrices of all samples.
  static Matrix ExpectedStiffness() {
    Matrix stiffness(4, 4);
    stiffness << 4, -2, 0, 0, -2, 5, -1.5, 0, 0, -1.5, 3, -1, 0, 0, -1, 1;
    return 1e6 * stiffness;
  }

  static Matrix ExpectedMass() {
    Matrix mass = Matrix::Zero(4, 4);
    mass.topLeftCorner(2, 2) << 2.0, 0.5, 0.5, 2.0;
    mass(3, 3) = 1.0;
    return mass;
  }

  static FiniteElementFiles Files(const MatrixSource& mass,
                                  const MatrixSource& stiffness,
                                  const std::string& dof_names = "") {
    FiniteElementFiles files;
    files.mass = mass;
    files.stiffness = stiffness;
    files.dof_names = dof_names;
    return files;
  }

  static FiniteElementFiles OneFile(const std::string& path, bool damped) {
    FiniteElementFiles files = Files({path, ""}, {path, ""});
    if (damped) files.damping = {path, ""};
    return files;
  }

  static FiniteElementModel ReadOrFail(const FiniteElementFiles& files) {
    FiniteElementModel model;
    std::string error;
    EXPECT_TRUE(ReadFiniteElementModel(files, &model, &error)) << error;
    return model;
  }

  static std::string ErrorOf(const FiniteElementFiles& files) {
    FiniteElementModel model;
    model.dof_names = {"untouched"};
    std::string error;
    EXPECT_FALSE(ReadFiniteElementModel(files, &model, &error));
    EXPECT_THAT(model.dof_names, ::testing::ElementsAre("untouched"));
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    return error;
  }
};

}  // namespace pinode

#endif  // TESTS_SUPPORT_FINITE_ELEMENT_FILES_TESTING_H_
