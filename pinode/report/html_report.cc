#include "pinode/report/html_report.h"

#include <algorithm>
#include <cmath>
#include <kainjow/mustache.hpp>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/parallel_for.h"
#include "pinode/base/strings.h"
#include "pinode/report/console.h"
#include "pinode/report/figure.h"
#include "pinode/report/number_text.h"
#include "pinode/report/restoring_force.h"

namespace pinode {
namespace {

using Align = TextTable::Align;

#include "pinode/report/html_template.inc"

namespace mustache = kainjow::mustache;
using Data = mustache::data;
using Role = IdentificationRecord::Role;

// From where two estimates count as one: beyond, a change of one is undone by
// the other nearly without trace in the records.
constexpr double kStrongCorrelation = 0.95;
constexpr size_t kMaxCorrelations = 12;

// Figures in the order of the page, drawn several at a time.
class Gallery {
 public:
  // Index for DataOf(), -1 for an empty figure.
  int Add(Figure figure) {
    if (figure.empty()) return -1;
    pictures_.push_back({std::move(figure), "", ""});
    return static_cast<int>(pictures_.size()) - 1;
  }

  void Draw(const HtmlReportOptions& options) {
    ParallelFor(static_cast<int>(pictures_.size()),
                std::max(options.num_threads, 1), [&](int index, int) {
                  Picture& picture = pictures_[static_cast<size_t>(index)];
                  if (!DrawFigure(picture.figure, options.gnuplot, &picture.svg,
                                  &picture.error)) {
                    picture.svg.clear();
                  }
                });
  }

  Data DataOf(int index) const {
    const Picture& picture = pictures_[static_cast<size_t>(index)];
    Data data;
    data.set("caption", picture.figure.caption);
    data.set("half", picture.figure.half_width);
    data.set("drawn", !picture.svg.empty());
    data.set("svg", picture.svg);
    data.set("error", picture.error);
    return data;
  }

