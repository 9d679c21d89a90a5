// Resolution of the spectra of unmeasured loads.

#ifndef PINODE_STUDY_IDENTIFY_LOAD_SPECTRA_H_
#define PINODE_STUDY_IDENTIFY_LOAD_SPECTRA_H_

#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/problem/inner_fit.h"

namespace pinode {

// Ambient records whose knots nobody has given (0) and whose spectra a fit
// describes with a probability below limits::kSpectrumProbability get a knot
// between any two: one an octave becomes two. (Not where what is left goes with
// measured loads, which finer spectra would but hide.) Knots stay far wider
// than modes, so that what a model lacks is not put down to its loads. `given`:
// knots of the ambient records as somebody has given them. False where there is
// no such record.
bool RefineLoadSpectra(const std::vector<int>& given, const FitSummary& summary,
                       IdentificationProblem* problem);

// The same for those that are described, by more than that probability, and
// whose evidence would be larger with finer spectra.
bool RefineByEvidence(const std::vector<int>& given, const FitSummary& summary,
                      IdentificationProblem* problem);

// Settles the spectra after a fit (`summary` and `model`) of *problem that
// describes its ambient records doubtfully:
//
// - fits once more from there, with loads found anew at that model; the cheaper
//   fit stands,
// - fits with finer spectra, up to four knots an octave, until the records are
//   described; the best description stands,
// - if they are described, goes on with finer spectra while the evidence
//   promises more and finds it.
//
// *problem gets the knots of the fit that stands; remarks of *summary say what
// was tried.
void SettleLoadSpectra(const IdentificationOptions& options, InnerFit* fit,
                       IdentificationProblem* problem, FitSummary* summary,
                       IdentifiedModel* model);

}  // namespace pinode

#endif  // PINODE_STUDY_IDENTIFY_LOAD_SPECTRA_H_
