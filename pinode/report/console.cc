#include "pinode/report/console.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/report/mode_tables.h"
#include "pinode/report/number_text.h"

namespace pinode {
namespace {

using Align = TextTable::Align;
using Role = IdentificationRecord::Role;

const char* RoleName(Role role) {
  return role == Role::kTrain ? "train" : "hold-out";
}

// Returns the indices of the scored records, hold-out ones first.
std::vector<int> HoldoutFirst(const IdentificationSummary& summary) {
  std::vector<int> order;
  for (const Role role : {Role::kHoldout, Role::kTrain}) {
    for (size_t i = 0; i < summary.records.size(); ++i) {
      if (summary.records[i].role == role) order.push_back(static_cast<int>(i));
    }
  }
  return order;
}

std::string NoteOn(const ParameterEstimate& parameter) {
  if (!parameter.tie.empty()) {
    return (parameter.tie_factor == 1.0
                ? "as "
                : FormatNumber(parameter.tie_factor, 6) + " times ") +
           parameter.tie;
  }
  if (!parameter.free) return "fixed";
  if (parameter.at_bound) return "at bound";
  return std::isfinite(parameter.sigma) ? "" : "no interval";
}

// Formats a change, to at most a hundredth of a per cent.
std::string Hundredths(double fraction) {
  // Adding zero avoids a negative zero.
  return FormatNumber(std::round(1e4 * fraction) / 100.0 + 0.0, 6);
}

// True if a subject may be a side effect of a cause that was not examined.
bool StandsIn(const DamageResult& damage, size_t subject) {
  const std::vector<Reason>& reasons = damage.judgement.reasons;
  return subject < reasons.size() &&
         (reasons[subject] == Reason::kUnexplained ||
          reasons[subject] == Reason::kModelError ||
          reasons[subject] == Reason::kOtherLevel ||
          reasons[subject] == Reason::kOtherExplanation);
}

// True if the interval is not centred on the value: that of a result that lacks
// something reaches as far as the best explanation.
bool IsOneSided(const ParameterEstimate& parameter) {
  constexpr double kRounding = 0.02;
  const double width = parameter.upper95 - parameter.lower95;
  const double middle = 0.5 * (parameter.upper95 + parameter.lower95);
  return parameter.free && std::isfinite(width) &&
         std::abs(middle - parameter.value) > kRounding * width;
}

}  // namespace

TextTable MakeChangeTable(const DamageResult& damage) {
  TextTable table(
      {{"change of", Align::kLeft},
       {"%", Align::kDecimal},
       {"95 % interval", Align::kDecimal},
       {"P(loss > " + FormatNumber(100.0 * damage.options.threshold, 3) + " %)",
        Align::kDecimal},
       {"", Align::kLeft}});
  for (const size_t j : ShownChanges(damage)) {
    const std::string& name = damage.subjects[j].name;
    const GroupChange& change = damage.estimate.groups[j];
    if (!IsSeen(change)) {
      table.AddRow({name, "", "not seen", "", ""});
      continue;
    }
    const double probability = LossProbability(damage, j);
    table.AddRow(
        {name, Hundredths(change.change),
         Hundredths(change.lower95) + " to " + Hundredths(change.upper95),
         std::isfinite(probability)
             ? FormatNumber(std::round(1e3 * probability) / 1e3, 3)
             : "",
         !change.changed       ? ""
         : StandsIn(damage, j) ? "may be a side effect"
                               : "changed"});
  }
  return table;
}

TextTable MakeChangeExplanationTable(const DamageResult& damage) {
  TextTable table({{"explanation", Align::kLeft},
                   {"probability %", Align::kDecimal},
                   {"change of", Align::kLeft},
                   {"%", Align::kDecimal},
                   {"95 % interval", Align::kDecimal}});
  const std::vector<ChangeExplanation>& all = damage.estimate.explanations;
  if (all.size() < 2) return table;
  for (size_t i = 0; i < all.size(); ++i) {
    for (size_t k = 0; k < all[i].changed.size(); ++k) {
      const GroupChange& change = all[i].changes[k];
      table.AddRow(
          {k == 0 ? std::to_string(i + 1) : "",
           k == 0 ? PercentText(all[i].probability) : "",
           damage.subjects[static_cast<size_t>(all[i].changed[k])].name,
           Hundredths(change.change),
           Hundredths(change.lower95) + " to " + Hundredths(change.upper95)});
    }
  }
  return table;
}

TextTable MakeParameterTable(const ReportInput& input) {
  TextTable table({{"parameter", Align::kLeft},
                   {"initial", Align::kDecimal},
                   {"identified", Align::kDecimal},
                   {"\u00b1 95 %", Align::kDecimal},
                   {"unit", Align::kLeft},
                   {"", Align::kLeft}});
  for (const ParameterEstimate& parameter : input.summary->parameters) {
    const double half_width =
        parameter.free || !parameter.tie.empty()
            ? 0.5 * (parameter.upper95 - parameter.lower95)
            : 0.0;
    const EstimateText text =
        FormatEstimate(parameter.initial, parameter.value, half_width);
    const std::string within =
        IsOneSided(parameter)
            ? FormatEstimate(0.0, parameter.lower95, half_width).value +
                  " to " +
                  FormatEstimate(0.0, parameter.upper95, half_width).value
            : text.half_width;
    table.AddRow({parameter.name, text.initial, text.value, within,
                  UnitText(parameter.unit), NoteOn(parameter)});
  }
  return table;
}

TextTable MakeProfileTable(const ReportInput& input) {
  TextTable table({{"parameter", Align::kLeft},
                   {"identified", Align::kDecimal},
                   {"linear 95 %", Align::kDecimal},
                   {"profile 95 %", Align::kDecimal},
                   {"profile 99 %", Align::kDecimal},
                   {"result", Align::kLeft}});
  for (const ParameterProfile& profile : input.summary->profiles) {
    // Three digits of an interval correspond to two of its width.
    const auto interval = [&profile](double low, double high) {
      double width = std::max(std::abs(low - profile.estimate),
                              std::abs(high - profile.estimate));
      if (!std::isfinite(width)) {
        width = std::isfinite(low)    ? std::abs(low - profile.estimate)
                : std::isfinite(high) ? std::abs(high - profile.estimate)
                                      : 0.0;
      }
      const auto end = [&](double value) {
        if (!std::isfinite(value)) return std::string("-");
        return FormatEstimate(value, value, width).value;
      };
      if (std::isinf(low) && std::isinf(high)) return std::string("none");
      return end(low) + " to " + end(high);
    };
    std::string says = DeterminationName(profile.determination);
    if (!profile.combinations.empty()) {
      says += "; determined together: " + Join(profile.combinations, ", ");
    }
    if (profile.unsettled)
      says += "; not all refits converged, so it may be wider";
    if (profile.found_lower) says += "; a better fit was found on the way";
    table.AddRow({profile.name, ReadableNumber(profile.estimate, 5),
                  interval(profile.linear_lower95, profile.linear_upper95),
                  interval(profile.lower95, profile.upper95),
                  interval(profile.lower99, profile.upper99), says});
  }
  return table;
}

TextTable MakeExplanationTable(const ReportInput& input) {
  TextTable table({{"", Align::kLeft},
                   {"explanation", Align::kLeft},
                   {"P", Align::kDecimal},
                   {"log10 odds", Align::kDecimal},
                   {"error removed %", Align::kDecimal},
                   {"moves most", Align::kLeft},
                   {"shift", Align::kDecimal}});
  int number = 0;
  for (const Explanation& explanation : input.summary->explanations) {
    table.AddRow({std::to_string(++number), explanation.what,
                  ReadableNumber(explanation.probability, 2),
                  ReadableNumber(explanation.log_odds / std::log(10.0), 3),
                  PercentText(explanation.removes), explanation.moved,
                  ReadableNumber(explanation.shift, 2)});
  }
  return table;
}

TextTable MakeAmbientTable(const ReportInput& input) {
  const std::vector<AmbientScore>& scores = input.summary->ambient;
  const bool measured =
      std::any_of(scores.begin(), scores.end(), [](const AmbientScore& score) {
        return score.by_measured_loads.size() > 0;
      });
  std::vector<TextTable::Column> columns = {{"record", Align::kLeft},
                                            {"channel", Align::kLeft},
                                            {"explained, %", Align::kDecimal}};
  if (measured) columns.push_back({"by measured loads, %", Align::kDecimal});
  for (const char* header : {"noise", "from, Hz", "to, Hz", "probability",
                             "knots", "evidence for more"}) {
    columns.push_back({header, Align::kDecimal});
  }
  TextTable table(std::move(columns));
  const double hz = input.problem->description.HzPerModelFrequency();
  for (const AmbientScore& score : scores) {
    for (size_t c = 0; c < score.channels.size(); ++c) {
      const Eigen::Index row = static_cast<Eigen::Index>(c);
      std::vector<std::string> cells = {
          c == 0 ? score.name : "", score.channels[c],
          ReadableNumber(100.0 * score.explained[row], 4)};
      if (measured) {
        cells.push_back(
            score.by_measured_loads.size() > 0
                ? ReadableNumber(100.0 * score.by_measured_loads[row], 4)
                : "-");
      }
      cells.push_back(ReadableNumber(score.noise_sigma[row], 3));
      for (const double value :
           {hz * score.lowest_frequency, hz * score.highest_frequency}) {
        cells.push_back(c == 0 ? ReadableNumber(value, 3) : "");
      }
      cells.push_back(c == 0 ? ReadableNumber(score.LeastProbability(), 2)
                             : "");
      cells.push_back(c == 0 ? std::to_string(score.num_knots) : "");
      const LoadEvidence& evidence = score.evidence;
      cells.push_back(
          c == 0 && evidence.finer_knots > 0
              ? ReadableNumber(evidence.finer_gain - evidence.finer_price, 3)
              : "");
      table.AddRow(std::move(cells));
    }
  }
  return table;
}

TextTable MakeFrfTable(const ReportInput& input) {
  TextTable table({{"functions", Align::kLeft},
                   {"pair", Align::kLeft},
                   {"initial error, %", Align::kDecimal},
                   {"error, %", Align::kDecimal},
                   {"unexplained, %", Align::kDecimal},
                   {"noise", Align::kDecimal},
                   {"from, Hz", Align::kDecimal},
                   {"to, Hz", Align::kDecimal},
                   {"lines", Align::kDecimal},
                   {"probability", Align::kDecimal}});
  const double hz = input.problem->description.HzPerModelFrequency();
  for (const FrfScore& score : input.summary->frfs) {
    for (size_t p = 0; p < score.pairs.size(); ++p) {
      const auto pair = static_cast<Eigen::Index>(p);
      const auto once = [p](const std::string& text) {
        return p == 0 ? text : std::string();
      };
      table.AddRow({once(score.name), score.pairs[p],
                    ReadableNumber(100.0 * score.prior_errors[pair], 4),
                    ReadableNumber(100.0 * score.errors[pair], 4),
                    ReadableNumber(100.0 * score.unexplained[pair], 3),
                    ReadableNumber(score.sigma[pair], 3),
                    once(ReadableNumber(hz * score.lowest_frequency, 4)),
                    once(ReadableNumber(hz * score.highest_frequency, 4)),
                    once(std::to_string(score.num_lines)),
                    once(ReadableNumber(score.probability, 2))});
    }
  }
  return table;
}

TextTable MakeRecordTable(const ReportInput& input) {
  TextTable table({{"record", Align::kLeft},
                   {"role", Align::kLeft},
                   {"error %", Align::kDecimal},
                   {"initial %", Align::kDecimal},
                   {"error / initial", Align::kDecimal},
                   {"", Align::kLeft}});
  for (const int i : HoldoutFirst(*input.summary)) {
    const RecordScore& record = input.summary->records[static_cast<size_t>(i)];
    std::string note;
    if (!record.finite) {
      note = "simulation not finite";
    } else if (record.first_scored_sample > 0) {
      const IdentificationRecord& data =
          input.problem->records.at(static_cast<size_t>(i));
      note =
          "scored from " +
          ReadableNumber(data.excitation->time(record.first_scored_sample), 3) +
          " " + input.problem->description.units.time;
    }
    table.AddRow({record.name, RoleName(record.role),
                  record.finite ? PercentText(record.nrmse) : "-",
                  PercentText(record.prior_nrmse),
                  record.finite
                      ? ReadableNumber(record.nrmse / record.prior_nrmse, 3)
                      : "-",
                  note});
  }
  return table;
}

TextTable MakeSensorTable(const ReportInput& input) {
  TextTable table({{"record", Align::kLeft},
                   {"sensor", Align::kLeft},
                   {"quantity", Align::kLeft},
                   {"at", Align::kLeft},
                   {"rmse", Align::kDecimal},
                   {"unit", Align::kLeft},
                   {"error %", Align::kDecimal},
                   {"initial %", Align::kDecimal},
                   {"noise %", Align::kDecimal},
                   {"in 95 % band", Align::kDecimal},
                   {"", Align::kLeft}});
  for (const int i : HoldoutFirst(*input.summary)) {
    const RecordScore& record = input.summary->records[static_cast<size_t>(i)];
    const IdentificationRecord& data =
        input.problem->records.at(static_cast<size_t>(i));
    for (size_t c = 0; c < record.channels.size(); ++c) {
      const ChannelScore& channel = record.channels[c];
      const MeasuredChannel& measured = data.channels.at(c);
      const int index = static_cast<int>(c);
      std::string quantity = QuantityName(measured.observation.quantity);
      for (char& letter : quantity) letter = letter == '_' ? ' ' : letter;
      table.AddRow(
          {record.name, channel.name, quantity, ChannelPlace(input, i, index),
           ReadableNumber(channel.rmse, 4),
           UnitText(ChannelUnit(input, i, index)), PercentText(channel.nrmse),
           PercentText(channel.prior_nrmse),
           PercentText(NoiseShare(input, i, index)),
           std::isfinite(channel.band_coverage)
               ? PercentText(channel.band_coverage)
               : "",
           measured.fit ? "" : "not fitted"});
    }
  }
  return table;
}

TextTable MakeStageTable(const ReportInput& input) {
  TextTable table({{"stage", Align::kDecimal},
                   {"longest segment, samples", Align::kDecimal},
                   {"segments", Align::kDecimal},
                   {"iterations", Align::kDecimal},
                   {"largest gap", Align::kDecimal},
                   {"simulation error %", Align::kDecimal},
                   {"", Align::kLeft}});
  int number = 0;
  for (const StageRecord& stage : input.summary->stages) {
    // Modes and ambient records have stages without a segment.
    if (stage.num_segments == 0) continue;
    table.AddRow(
        {std::to_string(++number), std::to_string(stage.segment_samples),
         std::to_string(stage.num_segments), std::to_string(stage.iterations),
         ReadableNumber(stage.largest_gap, 2),
         PercentText(stage.free_run_error),
         stage.rolled_back ? "rolled back" : ""});
  }
  return table;
}

TextTable MakeExplainedValueTable(const ReportInput& input) {
  const std::vector<Explanation>& all = input.summary->explanations;
  // Explanations that can be told from the best are not in it.
  size_t count = 0;
  while (count < all.size() &&
         all[count].log_odds > all[0].log_odds - limits::kLogOdds) {
    ++count;
  }
  std::vector<TextTable::Column> columns = {
      {"parameter", Align::kLeft}, {"model as it is", Align::kDecimal}};
  for (size_t e = 0; e < count; ++e) {
    columns.push_back(
        {"explanation " + std::to_string(e + 1), Align::kDecimal});
  }
  TextTable table(std::move(columns));
  if (count == 0) return table;
  const auto text = [](double value, double lower, double upper) {
    const EstimateText estimate =
        FormatEstimate(0.0, value, 0.5 * (upper - lower));
    return estimate.half_width.empty()
               ? estimate.value
               : estimate.value + " \u00b1 " + estimate.half_width;
  };
  for (const ExplainedValue& value : all[0].values) {
    std::vector<std::string> row = {value.name, ""};
    for (const ParameterEstimate& estimate : input.summary->parameters) {
      if (estimate.name == value.name) {
        row[1] = text(estimate.value, estimate.value - estimate.half_width95,
                      estimate.value + estimate.half_width95);
      }
    }
    for (size_t e = 0; e < count; ++e) {
      row.emplace_back();
      for (const ExplainedValue& one : all[e].values) {
        if (one.name == value.name) {
          row.back() = text(one.value, one.lower95, one.upper95);
        }
      }
    }
    table.AddRow(std::move(row));
  }
  return table;
}

std::string ConsoleReport(const ReportInput& input) {
  std::string text = VerdictSentence(input) + "\n";
  for (const std::string& direction : input.summary->undetermined) {
    text += "Not determined by these records: " + direction + ".\n";
  }
  for (const std::string& remark : input.summary->remarks) {
    text += remark + "\n";
  }
  for (const std::string& remark : input.problem->description.remarks) {
    text += remark + "\n";
  }
  const auto add = [&](const std::string& heading, const TextTable& table) {
    if (!table.empty()) text += "\n" + heading + "\n" + table.ToText();
  };
  add("Error of the simulation (free run)", MakeRecordTable(input));
  add("Parameters", MakeParameterTable(input));
  add("What the model may lack", MakeExplanationTable(input));
  add("Parameters under these explanations", MakeExplainedValueTable(input));
  add("Profiles", MakeProfileTable(input));
  add("Measured modes", MakeMeasuredModeTable(input));
  add("Ambient records", MakeAmbientTable(input));
  add("Frequency response functions", MakeFrfTable(input));
  add("Modes", MakeModeTable(input));
  add("Sensors", MakeSensorTable(input));
  return text;
}

}  // namespace pinode
