// Frequency response functions of the records of a case.

#ifndef PINODE_CASE_RUN_ESTIMATE_FRFS_H_
#define PINODE_CASE_RUN_ESTIMATE_FRFS_H_

#include <string>

#include "pinode/case/sections/modes_section.h"
#include "pinode/record/frf/frequency_responses.h"

namespace pinode {

// FRFs of a case, and the band in which its forces act.
struct EstimatedFrfs {
  FrequencyResponses all;
  double lowest_hz = 0.0, highest_hz = 0.0;
  // Largest distance of the lines, and true if leakage widens resonances.
  double line_distance_hz = 0.0;
  bool has_leakage = false;
  // Shortest block and shortest rest of blows, in s; 0: there are none.
  double block_seconds = 0.0, shortest_rest = 0.0;
};

// Estimates the FRFs of the case's records as [modes.frf] says. Records with
// the same channels and forces are averaged together. Others add references or
// responses, as with a hammer that roves. Fails with one line that names the
// record.
[[nodiscard]] bool EstimateFrfsOfCase(const ModesCase& c, EstimatedFrfs* result,
                                      std::string* error);

// Returns the functions as a universal file in the case's units, at the lines
// at which the forces act and those of a wider band in [modes]. Coherences of
// few averages are left out, because [[frf]] would weight lines by them.
std::string EstimatedFrfsAsFile(const EstimatedFrfs& estimated,
                                const ModesCase& c);

}  // namespace pinode

#endif  // PINODE_CASE_RUN_ESTIMATE_FRFS_H_
