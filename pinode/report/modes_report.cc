#include "pinode/report/modes_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/modal/frf/frf_modes.h"
#include "pinode/modal/stabilisation.h"
#include "pinode/report/number_text.h"
#include "pinode/report/page_data.h"
#include "pinode/report/structure_view.h"

namespace pinode {
namespace {

using Align = TextTable::Align;

#include "pinode/report/modes_template.inc"

// Shapes that are drawn, and modes of a table that fits the page.
constexpr int kMostShapes = 16;
constexpr size_t kLargestMacTable = 20;

// Returns the half-width of the 95 % interval.
double HalfWidth(const IdentifiedMode& mode, double sigma) {
  return StudentQuantile(mode.degrees_of_freedom) * sigma;
}

TextTable MakeModesTable(const MergedModes& merged, bool for_page) {
  std::vector<TextTable::Column> columns = {{"mode", Align::kDecimal},
                                            {"Hz", Align::kDecimal},
                                            {"+-", Align::kDecimal},
                                            {"damping, %", Align::kDecimal},
                                            {"+-", Align::kDecimal}};
  if (for_page) {
    columns.push_back({"between orders, Hz", Align::kDecimal});
    columns.push_back({"orders", Align::kDecimal});
    columns.push_back({"in phase", Align::kDecimal});
  }
  TextTable table(columns);
  for (size_t m = 0; m < merged.modes.size(); ++m) {
    const IdentifiedMode& mode = merged.modes[m].mode;
    const EstimateText frequency =
        FormatEstimate(mode.frequency_hz, mode.frequency_hz,
                       HalfWidth(mode, mode.frequency_sigma));
    const EstimateText damping =
        FormatEstimate(100.0 * mode.damping_ratio, 100.0 * mode.damping_ratio,
                       100.0 * HalfWidth(mode, mode.damping_sigma));
    std::vector<std::string> row = {std::to_string(m + 1), frequency.value,
                                    frequency.half_width, damping.value,
                                    damping.half_width};
    if (for_page) {
      row.push_back(ReadableNumber(mode.frequency_spread, 2));
      row.push_back(std::to_string(mode.orders_seen) + " of " +
                    std::to_string(mode.orders_possible));
      row.push_back(ReadableNumber(mode.phase_collinearity, 3));
    }
    table.AddRow(row);
  }
  return table;
}

// Makes a table of each set-up's results for each mode.
TextTable MakeSetupsTable(const ModesReportInput& input) {
  std::vector<TextTable::Column> columns = {{"mode", Align::kDecimal}};
  for (const ResponseRecord& record : *input.records) {
    columns.push_back({record.name + ", Hz", Align::kDecimal});
  }
  columns.push_back({"between, Hz", Align::kDecimal});
  TextTable table(columns);
  for (size_t m = 0; m < input.merged->modes.size(); ++m) {
    const MergedMode& merged = input.merged->modes[m];
    std::vector<std::string> row = {std::to_string(m + 1)};
    for (size_t s = 0; s < merged.in_setups.size(); ++s) {
      const int number = merged.in_setups[s];
      row.push_back(number < 0
                        ? "-"
                        : ReadableNumber((*input.by_record)[s]
                                             .modes[static_cast<size_t>(number)]
                                             .frequency_hz,
                                         6));
    }
    row.push_back(ReadableNumber(merged.frequency_between, 2));
    table.AddRow(row);
  }
  return table;
}

// Returns the MAC at the places that both modes have.
double MacBetween(const IdentifiedMode& a, const IdentifiedMode& b) {
  Eigen::VectorXcd x = a.shape;
  Eigen::VectorXcd y = b.shape;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (std::isfinite(x[i].real()) && std::isfinite(y[i].real())) continue;
    x[i] = y[i] = 0.0;
  }
  return ComplexMac(x, y);
}

// Makes a table of the first `count` modes.
TextTable MakeMacTable(const MergedModes& merged, size_t count) {
  std::vector<TextTable::Column> columns = {{"mode", Align::kDecimal}};
  for (size_t m = 0; m < count; ++m) {
    columns.push_back({std::to_string(m + 1), Align::kDecimal});
  }
  TextTable table(columns);
  for (size_t m = 0; m < count; ++m) {
    std::vector<std::string> row = {std::to_string(m + 1)};
    for (size_t other = 0; other < count; ++other) {
      const double mac =
          MacBetween(merged.modes[m].mode, merged.modes[other].mode);
      char cell[16];
      std::snprintf(cell, sizeof(cell), "%.2f", mac);
      row.emplace_back(cell);
    }
    table.AddRow(row);
  }
  return table;
}

TextTable MakeBandsTable(const ModesOfRecord& modes) {
  TextTable table({{"from, Hz", Align::kDecimal},
                   {"to, Hz", Align::kDecimal},
                   {"sampled at, Hz", Align::kDecimal},
                   {"block rows", Align::kDecimal},
                   {"orders up to", Align::kDecimal},
                   {"windows", Align::kDecimal}});
  for (const AnalysedBand& band : modes.bands) {
    table.AddRow(
        {ReadableNumber(band.lowest_hz, 4), ReadableNumber(band.highest_hz, 4),
         ReadableNumber(1.0 / band.sampling_step, 5),
         std::to_string(band.block_rows), std::to_string(band.max_order),
         std::to_string(band.num_windows)});
  }
  return table;
}

// Returns a sentence on how the modes of a record were found, and on the source
// of their intervals.
std::string MethodSentence(ModalMethod method) {
  switch (method) {
    case ModalMethod::kInputOutput:
      return "Subspace identification with the measured loads. Their effect on "
             "the channels is projected out. Models of all orders are "
             "identified from the rest. Intervals come from the differences "
             "between parts of the record.";
    case ModalMethod::kRingDown:
      return "Free decay: the eigensystem realisation algorithm over models of "
             "all orders. A single decay has no parts to compare. Intervals "
             "therefore come from noise with the spectrum of the residual, "
             "the record minus its decaying vibrations.";
    case ModalMethod::kDataDriven:
      return "Data-driven stochastic subspace identification under unmeasured "
             "loads: the future of the channels is projected on their past. "
             "Intervals come from the differences between parts of the record.";
    default:
      return "Covariance-driven stochastic subspace identification under "
             "unmeasured loads. Models of all orders are identified from the "
             "correlations of the channels. Intervals come from the "
             "differences between parts of the record.";
  }
}

std::string FrfSentence() {
  return "Frequency response functions: poles by poly-reference least squares "
         "over models of all orders, then a modal model by maximum likelihood. "
         "Intervals come from its information matrix and the noise that "
         "it leaves.";
}

TextTable MakeErrorsTable(const ModesOfFrfs& frfs) {
  TextTable table({{"response / reference", Align::kLeft},
                   {"error of synthesis, %", Align::kDecimal}});
  for (Eigen::Index p = 0; p < frfs.errors.size(); ++p) {
    table.AddRow({frfs.pair_names[static_cast<size_t>(p)],
                  ReadableNumber(100.0 * frfs.errors[p], 3)});
  }
  return table;
}

TextTable MakeExplainedTable(const ResponseRecord& record,
                             const ModalSpectra& spectra) {
  TextTable table(
      {{"channel", Align::kLeft}, {"explained, %", Align::kDecimal}});
  for (Eigen::Index c = 0; c < spectra.explained.size(); ++c) {
    table.AddRow({record.channels[static_cast<size_t>(c)].name,
                  ReadableNumber(100.0 * spectra.explained[c], 3)});
  }
  return table;
}

}  // namespace

