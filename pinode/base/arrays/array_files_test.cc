#include "pinode/base/arrays/array_files.h"

#include <hdf5.h>
#include <matio.h>
#include <zip.h>

#include <cmath>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/file.h"
#include "pinode/base/unpacked_size.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// Returns a file that tests/generators/array_files.py wrote.
std::string Sample(const std::string& name) {
  return std::string(PINODE_SOURCE_DIR) + "/tests/fuzz/corpus/arrays/" + name;
}

double ExactY(Eigen::Index k, Eigen::Index c) {
  return static_cast<double>(c + 1) *
         std::sin(0.5 * static_cast<double>(k) + static_cast<double>(c));
}

std::vector<NamedArray> ReadOrFail(const std::string& path) {
  std::vector<NamedArray> arrays;
  std::string error;
  EXPECT_TRUE(ReadArrayFile(
      path, [](const std::string&) { return true; }, &arrays, &error))
      << error;
  return arrays;
}

const NamedArray& Find(const std::vector<NamedArray>& arrays,
                       const std::string& name) {
  static const NamedArray& none = *new NamedArray;
  for (const NamedArray& array : arrays) {
    if (array.name == name) return array;
  }
  ADD_FAILURE() << "no " << name;
  return none;
}

void ExpectY(const std::vector<NamedArray>& arrays, const std::string& name,
             double scale = 1.0, double tolerance = 1e-15) {
  const NamedArray& y = Find(arrays, name);
  ASSERT_EQ(y.fault, "") << name;
  ASSERT_EQ(y.values.rows(), 7) << name;
  ASSERT_EQ(y.values.cols(), 3) << name;
  for (Eigen::Index k = 0; k < 7; ++k) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      EXPECT_NEAR(y.values(k, c), scale * ExactY(k, c), tolerance) << name;
    }
  }
}

void ExpectTimes(const std::vector<NamedArray>& arrays, const std::string& name,
                 double tolerance = 1e-15) {
  const NamedArray& t = Find(arrays, name);
  ASSERT_EQ(t.values.rows(), 7) << name;
  ASSERT_EQ(t.values.cols(), 1) << name;
  for (int k = 0; k < 7; ++k) EXPECT_NEAR(t.values(k, 0), 0.01 * k, tolerance);
}

TEST(ArrayFilesTest, NumpyArrays) {
  ExpectY(ReadOrFail(Sample("y.npy")), "y");
  ExpectY(ReadOrFail(Sample("y_rows.npy")), "y_rows");
  const std::vector<NamedArray> arrays = ReadOrFail(Sample("record.npz"));
  ExpectY(arrays, "y");
  ExpectTimes(arrays, "t");
  EXPECT_TRUE(std::isnan(Find(arrays, "a").values(2, 0)));
  EXPECT_EQ(Find(arrays, "rate").samples, 1);
  EXPECT_THAT(Find(arrays, "names").fault, HasSubstr("text"));
  EXPECT_THAT(Find(arrays, "z").fault, HasSubstr("complex"));
  const std::vector<NamedArray> types = ReadOrFail(Sample("types.npz"));
  ExpectY(types, "y", 1000.0, 0.5);
  ExpectTimes(types, "t", 1e-8);
}

TEST(ArrayFilesTest, MatlabArraysAndStructures) {
  for (const char* name : {"record.mat", "compressed.mat"}) {
    const std::vector<NamedArray> arrays = ReadOrFail(Sample(name));
    ExpectY(arrays, "y");
    ExpectY(arrays, "data.acc");
    ExpectTimes(arrays, "t");
    EXPECT_TRUE(std::isnan(Find(arrays, "data.info.b").values(2, 0)));
    EXPECT_THAT(Find(arrays, "z").fault, HasSubstr("complex"));
    EXPECT_THAT(Find(arrays, "cube").fault, HasSubstr("3 dimensions"));
  }
}

TEST(ArrayFilesTest, MatlabCellsAndArraysOfStructures) {
  const std::vector<NamedArray> arrays = ReadOrFail(Sample("containers.mat"));
  ExpectTimes(arrays, "events(1).t");
  ExpectY(arrays, "events(1).acc");
  ExpectY(arrays, "events(2).acc", 2.0, 4e-15);
  // Counted down the columns, as MATLAB does.
  ExpectY(arrays, "cells{1}");
  EXPECT_THAT(Find(arrays, "cells{3}").fault, HasSubstr("empty"));
  ExpectY(arrays, "cells{4}.y");
  ExpectY(arrays, "data.channels{1}{1}");
  ExpectY(arrays, "data.channels{1}{4}.y");
  // Text is no array.
  EXPECT_EQ(arrays.size(), 10U);
}

