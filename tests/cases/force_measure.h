// Forces that nobody measured: what acted in the cases of
// data/three_storey_force, and how well it was found.

#ifndef PINODE_TESTS_CASES_FORCE_MEASURE_H_
#define PINODE_TESTS_CASES_FORCE_MEASURE_H_

#include <cstdint>
#include <string>

#include "tests/cases/measure.h"

namespace pinode {
namespace testing {

Case ForceCase(const std::string& name);
// Number from truth.json: "pulse/start".
double ForceTruthNumber(const std::string& pointer);

// What acted in the record of that name, at any time: "impact", "sweep",
// "sweep_wide", "sweep_high", "gust".
double TrueForce(const std::string& record, double time);

// Another draw of the noise, 1 % of each channel's standard deviation, on the
// response to the true force.
void DrawNoiseAnew(uint64_t seed, Case* c);

// The first unknown force of a case against what acted.
struct ForceScore {
  double nrmse = 0.0;     // at every integration step
  double coverage = 0.0;  // share of the steps whose 95 % band holds the truth
  // The same, for the steps where the force is above 2 % of its peak.
  double coverage_acting = 0.0;
  // Of a blow: within 30 ms of it, relative; and s.
  double impulse_error = 0.0;
  double peak_error = 0.0;
  // Of a blow that is looked for as a pulse: s; and relative.
  double start_error = 0.0;
  double duration_error = 0.0;
  double amplitude_error = 0.0;
};
ForceScore ScoreForce(const CaseRun& run);

// What is held of a pulse's start (s), duration and amplitude (relative): three
// times the worst of twenty seeds (force_study_test.cc).
inline constexpr double kHeldPulseStart = 1.4e-4;
inline constexpr double kHeldPulseDuration = 0.0105;
inline constexpr double kHeldPulseAmplitude = 0.0101;

}  // namespace testing
}  // namespace pinode

#endif  // PINODE_TESTS_CASES_FORCE_MEASURE_H_
