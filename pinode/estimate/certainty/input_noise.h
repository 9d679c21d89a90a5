// Effect of an error of a measured excitation on a prediction.

#ifndef PINODE_ESTIMATE_CERTAINTY_INPUT_NOISE_H_
#define PINODE_ESTIMATE_CERTAINTY_INPUT_NOISE_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Trajectory of one record, linearised in its states x_i and in errors e_i of
// its input samples:
//
//   x_{i+1} = transition_i x_i + left_i e_i + right_i e_{i+1}
//   y_i     = by_state_i x_i + by_input_i e_i
//
// Sensor gains are included, delays are not. The error is interpolated linearly
// (held for a held input).
struct LinearizedRecord {
  struct Sample {
    Matrix by_state;  // channels x num_states
    Matrix by_input;  // channels x inputs
    // To the next sample; empty for the last one.
    Matrix transition;   // num_states x num_states
    Matrix left, right;  // num_states x inputs
  };
  std::vector<Sample> samples;
};

// Linearises the trajectory of a record. `inputs`: indices of the dynamics'
// inputs that have errors. `states`: the trajectory, num_states x samples.
// `parameters`: all of the problem's.
LinearizedRecord LinearizeRecord(const IdentificationProblem& problem,
                                 const ParameterLayout& layout, int record,
                                 const std::vector<int>& inputs,
                                 const Vector& parameters,
                                 const Matrix& states);

// Computes by a backward (adjoint) run, for every input sample i and every
// column p of `weights`,
//
//   v(p, i) = sum_j weights(j, p) d y_j / d e_i,
//
// where j runs over samples and channels, channels fastest. `weights` is
// (channels * samples) x columns. Returns one matrix (columns x samples) for
// one of the record's inputs.
Matrix InputSensitivity(const LinearizedRecord& record, int input,
                        const Matrix& weights);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_INPUT_NOISE_H_
