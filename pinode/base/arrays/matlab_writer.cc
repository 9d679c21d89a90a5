#include "pinode/base/arrays/matlab_writer.h"

#include <matio.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <limits>

#include "pinode/base/arrays/matlab_file.h"
#include "pinode/base/file.h"

namespace pinode {
namespace {

// Characters of a name that MATLAB distinguishes (namelengthmax).
constexpr size_t kLongestMatlabName = 63;

// Returns the content of a char array of MATLAB. Bytes that are not UTF-8
// become U+FFFD.
std::vector<std::uint16_t> Utf16(const std::string& text) {
  std::vector<std::uint16_t> units;
  for (size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const size_t length = lead < 0x80           ? 1
                          : (lead >> 5) == 0x06 ? 2
                          : (lead >> 4) == 0x0E ? 3
                          : (lead >> 3) == 0x1E ? 4
                                                : 0;
    std::uint32_t code =
        length == 1 ? lead : lead & (0x7Fu >> std::max<size_t>(length, 1));
    bool valid = length > 0 && i + length <= text.size();
    for (size_t k = 1; valid && k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      valid = (next >> 6) == 0x02;
      code = (code << 6) | (next & 0x3Fu);
    }
    if (!valid || code > 0x10FFFF) code = 0xFFFD;
    if (code >= 0x10000) {
      code -= 0x10000;
      units.push_back(static_cast<std::uint16_t>(0xD800 + (code >> 10)));
      units.push_back(static_cast<std::uint16_t>(0xDC00 + (code & 0x3FF)));
    } else {
      units.push_back(static_cast<std::uint16_t>(code));
    }
    i += valid ? length : 1;
  }
  return units;
}

MatlabVariable Numbers(const char* name, const double* data, Eigen::Index rows,
                       Eigen::Index cols) {
  size_t dims[2] = {static_cast<size_t>(rows), static_cast<size_t>(cols)};
  return MatlabVariable(Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims,
                                      const_cast<double*>(data), 0));
}

// Writes ASCII text in bytes, and other text in MATLAB's own encoding. (matio
// 1.5.23 writes files that are too short for its own MAT_T_UTF16.)
MatlabVariable Text(const char* name, const std::string& text) {
  std::vector<std::uint16_t> units = Utf16(text);
  const bool plain =
      std::all_of(units.begin(), units.end(),
                  [](std::uint16_t unit) { return unit < 0x80; });
  std::string bytes = plain ? text : std::string();
  size_t dims[2] = {units.empty() ? size_t{0} : size_t{1}, units.size()};
  void* data = units.data();
  if (plain) data = bytes.data();
  return MatlabVariable(Mat_VarCreate(
      name, MAT_C_CHAR, plain ? MAT_T_UTF8 : MAT_T_UINT16, 2, dims, data, 0));
}

// The returned variable owns the cells.
MatlabVariable Cells(const char* name, const std::vector<std::string>& texts) {
  size_t dims[2] = {texts.size(), 1};
  std::vector<matvar_t*> cells;
  cells.reserve(texts.size());
  for (const std::string& text : texts) {
    cells.push_back(Text(nullptr, text).release());
  }
  return MatlabVariable(
      Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, dims, cells.data(), 0));
}

// Returns true if a file of version 5 has all bytes of so many variables. After
// a head of 128 bytes, each variable has its size in its second four bytes.
bool IsWhole(const std::string& content, size_t num_variables) {
  size_t end = 128, count = 0;
  for (; end + 8 <= content.size(); ++count) {
    std::uint32_t size;
    std::memcpy(&size, &content[end + 4], sizeof(size));
    end += 8 + size_t{size};
  }
  return end == content.size() && count == num_variables;
}

}  // namespace

struct MatlabWriter::Opened {
  struct Closer {
    void operator()(mat_t* mat) const { Mat_Close(mat); }
  };
  std::string path;
  // matio does not check that all its output is written. It therefore writes to
  // memory, and Close writes from memory to the disk.
  int memory = -1;
  std::string memory_path;
  std::unique_ptr<mat_t, Closer> file;
  std::vector<std::string> names;
  std::string fault;

  ~Opened() {
    file.reset();
    if (memory >= 0) close(memory);
  }
  // Call it before a variable with so many numbers is created; its name is
  // written first.
  bool HasRoomFor(Eigen::Index numbers, Eigen::Index bytes_of_a_number) {
    if (!FitsMatlabFile(numbers * bytes_of_a_number) && fault.empty()) {
      fault = "'" + names.back() + "' has " + std::to_string(numbers) +
              " numbers, more than a variable of a MATLAB file of version 5 "
              "can have";
    }
    return fault.empty();
  }
  void Write(MatlabVariable variable) {
    if (!fault.empty()) return;
    if (variable == nullptr ||
        Mat_VarWrite(file.get(), variable.get(), MAT_COMPRESSION_ZLIB) != 0) {
      fault = "'" + names.back() + "' cannot be written";
    }
  }
  const char* Name(const std::string& name) {
    MatlabName(name, &names);
    return names.back().c_str();
  }
};

