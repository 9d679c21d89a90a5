// How a problem is solved.

#ifndef PINODE_PROBLEM_IDENTIFICATION_OPTIONS_H_
#define PINODE_PROBLEM_IDENTIFICATION_OPTIONS_H_

#include <cstdint>
#include <functional>
#include <string>

#include "pinode/base/communicator.h"
#include "pinode/base/types.h"
#include "pinode/integrate/integrator.h"
#include "pinode/problem/robust_loss.h"
#include "pinode/problem/tuning.h"

namespace pinode {

struct IdentifiedModel;

// Progress of a running fit, for programs that show or save it.
struct IdentificationProgress {
  int stage = 0;  // from 1
  int num_stages = 0;
  Eigen::Index segment_samples = 0;  // longest segment of the stage
  int iteration = 0;                 // Levenberg-Marquardt iterations so far
  double cost = 0.0;
  double largest_gap = 0.0;  // in units of the state's RMS
  // The newest one measured, nrmse over all channels: as the stage began, and
  // while networks are annealed, at every iteration. Infinite where the free
  // run is.
  double free_run_error = 0.0;
  double elapsed_seconds = 0.0;
  double expected_seconds = 0.0;  // in all, at this pace; an upper bound
  // Parameters, noise levels and decay at this iteration and the stage; what
  // Identify takes to go on from here. Without starts. While annealed networks
  // predict worse than the first fit, it is the first fit's.
  const IdentifiedModel* model = nullptr;
};

struct IdentificationOptions {
  enum class Shooting { kMultiple, kSingle };
  enum class Covariance { kAuto, kPlain, kSandwich };

  // Multiple shooting reaches solutions that a long free run does not lead to
  // (H. G. Bock, 1981); the last stage is a free run wherever that is stable.
  Shooting shooting = Shooting::kMultiple;

  // Segment length of the first stage in samples; 0: a quarter of the longest
  // period, and at least ten samples.
  Eigen::Index segment_samples = 0;

  // Levenberg-Marquardt iterations in all stages together.
  int max_num_iterations = 2000;

  // Relative change of the cost that ends a solve.
  double function_tolerance = 1e-10;

  // Derivatives by hand-made tangents or by Jets through the whole segment.
  // They agree up to rounding; tangents are many times faster.
  DerivativeMethod derivatives = DerivativeMethod::kTangents;

  RobustLoss loss = RobustLoss::kNone;
  double loss_scale = 3.0;  // in units of sigma

  // kAuto: where an input has noise, its errors are unknowns of the fit
  // (FitWithInputNoise) or, where that cannot be, enter the covariance;
  // block-sandwich where residuals are autocorrelated; else the plain inverse
  // Hessian. The others are of the fit that takes the excitation as exact.
  Covariance covariance = Covariance::kAuto;

  // Predictions get bands. Fits that are only compared need none.
  bool prediction_bands = true;

  // The states of the free runs are kept in the summary, 8 bytes a
  // state and sample: for what looks at restoring forces, or searches for
  // terms.
  bool keep_states = true;

  // Number of starts for multistart; the first is the given one, the others
  // are drawn within bounds and priors (stiffness groups without, between half
  // and twice the nominal, damping groups between a third and three times),
  // networks from other seeds. 0: 8 where a linear structure is not given a
  // start and has at least twice as many stiffness groups as a record has
  // sensors, for then other stiffnesses may do as well or better (F. E.
  // Udwadia, D. K. Sharma, SIAM J. Appl. Math. 34 (1978) 104-118); 16 for
  // frequencies without shapes; else 1.
  int num_starts = 0;
  uint64_t seed = 1;

  int num_threads = 1;

  // Ranks that solve the problem together, each of which calls Identify with
  // the same problem and options and has the same outcome, of which the first
  // one alone keeps the histories (RecordScore); nullptr: a single process.
  Communicator* communicator = nullptr;

  // For studies; what a user needs is an option above.
  Tuning tuning;

  // Called after each iteration; false stops the fit, keeping the best so far.
  std::function<bool(const IdentificationProgress&)> callback;

  // Sizes and signs; on failure names the option and the violated constraint.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_IDENTIFICATION_OPTIONS_H_
