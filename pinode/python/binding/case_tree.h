// A case as Python has it, nested dictionaries with arrays in them, and as the
// library reads it.

#ifndef PINODE_PYTHON_BINDING_CASE_TREE_H_
#define PINODE_PYTHON_BINDING_CASE_TREE_H_

#include <pybind11/pybind11.h>

#include "pinode/case/text/case_data.h"
#include "pinode/case/text/toml_value.h"

namespace pinode::python {

// The keys are those of a case file. Where it names a file there may be an
// array in its place, which goes to *data under a name that says where it was:
// matrices (those of a finite-element model sparse), and a dictionary of equal
// columns for the `file` of a record. None counts as absent. Throws Error.
TomlValue TreeFromPython(const pybind11::handle& tree, CaseData* data);

// The way back; arrays of `data` stand in their places again.
pybind11::object TreeToPython(const TomlValue& tree, const CaseData& data);

}  // namespace pinode::python

#endif  // PINODE_PYTHON_BINDING_CASE_TREE_H_