 private:
  struct Picture {
    Figure figure;
    std::string svg;
    std::string error;
  };
  std::vector<Picture> pictures_;
};

// A section is there, or not.
void SetIf(const std::string& name, bool present, Data value, Data* page) {
  page->set(name, present ? std::move(value) : Data(false));
}

Data List() { return Data(Data::type::list); }

Data Text(const std::string& text) {
  Data data;
  data.set("text", text);
  return data;
}

// strong: rows to be printed bold.
Data TableData(const TextTable& table, const std::vector<bool>& strong = {}) {
  Data columns = List();
  for (const TextTable::Column& column : table.columns()) {
    Data header;
    header.set("header", column.header);
    header.set("number", column.align == Align::kDecimal);
    columns.push_back(header);
  }
  Data rows = List();
  const auto aligned = table.AlignedRows();
  for (size_t r = 0; r < aligned.size(); ++r) {
    Data cells = List();
    for (size_t c = 0; c < aligned[r].size(); ++c) {
      Data cell = Text(aligned[r][c]);
      cell.set("number", table.columns()[c].align == Align::kDecimal);
      cells.push_back(cell);
    }
    Data row;
    row.set("cells", cells);
    row.set("strong", r < strong.size() && strong[r]);
    rows.push_back(row);
  }
  Data data;
  data.set("columns", columns);
  data.set("rows", rows);
  return data;
}

std::string Joined(const std::vector<std::string>& texts) {
  std::string result;
  for (const std::string& text : texts) {
    result += (result.empty() ? "" : ", ") + text;
  }
  return result;
}

std::string CovarianceSentence(const std::string& method) {
  if (method == "plain") {
    return "plain: inverse of the Gauss-Newton Hessian. It takes the residuals "
           "as independent from sample to sample.";
  }
  if (method == "sandwich") {
    return "block sandwich: residuals close in time are correlated, and the "
           "intervals allow for it.";
  }
  if (method == "inflated") {
    return "inflated: residuals close in time are correlated, and the "
           "intervals are as if a sample came once per autocorrelation time.";
  }
  if (method == "input noise") {
    return "input noise: the noise of the measured excitation is carried "
           "through the model into the intervals, beside that of the sensors.";
  }
  if (method == "errors in variables") {
    return "errors in variables: the errors of the measured excitation are "
           "unknowns of the fit, within the noise that the case gives it.";
  }
  return method;
}

const char* TerminationSentence(Termination termination) {
  switch (termination) {
    case Termination::kFailure:
      return "failed";
    case Termination::kConverged:
      return "converged";
    case Termination::kNoConvergence:
      return "not converged";
    case Termination::kInterrupted:
      return "interrupted; the best so far is reported";
  }
  return "";
}

std::string StartText(const IdentificationRecord& record) {
  switch (record.start) {
    case IdentificationRecord::Start::kRest:
      return "at rest";
    case IdentificationRecord::Start::kKnown:
      return "known";
    case IdentificationRecord::Start::kFree:
      return "estimated";
  }
  return "";
}

// How each record entered the fit.
TextTable MakeDataTable(const ReportInput& input) {
  const std::string& time = input.units.time;
  TextTable table({{"record", Align::kLeft},
                   {"samples", Align::kDecimal},
                   {"step, " + time, Align::kDecimal},
                   {"length, " + time, Align::kDecimal},
                   {"substeps", Align::kDecimal},
                   {"excitation between samples", Align::kLeft},
                   {"start", Align::kLeft},
                   {"filter", Align::kLeft}});
  for (const IdentificationRecord& record : input.problem->records) {
    if (!record.excitation.has_value()) continue;
    const Excitation& excitation = *record.excitation;
    table.AddRow(
        {record.name, std::to_string(record.num_samples()),
         FormatNumber(record.sampling_step(), 6),
         ReadableNumber((record.num_samples() - 1) * record.sampling_step(), 4),
         std::to_string(record.substeps),
         excitation.num_inputs() == 0
             ? "none"
             : InterpolationName(excitation.interpolation()),
         StartText(record), record.filter != nullptr ? "zero-phase" : "none"});
  }
  return table;
}

// Pairs of parameters that the data hardly tell apart.
std::vector<std::string> StrongCorrelations(
    const IdentificationSummary& summary) {
  const Matrix& covariance = summary.covariance;
  const Eigen::Index size = covariance.rows();
  std::vector<std::pair<double, std::string>> found;
  if (covariance.cols() != size ||
      static_cast<size_t>(size) != summary.covariance_names.size()) {
    return {};
  }
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double correlation =
          covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j));
      if (!(std::abs(correlation) >= kStrongCorrelation)) continue;
      found.emplace_back(
          -std::abs(correlation),
          summary.covariance_names[static_cast<size_t>(j)] + " and " +
              summary.covariance_names[static_cast<size_t>(i)] +
              " are known together much better than each by itself "
              "(correlation " +
              ReadableNumber(correlation, 3) + ").");
    }
  }
  std::sort(found.begin(), found.end());
  if (found.size() > kMaxCorrelations) found.resize(kMaxCorrelations);
  std::vector<std::string> sentences;
  for (const auto& entry : found) sentences.push_back(entry.second);
  return sentences;
}

// Indices of the records' channels to be drawn, those with the largest errors
// if there are too many, in the record's order.
std::vector<int> ChannelsToDraw(const RecordScore& score, int count,
                                int limit) {
  std::vector<int> channels(static_cast<size_t>(count));
  for (int c = 0; c < count; ++c) channels[static_cast<size_t>(c)] = c;
  const auto error = [&](int c) {
    const size_t index = static_cast<size_t>(c);
    const double nrmse =
        index < score.channels.size() ? score.channels[index].nrmse : 0.0;
    // What is not a number is worst.
    return std::isfinite(nrmse) ? nrmse : kInfinity;
  };
  std::stable_sort(channels.begin(), channels.end(),
                   [&](int a, int b) { return error(a) > error(b); });
  if (count > limit) channels.resize(static_cast<size_t>(std::max(limit, 0)));
  std::sort(channels.begin(), channels.end());
  return channels;
}

