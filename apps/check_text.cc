#include "apps/check_text.h"

#include <cmath>
#include <string>
#include <vector>

#include "apps/print.h"
#include "pinode/base/strings.h"
#include "pinode/base/units.h"
#include "pinode/case/sections/finite_element_section.h"
#include "pinode/record/excitation.h"
#include "pinode/structure/model/modal_mass.h"

namespace pinode {
namespace {

void PrintNumber(double value, const char* format, int width) {
  if (std::isfinite(value)) {
    Print(format, value);
  } else {
    Print("%*s", width, "-");
  }
}

// Rounds to a number of decimals. Never returns -0, which would be printed so.
double Rounded(double value, int decimals) {
  const double unit = std::pow(10.0, -decimals);
  return std::round(value / unit) * unit + 0.0;
}

void PrintFiniteElementModel(const Case& c) {
  if (c.finite_element == nullptr) return;
  const ReducedStructure& source = *c.finite_element;
  const ReducedModel& reduced = source.reduced;
  const SparseModes& modes = reduced.whole_modes;
  const SpecialDofs special = FindSpecialDofs(source.model);
  Print(
      "Finite-element model: %d DOFs, %zu removed, %zu without mass\n"
      "%d rigid-body modes, %ld non-zeros in K, damping %s\n",
      source.exported.num_dofs(), source.removed_dofs.size(),
      special.massless.size(), modes.num_rigid_body_modes,
      static_cast<long>(source.model.stiffness.nonZeros()),
      source.exported.has_damping() ? "exported" : "not exported");
  for (const std::string& note : source.notes) {
    Print("  %s\n", note.c_str());
  }
  if (source.is_reduced) {
    Print("Reduced by %s to %zu coordinates:",
          ReductionMethodName(source.options.method),
          reduced.coordinate_names.size());
    for (const std::string& name : reduced.coordinate_names) {
      Print(" %s", name.c_str());
    }
    Print("\n");
  }
  Print(
      "\nMode    full Hz   expected Hz   error %%   reduced: error %%      "
      "MAC\n");
  const double to_hz = c.problem.description.HzPerModelFrequency();
  for (int i = 0; i < modes.frequency_hz.size(); ++i) {
    const double hz = to_hz * modes.frequency_hz[i];
    Print("%4d ", i + 1);
    PrintNumber(hz, "%10.5g", 10);
    const int place = i - modes.num_rigid_body_modes;
    const bool expected =
        place >= 0 && place < static_cast<int>(source.expected_hz.size());
    const double listed = expected
                              ? source.expected_hz[static_cast<size_t>(place)]
                              : std::nan("");
    Print("    ");
    PrintNumber(listed, "%10.5g", 10);
    PrintNumber(Rounded(100.0 * (hz / listed - 1.0), 3), "%10.3f", 10);
    const bool compared = i < reduced.mac.size();
    Print("        ");
    PrintNumber(compared ? Rounded(100.0 * reduced.frequency_error[i], 3)
                         : std::nan(""),
                "%10.3f", 10);
    PrintNumber(compared ? reduced.mac[i] : std::nan(""), "%9.5f", 9);
    Print("\n");
  }
  Print("\n");
}

void PrintModel(const Case& c, const CaseCheck& check) {
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  Print("Model: %d DOFs, %d states, units %s, %s, %s\n", dynamics.num_dofs(),
        dynamics.num_states(), c.problem.description.units.force.c_str(),
        c.problem.description.units.length.c_str(),
        c.problem.description.units.time.c_str());
  if (!check.no_modes.empty()) {
    Print("No modes: %s\n", check.no_modes.c_str());
    return;
  }
  const ModalProperties& modes = check.modes;
  const double to_hz = c.problem.description.HzPerModelFrequency();
  Print(
      "\nModes (damping in %% of critical)\n"
      "Mode      Hz   damping %%%s\n",
      c.expected_hz.empty() ? "" : "   expected Hz   error %");
  for (int i = 0; i < modes.frequency_hz.size(); ++i) {
    const double hz = to_hz * modes.frequency_hz[i];
    // A negative stiffness has no frequency.
    if (!std::isfinite(hz)) {
      Print("%4d %8s %10s\n", i + 1, "-", "-");
      continue;
    }
    // A rigid body has no damping ratio.
    Print("%4d %8.4g ", i + 1, hz);
    PrintNumber(100.0 * modes.damping_ratio[i] + 0.0, "%10.3g", 10);
    const size_t index = static_cast<size_t>(i);
    if (index < c.expected_hz.size()) {
      Print("   %11.4g %9.2f", c.expected_hz[index],
            Rounded(100.0 * (hz / c.expected_hz[index] - 1.0), 2));
    }
    Print("\n");
  }
}

// Prints how much of the moving mass each mode has, down to the mode with which
// all but a thousandth is there.
void PrintModalMasses(const CaseCheck& check) {
  const std::vector<std::string>& directions = check.model.directions;
  if (!check.no_modes.empty() || directions.empty()) return;
  const Matrix shares =
      EffectiveModalMasses(check.model, check.modes.mode_shapes).Shares();
  Print("\nEffective modal mass, %% of the moving mass (sum so far)\nMode");
  for (const std::string& direction : directions) {
    Print("  %15s", direction.c_str());
  }
  Print("\n");
  constexpr int kMostRows = 20;
  Vector sum = Vector::Zero(shares.cols());
  for (Eigen::Index i = 0; i < shares.rows() && i < kMostRows; ++i) {
    sum += shares.row(i).transpose();
    Print("%4d", static_cast<int>(i) + 1);
    for (Eigen::Index d = 0; d < shares.cols(); ++d) {
      if (std::isfinite(sum[d])) {
        Print("  %6.2f (%6.2f)", 100.0 * shares(i, d), 100.0 * sum[d]);
      } else {
        Print("  %15s", "-");
      }
    }
    Print("\n");
    if (!(sum.array() < 0.999).any()) break;
  }
}

// Prints the peaks of the records' spectra beside the model's modes.
void PrintPeaks(const CaseCheck& check) {
  bool any = false;
  for (const RecordPeaks& record : check.record_peaks) {
    if (record.hz.empty()) continue;
    if (!any) {
      Print(
          "\nPeaks in the spectra of the responses, Hz (compare them with the "
          "modes)\n");
    }
    any = true;
    Print("  %s:", record.record.c_str());
    for (const double hz : record.hz) Print(" %.4g", hz);
    Print("\n");
  }
}

void PrintQuestions(const CaseCheck& check) {
  if (check.questions.empty()) return;
  Print("\nPlease check\n");
  for (const std::string& question : check.questions) {
    Print("  %s\n", question.c_str());
  }
}

// How the record is integrated, and the accuracy of that.
void PrintSteps(const Case& c, const IdentificationRecord& record,
                const SubstepChoice& choice) {
  const double pi = std::acos(-1.0);
  const char* chosen = record.substeps_chosen ? "chosen" : "given";
  if (choice.integrator == Integrator::kExact) {
    Print("    integrated exactly");
  } else if (choice.integrator == Integrator::kExponential) {
    Print("    exponential steps, %d a sample (%s)", record.exponential_steps,
          chosen);
  } else {
    Print("    Runge-Kutta steps, %d a sample (%s)", record.substeps, chosen);
  }
  Print("; fastest mode %.4g Hz", c.problem.description.HzPerModelFrequency() *
                                      choice.stability.largest_eigenvalue /
                                      (2.0 * pi));
  if (std::isfinite(choice.error) && !choice.channel.empty()) {
    std::string unit;
    for (const MeasuredChannel& channel : record.channels) {
      if (channel.observation.name == choice.channel) {
        unit = UnitName(DimensionOf(channel.observation.quantity),
                        c.problem.description.units);
      }
    }
    Print("; half the step moves %s by %.2g (limit %.2g%s%s)",
          choice.channel.c_str(), choice.error, choice.error_limit,
          unit.empty() ? "" : " ", unit.c_str());
  }
  Print("\n");
}

void PrintRecords(const Case& c) {
  Print("\nRecords\n");
  const std::string& time = c.problem.description.units.time;
  for (size_t r = 0; r < c.problem.records.size(); ++r) {
    const IdentificationRecord& record = c.problem.records[r];
    const Excitation& excitation = *record.excitation;
    Print(
        "  %s (%s): %td samples, step %.6g %s, %.4g %s, %zu channels",
        record.name.c_str(),
        record.role == IdentificationRecord::Role::kTrain ? "train" : "holdout",
        record.num_samples(), record.sampling_step(), time.c_str(),
        record.sampling_step() * static_cast<double>(record.num_samples() - 1),
        time.c_str(), record.channels.size());
    if (excitation.samples().isZero(0.0)) {
      Print(", no excitation");
    } else {
      Print(", excitation %s between samples",
            InterpolationName(excitation.interpolation()));
    }
    Print("%s\n", excitation.periodic() ? ", periodic" : "");
    PrintSteps(c, record, c.substeps[r]);
    for (const std::string& remark : record.description.remarks) {
      Print("    %s\n", remark.c_str());
    }
  }
}

// Prints measured inputs of an ambient record.
void PrintInputs(const Case& c, const AmbientRecord& record) {
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  std::vector<std::string> loads;
  for (int i = 0; i < dynamics.num_inputs(); ++i) {
    const InputSpec& input = dynamics.inputs()[static_cast<size_t>(i)];
    const auto samples = record.inputs->samples().row(i);
    if (input.kind == InputSpec::Kind::kCovariate) {
      Print("    %s: mean %.5g, from %.5g to %.5g\n", input.name.c_str(),
            samples.mean(), samples.minCoeff(), samples.maxCoeff());
    } else if (samples.maxCoeff() > samples.minCoeff()) {
      loads.push_back(input.name);
    }
  }
  if (loads.empty()) return;
  Print("    measured loads, %s between samples: %s\n",
        InterpolationName(record.inputs->interpolation()),
        Join(loads, ", ").c_str());
}

void PrintAmbientRecords(const Case& c) {
  if (c.problem.ambient.empty()) return;
  Print("\nRecords of unmeasured loads\n");
  const std::string& time = c.problem.description.units.time;
  for (const AmbientRecord& record : c.problem.ambient) {
    Print("  %s: %ld samples, step %.6g %s, %.4g %s, %zu channels\n",
          record.name.c_str(), static_cast<long>(record.samples.cols()),
          record.sampling_step, time.c_str(),
          record.sampling_step * static_cast<double>(record.samples.cols() - 1),
          time.c_str(), record.channels.size());
    if (record.inputs.has_value()) PrintInputs(c, record);
  }
}

void PrintFrequencyResponses(const Case& c) {
  if (c.problem.frfs.empty()) return;
  const double to_hz = c.problem.description.HzPerModelFrequency();
  Print("\nFrequency response functions\n");
  for (const FrfRecord& record : c.problem.frfs) {
    Print("  %s: %ld lines from %.5g to %.5g Hz, %ld responses, %ld forces\n",
          record.name.c_str(), static_cast<long>(record.num_lines()),
          to_hz * record.frequencies[0],
          to_hz * record.frequencies[record.num_lines() - 1],
          static_cast<long>(record.num_responses()),
          static_cast<long>(record.num_references()));
  }
}

void PrintCandidates(const Case& c) {
  if (c.candidates.empty()) return;
  Print("\nCandidates (a fit keeps those that the records support):");
  for (const ModelCandidate& candidate : c.candidates) {
    Print(" %s", candidate.name.c_str());
  }
  Print("\n");
}

void PrintMeasuredModes(const Case& c, const CaseCheck& check) {
  if (check.mode_in_use.empty()) return;
  const double to_hz = c.problem.description.HzPerModelFrequency();
  Print("\nMeasured modes, form %s\n", ModalFormName(c.problem.modal.form));
  for (size_t i = 0; i < check.mode_in_use.size(); ++i) {
    const MeasuredMode& mode = c.problem.modal.modes[i];
    Print("  %s: %.5g Hz, ", mode.name.c_str(), to_hz * mode.frequency);
    if (!check.mode_in_use[i]) {
      Print("like no mode of the model, so a fit does not use it\n");
      continue;
    }
    const ModeMatch& match = check.mode_match[i];
    Print("mode %d of the model has %.5g Hz (%+.2f %%)", match.mode + 1,
          to_hz * match.frequency,
          100.0 * (match.frequency / mode.frequency - 1.0));
    if (mode.HasShape()) {
      Print(", shape at %zu DOFs, MAC %.4f", mode.dofs.size(), match.mac);
    }
    Print("\n");
  }
}

void PrintAssessment(const CaseCheck& check) {
  if (!check.ok()) {
    Print("\nNot assessed: %s\n", check.not_assessed.c_str());
    return;
  }
  const ProblemAssessment& assessment = check.assessment;
  Print("\nSizes: %d free parameters", assessment.num_free);
  // Ambient records and modes have no residuals in time.
  if (assessment.num_residuals > 0) {
    Print(", %td residuals", assessment.num_residuals);
  }
  if (assessment.num_starts > 0) {
    Print(", %d unknown start states", assessment.num_starts);
  }
  Print("\n");
  if (!assessment.expected.empty()) {
    Print(
        "\nExpected 95 %% uncertainty at the initial values (noise as given, "
        "otherwise 5 %%)\n");
    for (const auto& expected : assessment.expected) {
      const std::string unit = expected.unit == "1" ? "" : " " + expected.unit;
      if (std::isfinite(expected.sigma)) {
        Print("  %-24s %12.5g +- %.2g%s\n", expected.name.c_str(),
              expected.initial, 1.96 * expected.sigma, unit.c_str());
      } else {
        Print("  %-24s %12.5g%s, not determined\n", expected.name.c_str(),
              expected.initial, unit.c_str());
      }
    }
  }
  for (const std::string& remark : assessment.remarks) {
    Print("\n%s\n", remark.c_str());
  }
  for (const std::string& direction : assessment.undetermined) {
    Print(
        "\nNot determined by the sensors and the load: %s. Add a prior, fix "
        "one of them or add a channel.\n",
        direction.c_str());
  }
  for (const std::string& confusion : check.confusions) {
    Print("\n%s\n", confusion.c_str());
  }
  if (assessment.undetermined.empty() && !assessment.expected.empty()) {
    Print("\nEvery named parameter is determined by the data%s.\n",
          check.confusions.empty()
              ? ""
              : ", if the case has none of the errors above");
  }
}

}  // namespace

void PrintCaseCheck(const Case& c, const CaseCheck& check) {
  if (!c.problem.description.title.empty()) {
    Print("%s\n\n", c.problem.description.title.c_str());
  }
  PrintFiniteElementModel(c);
  PrintModel(c, check);
  PrintModalMasses(check);
  if (!c.problem.records.empty()) PrintRecords(c);
  PrintAmbientRecords(c);
  PrintFrequencyResponses(c);
  PrintPeaks(check);
  PrintQuestions(check);
  PrintCandidates(c);
  PrintMeasuredModes(c, check);
  if (!c.problem.description.remarks.empty()) Print("\nRemarks\n");
  for (const std::string& remark : c.problem.description.remarks) {
    Print("  %s\n", remark.c_str());
  }
  if (check.has_measurements) PrintAssessment(check);
}

}  // namespace pinode
