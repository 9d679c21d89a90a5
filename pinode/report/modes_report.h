// Report of pinode_modes.

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

struct ModesOfFrfs;

struct ModesReportInput {
  std::string title;
  ReportOrigin origin;
  const std::vector<ResponseRecord>* records = nullptr;
  const std::vector<ModesOfRecord>* by_record = nullptr;  // per record
  const MergedModes* merged = nullptr;
  // Frequency response functions, if these were measured: one entry for each
  // record, which then has a name alone.
  const std::vector<ModesOfFrfs>* frfs = nullptr;
  // Picture of the structure; nullptr: its geometry is unknown.
  const StructurePicture* structure = nullptr;
  std::vector<std::string> remarks;
};

// Returns the first sentence: the number of modes and their range of
// frequencies.
std::string ModesSentence(const MergedModes& merged);

// Returns frequencies and damping ratios with their 95 % intervals, for a
// terminal.
std::string ModesAsText(const MergedModes& merged);

// Makes the poles of all orders over the singular values of the spectra, from
// which the modes were found.
Figure MakeStabilisationFigure(const ResponseRecord& record,
                               const ModesOfRecord& modes, int number);

// Makes the spectra of the channels, compared with those of the modes.
Figure MakeModalSpectraFigure(const ResponseRecord& record,
                              const ModalSpectra& spectra, int number);

// Makes magnitude and phase of the first functions, measured and synthesised.
Figure MakeFrfFigure(const ModesOfFrfs& frfs, int number);

// Makes the complex mode indicator function of the functions, and their
// coherence where it is known.
Figure MakeFrfIndicatorFigure(const ModesOfFrfs& frfs, int number);

// Makes the real parts of the first shapes (at most `most`) with 95 %
// intervals, by place.
Figure MakeIdentifiedShapesFigure(const MergedModes& merged, int most);

std::string RenderModesReport(const ModesReportInput& input,
                              const HtmlReportOptions& options);
[[nodiscard]] bool WriteModesReport(const ModesReportInput& input,
                                    const HtmlReportOptions& options,
                                    const std::string& path,
                                    std::string* error);

}  // namespace pinode

#endif  // PINODE_REPORT_MODES_REPORT_H_
