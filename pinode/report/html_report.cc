#include "pinode/report/html_report.h"

#include <cmath>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/problem/record_grid.h"
#include "pinode/report/console.h"
#include "pinode/report/figure.h"
#include "pinode/report/fit_text.h"
#include "pinode/report/mode_tables.h"
#include "pinode/report/number_text.h"
#include "pinode/report/page_data.h"
#include "pinode/report/report_figures.h"
#include "pinode/report/structure_view.h"

namespace pinode {
namespace {

using Align = TextTable::Align;

#include "pinode/report/html_template.inc"

using Data = PageData;
using Role = IdentificationRecord::Role;

std::string StartText(const IdentificationRecord& record) {
  switch (record.start) {
    case IdentificationRecord::Start::kRest:
      return "at rest";
    case IdentificationRecord::Start::kKnown:
      return record.start_samples > 0
                 ? "from the first " + std::to_string(record.start_samples) +
                       " samples"
                 : "known";
    case IdentificationRecord::Start::kFree:
      return record.excitation->periodic() &&
                     record.role == IdentificationRecord::Role::kHoldout
                 ? "steady state"
                 : "estimated";
  }
  return "";
}

std::string IntegrationText(const StructuralDynamics& dynamics,
                            const IdentificationRecord& record) {
  switch (IntegratorOf(dynamics, record)) {
    case Integrator::kExact:
      return "exact";
    case Integrator::kExponential:
      return "exponential, " + std::to_string(record.exponential_steps) +
             " steps";
    case Integrator::kRungeKutta:
      break;
  }
  return "RK4, " + std::to_string(record.substeps) + " steps";
}

// Makes a table of the records' roles in the fit.
TextTable MakeDataTable(const ReportInput& input) {
  const std::string& time = input.problem->description.units.time;
  TextTable table({{"record", Align::kLeft},
                   {"samples", Align::kDecimal},
                   {"step, " + time, Align::kDecimal},
                   {"length, " + time, Align::kDecimal},
                   {"integration", Align::kLeft},
                   {"excitation between samples", Align::kLeft},
                   {"start", Align::kLeft},
                   {"filter", Align::kLeft}});
  for (const IdentificationRecord& record : input.problem->records) {
    if (!record.excitation.has_value()) continue;
    const Excitation& excitation = *record.excitation;
    table.AddRow(
        {record.name, std::to_string(record.num_samples()),
         FormatNumber(record.sampling_step(), 6),
         ReadableNumber(static_cast<double>(record.num_samples() - 1) *
                            record.sampling_step(),
                        4),
         IntegrationText(*input.problem->dynamics, record),
         excitation.num_inputs() == 0
             ? "none"
             : InterpolationName(excitation.interpolation()) +
                   std::string(excitation.periodic() ? ", periodic" : ""),
         StartText(record), record.filter != nullptr ? "zero-phase" : "none"});
  }
  return table;
}

const std::vector<DiscoveredEquation>& EquationsOf(const ReportInput& input) {
  static const auto& none = *new std::vector<DiscoveredEquation>;
  return input.equations != nullptr ? *input.equations : none;
}

// Makes all parts of the page, section by section.
class PageMaker {
 public:
  PageMaker(const ReportInput& input, const HtmlReportOptions& options)
      : input_(input),
        summary_(*input.summary),
        options_(options),
        equations_(EquationsOf(input)),
        figures_(PlanFigures(input, options)) {}

  Data Make() {
    DrawFigures(options_, &figures_);
    AddHead();
    AddDamage();
    AddStructure();
    AddEquations();
    AddForces();
    AddParameters();
    AddProfiles();
    AddScores();
    AddModes();
    AddHistories();
    AddLoops();
    AddSolution();
    AddLimits();
    AddRemarks();
    return page_;
  }

 private:
  Data FigureData(int index) const {
    return PictureData(figures_.pictures[static_cast<size_t>(index)]);
  }

  void SetFigure(const std::string& name, int index) {
    SetIf(name, index >= 0, index >= 0 ? FigureData(index) : Data(), &page_);
  }

  Data FigureList(const std::vector<int>& indices) const {
    Data list = PageList();
    for (const int index : indices) list.push_back(FigureData(index));
    return list;
  }

  void SetList(const std::string& name, const std::vector<std::string>& texts) {
    page_.set(name, PageTexts(texts));
    page_.set("has_" + name, !texts.empty());
  }

