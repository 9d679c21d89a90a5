// Questions about a case that can hardly be meant as it is written.

#ifndef PINODE_CASE_RESULTS_CASE_QUESTIONS_H_
#define PINODE_CASE_RESULTS_CASE_QUESTIONS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {

// Frequencies at which the responses of a record have most motion.
struct RecordPeaks {
  std::string record;
  // In Hz, ascending; at most six.
  std::vector<double> hz;
};

// Finds the peaks of the responses' spectra, of all channels together, each
// divided by its standard deviation. Where a ground motion was measured, its
// spectrum is divided out. Records that are too short have no peaks.
std::vector<RecordPeaks> FindRecordPeaks(const Case& c);

// Returns a sentence for each of these: modes far from the peaks of all records
// (with the factor between them, and what has that factor: weights in place of
// masses, kN beside kg), and modes with a damping ratio above one half.
std::vector<std::string> FindQuestions(const Case& c,
                                       const ModalProperties& modes,
                                       const std::vector<RecordPeaks>& peaks);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_CASE_QUESTIONS_H_
