// Tables of modes: those of the model, those that were measured, and the mass
// that takes part in them.

#ifndef PINODE_REPORT_MODE_TABLES_H_
#define PINODE_REPORT_MODE_TABLES_H_

#include "pinode/report/report.h"
#include "pinode/report/text_table.h"

namespace pinode {

// Returns frequencies (Hz), damping ratios (%) and MAC of the initial and the
// updated model.
TextTable MakeModeTable(const ReportInput& input);

// Returns the effective mass of the updated model's modes, in the order of
// their frequencies and with their numbers in that model. For each direction of
// ground motion it is in per cent of the moving mass, and summed from the first
// mode on. The table ends with the mode at which the sum reaches 99.9 %, or
// after 20 modes. Empty: no ground motion, or no modes.
TextTable MakeModalMassTable(const ReportInput& input);

// Returns the measured modes: their frequencies (Hz), those of the initial and
// the updated model, errors of these in per cent, and MAC at the measured DOFs.
TextTable MakeMeasuredModeTable(const ReportInput& input);

}  // namespace pinode

#endif  // PINODE_REPORT_MODE_TABLES_H_
