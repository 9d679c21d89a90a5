#include "pinode/base/arrays/quiet_hdf5.h"

#include <hdf5.h>

namespace pinode {

struct QuietHdf5::Handler {
  H5E_auto2_t function = nullptr;
  void* data = nullptr;
};

QuietHdf5::QuietHdf5() : before_(std::make_unique<Handler>()) {
  H5Eget_auto2(H5E_DEFAULT, &before_->function, &before_->data);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

QuietHdf5::~QuietHdf5() {
  H5Eset_auto2(H5E_DEFAULT, before_->function, before_->data);
}

void QuietHdf5AtExit() { H5dont_atexit(); }

}  // namespace pinode
