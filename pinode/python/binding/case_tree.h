// Conversion of a case between Python (nested dictionaries with arrays) and the
// library.

#ifndef PINODE_PYTHON_BINDING_CASE_TREE_H_
#define PINODE_PYTHON_BINDING_CASE_TREE_H_

#include <pybind11/pybind11.h>

#include "pinode/case/text/case_data.h"
#include "pinode/case/text/toml_value.h"

namespace pinode::python {

// Converts a case from Python. The keys are those of a case file. An array may
// take the place of a file name; it goes to *data under a name that tells its
// place. This applies to matrices (those of a finite-element model sparse), and
// to a dictionary of equally long columns for the `file` of a record. None
// counts as absent. Throws Error.
TomlValue TreeFromPython(const pybind11::handle& tree, CaseData* data);

// Converts back to Python; arrays of `data` return to their places.
pybind11::object TreeToPython(const TomlValue& tree, const CaseData& data);

}  // namespace pinode::python

#endif  // PINODE_PYTHON_BINDING_CASE_TREE_H_
