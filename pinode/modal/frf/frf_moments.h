// Moments of the modes of a fit, and their residues and modal masses.

#ifndef PINODE_MODAL_FRF_FRF_MOMENTS_H_
#define PINODE_MODAL_FRF_FRF_MOMENTS_H_

#include <complex>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/frf/frf_fit.h"
#include "pinode/modal/frf/frf_model.h"

namespace pinode {

// A mode with its covariance: of Re s, Im s, then of the real and the imaginary
// part of each entry of the shape, then of each of the participation.
struct FrfMoments {
  FrfMode mode;
  ComplexVector shape;  // outputs
  Matrix covariance;
};

// Returns the moments of all modes of a fit: the inverse of the information
// matrix of all unknowns.
std::vector<FrfMoments> MomentsOf(const FrfModel& model, const FrfFit& fit);

// Residue of output o and reference j, with the deviations of its parts.
struct FrfResidue {
  std::complex<double> value;
  double sigma_real = 0.0, sigma_imaginary = 0.0;
};
FrfResidue ResidueOf(const FrfMoments& moments, Eigen::Index output,
                     Eigen::Index reference);

// Modal A and modal mass of the shape with largest entry 1, from the driving
// point: output o and reference j.
struct FrfScale {
  std::complex<double> modal_a;
  double mass = 0.0, mass_sigma = 0.0;
};
FrfScale ScaleOf(const FrfMoments& moments, Eigen::Index output,
                 Eigen::Index reference);

// Fits each output with poles of its own, from those of a common fit.
// `groups[o]` is the file of output o; outputs of one file share poles. There
// is one reference. The moments have the mean pole of the files, weighted by
// the inverse of the variance and the drift, and in its covariance the variance
// of the mean and the variance between files that their own do not explain
// (R. DerSimonian, N. Laird, Control. Clin. Trials 7 (1986) 177). *residuals:
// lines x outputs. *drift: standard deviation between files in 1 / s, real and
// imaginary part of s, for each mode.
std::vector<FrfMoments> FitPolesPerFile(
    const FrfData& data, const std::vector<FrfMode>& common,
    const std::vector<int>& groups, bool complex_residuals, int num_threads,
    ComplexMatrix* residuals, std::vector<std::complex<double>>* drift);

}  // namespace pinode

#endif  // PINODE_MODAL_FRF_FRF_MOMENTS_H_
