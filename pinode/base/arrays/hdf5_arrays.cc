#include <optional>
#include <utility>

#include "pinode/base/arrays/array_shape.h"
#include "pinode/base/arrays/hdf5_id.h"
#include "pinode/base/arrays/hdf5_storage.h"
#include "pinode/base/arrays/quiet_hdf5.h"
#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/unpacked_size.h"

namespace pinode {
namespace {

// Largest possible ratio of unpacked to packed bytes in the filters of HDF5,
// rounded up. Data sets that were never written take no place at all.
constexpr double kLargestHdf5Expansion = 1100.0;

bool IsNumber(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  return kind == H5T_INTEGER || kind == H5T_FLOAT;
}

class Hdf5Reader {
 public:
  Hdf5Reader(const std::string& path, const ArrayFilter& wanted,
             std::vector<NamedArray>* arrays, std::string* error)
      : path_(path), wanted_(wanted), arrays_(arrays), error_(error) {}

  bool Read() {
    // Checks that the file exists, and finds its size.
    std::string content;
    if (!ReadBinaryFile(path_, &content, error_)) return false;
    file_size_ = static_cast<double>(content.size());
    memory_.emplace(file_size_);
    content = std::string();
    const QuietHdf5 quiet;
    const Hdf5Id file(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                      H5Fclose);
    if (!file.good()) {
      *error_ = path_ + ": cannot be opened, a whole HDF5 file was expected";
      return false;
    }
    std::vector<std::string> names;
    if (H5Ovisit2(file.get(), H5_INDEX_NAME, H5_ITER_INC, &Hdf5Reader::OnObject,
                  &names, H5O_INFO_BASIC) < 0) {
      *error_ =
          path_ +
          ": its groups cannot be listed; check that the file is complete";
      return false;
    }
    for (const std::string& name : names) {
      if (!AddDataSet(file.get(), name)) return false;
    }
    return true;
  }

 private:
  static herr_t OnObject(hid_t, const char* name, const H5O_info_t* info,
                         void* names) {
    if (info->type == H5O_TYPE_DATASET) {
      static_cast<std::vector<std::string>*>(names)->emplace_back(name);
    }
    return 0;
  }

  bool Fail(const std::string& name) {
    *error_ = path_ + ": data set " + Quote(name) +
              " cannot be read; check that the file is complete";
    return false;
  }

  bool AddDataSet(hid_t file, const std::string& name) {
    const Hdf5Id set(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!set.good()) return Fail(name);
    const std::string outside = Hdf5StorageFault(set.get());
    if (!outside.empty()) {
      NamedArray array;
      array.name = name;
      array.fault = outside;
      arrays_->push_back(std::move(array));
      return true;
    }
    const Hdf5Id type(H5Dget_type(set.get()), H5Tclose);
    const Hdf5Id space(H5Dget_space(set.get()), H5Sclose);
    if (!type.good() || !space.good()) return Fail(name);
    std::vector<int64_t> dimensions;
    const int rank = H5Sget_simple_extent_ndims(space.get());
    if (rank < 0) return Fail(name);
    std::vector<hsize_t> sizes(static_cast<size_t>(rank));
    if (rank > 0 &&
        H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr) != rank) {
      return Fail(name);
    }
    double count =
        H5Sget_simple_extent_type(space.get()) == H5S_NULL ? 0.0 : 1.0;
    for (const hsize_t size : sizes) {
      count *= static_cast<double>(size);
      dimensions.push_back(static_cast<int64_t>(size));
    }
    if (count == 0.0) dimensions = {0};
    if (count > kLargestHdf5Expansion * file_size_) {
      NamedArray array;
      array.name = name;
      array.fault = "it is larger than the file can hold";
      arrays_->push_back(std::move(array));
      return true;
    }
    // HDF5 does not check that a data set in its own header has the length that
    // it states.
    const Hdf5Id layout(H5Dget_create_plist(set.get()), H5Pclose);
    if (!layout.good()) return Fail(name);
    if (H5Pget_layout(layout.get()) == H5D_COMPACT &&
        static_cast<double>(H5Dget_storage_size(set.get())) <
            count * static_cast<double>(H5Tget_size(type.get()))) {
      return Fail(name);
    }
    if (H5Tget_class(type.get()) != H5T_COMPOUND) {
      return AddNumbers(set.get(), name, IsNumber(type.get()), dimensions,
                        H5T_NATIVE_DOUBLE);
    }
    const int members = H5Tget_nmembers(type.get());
    // HDF5 does not check either that a file's fields lie within their record.
    for (int m = 0; m < members; ++m) {
      const auto number = static_cast<unsigned>(m);
      const Hdf5Id member(H5Tget_member_type(type.get(), number), H5Tclose);
      if (!member.good() ||
          H5Tget_member_offset(type.get(), number) + H5Tget_size(member.get()) >
              H5Tget_size(type.get())) {
        return Fail(name);
      }
    }
    for (int m = 0; m < members; ++m) {
      const auto number = static_cast<unsigned>(m);
      const Hdf5Id member(H5Tget_member_type(type.get(), number), H5Tclose);
      char* field = H5Tget_member_name(type.get(), number);
      if (!member.good() || field == nullptr) return Fail(name);
      // Only this field of the compound is read.
      const Hdf5Id one(H5Tcreate(H5T_COMPOUND, sizeof(double)), H5Tclose);
      const bool made =
          one.good() && H5Tinsert(one.get(), field, 0, H5T_NATIVE_DOUBLE) >= 0;
      const std::string full = name + "." + field;
      H5free_memory(field);
      if (!made) return Fail(name);
      if (!AddNumbers(set.get(), full, IsNumber(member.get()), dimensions,
                      one.get())) {
        return false;
      }
    }
    return true;
  }

  bool AddNumbers(hid_t set, const std::string& name, bool is_number,
                  const std::vector<int64_t>& dimensions, hid_t memory_type) {
    NamedArray array;
    array.name = name;
    int64_t by_sample = 0;
    int64_t by_column = 0;
    if (!is_number) {
      array.fault = "it is not of a real type";
    } else if (ShapeArray(dimensions, /*by_rows=*/true, &array, &by_sample,
                          &by_column) &&
               wanted_(name)) {
      const size_t count = static_cast<size_t>(array.samples) *
                           static_cast<size_t>(array.columns);
      std::string what;
      // The numbers stand in the order of the file and in ours for a while.
      if (!memory_->Take(2.0 * sizeof(double) * static_cast<double>(count),
                         &what)) {
        *error_ = path_ + ": data set " + Quote(name) + " " + what;
        return false;
      }
      std::vector<double> numbers(count);
      if (H5Dread(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                  numbers.data()) < 0) {
        return Fail(name);
      }
      array.values.resize(array.samples, array.columns);
      for (Eigen::Index c = 0; c < array.columns; ++c) {
        for (Eigen::Index k = 0; k < array.samples; ++k) {
          array.values(k, c) =
              numbers[static_cast<size_t>(k * by_sample + c * by_column)];
        }
      }
    }
    arrays_->push_back(std::move(array));
    return true;
  }

  const std::string& path_;
  const ArrayFilter& wanted_;
  std::vector<NamedArray>* const arrays_;
  std::string* const error_;
  double file_size_ = 0.0;
  std::optional<UnpackedSize> memory_;
};

}  // namespace

bool ReadHdf5Arrays(const std::string& path, const ArrayFilter& wanted,
                    std::vector<NamedArray>* arrays, std::string* error) {
  return Hdf5Reader(path, wanted, arrays, error).Read();
}

}  // namespace pinode
