// A fit's outcome as bytes, for pickling: bit for bit, between processes of the
// same version on machines alike.

#ifndef PINODE_PYTHON_BINDING_FIT_ARCHIVE_H_
#define PINODE_PYTHON_BINDING_FIT_ARCHIVE_H_

#include <string>

#include "pinode/python/binding/fit.h"

namespace pinode::python {

// Everything of the fit but the case's tree and data, which read again make its
// problem: what the fit has done to the steps of its records is here.
std::string PackFit(const Fit& fit);
// Into a fit whose case has been read. False where the bytes are not those of a
// fit of that case.
[[nodiscard]] bool UnpackFit(const std::string& packed, Fit* fit);

}  // namespace pinode::python

#endif  // PINODE_PYTHON_BINDING_FIT_ARCHIVE_H_
