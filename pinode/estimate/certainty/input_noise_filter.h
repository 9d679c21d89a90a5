// Likelihood of residuals that contain the response to noise on the excitation.

#ifndef PINODE_ESTIMATE_CERTAINTY_INPUT_NOISE_FILTER_H_
#define PINODE_ESTIMATE_CERTAINTY_INPUT_NOISE_FILTER_H_

#include <Eigen/Cholesky>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/certainty/input_noise.h"

namespace pinode {

// Residuals of one record as a linear Gaussian model along its trajectory,
//
//   q_i = by_state_i x_i + by_input_i e_i + v_i,
//
// with x the response to the input's errors (see LinearizedRecord), e_i white
// with `input_sigmas`, v_i white with `noise`, and x_0 with `start_sigmas`. The
// covariance of all q, Sigma, has samples^2 channels^2 entries; a Kalman filter
// on the state [x; e] works with its inverse in a time that grows linearly
// (T. Kailath, A. H. Sayed, B. Hassibi, Linear Estimation, Prentice Hall, 2000,
// ch. 9 and 10).
class InputNoiseFilter {
 public:
  // Keeps a reference to `record`, which must outlive this object.
  // input_sigmas: one per input of the record. start_sigmas: num_states, zero
  // where the start is known. noise: channels x samples, positive, NaN where
  // there is no residual.
  InputNoiseFilter(const LinearizedRecord& record, const Vector& input_sigmas,
                   const Vector& start_sigmas, const Matrix& noise);

  // Returns B' Sigma^-1 B for any columns B, (channels * samples) x columns,
  // channels fastest. Rows without a residual do not count.
  Matrix Information(const Matrix& columns) const;

  // Computes from q the most likely e, inputs x samples; and per channel the
  // expected mean square of v, over the samples that have a residual.
  void Smooth(const Vector& residuals, Matrix* errors,
              Vector* noise_mean_square) const;

 private:
  struct Update {
    std::vector<int> rows;          // channels that have a residual
    Matrix by_all;                  // [by_state by_input], rows x size
    Matrix variance;                // of [x; e] before the update
    Eigen::LLT<Matrix> innovation;  // rows x rows
    Matrix gain;                    // size x rows
  };
  // F of [x; e]_{i+1} = F [x; e]_i + ...; the new e does not depend on the old.
  Matrix Transition(Eigen::Index sample) const;
  // Returns the rows of `columns` for one sample that have a residual.
  static Matrix Rows(const Update& update, Eigen::Index first,
                     const Matrix& columns);

  const LinearizedRecord& record_;
  int num_channels_ = 0;
  int num_states_ = 0;
  int num_inputs_ = 0;
  std::vector<Update> updates_;  // one per sample
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_INPUT_NOISE_FILTER_H_
