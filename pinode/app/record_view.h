// Records for the page: facts about their columns, and pictures of few points.

#ifndef PINODE_APP_RECORD_VIEW_H_
#define PINODE_APP_RECORD_VIEW_H_

#include <nlohmann/json_fwd.hpp>

#include "pinode/case/draft/log_file.h"

namespace pinode {

// The number, or null where it is not finite.
nlohmann::ordered_json NumberOrNull(double value);

// {"samples", "step", "rate_hz", "seconds", "time", "reading",
//  "columns": [{"name", "unit", "quantity", "min", "max", "rms", "missing"}]}
// Numbers that are unknown are null. "rms" is about the mean. "quantity" is
// "acceleration", ... or "" if the unit is not stated.
nlohmann::ordered_json LogOverview(const LogFile& log);

// Widest picture in pixels.
inline constexpr int kWidestView = 2000;

// {"column", "unit", "samples", "history": {"x": [s], "y": []},
//  "spectrum": {"x": [Hz], "y": [unit/sqrt(Hz)]}}
// Both lines have at most two points per pixel, the smallest and the largest
// value there (DecimateHistory), so that no peak is lost. The spectrum is the
// square root of EstimateSpectra. null in y: a gap. `width`: pixels, 1 to
// kWidestView.
nlohmann::ordered_json ColumnView(const LogFile& log, const LogColumn& column,
                                  int width);

}  // namespace pinode

#endif  // PINODE_APP_RECORD_VIEW_H_
