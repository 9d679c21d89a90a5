// Flags of the programs that fit a case and write a result folder.

#ifndef PINODE_APPS_FIT_FLAGS_H_
#define PINODE_APPS_FIT_FLAGS_H_

#include <gflags/gflags.h>

#include <string>

#include "pinode/case/results/result_folder.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/problem/verdict.h"

DECLARE_string(case);
DECLARE_string(output_dir);
DECLARE_bool(mat);
DECLARE_bool(overwrite);
DECLARE_bool(resume);
DECLARE_bool(progress);

namespace pinode {

// Checks these flags and --threads, which goes into the case's options, and
// reads the case, its tables by `tables`. Returns false, with one line in
// *error, on an error; nothing has been written then.
[[nodiscard]] bool ReadFitFlags(SharedTables* tables, Case* c,
                                std::string* error);

// Returns the exit status that follows from a verdict, and --strict.
int StatusOf(const Verdict& verdict);

// Writes results.mat of the present contents of the folder, with --mat.
[[nodiscard]] bool WriteForMatlab(const ResultFolder& folder,
                                  std::string* error);

}  // namespace pinode

#endif  // PINODE_APPS_FIT_FLAGS_H_
