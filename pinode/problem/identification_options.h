// Options of a fit, and its progress.

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
  int stage = 0;  // number of the stage, from 1
  int num_stages = 0;
  Eigen::Index segment_samples = 0;  // longest segment of the stage
  int iteration = 0;                 // iterations so far, all stages
  double cost = 0.0;
  double largest_gap = 0.0;  // in units of the state's RMS
  // Error (nrmse over all channels) of the latest simulation of the training
  // records. Simulations are run at the beginning of each stage, and at every
  // iteration while networks are annealed. Infinite: the simulation diverged.
  double free_run_error = 0.0;
  double elapsed_seconds = 0.0;
  // Upper bound of the duration of the whole fit at the present speed.
  double expected_seconds = 0.0;
  // Model at this iteration: parameters, noise levels, decays and stage,
  // without starts. Identify can continue from it. It is valid only during the
  // callback. Null: there is none. While annealed networks predict worse than
  // the first fit, this is the model of the first fit.
  const IdentifiedModel* model = nullptr;
};

// Options of a fit.
struct IdentificationOptions {
  enum class Shooting { kMultiple, kSingle };
  // Method of the covariance of the parameters, see `covariance`.
  enum class Covariance { kAuto, kPlain, kSandwich, kNone };

  // Multiple shooting (H. G. Bock 1981) or one segment per record. Multiple
  // shooting reaches solutions that a long simulation does not lead to. Its
  // last stage is a simulation of whole records if that is stable.
  Shooting shooting = Shooting::kMultiple;

  // Segment length of the first stage in samples. 0: a quarter of the longest
  // period, and at least ten samples.
  Eigen::Index segment_samples = 0;

  // Largest number of Levenberg-Marquardt iterations in all stages together.
  int max_num_iterations = 2000;

  // Relative change of the cost that ends a solve.
  double function_tolerance = 1e-10;

  // Method for the derivatives: tangents coded by hand, or Jets through whole
  // segments. They agree up to rounding. Tangents are many times faster.
  DerivativeMethod derivatives = DerivativeMethod::kTangents;

  // Loss function of the residuals. Residuals beyond `loss_scale` count less.
  RobustLoss loss = RobustLoss::kNone;
  double loss_scale = 3.0;  // in units of the noise's sigma

  // Method of the covariance of the parameters:
  // - kPlain: the inverse Hessian;
  // - kSandwich: a sandwich estimate over blocks of samples, for autocorrelated
  //   residuals;
  // - kNone: no intervals. For fits of known noise that are only compared by
  //   their cost: they end without the last exact steps, and the scores of
  //   hold-outs and of the initial model are NaN. FitOnce alone takes it;
  // - kAuto: kSandwich if residuals are autocorrelated, else kPlain. Errors of
  //   an input that has noise become unknowns of the fit (FitWithInputNoise).
  //   If that is impossible, they are included in the covariance.
  // kPlain and kSandwich assume that the excitation is exact.
  Covariance covariance = Covariance::kAuto;

  // True: computes RecordScore::deviations. Fits that are only compared do not
  // need them.
  bool prediction_bands = true;

  // True: keeps the states of the simulations, 8 bytes per state and sample.
  // Plots of restoring forces and the search for terms need them.
  bool keep_states = true;

  // Number of starts of the fit. The first start has the given initial values.
  // Other starts are drawn within bounds and priors. Without them, stiffness
  // groups are drawn between half and twice the nominal value, damping groups
  // between a third and three times. Networks get other seeds.
  //
  // The default, 0, chooses the number:
  // - 8 for a linear structure with records alone and no start model, if it has
  //   at least twice as many stiffness groups as a record has fitted channels.
  //   Other stiffnesses may then fit as well (F. E. Udwadia, D. K. Sharma, SIAM
  //   J. Appl. Math. 34 (1978) 104-118);
  // - 16 for frequencies without shapes;
  // - 1 otherwise. If this fit of a linear structure fails, or its error is
  //   above 0.9, up to 3 more starts follow.
  int num_starts = 0;
  // Seed of the random starts, and number of threads.
  uint64_t seed = 1;

  int num_threads = 1;

  // Ranks that solve the problem together; nullptr: a single process. Each rank
  // calls Identify with the same problem and options, and gets the same result.
  // Only the first rank keeps the histories of RecordScore.
  Communicator* communicator = nullptr;

  // Constants for studies of the method. Users need only the options above.
  Tuning tuning;

  // Function that is called after each iteration. If it returns false, the fit
  // stops and keeps its best result.
  std::function<bool(const IdentificationProgress&)> callback;

  // Checks sizes and signs. On failure returns false, and *error names the
  // option and the violated constraint.
  [[nodiscard]] bool IsValid(std::string* error) const;
  // Returns false, with *error, if `covariance` is kNone.
  [[nodiscard]] bool GivesIntervals(std::string* error) const;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_IDENTIFICATION_OPTIONS_H_
