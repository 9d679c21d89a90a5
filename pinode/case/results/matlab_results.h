// A result folder as one MATLAB file.

#ifndef PINODE_CASE_RESULTS_MATLAB_RESULTS_H_
#define PINODE_CASE_RESULTS_MATLAB_RESULTS_H_

#include <string>

namespace pinode {

// Writes <folder>/results.mat with the contents of the other files of `folder`,
// each as a variable of its file's name:
//
// - a CSV file as a structure with its columns (numbers, NaN for an empty cell;
//   cell arrays of texts);
// - a Matrix Market file as a matrix (sparse above 100 rows);
// - a JSON file as its text, for jsondecode;
// - a text file as a structure with its lines.
//
// Checkpoints, case files and reports are left out. Returns false, with one
// line in *error, if a file cannot be read or the result cannot be written.
[[nodiscard]] bool WriteMatlabResults(const std::string& folder,
                                      std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_MATLAB_RESULTS_H_
