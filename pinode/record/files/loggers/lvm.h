// Reads LVM files (LabVIEW Measurement).

#ifndef PINODE_RECORD_FILES_LOGGERS_LVM_H_
#define PINODE_RECORD_FILES_LOGGERS_LVM_H_

#include <string>

#include "pinode/record/files/loggers/logged_file.h"

namespace pinode {

// Parses an LVM file of LabVIEW, in text: a header, then segments with a header
// of their own (Channels, Samples, Date, Time, Y_Unit_Label, X0, Delta_X), the
// columns' names and rows. X_Columns may be One, Multi or No; the separator is
// a tab or a comma, the decimal sign a point or a comma. The step is Delta_X;
// the written times, which are rounded, are not used. Segments follow each
// other where X0 goes on, or else by date and time, with missing samples
// between them.
//
// Channels of one X column whose starts differ by less than half a step, as
// those of cards that sample one after the other, get the start of the first.
//
// The time is called "t" or "X_Value". Refuses with `path:line: ...`.
// Source: National Instruments, "Specification for the LabVIEW Measurement
// File (.lvm)".
[[nodiscard]] bool ParseLvm(const std::string& text, const std::string& path,
                            const ChannelFilter& wanted, LoggedFile* file,
                            std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_LVM_H_
