// Estimates frequency response functions from records of forces and responses.

#ifndef PINODE_RECORD_FRF_FRF_ESTIMATE_H_
#define PINODE_RECORD_FRF_FRF_ESTIMATE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/record/frf/blows.h"
#include "pinode/record/frf/frequency_responses.h"

namespace pinode {

// Estimator from averaged spectra. With G_xx of the forces, G_yy of a response,
// G_yx of both:
//
// - H1 = G_yx G_xx^-1 has the noise in the responses;
// - H2 = G_yy / G_xy, for one force, has the noise in the force;
// - Hv has it in both, in proportion to their spectra: total least squares on
//   signals that are divided by the roots of their spectra (G. T. Rocklin, J.
//   Crowley, H. Vold, Proc. IMAC III (1985) 272).
enum class FrfEstimator { kH1, kH2, kHv };

enum class FrfExcitation {
  kAutomatic,  // kBlows if the force is a few short pulses, else kRandom
  kBlows,      // a block for each blow of a hammer, see FindBlows
  kRandom,     // Welch's method: overlapping blocks, Hann's window
  // One block for each period of the force, without a window. The first one is
  // left out, because it has the beginning of the motion. One force.
  kPeriodic,
};

struct FrfEstimateOptions {
  FrfEstimator estimator = FrfEstimator::kH1;
  FrfExcitation excitation = FrfExcitation::kAutomatic;
  // Samples of a block. 0: about 16 blocks (kRandom), up to the next blow
  // (kBlows). The period, for kPeriodic.
  Eigen::Index block_samples = 0;
  // Overlap of blocks as a share of their length, of kRandom.
  double overlap = 0.5;
  // Length in s from the beginning of a block after which the force is set to
  // zero, with a taper of a quarter of it; 0: all of the force is used. Blows.
  double force_window = 0.0;
  // Time constant in s of an exponential window on forces and responses; 0:
  // none. Blows.
  double exponential_window = 0.0;
};

struct FrfEstimate {
  // Lines between 0 and half the sampling rate at which all forces act.
  Vector frequencies_hz;
  // Column `response + responses * reference` is one pair.
  ComplexMatrix values;
  // Variance E |error|^2 of each value from noise that the forces do not
  // explain. No rows: there are not more blocks than forces.
  Matrix variances;
  // Partial coherence of each pair, the other forces taken off; with one force
  // the ordinary one. No rows, as above.
  Matrix coherence;
  // Power of the largest force relative to its maximum over the lines.
  Vector force_power;
  int num_blocks = 0;
  // Number of independent blocks, which overlapping ones are not (P. D. Welch,
  // IEEE Trans. Audio Electroacoust. 15 (1967) 70).
  double num_averages = 0.0;
  // One over the time constant of the exponential window, 1 / s.
  double decay_rate = 0.0;
  // Length of the blocks, in s.
  double block_seconds = 0.0;
  // For blows: shortest time from any blow to the next one that is used, in s.
  // 0: there are no two.
  double shortest_rest = 0.0;
  FrfExcitation excitation = FrfExcitation::kRandom;
  std::vector<std::string> remarks;
};

// Averages below which coherences are chance, and must not weight the lines of
// a fit. Weights from n averages cost (2 n - 4) / (2 n - 6) in variance: 1.2 at
// 8.
constexpr double kFewestAveragesForWeights = 8.0;

// Estimates the FRFs of all records together; they have the same channels and
// step. Fails with a sentence.
[[nodiscard]] bool EstimateFrfs(const std::vector<ForcedRecord>& records,
                                const FrfEstimateOptions& options,
                                FrfEstimate* estimate, std::string* error);

// Sets options->block_samples to a block of `seconds`, which is shortened to a
// length that is fast to transform unless it is a period. Fails with a sentence
// if it is not within 4 samples and the longest record. `records`: at least
// one.
[[nodiscard]] bool FindFrfBlock(const std::vector<ForcedRecord>& records,
                                double seconds, FrfEstimateOptions* options,
                                std::string* error);

// Returns single FRFs of the estimate, for AssembleFrequencyResponses. `file`:
// for messages. `derivative`: what the responses measured, as in
// FrequencyResponse.
std::vector<FrequencyResponse> SingleFrfs(
    const FrfEstimate& estimate, const std::string& file,
    const std::vector<std::string>& responses,
    const std::vector<std::string>& references, int derivative);

}  // namespace pinode

#endif  // PINODE_RECORD_FRF_FRF_ESTIMATE_H_
