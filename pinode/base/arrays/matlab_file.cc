#include "pinode/base/arrays/matlab_file.h"

#include <cmath>
#include <cstdint>
#include <string_view>

#include "pinode/base/arrays/hdf5_storage.h"
#include "pinode/base/arrays/mat5_structure.h"
#include "pinode/base/arrays/quiet_hdf5.h"
#include "pinode/base/file.h"

namespace pinode {
namespace {

// Version 2.0 (called 7.3 by its users) and the byte order, as after MATLAB's
// header.
constexpr std::string_view kMat73("\x00\x02IM", 4);

}  // namespace

struct MatlabFile::Opened {
  struct Closer {
    void operator()(mat_t* mat) const { Mat_Close(mat); }
  };
  QuietHdf5 quiet;
  std::unique_ptr<mat_t, Closer> file;
};

MatlabFile::MatlabFile() = default;
MatlabFile::~MatlabFile() = default;

bool MatlabFile::Open(const std::string& path, std::string* error) {
  std::string content;
  if (!ReadBinaryFile(path, &content, error)) return false;
  size_ = content.size();
  std::string what;
  const bool is_mat73 =
      content.size() >= 128 && content.substr(124, 4) == kMat73;
  if (!is_mat73 && !IsWholeMat5(content, &what)) {
    *error = path + ": " + what +
             ", expected a whole MATLAB file of version 5 or 7.3";
    return false;
  }
  content = std::string();
  if (is_mat73 && !CheckHdf5Storage(path, &what)) {
    *error = path + ": the file " + what;
    return false;
  }
  opened_ = std::make_unique<Opened>();
  opened_->file.reset(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  if (opened_->file != nullptr) return true;
  *error =
      path +
      ": cannot be opened, expected a whole MATLAB file of version 5 or 7.3";
  return false;
}

MatlabVariable MatlabFile::Next() {
  return MatlabVariable(Mat_VarReadNextInfo(opened_->file.get()));
}

bool MatlabFile::ReadData(matvar_t* variable) {
  return Mat_VarReadDataAll(opened_->file.get(), variable) == 0;
}

double MatlabNumberAt(const void* data, matio_types type, size_t index) {
  switch (type) {
    case MAT_T_DOUBLE:
      return static_cast<const double*>(data)[index];
    case MAT_T_SINGLE:
      return static_cast<const float*>(data)[index];
    case MAT_T_INT8:
      return static_cast<const int8_t*>(data)[index];
    case MAT_T_UINT8:
      return static_cast<const uint8_t*>(data)[index];
    case MAT_T_INT16:
      return static_cast<const int16_t*>(data)[index];
    case MAT_T_UINT16:
      return static_cast<const uint16_t*>(data)[index];
    case MAT_T_INT32:
      return static_cast<const int32_t*>(data)[index];
    case MAT_T_UINT32:
      return static_cast<const uint32_t*>(data)[index];
    case MAT_T_INT64:
      return static_cast<double>(static_cast<const int64_t*>(data)[index]);
    case MAT_T_UINT64:
      return static_cast<double>(static_cast<const uint64_t*>(data)[index]);
    default:
      return std::nan("");
  }
}

size_t MatlabTypeSize(matio_types type) {
  switch (type) {
    case MAT_T_DOUBLE:
    case MAT_T_INT64:
    case MAT_T_UINT64:
      return 8;
    case MAT_T_SINGLE:
    case MAT_T_INT32:
    case MAT_T_UINT32:
      return 4;
    case MAT_T_INT16:
    case MAT_T_UINT16:
    case MAT_T_UTF16:
      return 2;
    case MAT_T_INT8:
    case MAT_T_UINT8:
    case MAT_T_UTF8:
      return 1;
    default:
      return 0;
  }
}

}  // namespace pinode
