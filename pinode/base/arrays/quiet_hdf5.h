// Keeps HDF5 from writing to standard error.

#ifndef PINODE_BASE_ARRAYS_QUIET_HDF5_H_
#define PINODE_BASE_ARRAYS_QUIET_HDF5_H_

#include <memory>

namespace pinode {

// Suppresses HDF5's error messages while an object of this class exists. By
// default HDF5 writes errors to standard error. A program that installs pinode
// needs none of HDF5's headers.
class QuietHdf5 {
 public:
  QuietHdf5();
  ~QuietHdf5();
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;

 private:
  struct Handler;
  const std::unique_ptr<Handler> before_;
};

// Keeps HDF5 from closing what is open when the process ends. After a damaged
// file it would write "infinite loop closing library" to standard error. For
// programs, which only read such files and close them: call it before anything
// else of HDF5.
void QuietHdf5AtExit();

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_QUIET_HDF5_H_