// Everything that the page shows, section by section.
class PageMaker {
 public:
  PageMaker(const ReportInput& input, const HtmlReportOptions& options)
      : input_(input), summary_(*input.summary), options_(options) {}

  Data Make() {
    PlanFigures();
    gallery_.Draw(options_);
    AddHead();
    AddDamage();
    AddScores();
    AddEquations();
    AddParameters();
    AddForces();
    AddModes();
    AddHistories();
    AddLoops();
    AddSolution();
    AddLimits();
    AddRemarks();
    return page_;
  }

 private:
  struct History {
    int record;
    std::vector<int> figures;
    int num_left_out;
  };

  void PlanFigures() {
    if (input_.damage.has_value()) {
      change_figure_ = gallery_.Add(MakeChangeFigure(*input_.damage));
    }
    parameter_figure_ = gallery_.Add(MakeParameterFigure(input_));
    for (size_t f = 0; f < summary_.forces.size(); ++f) {
      const int figure =
          gallery_.Add(MakeForceFigure(input_, static_cast<int>(f)));
      if (figure >= 0) force_figures_.push_back(figure);
    }
    mode_figure_ = gallery_.Add(MakeModeShapeFigure(input_));
    convergence_figure_ = gallery_.Add(MakeConvergenceFigure(input_));
    for (const Role role : {Role::kHoldout, Role::kTrain}) {
      for (size_t r = 0; r < summary_.records.size(); ++r) {
        const IdentificationRecord& record = input_.problem->records.at(r);
        if (record.role != role) continue;
        const int count = static_cast<int>(record.channels.size());
        const std::vector<int> channels = ChannelsToDraw(
            summary_.records[r], count, options_.max_channels_per_record);
        History history = {static_cast<int>(r), {}, 0};
        for (const int channel : channels) {
          const int figure = gallery_.Add(
              MakeChannelFigure(input_, static_cast<int>(r), channel));
          if (figure >= 0) history.figures.push_back(figure);
        }
        if (history.figures.empty()) continue;
        history.num_left_out = count - static_cast<int>(channels.size());
        histories_.push_back(history);
      }
    }
    const std::vector<RestoringForceLoop> loops =
        ComputeRestoringForceLoops(input_);
    for (size_t i = 0; i < loops.size(); ++i) {
      if (static_cast<int>(loop_figures_.size()) >= options_.max_loops) {
        ++loops_left_out_;
        continue;
      }
      const int figure =
          gallery_.Add(MakeLoopFigure(input_, loops[i], static_cast<int>(i)));
      if (figure >= 0) loop_figures_.push_back(figure);
    }
    for (size_t e = 0; e < input_.equations.size(); ++e) {
      const int number = static_cast<int>(e);
      std::vector<int> figures;
      for (const int figure :
           {gallery_.Add(MakeEquationFigure(input_.equations[e], number)),
            gallery_.Add(MakeParetoFigure(input_.equations[e], number))}) {
        if (figure >= 0) figures.push_back(figure);
      }
      equation_figures_.push_back(figures);
    }
  }

  void SetFigure(const std::string& name, int index) {
    SetIf(name, index >= 0, index >= 0 ? gallery_.DataOf(index) : Data(),
          &page_);
  }

  Data FigureList(const std::vector<int>& indices) const {
    Data list = List();
    for (const int index : indices) list.push_back(gallery_.DataOf(index));
    return list;
  }

  void SetList(const std::string& name, const std::vector<std::string>& texts) {
    Data list = List();
    for (const std::string& text : texts) list.push_back(Text(text));
    page_.set(name, list);
    page_.set("has_" + name, !texts.empty());
  }

