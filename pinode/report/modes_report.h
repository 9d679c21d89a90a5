// What pinode_modes shows of the modes it has found.

#ifndef PINODE_REPORT_MODES_REPORT_H_
#define PINODE_REPORT_MODES_REPORT_H_

#include <string>
#include <vector>

#include "pinode/modal/identify_modes.h"
#include "pinode/modal/merge_setups.h"
#include "pinode/modal/modal_spectra.h"
#include "pinode/modal/response_record.h"
#include "pinode/report/figure.h"
#include "pinode/report/html_report.h"
#include "pinode/report/report.h"
#include "pinode/study/picture/structure_picture.h"

namespace pinode {

struct ModesReportInput {
  std::string title;
  ReportOrigin origin;
  const std::vector<ResponseRecord>* records = nullptr;
  const std::vector<ModesOfRecord>* by_record = nullptr;  // of each record
  const MergedModes* merged = nullptr;
  // Where it all is; nullptr: nobody knows.
  const StructurePicture* structure = nullptr;
  std::vector<std::string> remarks;
};

// The first sentence: how many modes, from where to where.
std::string ModesSentence(const MergedModes& merged);

// Frequencies and damping ratios with their 95 % intervals, for a terminal.
std::string ModesAsText(const MergedModes& merged);

// Poles of all orders over the singular values of the spectra: what the modes
// were read from.
Figure MakeStabilisationFigure(const ResponseRecord& record,
                               const ModesOfRecord& modes, int number);

// Spectra of the channels beside those of the modes.
Figure MakeModalSpectraFigure(const ResponseRecord& record,
                              const ModalSpectra& spectra, int number);

// Real parts of the first shapes (at most `most`) with 95 % intervals, place by
// place.
Figure MakeIdentifiedShapesFigure(const MergedModes& merged, int most);

std::string RenderModesReport(const ModesReportInput& input,
                              const HtmlReportOptions& options);
[[nodiscard]] bool WriteModesReport(const ModesReportInput& input,
                                    const HtmlReportOptions& options,
                                    const std::string& path,
                                    std::string* error);

}  // namespace pinode

#endif  // PINODE_REPORT_MODES_REPORT_H_
