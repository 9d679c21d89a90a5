// Result folder of pinode_check, written on request.

#ifndef PINODE_CASE_RESULTS_CHECK_FILES_H_
#define PINODE_CASE_RESULTS_CHECK_FILES_H_

#include <string>

#include "pinode/case/results/case_check.h"
#include "pinode/case/sections/case_file.h"

namespace pinode {

// {"schema": "pinode-check-1", "case", "title", "assessed", "message",
//  "dofs": [...], "num_states", "units": {"force", "length", "time"},
//  "no_modes": why there are none, or null,
//  "modes": [{"mode", "frequency_hz", "damping_ratio", "expected_hz",
//             "participation_<direction>", "effective_mass_<direction>",
//             "mass_share_<direction>"}],
//  "finite_element": {"dofs", "removed", "rigid_body_modes", "reduction",
//                     "notes",
//                     "modes": [{"mode", "whole_hz", "expected_hz",
//                                "frequency_error", "mac"}]} or null,
//  "records": [{"name", "role", "samples", "step", "channels": [...],
//               "integrator", "substeps", "fastest_mode", "remarks": [...]}],
//  "ambient": [{"name", "samples", "step", "channels": [...]}],
//  "peaks": [{"record", "hz": [...]}], "questions": [...],
//  "measured_modes": [{"name", "frequency_hz", "in_use", "mode", "model_hz",
//                      "mac"}],
//  "candidates": [...], "free_parameters", "residuals", "start_states",
//  "expected": [{"name", "unit", "initial", "sigma"}],
//  "undetermined": [...], "confusions": [...], "remarks": [...]}
// Steps are in the model's unit of time; unknown numbers are null.
std::string CheckAsJson(const Case& c, const CaseCheck& check);

// Writes to `folder`: check.json; M.mtx, C.mtx, K.mtx, modes.csv and
// mode_shapes.mtx (DOFs x modes, mass-normalised) of the model; and, if the
// case has them, reduction.csv (error of the reduction), measured_modes.csv and
// expected.csv (deviations of the parameters).
[[nodiscard]] bool WriteCheckFiles(const Case& c, const CaseCheck& check,
                                   const std::string& folder,
                                   std::string* error);

// True if a check or a plan, which are quick to repeat, may replace the
// contents of `folder`: not those of a fit, a simulation or another long
// computation. One sentence in *error.
[[nodiscard]] bool MayGiveWayToCheck(const std::string& folder,
                                     std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_CHECK_FILES_H_