  // Neither a title nor a path is certain to be there.
  void AddHead() {
    page_.set("title", input_.title.empty() ? "Identification" : input_.title);
    page_.set(
        "source",
        "Identification by pinode " + input_.version +
            (input_.case_path.empty() ? "" : ", case " + input_.case_path));
    page_.set("usable", summary_.usable);
    page_.set("verdict", Verdict(input_));
    page_.set("command", input_.command_line);
    page_.set("footer", "pinode " + input_.version + ", " +
                            Duration(input_.wall_seconds) + " in all.");
  }

  void AddDamage() {
    if (!input_.damage.has_value()) {
      page_.set("damage", Data(false));
      return;
    }
    const ReportDamage& damage = *input_.damage;
    Data data;
    data.set("sentence", damage.sentence);
    data.set("alarm", damage.alarm);
    std::vector<bool> strong;
    for (const ReportDamage::Change& change : damage.changes) {
      strong.push_back(change.changed);
    }
    data.set("changes", TableData(MakeChangeTable(damage), strong));
    SetIf("change_figure", change_figure_ >= 0,
          change_figure_ >= 0 ? gallery_.DataOf(change_figure_) : Data(),
          &data);
    std::string text = "Compared with " + Joined(damage.baselines) + ". ";
    text += damage.places.empty() ? "No other kind of change was looked for."
                                  : "Other kinds of change were looked for: " +
                                        Joined(damage.places) + ".";
    data.set("text", text);
    Data remarks = List();
    for (const std::string& remark : damage.remarks) {
      remarks.push_back(Text(remark));
    }
    data.set("has_remarks", !damage.remarks.empty());
    data.set("remarks", remarks);
    page_.set("damage", data);
  }

  void AddScores() {
    const TextTable records = MakeRecordTable(input_);
    page_.set("scores", !records.empty());
    if (records.empty()) return;
    std::vector<bool> strong;
    for (const RecordScore& record : summary_.records) {
      if (record.role == Role::kHoldout) strong.push_back(true);
    }
    page_.set("holdout_note",
              strong.empty() ? "No record was held out."
                             : "Hold-out records took no part in any choice.");
    page_.set("record_table", TableData(records, strong));
    page_.set("sensor_table", TableData(MakeSensorTable(input_)));
  }

  void AddParameters() {
    const TextTable table = MakeParameterTable(input_);
    SetIf("parameters", !table.empty(), TableData(table), &page_);
    const std::string& method = summary_.covariance_method;
    page_.set("interval_note",
              method.empty() ? Data(false)
                             : Data("Intervals hold the true value with 95 % "
                                    "probability if the model can be true at "
                                    "all. Covariance, " +
                                    CovarianceSentence(method)));
    SetFigure("parameter_figure", parameter_figure_);

    Data networks = List();
    for (const NetworkTerm& term : input_.problem->dynamics->networks()) {
      const NetworkArchitecture& architecture = term.network->architecture();
      std::string text =
          "Network " + term.name + ": " + Count(term.weights.size(), "weight");
      if (architecture.gauge) {
        text +=
            ", without value and slope at rest: stiffness and damping groups "
            "over the same inputs mean the tangent at rest";
      }
      networks.push_back(Text(text + "."));
    }
    const bool has_networks = !input_.problem->dynamics->networks().empty();
    if (has_networks && summary_.effective_parameters > 0.0) {
      networks.push_back(
          Text("The data determine about " +
               ReadableNumber(summary_.effective_parameters, 3) +
               " parameters in all, weights included; weight decay holds the "
               "others."));
    }
    page_.set("networks", networks);
  }

