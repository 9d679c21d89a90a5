// Finds the decaying vibrations of which a free decay consists.

#ifndef PINODE_MODAL_DECAY_FIT_H_
#define PINODE_MODAL_DECAY_FIT_H_

#include <complex>
#include <vector>

#include "pinode/modal/decay_model.h"

namespace pinode {

// Returns true if two vibrations of a fit are one mode: they differ in
// frequency by less than half the faster's decay rate, and their shapes agree.
bool IsOneMode(const DecayFit& fit, size_t a, size_t b);

// Finds the terms that the samples need. Starts from `start` and adds, one at a
// time, the candidate that explains most of what is left; all poles are refined
// together after each step. A term is needed if the energy that it explains
// exceeds that of noise, measured near its frequency and over its duration,
// with a probability of 1e-3 that noise is taken for a term anywhere in the
// record. Terms that later ones make needless are removed, except fixed ones.
//
// Because the other poles are refined with and without it, a term must explain
// what they cannot: inexact poles, rounding and noise do not add terms.
//
// Sets the weights of the model: by the noise of the channels, and, if it
// changes, by the noise over time.
DecayFit FindDecays(const std::vector<DecayTerm>& start,
                    const std::vector<std::complex<double>>& candidates,
                    DecayModel* model);

// Returns the residuals, channels x samples, not weighted.
Matrix DecayResiduals(const DecayFit& fit, const DecayModel& model);

}  // namespace pinode

#endif  // PINODE_MODAL_DECAY_FIT_H_
