#include "pinode/base/arrays/hdf5_storage.h"

#include <hdf5.h>

#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/arrays/array_files.h"
#include "pinode/base/file.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

constexpr hsize_t kSize = 4;

// Writes a file with the data set "t", and another one, "a", with the
// properties that `set` gives it. `user_block`: bytes before HDF5's own.
template <typename Set>
void WriteFile(const std::string& path, hsize_t user_block, const Set& set) {
  const hid_t access = H5Pcreate(H5P_FILE_CREATE);
  ASSERT_GE(H5Pset_userblock(access, user_block), 0);
  const hid_t file =
      H5Fcreate(path.c_str(), H5F_ACC_TRUNC, access, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  const hid_t space = H5Screate_simple(1, &kSize, nullptr);
  const double times[kSize] = {0.0, 1.0, 2.0, 3.0};
  for (const char* name : {"t", "a"}) {
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    if (name[0] == 'a') set(properties, space);
    const hid_t data = H5Dcreate2(file, name, H5T_IEEE_F64LE, space,
                                  H5P_DEFAULT, properties, H5P_DEFAULT);
    ASSERT_GE(data, 0) << name;
    if (name[0] == 't') {
      H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, times);
    }
    H5Dclose(data);
    H5Pclose(properties);
  }
  H5Sclose(space);
  H5Pclose(access);
  ASSERT_GE(H5Fclose(file), 0);
}

// The samples are the bytes of another file, which may be any file or a pipe.
void WriteExternal(const std::string& path, const std::string& other,
                   hsize_t user_block = 0) {
  WriteFile(path, user_block, [&](hid_t properties, hid_t) {
    ASSERT_GE(
        H5Pset_external(properties, other.c_str(), 0, kSize * sizeof(double)),
        0);
  });
}

// Makes a file with a user block one of MATLAB 7.3.
void WriteMatlabHeader(const std::string& path) {
  std::string content, error;
  ASSERT_TRUE(ReadBinaryFile(path, &content, &error)) << error;
  std::string header = "MATLAB 7.3 MAT-file";
  header.resize(124, ' ');
  header += std::string("\x00\x02IM", 4);
  content.replace(0, header.size(), header);
  ASSERT_TRUE(WriteFileAtomically(path, content, &error)) << error;
}

std::string FaultOf(const std::string& path, const std::string& name) {
  std::vector<NamedArray> arrays;
  std::string error;
  EXPECT_TRUE(ReadArrayFile(
      path, [](const std::string&) { return true; }, &arrays, &error))
      << error;
  for (const NamedArray& array : arrays) {
    if (array.name == name) return array.fault;
  }
  return "is not there";
}

std::string ErrorOf(const std::string& path) {
  std::vector<NamedArray> arrays;
  std::string error;
  EXPECT_FALSE(ReadArrayFile(
      path, [](const std::string&) { return true; }, &arrays, &error));
  return error;
}

TEST(Hdf5Storage, SamplesInOtherFilesAreNotRead) {
  const TemporaryFolder folder;
  const std::string secret =
      folder.Write("secret", "0123456789012345678901234567890123456789");
  const std::string path = folder.Path("external.h5");
  WriteExternal(path, secret);
  EXPECT_EQ(FaultOf(path, "t"), "");
  EXPECT_THAT(FaultOf(path, "a"), HasSubstr("external storage"));
}

// HDF5 follows such a data set until the stack ends.
TEST(Hdf5Storage, VirtualDataSetOfItself) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("virtual.h5");
  WriteFile(path, 0, [&](hid_t properties, hid_t space) {
    ASSERT_GE(H5Pset_virtual(properties, space, ".", "a", space), 0);
  });
  EXPECT_EQ(FaultOf(path, "t"), "");
  EXPECT_THAT(FaultOf(path, "a"), HasSubstr("virtual"));
}

TEST(Hdf5Storage, MatlabFilesHoldTheirOwnData) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("external.mat");
  WriteExternal(path, folder.Write("secret", std::string(40, 'x')), 512);
  WriteMatlabHeader(path);
  EXPECT_THAT(ErrorOf(path), HasSubstr("data set 'a'"));
  EXPECT_THAT(ErrorOf(path), HasSubstr("external storage"));

  const std::string linked = folder.Path("linked.mat");
  WriteFile(linked, 512, [](hid_t, hid_t) {});
  const hid_t file = H5Fopen(linked.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(
      H5Lcreate_external("other.h5", "/t", file, "b", H5P_DEFAULT, H5P_DEFAULT),
      0);
  ASSERT_GE(H5Fclose(file), 0);
  WriteMatlabHeader(linked);
  EXPECT_THAT(ErrorOf(linked), HasSubstr("link 'b' to another file"));
}

}  // namespace
}  // namespace pinode
