// How fine the spectra of loads are that nobody measured.

#ifndef PINODE_STUDY_IDENTIFY_LOAD_SPECTRA_H_
#define PINODE_STUDY_IDENTIFY_LOAD_SPECTRA_H_

#include <vector>

#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/study/problem/growth.h"

namespace pinode {

// Ambient records whose knots nobody has given (0) and whose spectra a fit
// describes with a probability below kLeastAmbientProbability get a knot
// between any two: one an octave becomes two. (Not where what is left goes with
// measured loads, which finer spectra would but hide.) Knots stay far wider
// than modes, so that what a model lacks is not put down to its loads. `given`:
// knots of the ambient records as somebody has given them. False where there is
// no such record.
bool RefineLoadSpectra(const std::vector<int>& given,
                       const IdentificationSummary& summary,
                       IdentificationProblem* problem);

// The same for those that are described, by more than that probability, and
// whose evidence would be larger with finer spectra.
bool RefineByEvidence(const std::vector<int>& given,
                      const IdentificationSummary& summary,
                      IdentificationProblem* problem);

// After a fit (`summary` and `model`) of *problem whose ambient records it
// describes doubtfully, fits it once more from there, with loads found anew at
// that model; what costs least stands. Then fits it with finer spectra, up to
// four knots an octave, until its ambient records are described; what describes
// them best stands. Where they are, it goes on with finer spectra as long as
// the evidence promises and then has more of these. *problem has the knots of
// what stands; remarks say what was tried. `fit`: as FitOrIdentify.
void SettleLoadSpectra(const FitFunction& fit,
                       const IdentificationOptions& options,
                       IdentificationProblem* problem,
                       IdentificationSummary* summary, IdentifiedModel* model);

}  // namespace pinode

#endif  // PINODE_STUDY_IDENTIFY_LOAD_SPECTRA_H_
