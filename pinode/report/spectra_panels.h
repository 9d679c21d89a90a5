// Spectral densities of channels, a panel each: the frame of the figures that
// show what was measured beside what a model makes of it.

#ifndef PINODE_REPORT_SPECTRA_PANELS_H_
#define PINODE_REPORT_SPECTRA_PANELS_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"

namespace pinode {

// 10 log10(density); NaN where that is not positive.
double Decibels(double density);

// Panels of the first channels over frequencies in Hz, two side by side.
// `draw(channel, script)` writes the commands between a panel's title and the
// next one's; the first panel alone has a legend.
Figure MakeSpectraPanels(
    const std::string& id, const std::vector<std::string>& channels,
    double lowest_hz, double highest_hz, const std::string& caption,
    const std::function<void(int channel, FigureScript* script)>& draw);

}  // namespace pinode

#endif  // PINODE_REPORT_SPECTRA_PANELS_H_