std::string ModesSentence(const MergedModes& merged) {
  if (merged.modes.empty()) {
    return "No mode was found: models of different orders agree on none. Use "
           "longer records or more sensors, or set the band of frequencies.";
  }
  const int count = static_cast<int>(merged.modes.size());
  return Count(count, "mode") +
         (count == 1 ? " was found, at " : " were found, from ") +
         ReadableNumber(merged.modes.front().mode.frequency_hz, 4) +
         (count == 1 ? ""
                     : " to " + ReadableNumber(
                                    merged.modes.back().mode.frequency_hz, 4)) +
         " Hz.";
}

std::string ModesAsText(const MergedModes& merged) {
  return ModesSentence(merged) + "\n\n" +
         (merged.modes.empty() ? std::string()
                               : MakeModesTable(merged, false).ToText());
}

std::string RenderModesReport(const ModesReportInput& input,
                              const HtmlReportOptions& options) {
  CHECK(input.records != nullptr && input.by_record != nullptr &&
        input.merged != nullptr)
      << "a report of modes needs records and modes";
  ReportFigures figures;
  const auto plan = [&figures](Figure figure) {
    if (figure.empty()) return -1;
    figures.pictures.push_back({std::move(figure), "", ""});
    return static_cast<int>(figures.pictures.size()) - 1;
  };
  const int shapes =
      plan(MakeIdentifiedShapesFigure(*input.merged, kMostShapes));
  std::vector<int> diagrams;
  std::vector<ModalSpectra> spectra;
  std::vector<int> spectra_figures;
  std::vector<int> indicators;
  for (size_t r = 0; r < input.records->size(); ++r) {
    const ResponseRecord& record = (*input.records)[r];
    const ModesOfRecord& modes = (*input.by_record)[r];
    const int number = static_cast<int>(r);
    diagrams.push_back(plan(MakeStabilisationFigure(record, modes, number)));
    if (input.frfs != nullptr) {
      spectra.emplace_back();
      spectra_figures.push_back(plan(MakeFrfFigure((*input.frfs)[r], number)));
      indicators.push_back(
          plan(MakeFrfIndicatorFigure((*input.frfs)[r], number)));
      continue;
    }
    spectra.push_back(FitModalSpectra(record, modes));
    spectra_figures.push_back(
        plan(MakeModalSpectraFigure(record, spectra.back(), number)));
  }
  DrawFigures(options, &figures);
  const auto picture = [&figures](int index) {
    return index < 0
               ? PageData(false)
               : PictureData(figures.pictures[static_cast<size_t>(index)]);
  };

  PageData page;
  page.set("title", input.title.empty() ? "Modes" : input.title);
  page.set("source", "Modes by pinode " + PinodeVersion() +
                         (input.origin.case_path.empty()
                              ? ""
                              : ", case " + input.origin.case_path));
  page.set("usable", !input.merged->modes.empty());
  page.set("verdict", ModesSentence(*input.merged));
  const bool any = !input.merged->modes.empty();
  SetIf("modes", any, TableData(MakeModesTable(*input.merged, true)), &page);
  SetIf("setups", any && input.records->size() > 1,
        TableData(MakeSetupsTable(input)), &page);
  page.set("shapes", picture(shapes));
  const size_t num_modes = input.merged->modes.size();
  const size_t in_table = std::min(num_modes, kLargestMacTable);
  PageData mac = TableData(MakeMacTable(*input.merged, in_table));
  mac.set("which", in_table < num_modes
                       ? "the first " + std::to_string(in_table) + " of " +
                             std::to_string(num_modes) + " modes"
                       : std::string("the modes"));
  SetIf("mac", num_modes > 1 && input.merged->places.size() > 1, mac, &page);
  PageData structure;
  if (input.structure != nullptr) {
    structure.set("html", StructureSection(*input.structure));
  }
  SetIf("structure", input.structure != nullptr, structure, &page);
  PageData records = PageList();
  for (size_t r = 0; r < input.records->size(); ++r) {
    PageData record;
    record.set("name", (*input.records)[r].name);
    record.set("method", input.frfs != nullptr
                             ? FrfSentence()
                             : MethodSentence((*input.by_record)[r].method));
    record.set("diagram", picture(diagrams[r]));
    record.set("spectra", picture(spectra_figures[r]));
    record.set("indicator", picture(indicators.empty() ? -1 : indicators[r]));
    SetIf("explained", spectra[r].explained.size() > 0,
          TableData(MakeExplainedTable((*input.records)[r], spectra[r])),
          &record);
    if (input.frfs != nullptr) {
      record.set("bands", TableData(MakeErrorsTable((*input.frfs)[r])));
    } else {
      record.set("bands", TableData(MakeBandsTable((*input.by_record)[r])));
    }
    records.push_back(record);
  }
  page.set("records", records);
  page.set("has_remarks", !input.remarks.empty());
  page.set("remarks", PageTexts(input.remarks));
  SetIf("command", !input.origin.command_line.empty(),
        input.origin.command_line, &page);
  page.set("footer", "pinode " + PinodeVersion() + ", " +
                         Duration(input.origin.wall_seconds) + " in all.");
  return RenderPage(kModesTemplate, page);
}

bool WriteModesReport(const ModesReportInput& input,
                      const HtmlReportOptions& options, const std::string& path,
                      std::string* error) {
  return WriteFileAtomically(path, RenderModesReport(input, options), error);
}

}  // namespace pinode
