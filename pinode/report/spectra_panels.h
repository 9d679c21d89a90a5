// Panels with spectral densities of channels: the frame of figures that compare
// measurements with a model.

#ifndef PINODE_REPORT_SPECTRA_PANELS_H_
#define PINODE_REPORT_SPECTRA_PANELS_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"

namespace pinode {

// Returns 10 log10(density); NaN if the density is not positive.
double Decibels(double density);

// Makes panels of the first channels over frequencies in Hz, two side by side.
// `draw(channel, script)` writes the commands between a panel's title and the
// next one's; only the first panel has a legend.
Figure MakeSpectraPanels(
    const std::string& id, const std::vector<std::string>& channels,
    double lowest_hz, double highest_hz, const std::string& caption,
    const std::function<void(int channel, FigureScript* script)>& draw);

}  // namespace pinode

#endif  // PINODE_REPORT_SPECTRA_PANELS_H_
