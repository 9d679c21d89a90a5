// An identifier of HDF5 that closes itself.

#ifndef PINODE_BASE_ARRAYS_HDF5_ID_H_
#define PINODE_BASE_ARRAYS_HDF5_ID_H_

#include <hdf5.h>

namespace pinode {

// Closes the identifier by `close` at the end, if it is one.
class Hdf5Id {
 public:
  Hdf5Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Hdf5Id() {
    if (id_ >= 0) close_(id_);
  }
  Hdf5Id(const Hdf5Id&) = delete;
  Hdf5Id& operator=(const Hdf5Id&) = delete;
  hid_t get() const { return id_; }
  bool good() const { return id_ >= 0; }

 private:
  const hid_t id_;
  herr_t (*const close_)(hid_t);
};

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_HDF5_ID_H_