// The file comes from matio itself, version 7.3 as MATLAB has it since 2006.
TEST(ArrayFilesTest, Matlab73) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("new.mat");
  double numbers[21];
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < 7; ++k) numbers[7 * c + k] = ExactY(k, c);
  }
  size_t dims[2] = {7, 3};
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT73);
  ASSERT_NE(file, nullptr);
  matvar_t* y =
      Mat_VarCreate("y", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, numbers, 0);
  EXPECT_EQ(Mat_VarWrite(file, y, MAT_COMPRESSION_ZLIB), 0);
  const char* fields[] = {"acc"};
  size_t one[2] = {1, 1};
  matvar_t* data = Mat_VarCreateStruct("data", 2, one, fields, 1);
  Mat_VarSetStructFieldByName(
      data, "acc", 0,
      Mat_VarCreate("acc", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, numbers, 0));
  EXPECT_EQ(Mat_VarWrite(file, data, MAT_COMPRESSION_NONE), 0);
  size_t two[2] = {1, 2};
  matvar_t* cells =
      Mat_VarCreate("cells", MAT_C_CELL, MAT_T_CELL, 2, two, nullptr, 0);
  for (int i = 0; i < 2; ++i) {
    Mat_VarSetCell(cells, i,
                   Mat_VarCreate(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims,
                                 numbers, 0));
  }
  EXPECT_EQ(Mat_VarWrite(file, cells, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(y);
  Mat_VarFree(data);
  Mat_VarFree(cells);
  Mat_Close(file);
  const std::vector<NamedArray> arrays = ReadOrFail(path);
  ExpectY(arrays, "y");
  ExpectY(arrays, "data.acc");
  ExpectY(arrays, "cells{2}");
}

TEST(ArrayFilesTest, Hdf5DataSets) {
  const std::vector<NamedArray> arrays = ReadOrFail(Sample("record.h5"));
  ExpectY(arrays, "setup1/y");
  ExpectY(arrays, "setup1/raw", 1000.0, 0.5);
  ExpectTimes(arrays, "t");
  ExpectTimes(arrays, "table.t");
  EXPECT_TRUE(std::isnan(Find(arrays, "table.a").values(2, 0)));
  EXPECT_THAT(Find(arrays, "name").fault, HasSubstr("real type"));
  const std::vector<NamedArray> huge = ReadOrFail(Sample("huge.h5"));
  ExpectTimes(huge, "t");
  EXPECT_THAT(Find(huge, "empty").fault, HasSubstr("larger than the file"));
}

// HDF5 does not check a data set in its own header ("compact"). If one is
// shorter than its shape says, HDF5 reads the bytes behind it.
TEST(ArrayFilesTest, CompactHdf5DataSetShorterThanItSays) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("compact.h5");
  const double values[] = {1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0};
  const hsize_t size = 8;
  const hid_t file =
      H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t space = H5Screate_simple(1, &size, nullptr);
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  ASSERT_GE(H5Pset_layout(properties, H5D_COMPACT), 0);
  const hid_t set = H5Dcreate2(file, "a", H5T_IEEE_F64LE, space, H5P_DEFAULT,
                               properties, H5P_DEFAULT);
  ASSERT_GE(
      H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values),
      0);
  H5Dclose(set);
  H5Pclose(properties);
  H5Sclose(space);
  ASSERT_GE(H5Fclose(file), 0);
  const std::vector<NamedArray> whole = ReadOrFail(path);
  ASSERT_EQ(Find(whole, "a").values.rows(), 8);
  EXPECT_EQ(Find(whole, "a").values(7, 0), 128.0);

  // Its layout: version 3, class 0, 64 bytes, which become 32.
  std::string content;
  std::string error;
  ASSERT_TRUE(ReadBinaryFile(path, &content, &error)) << error;
  const std::string layout("\x03\x00\x40\x00", 4);
  const size_t at = content.find(layout);
  ASSERT_NE(at, std::string::npos);
  ASSERT_EQ(content.find(layout, at + 1), std::string::npos);
  content[at + 2] = '\x20';
  ASSERT_TRUE(WriteFileAtomically(path, content, &error)) << error;
  std::vector<NamedArray> arrays;
  EXPECT_FALSE(ReadArrayFile(
      path, [](const std::string&) { return true; }, &arrays, &error));
  EXPECT_THAT(error, HasSubstr(path + ": data set 'a' cannot be read"));
}

TEST(ArrayFilesTest, OnlyWhatIsWantedIsRead) {
  for (const char* name : {"record.npz", "record.mat", "record.h5"}) {
    std::vector<NamedArray> arrays;
    std::string error;
    ASSERT_TRUE(ReadArrayFile(
        Sample(name), [](const std::string& array) { return array == "t"; },
        &arrays, &error))
        << error;
    for (const NamedArray& array : arrays) {
      EXPECT_EQ(array.values.size() > 0, array.name == "t") << array.name;
      EXPECT_TRUE(array.samples > 0 || !array.fault.empty()) << array.name;
    }
  }
}

// Sets the limit for one test.
class UnpackedBytes {
 public:
  explicit UnpackedBytes(double bytes) { SetLargestUnpackedBytes(bytes); }
  ~UnpackedBytes() { SetLargestUnpackedBytes(before_); }
  UnpackedBytes(const UnpackedBytes&) = delete;
  UnpackedBytes& operator=(const UnpackedBytes&) = delete;

 private:
  const double before_ = LargestUnpackedBytes();
};

