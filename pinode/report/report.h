// What a report is made from, and the sentence it begins with.

#ifndef PINODE_REPORT_REPORT_H_
#define PINODE_REPORT_REPORT_H_

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/base/units.h"
#include "pinode/estimate/identification_problem.h"
#include "pinode/estimate/identification_summary.h"

namespace pinode {

// One mode before and after, paired by MAC. NaN, or an empty shape, where there
// is nothing to say (overdamped, rigid body, no partner).
struct ReportMode {
  double initial_hz = std::numeric_limits<double>::quiet_NaN();
  double updated_hz = std::numeric_limits<double>::quiet_NaN();
  // Fractions of critical damping.
  double initial_damping = std::numeric_limits<double>::quiet_NaN();
  double updated_damping = std::numeric_limits<double>::quiet_NaN();
  double mac = std::numeric_limits<double>::quiet_NaN();
  Vector initial_shape;  // num_dofs, at any scale and sign
  Vector updated_shape;
};

// What a report knows of a record beyond the problem and the summary.
struct ReportRecord {
  // Free run of the model before the identification, channels x samples; empty:
  // it is not drawn.
  Matrix prior_prediction;
  // Unit of each channel's values. Empty: the model's own unit of the channel's
  // quantity, which is right for all but combinations that carry a length.
  std::vector<std::string> channel_units;
};

// An equation that discovery has put in a network's place.
struct ReportEquation {
  struct Term {
    std::string basis;
    std::string unit;  // of the coefficient
    double coefficient = 0.0;
    // NaN where not known, as what follows.
    double lower95 = 0.0;
    double upper95 = 0.0;
    double regressed = 0.0;  // before the refit
    double inclusion_probability = 0.0;
  };
  struct Axis {
    std::string name;
    std::string unit;
    Vector values;  // one a sample
    // Sum of the equation's terms that depend on this feature.
    Vector part;
  };
  // Residual of the best fit of so many terms, over the scale of the equation.
  struct ParetoPoint {
    int num_terms = 0;
    double residual = 0.0;
  };

  std::string output;  // the DOF, or a pair
  std::string source;  // what was regressed: "network nn1"
  std::string unit;
  std::vector<Term> terms;
  int num_candidates = 0;
  int num_regressed_terms = 0;  // chosen on the curve below
  std::vector<ParetoPoint> pareto;
  // Along the training records: the features that terms depend on, what was
  // regressed, and what the equation says there.
  std::vector<Axis> features;
  Vector source_values;
  Vector equation_values;
};

// What has changed since healthy records.
struct ReportDamage {
  struct Change {
    std::string name;
    // Fractions; of a nonlinear force, of the linear one at its place.
    double change = 0.0;
    double lower95 = 0.0;
    double upper95 = 0.0;
    // P(loss > threshold); NaN where a loss has no meaning.
    double probability = std::numeric_limits<double>::quiet_NaN();
    bool changed = false;
  };

  std::string sentence;
  bool alarm = false;  // something has changed
  double threshold = 0.0;
  std::vector<Change> changes;
  std::vector<std::string> baselines;
  std::vector<std::string> places;  // where else was looked
  std::vector<std::string> remarks;
};

// What an unknown force was in truth, where a case gives it.
struct ReportForceTruth {
  std::string name;
  Vector times;
  Vector values;
};

// The force of a term as known from elsewhere, to be drawn beside what was
// identified. The term has one output and resists, or is an acceleration of one
// uncoupled mass.
struct ReportCurve {
  std::string term;
  std::string name;
  // Model units; the force resists positive deformation.
  Vector deformation, force;
};

// Filled by a program; the objects pointed to outlive it. The summary may be
// that of a failure: what it lacks is left out of the report.
struct ReportInput {
  std::string title;
  std::string case_path;
  std::string command_line;
  std::string version;
  UnitSystem units;
  double wall_seconds = 0.0;  // of the whole program
  const IdentificationProblem* problem = nullptr;
  const IdentificationSummary* summary = nullptr;
  const IdentifiedModel* model = nullptr;
  std::vector<ReportRecord> records;  // in the problem's order, or empty
  std::vector<ReportMode> modes;
  std::vector<ReportEquation> equations;
  std::optional<ReportDamage> damage;
  std::vector<ReportForceTruth> force_truths;
  std::vector<ReportCurve> curves;
  // About the data as they were read, a sentence each.
  std::vector<std::string> remarks;
};

// Whether the result may be used, and why, in a sentence or two:
//   "Usable. ..." or "Not usable: ...".
std::string Verdict(const ReportInput& input);

// Name of the DOF at which channel `channel` measures, or the combination of
// them, "u2 - u1".
std::string ChannelPlace(const ReportInput& input, int record, int channel);

// "m/s^2": the unit of a channel's values.
std::string ChannelUnit(const ReportInput& input, int record, int channel);

// Noise of the channel as a fraction of its fluctuation, sigma / rms(y -
// mean(y)): the nrmse of a perfect model. NaN where it is not known.
double NoiseShare(const ReportInput& input, int record, int channel);

}  // namespace pinode

#endif  // PINODE_REPORT_REPORT_H_
