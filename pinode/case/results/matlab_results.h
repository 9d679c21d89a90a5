// A result folder as one MATLAB file.

#ifndef PINODE_CASE_RESULTS_MATLAB_RESULTS_H_
#define PINODE_CASE_RESULTS_MATLAB_RESULTS_H_

#include <string>

namespace pinode {

// Writes <folder>/results.mat with what stands in the other files of `folder`,
// each a variable of its file's name: of a CSV file a structure with its
// columns (numbers, NaN where a cell is empty; cell arrays of texts), of a
// Matrix Market file a matrix (sparse above 100 rows), of a JSON file its text,
// for jsondecode, of a text file a structure with its lines. Checkpoints, case
// files and reports are left out. False, with one line in *error, where a file
// cannot be read or the result not be written.
[[nodiscard]] bool WriteMatlabResults(const std::string& folder,
                                      std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_MATLAB_RESULTS_H_