// Writes an archive of NumPy with 'zeros' (1e6 numbers, packed to a thousandth)
// and 't' (3 numbers).
void WriteZerosNpz(const std::string& path) {
  std::string members[2];
  const char* const shapes[] = {"(1000000,)", "(3,)"};
  const size_t bytes[] = {8000000, 24};
  for (int m = 0; m < 2; ++m) {
    std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': " +
                         std::string(shapes[m]) + ", }";
    header.resize(117, ' ');
    header += '\n';
    members[m] = std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header +
                 std::string(bytes[m], '\0');
  }
  zip_t* archive = zip_open(path.c_str(), ZIP_CREATE, nullptr);
  ASSERT_NE(archive, nullptr);
  const char* const names[] = {"zeros.npy", "t.npy"};
  for (int m = 0; m < 2; ++m) {
    zip_source_t* source = zip_source_buffer(archive, members[m].data(),
                                             members[m].size(), /*freep=*/0);
    ASSERT_GE(zip_file_add(archive, names[m], source, 0), 0);
  }
  ASSERT_EQ(zip_close(archive), 0);
}

// Writes the same to HDF5; the samples of 'zeros' were never written.
void WriteZerosHdf5(const std::string& path) {
  const hid_t file =
      H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const double times[] = {0.0, 1.0, 2.0};
  for (const hsize_t size : {hsize_t{1000000}, hsize_t{3}}) {
    const hid_t space = H5Screate_simple(1, &size, nullptr);
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    const hid_t set =
        H5Dcreate2(file, size == 3 ? "t" : "zeros", H5T_IEEE_F64LE, space,
                   H5P_DEFAULT, properties, H5P_DEFAULT);
    if (size == 3) {
      H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, times);
    }
    H5Dclose(set);
    H5Pclose(properties);
    H5Sclose(space);
  }
  ASSERT_GE(H5Fclose(file), 0);
}

// A small file that becomes large takes no memory unless it is asked for, and
// only as much as the limit then.
TEST(ArrayFilesTest, SmallFilesThatBecomeLarge) {
  const TemporaryFolder folder;
  WriteZerosNpz(folder.Path("zeros.npz"));
  WriteZerosHdf5(folder.Path("zeros.h5"));
  for (const char* name : {"zeros.npz", "zeros.h5"}) {
    const auto read = [&](const std::string& wanted,
                          std::vector<NamedArray>* arrays, std::string* error) {
      return ReadArrayFile(
          folder.Path(name),
          [&](const std::string& array) { return array == wanted; }, arrays,
          error);
    };
    std::vector<NamedArray> arrays;
    std::string error;
    ASSERT_TRUE(read("zeros", &arrays, &error)) << error;
    EXPECT_EQ(Find(arrays, "zeros").values.rows(), 1000000);

    const UnpackedBytes limit(1e6);
    ASSERT_TRUE(read("t", &arrays, &error)) << error;
    EXPECT_EQ(Find(arrays, "zeros").samples, 1000000);
    EXPECT_EQ(Find(arrays, "t").values.rows(), 3);
    EXPECT_FALSE(read("zeros", &arrays, &error)) << name;
    EXPECT_THAT(error, HasSubstr("takes more than 0.001 GB of memory"));
    EXPECT_THAT(error, HasSubstr("--unpacked_gb"));
  }
}

TEST(ArrayFilesTest, DamagedFilesAreRefusedInOneLine) {
  const TemporaryFolder folder;
  for (const char* name : {"y.npy", "record.npz", "record.mat", "record.h5"}) {
    std::string content;
    std::string error;
    ASSERT_TRUE(ReadBinaryFile(Sample(name), &content, &error)) << error;
    const std::string damaged = folder.Path(std::string("damaged_") + name);
    for (const std::string& bytes : {std::string(), std::string("just a text"),
                                     content.substr(0, content.size() / 2)}) {
      ASSERT_TRUE(WriteFileAtomically(damaged, bytes, &error)) << error;
      std::vector<NamedArray> arrays;
      EXPECT_FALSE(ReadArrayFile(
          damaged, [](const std::string&) { return true; }, &arrays, &error))
          << name;
      EXPECT_THAT(error, HasSubstr(damaged + ": "));
      EXPECT_EQ(error.find('\n'), std::string::npos);
    }
    std::vector<NamedArray> arrays;
    EXPECT_FALSE(ReadArrayFile(
        folder.Path("no.h5"), [](const std::string&) { return true; }, &arrays,
        &error));
    EXPECT_THAT(error, HasSubstr("no.h5"));
  }
}

TEST(ArrayFilesTest, ExtensionsInAnyCase) {
  for (const char* path : {"a.mat", "b.NPZ", "c/d.npy", "e.H5", "f.hdf5"}) {
    EXPECT_TRUE(IsArrayFile(path)) << path;
  }
  for (const char* path : {"a.csv", "npz", "a.npz.gz", "b.uff"}) {
    EXPECT_FALSE(IsArrayFile(path)) << path;
  }
}

}  // namespace
}  // namespace pinode