  void AddEquations() {
    Data equations = List();
    for (size_t e = 0; e < input_.equations.size(); ++e) {
      const ReportEquation& equation = input_.equations[e];
      bool any_probability = false;
      for (const ReportEquation::Term& term : equation.terms) {
        any_probability =
            any_probability || std::isfinite(term.inclusion_probability);
      }
      std::vector<TextTable::Column> columns = {
          {"term", Align::kLeft},
          {"coefficient", Align::kDecimal},
          {"95 %, \u00b1", Align::kDecimal},
          {"regressed", Align::kDecimal}};
      if (any_probability) {
        columns.push_back({"inclusion probability", Align::kDecimal});
      }
      columns.push_back({"unit", Align::kLeft});
      TextTable table(std::move(columns));
      const auto number = [](double value, int digits) {
        return std::isfinite(value) ? ReadableNumber(value, digits)
                                    : std::string("-");
      };
      for (const ReportEquation::Term& term : equation.terms) {
        std::vector<std::string> row = {
            term.basis, number(term.coefficient, 5),
            number(0.5 * (term.upper95 - term.lower95), 2),
            number(term.regressed, 5)};
        if (any_probability) {
          row.push_back(number(term.inclusion_probability, 2));
        }
        row.push_back(UnitText(term.unit));
        table.AddRow(std::move(row));
      }
      Data data;
      data.set("name", equation.output);
      data.set("text", equation.terms.empty()
                           ? "No term in place of " + equation.source + "."
                           : "In place of " + equation.source + ", of " +
                                 Count(equation.num_candidates, "candidate") +
                                 ":");
      SetIf("terms", !table.empty(), TableData(table), &data);
      data.set("figures", FigureList(equation_figures_[e]));
      equations.push_back(data);
    }
    page_.set("has_equations", !input_.equations.empty());
    page_.set("equations", equations);
  }

  void AddForces() {
    page_.set("has_forces", !force_figures_.empty());
    page_.set("forces", FigureList(force_figures_));
  }

  void AddModes() {
    const TextTable measured = MakeMeasuredModeTable(input_);
    SetIf("measured_modes", !measured.empty(), TableData(measured), &page_);
    const TextTable table = MakeModeTable(input_);
    SetIf("modes", !table.empty(), TableData(table), &page_);
    SetFigure("mode_figure", mode_figure_);
  }

  void AddHistories() {
    Data histories = List();
    for (const History& history : histories_) {
      const IdentificationRecord& record =
          input_.problem->records[static_cast<size_t>(history.record)];
      Data data;
      data.set("name", record.name);
      data.set("role", record.role == Role::kHoldout ? "held out"
                                                     : "used for training");
      data.set("figures", FigureList(history.figures));
      const bool all = history.num_left_out == 0;
      data.set("left_out",
               all ? Data(false)
                   : Data("The " + Count(history.num_left_out, "channel") +
                          " with smaller errors are not drawn; the table of "
                          "sensors has their scores."));
      histories.push_back(data);
    }
    page_.set("histories", histories);
    page_.set("has_histories", !histories_.empty());
  }

  void AddLoops() {
    page_.set("has_loops", !loop_figures_.empty());
    page_.set("loops", FigureList(loop_figures_));
    page_.set(
        "loops_left_out",
        loops_left_out_ == 0
            ? Data(false)
            : Data("Not drawn: " + Count(loops_left_out_, "more term") + "."));
  }

  void AddFact(const std::string& name, const std::string& text, Data* facts) {
    Data fact = Text(text);
    fact.set("name", name);
    facts->push_back(fact);
  }