  // Title and path may both be missing.
  void AddHead() {
    const ReportOrigin& origin = input_.origin;
    const std::string& title = input_.problem->description.title;
    page_.set("title", title.empty() ? "Identification" : title);
    page_.set(
        "source",
        "Identification by pinode " + input_.version +
            (origin.case_path.empty() ? "" : ", case " + origin.case_path));
    page_.set("usable", summary_.usable());
    page_.set("verdict", VerdictSentence(input_));
    SetIf("command", !origin.command_line.empty(), origin.command_line, &page_);
    page_.set("footer", "pinode " + input_.version + ", " +
                            Duration(origin.wall_seconds) + " in all.");
  }

  void AddStructure() {
    Data data;
    if (input_.structure != nullptr) {
      data.set("html", StructureSection(*input_.structure));
    }
    SetIf("structure", input_.structure != nullptr, data, &page_);
  }

  void AddDamage() {
    if (input_.damage == nullptr) {
      page_.set("damage", Data(false));
      return;
    }
    const DamageResult& damage = *input_.damage;
    Data data;
    data.set("sentence", damage.judgement.sentence);
    data.set("alarm", damage.judgement.verdict != DamageVerdict::kNoDamage);
    std::vector<bool> strong;
    for (const size_t j : ShownChanges(damage)) {
      strong.push_back(damage.estimate.groups[j].changed);
    }
    data.set("changes", TableData(MakeChangeTable(damage), strong));
    const TextTable explanations = MakeChangeExplanationTable(damage);
    SetIf("explained", !explanations.empty(), TableData(explanations), &data);
    SetIf("change_figure", figures_.changes >= 0,
          figures_.changes >= 0 ? FigureData(figures_.changes) : Data(), &data);
    std::string text = "Compared with " + Join(damage.baselines, ", ") + ". ";
    text += damage.places.empty() ? "No other kind of change was looked for."
                                  : "Other kinds of change were looked for: " +
                                        Join(damage.places, ", ") + ".";
    data.set("text", text);
    data.set("has_remarks", !damage.remarks.empty());
    data.set("remarks", PageTexts(damage.remarks));
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
                             : Data("95 % intervals, valid if the form of the "
                                    "model is right. Covariance, " +
                                    CovarianceSentence(method)));
    SetFigure("parameter_figure", figures_.parameters);

    Data networks = PageList();
    for (const NetworkTerm& term : input_.problem->dynamics->networks()) {
      const NetworkArchitecture& architecture = term.network->architecture();
      std::string text =
          "Network " + term.name + ": " + Count(term.weights.size(), "weight");
      if (architecture.gauge) {
        text +=
            ". Its value and slope at rest are zero: stiffness and damping "
            "groups over the same inputs are the tangent at rest";
      }
      networks.push_back(PageText(text + "."));
    }
    for (const LawTerm& term : input_.problem->dynamics->laws()) {
      if (AsMemoryNetwork(term) == nullptr) continue;
      networks.push_back(PageText("Network with memory " + term.name + ": " +
                                  Count(term.parameters.size(), "weight") +
                                  "."));
    }
    const bool has_networks = !input_.problem->dynamics->networks().empty();
    if (has_networks && summary_.effective_parameters > 0.0) {
      networks.push_back(PageText(
          "The data determine about " +
          ReadableNumber(summary_.effective_parameters, 3) +
          " parameters, weights included. Weight decay holds the others."));
    }
    page_.set("networks", networks);
  }

  void AddEquations() {
    Data equations = PageList();
    for (size_t e = 0; e < equations_.size(); ++e) {
      const DiscoveredEquation& equation = equations_[e];
      bool compared = false;
      bool any_probability = false;
      for (const DiscoveredTerm& term : equation.terms) {
        any_probability =
            any_probability || std::isfinite(term.inclusion_probability);
        compared = compared || std::isfinite(term.probability);
      }
      std::vector<TextTable::Column> columns = {
          {"term", Align::kLeft},
          {"coefficient", Align::kDecimal},
          {"95 %, \u00b1", Align::kDecimal},
          {"regressed", Align::kDecimal}};
      if (compared) columns.push_back({"probability", Align::kDecimal});
      if (any_probability) {
        columns.push_back({"inclusion probability", Align::kDecimal});
      }
      columns.push_back({"unit", Align::kLeft});
      TextTable table(std::move(columns));
      const auto number = [](double value, int digits) {
        return std::isfinite(value) ? ReadableNumber(value, digits)
                                    : std::string("-");
      };
      for (const DiscoveredTerm& term : equation.terms) {
        std::vector<std::string> row = {
            term.basis, number(term.coefficient, 5),
            number(0.5 * (term.upper95 - term.lower95), 2),
            number(term.regressed, 5)};
        if (compared) row.push_back(number(term.probability, 2));
        if (any_probability) {
          row.push_back(number(term.inclusion_probability, 2));
        }
        row.push_back(UnitText(term.unit));
        table.AddRow(std::move(row));
      }
      Data data;
      data.set("name", equation.output);
      data.set("text", equation.terms.empty()
                           ? "No term replaces " + SourceOf(equation) + "."
                           : "These terms, chosen from " +
                                 Count(equation.num_candidates, "candidate") +
                                 ", replace " + SourceOf(equation) + ":");
      SetIf("terms", !table.empty(), TableData(table), &data);
      data.set("figures", FigureList(figures_.equations[e]));
      equations.push_back(data);
    }
    page_.set("has_equations", !equations_.empty());
    page_.set("equations", equations);
  }

