#include "pinode/structure/matrices/matrix_from_arrays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <limits>

namespace pinode {
namespace {

using ::testing::HasSubstr;

template <typename T>
NumpyArray MakeArray(char kind, const std::vector<T>& values) {
  NumpyArray array;
  array.kind = kind;
  array.item_size = sizeof(T);
  array.shape = {static_cast<int64_t>(values.size())};
  array.data.resize(values.size() * sizeof(T));
  std::memcpy(array.data.data(), values.data(), array.data.size());
  return array;
}

// [1 0 2; 0 0 3] by its three nonzeros, in each of SciPy's ways.
class MatrixFromPartsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    parts_.data = &data_;
    parts_.shape = &shape_;
  }

  void ExpectMatrix() {
    ASSERT_TRUE(MatrixFromParts(parts_, &matrix_, &what_)) << what_;
    Matrix expected(2, 3);
    expected << 1.0, 0.0, 2.0, 0.0, 0.0, 3.0;
    EXPECT_EQ(Matrix(matrix_), expected);
  }

  NumpyArray data_ = MakeArray<double>('f', {1.0, 2.0, 3.0});
  NumpyArray shape_ = MakeArray<int64_t>('i', {2, 3});
  NumpyArray rows_ = MakeArray<int32_t>('i', {0, 0, 1});
  NumpyArray columns_ = MakeArray<int32_t>('i', {0, 2, 2});
  NumpyArray row_pointers_ = MakeArray<int32_t>('i', {0, 2, 3});
  NumpyArray column_pointers_ = MakeArray<int32_t>('i', {0, 1, 1, 3});
  SparseParts parts_;
  SparseMatrix matrix_;
  std::string what_;
};

TEST_F(MatrixFromPartsTest, ByEntries) {
  parts_.indices = &rows_;
  parts_.columns = &columns_;
  ExpectMatrix();
}

TEST_F(MatrixFromPartsTest, ByRows) {
  parts_.indices = &columns_;
  parts_.pointers = &row_pointers_;
  ExpectMatrix();
}

TEST_F(MatrixFromPartsTest, ByColumns) {
  parts_.indices = &rows_;
  parts_.pointers = &column_pointers_;
  parts_.by_columns = true;
  ExpectMatrix();
}

TEST_F(MatrixFromPartsTest, RefusesPartsThatDoNotFit) {
  parts_.indices = &columns_;
  parts_.pointers = &column_pointers_;  // of another length than the rows
  EXPECT_FALSE(MatrixFromParts(parts_, &matrix_, &what_));
  EXPECT_THAT(what_, HasSubstr("do not fit each other"));
  row_pointers_ = MakeArray<int32_t>('i', {0, 2, 2});
  parts_.pointers = &row_pointers_;
  EXPECT_FALSE(MatrixFromParts(parts_, &matrix_, &what_));
  EXPECT_THAT(what_, HasSubstr("does not go from 0 to 3"));
  parts_.pointers = nullptr;
  parts_.indices = &columns_;  // as rows: there are only two
  parts_.columns = &rows_;
  EXPECT_FALSE(MatrixFromParts(parts_, &matrix_, &what_));
  EXPECT_THAT(what_, HasSubstr("index outside"));
}

TEST(MatrixFromFullArray, InEitherOrder) {
  NumpyArray array = MakeArray<double>('f', {1.0, 2.0, 0.0, 3.0});
  array.shape = {2, 2};
  SparseMatrix matrix;
  std::string what;
  for (const bool fortran_order : {false, true}) {
    array.fortran_order = fortran_order;
    ASSERT_TRUE(MatrixFromFullArray(array, &matrix, &what)) << what;
    EXPECT_EQ(matrix.nonZeros(), 3);
    EXPECT_EQ(matrix.coeff(0, 1), fortran_order ? 0.0 : 2.0);
    EXPECT_EQ(matrix.coeff(1, 0), fortran_order ? 2.0 : 0.0);
  }
  array = MakeArray<double>('f', {std::numeric_limits<double>::infinity()});
  array.shape = {1, 1};
  EXPECT_FALSE(MatrixFromFullArray(array, &matrix, &what));
  EXPECT_THAT(what, HasSubstr("not a finite number"));
}

TEST(NamesFromArray, PairsOfNodeAndDirection) {
  NumpyArray array = MakeArray<int16_t>('i', {12, 3, 7, 1});
  array.shape = {2, 2};
  std::vector<std::string> names;
  std::string what;
  ASSERT_TRUE(NamesFromArray(array, &names, &what)) << what;
  EXPECT_THAT(names, ::testing::ElementsAre("12.3", "7.1"));
  EXPECT_FALSE(NamesFromArray(MakeArray<double>('f', {1.0}), &names, &what));
}

}  // namespace
}  // namespace pinode
