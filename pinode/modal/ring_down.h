// Ring-downs: the eigensystem realisation algorithm on a free decay.

#ifndef PINODE_MODAL_RING_DOWN_H_
#define PINODE_MODAL_RING_DOWN_H_

#include <functional>

#include "pinode/base/types.h"
#include "pinode/modal/subspace.h"

namespace pinode {

struct RingDown {
  HankelWindows hankel;
  // Samples of the decay. The samples after them contain only noise.
  Matrix samples;
  // Root mean square of the residual of decaying vibrations, per channel.
  Vector noise;
  // Returns series b of the noise, channels x samples. May be called from
  // several threads at once.
  std::function<Matrix(int)> noise_series;
};

// Returns the matrix with blocks (i, j) = y(i + j) of samples y(k) (channels x
// samples, complete, k = 0 on a free decay). Its columns are those of the
// observability matrix, because no load acts (J. N. Juang and R. S. Pappa, J.
// Guidance Control Dyn. 8 (1985) 620).
//
// Its `windows` are not parts of the record, because a single decay does not
// show its scatter. They are kNoiseSeries series of noise with random
// amplitudes and phases (after J. Theiler et al., Physica D 58 (1992) 77).
// Their spectra, correlations and size are those of the residual of a fit with
// damped vibrations at the eigenvalues of a high order. Each frequency takes
// its amplitude from a nearby one, because at the frequencies of modes the fit
// has removed the noise too. Noise moves a pole, to first order, as these
// series do. The covariance follows as for subspace identification.
//
// block_rows: at least 2, fewer than half of the samples. order: order of the
// model whose residual is used.
RingDown RingDownHankel(const Matrix& samples, int block_rows, int order);

// Series of noise that show the scatter of a single decay.
constexpr int kNoiseSeries = 120;

// Returns the number of samples up to the last stretch with at least twice the
// energy of the quietest one, at least `fewest`.
Eigen::Index UsedSamples(const Matrix& samples, Eigen::Index fewest);

// Returns a generator of noise with the spectra, correlations and size of
// `residuals` (channels x samples), as in RingDownHankel. fractions: expected
// fraction of the noise that a fit has left at each frequency k / (samples
// step), k = 0, 1, ..., samples / 2; the series have all of it. Empty: all.
std::function<Matrix(int)> MakeNoiseSeries(const Matrix& residuals,
                                           const Vector& fractions);

}  // namespace pinode

#endif  // PINODE_MODAL_RING_DOWN_H_
