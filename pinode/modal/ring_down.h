// Ring-downs: the eigensystem realisation algorithm on a free decay.

#ifndef PINODE_MODAL_RING_DOWN_H_
#define PINODE_MODAL_RING_DOWN_H_

#include <complex>
#include <functional>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/stabilisation.h"
#include "pinode/modal/subspace.h"

namespace pinode {

struct RingDown {
  HankelWindows hankel;
  // Those that tell of the decay: behind them noise alone is left.
  Matrix samples;
  // Root mean square of what decaying vibrations leave of them, per channel.
  Vector noise;
  // Series b of the noise, channels x samples; from several threads at once.
  std::function<Matrix(int)> noise_series;
};

// Of samples y(k) (channels x samples, complete, k = 0 on a free decay) the
// matrix with blocks (i, j) = y(i + j), whose columns are those of the
// observability matrix: no load acts any more (J. N. Juang and R. S. Pappa, J.
// Guidance Control Dyn. 8 (1985) 620). Its `windows` are not parts of the
// record: a single decay does not say how it would come out again. They are
// kNoiseSeries series of noise with the spectra, correlations and size of what
// damped vibrations at the eigenvalues of a high order leave of the record,
// with random amplitudes and phases; at each frequency they are taken from one
// near it, for at those of modes the vibrations have taken the noise as well
// (after J. Theiler et al., Physica D 58 (1992) 77). How they move a pole to
// first order is how noise does, of which its covariance follows as for
// subspace identification.
//
// block_rows: at least 2, fewer than half of the samples; order: that of the
// model that what is left is taken from.
RingDown RingDownHankel(const Matrix& samples, int block_rows, int order);

constexpr int kNoiseSeries = 120;

// Of decays exp(s k step) those without which the samples are not to be
// explained: the others are left out one after the other, from the one that
// explains least. What a decay explains is chi-squared for one of noise, of
// which the record offers as many as it has frequencies.
std::vector<bool> FindSignificantDecays(
    const RingDown& ring_down, const std::vector<std::complex<double>>& s,
    double step);

// Shapes of modes by what their decays together, with a constant, explain of
// the samples: least squares, to which all samples contribute, where a first
// block row of the observability matrix is as good as the few samples of its
// noise. Influences are those of the noise series, and of what these do to the
// poles.
void FitDecayShapes(const RingDown& ring_down, double step,
                    std::vector<PoleCluster>* clusters);

}  // namespace pinode

#endif  // PINODE_MODAL_RING_DOWN_H_
