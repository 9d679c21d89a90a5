// Reads TDMS files of National Instruments (LabVIEW, DIAdem, FlexLogger).

#ifndef PINODE_RECORD_FILES_LOGGERS_TDMS_H_
#define PINODE_RECORD_FILES_LOGGERS_TDMS_H_

#include <string>

#include "pinode/record/files/loggers/logged_file.h"

namespace pinode {

// Parses a TDMS file of version 1 or 2: segments with new, repeated or
// incremental metadata, contiguous or interleaved numbers of any real type in
// either byte order, and a last segment that was not finished. A channel is
// called "group/channel". Its step, start and unit are its properties
// wf_increment, wf_start_time with wf_start_offset, and unit_string. Scales of
// unscaled numbers are applied (TdmsScales). Clock times become seconds from
// their first one.
//
// Raw data of DAQmx (format changing scalers and digital lines) become values
// by the same scales. Without a scale they are counts, which the reading says.
//
// A channel of text, complex numbers or with another scale has a fault.
//
// Source: National Instruments, "TDMS File Format Internal Structure"; for what
// that leaves out, npTDMS.
[[nodiscard]] bool ParseTdms(const std::string& bytes, const std::string& path,
                             const ChannelFilter& wanted, LoggedFile* file,
                             std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_TDMS_H_
