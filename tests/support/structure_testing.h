// Helpers for the tests of this layer.

#ifndef TESTS_SUPPORT_STRUCTURE_TESTING_H_
#define TESTS_SUPPORT_STRUCTURE_TESTING_H_

#include <string>

#include "gtest/gtest.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {

inline ModalProperties Modes(const Matrix& mass, const Matrix& damping,
                             const Matrix& stiffness) {
  ModalProperties modes;
  std::string error;
  EXPECT_TRUE(ComputeModes(mass, damping, stiffness, &modes, &error)) << error;
  return modes;
}

}  // namespace pinode

#endif  // TESTS_SUPPORT_STRUCTURE_TESTING_H_
