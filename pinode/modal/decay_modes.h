// Modes of a free decay at one sampling rate.

#ifndef PINODE_MODAL_DECAY_MODES_H_
#define PINODE_MODAL_DECAY_MODES_H_

#include <complex>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/decay_model.h"
#include "pinode/modal/stabilisation.h"
#include "pinode/modal/stabilisation_options.h"
#include "pinode/modal/subspace.h"

namespace pinode {

// Returns the terms that samples need (channels x samples, complete, in free
// decay from the first one): FindDecays from the terms `known`, with poles of
// all orders as candidates. Long records are used up to 4000 samples.
std::vector<DecayTerm> FindDecayTerms(const Matrix& samples, double step,
                                      const std::vector<SubspacePole>& poles,
                                      const std::vector<DecayTerm>& known);

struct DecayModes {
  // Vibrations that the samples need, by frequency, with the influences of
  // noise, but without members.
  std::vector<PoleCluster> clusters;
  // Root mean square of the residual relative to that of the samples, per
  // channel.
  Vector rest;
};

// Fits the terms `known` to all samples by maximum likelihood, with those of
// `candidates` that are needed. picked: vibrations to return, needed or not,
// and no others; empty: all.
DecayModes EstimateDecays(const Matrix& samples, double step,
                          const std::vector<DecayTerm>& known,
                          const std::vector<std::complex<double>>& candidates,
                          const std::vector<std::complex<double>>& picked);

// Sets the members of the cluster: the nearest pole of each order that has one
// near enough.
void FindDecayMembers(const std::vector<SubspacePole>& poles,
                      const StabilisationOptions& options,
                      PoleCluster* cluster);

// Returns terms as they are at half the sampling rate: vibrations above half of
// that rate have images below.
std::vector<DecayTerm> TermsAtHalfRate(const std::vector<DecayTerm>& terms,
                                       double step);

}  // namespace pinode

#endif  // PINODE_MODAL_DECAY_MODES_H_
