// Results of a fit as bytes, for pickling: bit for bit, between processes of
// the same version on similar machines.

#ifndef PINODE_PYTHON_BINDING_FIT_ARCHIVE_H_
#define PINODE_PYTHON_BINDING_FIT_ARCHIVE_H_

#include <string>

#include "pinode/python/binding/fit.h"

namespace pinode::python {

// Packs everything of the fit but the case's tree and data, which make its
// problem when read again. Changes of the fit to the steps of its records are
// included.
std::string PackFit(const Fit& fit);
// Unpacks into a fit whose case has been read. Returns false if the bytes are
// not those of a fit of that case.
[[nodiscard]] bool UnpackFit(const std::string& packed, Fit* fit);

}  // namespace pinode::python

#endif  // PINODE_PYTHON_BINDING_FIT_ARCHIVE_H_
