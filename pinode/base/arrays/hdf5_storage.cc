#include "pinode/base/arrays/hdf5_storage.h"

#include "pinode/base/arrays/hdf5_id.h"
#include "pinode/base/arrays/quiet_hdf5.h"
#include "pinode/base/file_text.h"

namespace pinode {
namespace {

// Ends the visit, with a sentence, at the first link that leaves the file.
herr_t OnLink(hid_t, const char* name, const H5L_info_t* info, void* what) {
  if (info->type == H5L_TYPE_HARD || info->type == H5L_TYPE_SOFT) return 0;
  *static_cast<std::string*>(what) = "has a link " + Quote(name) +
                                     " to another file, and all data in one "
                                     "file were expected";
  return 1;
}

// Ends the visit, with a sentence, at the first data set with a fault.
herr_t OnObject(hid_t file, const char* name, const H5O_info_t* info,
                void* what) {
  if (info->type != H5O_TYPE_DATASET) return 0;
  const Hdf5Id set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
  const std::string fault = set.good() ? Hdf5StorageFault(set.get()) : "";
  if (fault.empty()) return 0;
  *static_cast<std::string*>(what) = "has a data set " + Quote(name) +
                                     " of which " + fault +
                                     ", and all data in one file were expected";
  return 1;
}

}  // namespace

std::string Hdf5StorageFault(std::int64_t set) {
  const Hdf5Id properties(H5Dget_create_plist(set), H5Pclose);
  if (!properties.good()) return "";
  if (H5Pget_layout(properties.get()) == H5D_VIRTUAL) {
    return "the samples are those of other data sets (it is virtual)";
  }
  if (H5Pget_external_count(properties.get()) > 0) {
    return "the samples are in other files (external storage)";
  }
  return "";
}

bool CheckHdf5Storage(const std::string& path, std::string* what) {
  const QuietHdf5 quiet;
  const Hdf5Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                    H5Fclose);
  what->clear();
  if (file.good() &&
      H5Lvisit(file.get(), H5_INDEX_NAME, H5_ITER_INC, OnLink, what) >= 0 &&
      H5Ovisit2(file.get(), H5_INDEX_NAME, H5_ITER_INC, OnObject, what,
                H5O_INFO_BASIC) >= 0) {
    return what->empty();
  }
  if (what->empty()) *what = "cannot be opened, is the file whole?";
  return false;
}

}  // namespace pinode
