#include "pinode/report/mode_tables.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pinode/report/number_text.h"

namespace pinode {
namespace {

using Align = TextTable::Align;

}  // namespace

TextTable MakeModeTable(const ReportInput& input) {
  TextTable table({{"mode", Align::kDecimal},
                   {"initial Hz", Align::kDecimal},
                   {"updated Hz", Align::kDecimal},
                   {"change %", Align::kDecimal},
                   {"initial damping, % crit.", Align::kDecimal},
                   {"updated damping, % crit.", Align::kDecimal},
                   {"MAC", Align::kDecimal}});
  int number = 0;
  const double hz = input.problem->description.HzPerModelFrequency();
  for (const ModePair& mode : input.prior.modes) {
    const double initial_hz = hz * mode.initial_frequency;
    const double updated_hz = hz * mode.updated_frequency;
    const double change = 100.0 * (updated_hz / initial_hz - 1.0);
    std::string change_text = "-";
    if (std::isfinite(change)) {
      // Two decimals suffice: frequencies are rarely known better.
      const double rounded = std::round(100.0 * change) / 100.0;
      change_text = (rounded > 0.0 ? "+" : "") + ReadableNumber(rounded, 3);
    }
    table.AddRow({std::to_string(++number), ReadableNumber(initial_hz, 5),
                  ReadableNumber(updated_hz, 5), change_text,
                  PercentText(mode.initial_damping),
                  PercentText(mode.updated_damping),
                  ReadableNumber(mode.mac, 4)});
  }
  return table;
}

TextTable MakeModalMassTable(const ReportInput& input) {
  std::vector<TextTable::Column> columns = {{"mode", Align::kDecimal},
                                            {"updated Hz", Align::kDecimal}};
  const std::vector<std::string>& directions =
      input.problem->dynamics->model().directions;
  for (const std::string& direction : directions) {
    columns.push_back({direction + ", %", Align::kDecimal});
    columns.push_back({"sum", Align::kDecimal});
  }
  TextTable table(columns);
  if (directions.empty()) return table;
  constexpr int kMostRows = 20;
  const double hz = input.problem->description.HzPerModelFrequency();
  Vector sum = Vector::Zero(static_cast<Eigen::Index>(directions.size()));
  // The initial order is another one if modes have changed places.
  std::vector<const ModePair*> modes;
  for (const ModePair& mode : input.prior.modes) {
    if (mode.updated_mass_shares.size() == sum.size()) modes.push_back(&mode);
  }
  std::stable_sort(modes.begin(), modes.end(),
                   [](const ModePair* a, const ModePair* b) {
                     return a->updated_frequency < b->updated_frequency;
                   });
  for (const ModePair* at : modes) {
    const ModePair& mode = *at;
    sum += mode.updated_mass_shares;
    std::vector<std::string> row = {
        std::to_string(mode.updated_mode + 1),
        ReadableNumber(hz * mode.updated_frequency, 5)};
    for (Eigen::Index d = 0; d < sum.size(); ++d) {
      row.push_back(PercentText(mode.updated_mass_shares[d]));
      row.push_back(PercentText(sum[d]));
    }
    table.AddRow(std::move(row));
    if (table.num_rows() == kMostRows || !(sum.array() < 0.999).any()) break;
  }
  return table;
}

TextTable MakeMeasuredModeTable(const ReportInput& input) {
  TextTable table({{"mode", Align::kLeft},
                   {"measured Hz", Align::kDecimal},
                   {"initial Hz", Align::kDecimal},
                   {"error %", Align::kDecimal},
                   {"updated Hz", Align::kDecimal},
                   {"error %", Align::kDecimal},
                   {"initial MAC", Align::kDecimal},
                   {"updated MAC", Align::kDecimal}});
  const double hz = input.problem->description.HzPerModelFrequency();
  for (const ModeScore& mode : input.summary->modes) {
    const auto error = [&mode](double frequency) {
      return ReadableNumber(100.0 * (frequency / mode.frequency - 1.0), 3);
    };
    table.AddRow({mode.name, ReadableNumber(hz * mode.frequency, 5),
                  ReadableNumber(hz * mode.initial.frequency, 5),
                  error(mode.initial.frequency),
                  ReadableNumber(hz * mode.updated.frequency, 5),
                  error(mode.updated.frequency),
                  ReadableNumber(mode.initial.mac, 5),
                  ReadableNumber(mode.updated.mac, 5)});
  }
  return table;
}

}  // namespace pinode