  void AddForces() {
    page_.set("has_forces", !figures_.forces.empty());
    page_.set("forces", FigureList(figures_.forces));
  }

  void AddProfiles() {
    const TextTable table = MakeProfileTable(input_);
    SetIf("profiles", !table.empty(), TableData(table), &page_);
    const TextTable explanations = MakeExplanationTable(input_);
    SetIf("explanations", !explanations.empty(), TableData(explanations),
          &page_);
    const TextTable values = MakeExplainedValueTable(input_);
    SetIf("explained_values", !values.empty(), TableData(values), &page_);
    page_.set("profile_figures", FigureList(figures_.profiles));
  }

  void AddModes() {
    const TextTable ambient = MakeAmbientTable(input_);
    SetIf("ambient", !ambient.empty(), TableData(ambient), &page_);
    page_.set("ambient_figures", FigureList(figures_.ambient));
    const TextTable frfs = MakeFrfTable(input_);
    SetIf("frfs", !frfs.empty(), TableData(frfs), &page_);
    page_.set("frf_figures", FigureList(figures_.frfs));
    const TextTable measured = MakeMeasuredModeTable(input_);
    SetIf("measured_modes", !measured.empty(), TableData(measured), &page_);
    const TextTable table = MakeModeTable(input_);
    SetIf("modes", !table.empty(), TableData(table), &page_);
    SetFigure("mode_figure", figures_.modes);
    const TextTable masses = MakeModalMassTable(input_);
    SetIf("modal_masses", !masses.empty(), TableData(masses), &page_);
  }

  void AddHistories() {
    Data histories = PageList();
    for (const ReportFigures::History& history : figures_.histories) {
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
                          " with smaller errors are not drawn. The table of "
                          "sensors has their errors."));
      histories.push_back(data);
    }
    page_.set("histories", histories);
    page_.set("has_histories", !figures_.histories.empty());
  }

  void AddLoops() {
    page_.set("has_loops", !figures_.loops.empty());
    page_.set("loops", FigureList(figures_.loops));
    page_.set(
        "loops_left_out",
        figures_.num_loops_left_out == 0
            ? Data(false)
            : Data("Not drawn: " +
                   Count(figures_.num_loops_left_out, "more term") + "."));
  }

  void AddSolution() {
    Data facts = PageList();
    for (const auto& [name, text] : SolutionFacts(summary_)) {
      Data fact = PageText(text);
      fact.set("name", name);
      facts.push_back(fact);
    }
    page_.set("facts", facts);
    const TextTable data = MakeDataTable(input_);
    SetIf("data_table", !data.empty(), TableData(data), &page_);
    const TextTable stages = MakeStageTable(input_);
    SetIf("stage_table", !stages.empty(), TableData(stages), &page_);
    SetFigure("convergence_figure", figures_.convergence);
  }

  void AddLimits() {
    const std::string text = NoLimitsSentence(summary_);
    page_.set("limits_text", text.empty() ? Data(false) : Data(text));
    SetList("limits", Limits(summary_));
  }

  void AddRemarks() { SetList("remarks", RemarksOf(input_)); }

  const ReportInput& input_;
  const IdentificationSummary& summary_;
  const HtmlReportOptions& options_;
  const std::vector<DiscoveredEquation>& equations_;
  ReportFigures figures_;
  Data page_;
};

}  // namespace

std::string RenderHtmlReport(const ReportInput& input,
                             const HtmlReportOptions& options) {
  CHECK(input.problem != nullptr && input.problem->dynamics != nullptr)
      << "a report needs the problem and its dynamics";
  CHECK(input.summary != nullptr) << "a report needs the summary";
  CHECK_LE(input.summary->records.size(), input.problem->records.size())
      << "the summary is of another problem";
  return RenderPage(kPageTemplate, PageMaker(input, options).Make());
}

bool WriteHtmlReport(const ReportInput& input, const HtmlReportOptions& options,
                     const std::string& path, std::string* error) {
  return WriteFileAtomically(path, RenderHtmlReport(input, options), error);
}

}  // namespace pinode