MatlabWriter::MatlabWriter(const std::string& path)
    : opened_(std::make_unique<Opened>()) {
  opened_->path = path;
  opened_->memory = memfd_create("pinode", MFD_CLOEXEC);
  opened_->memory_path = "/proc/self/fd/" + std::to_string(opened_->memory);
  opened_->file.reset(Mat_CreateVer(opened_->memory_path.c_str(),
                                    "MATLAB 5.0 MAT-file, by pinode",
                                    MAT_FT_MAT5));
  if (opened_->file == nullptr) opened_->fault = "cannot be created";
}

MatlabWriter::~MatlabWriter() = default;

void MatlabWriter::AddMatrix(const std::string& name, const Matrix& matrix) {
  const char* valid = opened_->Name(name);
  if (!opened_->HasRoomFor(matrix.size(), sizeof(double))) return;
  opened_->Write(Numbers(valid, matrix.data(), matrix.rows(), matrix.cols()));
}

void MatlabWriter::AddSparse(const std::string& name,
                             const Eigen::SparseMatrix<double>& matrix) {
  const char* valid = opened_->Name(name);
  // Each nonzero needs its row too.
  if (!opened_->HasRoomFor(matrix.nonZeros(),
                           sizeof(double) + sizeof(mat_uint32_t))) {
    return;
  }
  Eigen::SparseMatrix<double> whole = matrix;
  whole.makeCompressed();
  const auto count = static_cast<size_t>(whole.nonZeros());
  std::vector<mat_uint32_t> rows(whole.innerIndexPtr(),
                                 whole.innerIndexPtr() + count);
  std::vector<mat_uint32_t> starts(whole.outerIndexPtr(),
                                   whole.outerIndexPtr() + whole.cols() + 1);
  mat_sparse_t sparse = {};
  sparse.nzmax = static_cast<mat_uint32_t>(count);
  sparse.ir = rows.data();
  sparse.nir = static_cast<mat_uint32_t>(count);
  sparse.jc = starts.data();
  sparse.njc = static_cast<mat_uint32_t>(starts.size());
  sparse.ndata = static_cast<mat_uint32_t>(count);
  sparse.data = whole.valuePtr();
  size_t dims[2] = {static_cast<size_t>(whole.rows()),
                    static_cast<size_t>(whole.cols())};
  opened_->Write(
      MatlabVariable(Mat_VarCreate(valid, MAT_C_SPARSE, MAT_T_DOUBLE, 2, dims,
                                   &sparse, MAT_F_DONT_COPY_DATA)));
}

void MatlabWriter::AddText(const std::string& name, const std::string& text) {
  opened_->Write(Text(opened_->Name(name), text));
}

void MatlabWriter::AddStructure(const std::string& name,
                                const std::vector<MatlabField>& fields) {
  std::vector<std::string> names;
  Eigen::Index numbers = 0;
  for (const MatlabField& field : fields) {
    MatlabName(field.name, &names);
    numbers += field.numbers.size();
  }
  std::vector<const char*> pointers;
  for (const std::string& field : names) pointers.push_back(field.c_str());
  size_t dims[2] = {1, 1};
  const char* valid = opened_->Name(name);
  if (!opened_->HasRoomFor(numbers, sizeof(double))) return;
  MatlabVariable structure(Mat_VarCreateStruct(
      valid, 2, dims, pointers.data(), static_cast<unsigned>(pointers.size())));
  for (size_t i = 0; structure != nullptr && i < fields.size(); ++i) {
    const MatlabField& field = fields[i];
    MatlabVariable value = field.texts.empty()
                               ? Numbers(pointers[i], field.numbers.data(),
                                         field.numbers.size(), 1)
                               : Cells(pointers[i], field.texts);
    Mat_VarSetStructFieldByIndex(structure.get(), i, 0, value.release());
  }
  opened_->Write(std::move(structure));
}

bool MatlabWriter::Close(std::string* error) {
  if (opened_->file != nullptr && Mat_Close(opened_->file.release()) != 0 &&
      opened_->fault.empty()) {
    opened_->fault = "cannot be written";
  }
  std::string content;
  std::string unused;
  if (opened_->fault.empty() &&
      (!ReadBinaryFile(opened_->memory_path, &content, &unused) ||
       !IsWhole(content, opened_->names.size()))) {
    opened_->fault = "cannot be written: there is not enough memory";
  }
  if (!opened_->fault.empty()) {
    *error = opened_->path + ": " + opened_->fault;
    return false;
  }
  return WriteFileAtomically(opened_->path, content, error);
}

bool FitsMatlabFile(Eigen::Index bytes) {
  // Bytes for the heads, names and dimensions of a variable.
  constexpr Eigen::Index kHeads = Eigen::Index{1} << 20;
  return bytes <= std::numeric_limits<std::int32_t>::max() - kHeads;
}

std::string MatlabName(const std::string& name,
                       std::vector<std::string>* taken) {
  std::string valid = name.substr(0, kLongestMatlabName);
  for (char& c : valid) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  if (valid.empty() ||
      std::isalpha(static_cast<unsigned char>(valid[0])) == 0) {
    valid = ("x" + valid).substr(0, kLongestMatlabName);
  }
  std::string unique = valid;
  for (int i = 2;
       std::find(taken->begin(), taken->end(), unique) != taken->end(); ++i) {
    const std::string suffix = "_" + std::to_string(i);
    unique = valid.substr(0, kLongestMatlabName - suffix.size()) + suffix;
  }
  taken->push_back(unique);
  return unique;
}

}  // namespace pinode
