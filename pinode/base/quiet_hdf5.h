// Keeps HDF5 from writing to standard error.

#ifndef PINODE_BASE_QUIET_HDF5_H_
#define PINODE_BASE_QUIET_HDF5_H_

#include <hdf5.h>

namespace pinode {

// HDF5 writes what goes wrong to standard error unless it is told not to: while
// one of these is alive it does not. A program that installs pinode needs
// HDF5's headers only where it includes this one.
class QuietHdf5 {
 public:
  QuietHdf5() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

}  // namespace pinode

#endif  // PINODE_BASE_QUIET_HDF5_H_