  void AddSolution() {
    Data facts = List();
    AddFact("Outcome",
            std::string(TerminationSentence(summary_.termination)) +
                (summary_.message.empty() || summary_.message == "converged"
                     ? ""
                     : " (" + summary_.message + ")"),
            &facts);
    std::string iterations = Count(summary_.num_iterations, "iteration");
    if (summary_.rejected_steps > 0) {
      iterations += ", " + Count(summary_.rejected_steps, "rejected step");
    }
    if (summary_.failed_evaluations > 0) {
      iterations += ", " + Count(summary_.failed_evaluations, "trajectory") +
                    " that did not stay finite and was stepped back from";
    }
    AddFact("Levenberg-Marquardt", iterations, &facts);
    AddFact("Cost",
            ReadableNumber(summary_.initial_cost, 5) + " \u2192 " +
                ReadableNumber(summary_.final_cost, 5),
            &facts);
    if (summary_.num_starts > 1) {
      AddFact("Starts",
              std::to_string(summary_.num_starts_at_best) + " of " +
                  std::to_string(summary_.num_starts) +
                  " reached the lowest cost",
              &facts);
    }
    AddFact("Time",
            Duration(summary_.seconds) + ", of it derivatives " +
                Duration(summary_.jacobian_seconds) + ", linear solver " +
                Duration(summary_.linear_solver_seconds),
            &facts);
    if (!summary_.stages.empty()) {
      AddFact("Shooting",
              summary_.records.empty() ? "no records, measured modes alone"
              : summary_.single_shooting
                  ? "the last stage was a free run over each whole record"
                  : "the records stay cut into segments: the free run over "
                    "the whole record was not stable or not better",
              &facts);
      if (summary_.largest_gap > 0.0) {
        AddFact("Largest gap between segments",
                ReadableNumber(summary_.largest_gap, 2) +
                    " of the state's root mean square",
                &facts);
      }
    }
    if (!summary_.covariance_method.empty()) {
      AddFact("Covariance", CovarianceSentence(summary_.covariance_method),
              &facts);
    }
    page_.set("facts", facts);
    const TextTable data = MakeDataTable(input_);
    SetIf("data_table", !data.empty(), TableData(data), &page_);
    const TextTable stages = MakeStageTable(input_);
    SetIf("stage_table", !stages.empty(), TableData(stages), &page_);
    SetFigure("convergence_figure", convergence_figure_);
  }

  void AddLimits() {
    std::vector<std::string> limits;
    for (const std::string& direction : summary_.undetermined) {
      limits.push_back("Not determined by these records: " + direction + ".");
    }
    for (const ParameterEstimate& parameter : summary_.parameters) {
      if (parameter.free && parameter.at_bound) {
        limits.push_back(parameter.name +
                         " stopped at its bound: its interval means nothing, "
                         "and the bound or the model should be questioned.");
      }
    }
    for (const std::string& sentence : StrongCorrelations(summary_)) {
      limits.push_back(sentence);
    }
    std::string text;
    if (summary_.covariance_method.empty()) {
      text =
          "There is no covariance, so nothing is known about what the data "
          "determine.";
    } else if (limits.empty()) {
      text =
          "The records determine every free named parameter, and no two of "
          "them are correlated by " +
          ReadableNumber(kStrongCorrelation, 2) + " or more.";
    }
    page_.set("limits_text", text.empty() ? Data(false) : Data(text));
    SetList("limits", limits);
  }

  void AddRemarks() { SetList("remarks", input_.remarks); }

  const ReportInput& input_;
  const IdentificationSummary& summary_;
  const HtmlReportOptions& options_;
  Gallery gallery_;
  int change_figure_ = -1;
  int parameter_figure_ = -1;
  std::vector<int> force_figures_;
  int mode_figure_ = -1;
  int convergence_figure_ = -1;
  std::vector<History> histories_;
  std::vector<int> loop_figures_;
  int loops_left_out_ = 0;
  std::vector<std::vector<int>> equation_figures_;  // per equation
  Data page_;
};

Data Partial(const char* text) {
  return Data(mustache::partial([text] { return std::string(text); }));
}

}  // namespace

std::string RenderHtmlReport(const ReportInput& input,
                             const HtmlReportOptions& options) {
  CHECK(input.problem != nullptr && input.problem->dynamics != nullptr)
      << "a report needs the problem and its dynamics";
  CHECK(input.summary != nullptr) << "a report needs the summary";
  CHECK_LE(input.summary->records.size(), input.problem->records.size())
      << "the summary is of another problem";
  Data page = PageMaker(input, options).Make();
  page.set("table", Partial(kTablePartial));
  page.set("figure", Partial(kFigurePartial));
  mustache::mustache view(kPageTemplate);
  CHECK(view.is_valid()) << view.error_message();
  return view.render(page);
}

bool WriteHtmlReport(const ReportInput& input, const HtmlReportOptions& options,
                     const std::string& path, std::string* error) {
  return WriteFileAtomically(path, RenderHtmlReport(input, options), error);
}

}  // namespace pinode
