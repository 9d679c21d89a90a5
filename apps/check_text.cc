#include "apps/check_text.h"

#include <cmath>
#include <string>
#include <vector>

#include "apps/print.h"
#include "pinode/base/strings.h"
#include "pinode/case/sections/finite_element_section.h"
#include "pinode/record/excitation.h"

namespace pinode {
namespace {

void PrintNumber(double value, const char* format, int width) {
  if (std::isfinite(value)) {
    Print(format, value);
  } else {
    Print("%*s", width, "-");
  }
}

void PrintFiniteElementModel(const Case& c) {
  if (c.finite_element == nullptr) return;
  const ReducedStructure& source = *c.finite_element;
  const ReducedModel& reduced = source.reduced;
  const SparseModes& modes = reduced.whole_modes;
  const SpecialDofs special = FindSpecialDofs(source.model);
  Print(
      "Finite-element model: %d DOFs, %zu removed, %zu of the others without "
      "mass\n%d rigid-body modes, %ld non-zeros in K, damping %s\n",
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
    PrintNumber(100.0 * (hz / listed - 1.0), "%10.3f", 10);
    const bool compared = i < reduced.mac.size();
    Print("        ");
    PrintNumber(compared ? 100.0 * reduced.frequency_error[i] : std::nan(""),
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
      "Mode      Hz   damping %%   expected Hz   error %%\n");
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
            100.0 * (hz / c.expected_hz[index] - 1.0));
    }
    Print("\n");
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

void PrintRecords(const Case& c) {
  Print("\nRecords\n");
  for (size_t r = 0; r < c.problem.records.size(); ++r) {
    const IdentificationRecord& record = c.problem.records[r];
    const SubstepChoice& choice = c.substeps[r];
    Print(
        "  %s (%s): %td samples, step %.6g s, %.4g s, %zu channels, "
        "excitation %s%s\n",
        record.name.c_str(),
        record.role == IdentificationRecord::Role::kTrain ? "train" : "holdout",
        record.num_samples(), record.sampling_step(),
        record.sampling_step() * static_cast<double>(record.num_samples() - 1),
        record.channels.size(),
        c.problem.IsDriven(record)
            ? InterpolationName(record.excitation->interpolation())
            : "none",
        record.excitation->periodic() ? ", periodic" : "");
    if (choice.integrator == Integrator::kExact) {
      Print("    integrated exactly; fastest mode %.4g rad/s",
            choice.stability.largest_eigenvalue);
    } else if (choice.integrator == Integrator::kExponential) {
      Print("    exponential steps, %d a sample%s; fastest mode %.4g rad/s",
            record.exponential_steps,
            record.substeps_chosen ? " (chosen)" : " (given)",
            choice.stability.largest_eigenvalue);
    } else {
      Print(
          "    Runge-Kutta steps, %d a sample%s; fastest mode %.4g rad/s, "
          "growth %.6f",
          record.substeps, record.substeps_chosen ? " (chosen)" : " (given)",
          choice.stability.largest_eigenvalue, choice.stability.growth);
    }
    if (std::isfinite(choice.error) && !choice.channel.empty()) {
      Print("; halving the step moves %s by %.2g (limit %.2g)",
            choice.channel.c_str(), choice.error, choice.error_limit);
    }
    Print("\n");
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
  for (const AmbientRecord& record : c.problem.ambient) {
    Print("  %s: %ld samples, step %.6g s, %.4g s, %zu channels\n",
          record.name.c_str(), static_cast<long>(record.samples.cols()),
          record.sampling_step,
          record.sampling_step * static_cast<double>(record.samples.cols() - 1),
          record.channels.size());
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
  Print("\nSizes: %d free parameters, %td residuals, %d unknown start states\n",
        assessment.num_free, assessment.num_residuals, assessment.num_starts);
  if (!assessment.expected.empty()) {
    Print(
        "\nExpected 95 %% uncertainty at the initial values (noise as given, "
        "otherwise 5 %%)\n");
    for (const auto& expected : assessment.expected) {
      Print("  %-24s %12.5g +- %.2g %s%s\n", expected.name.c_str(),
            expected.initial, 1.96 * expected.sigma,
            expected.unit == "1" ? "" : expected.unit.c_str(),
            std::isfinite(expected.sigma) ? "" : "(not determined)");
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
              : ", if the case is right about the errors above");
  }
}

}  // namespace

void PrintCaseCheck(const Case& c, const CaseCheck& check) {
  if (!c.problem.description.title.empty()) {
    Print("%s\n\n", c.problem.description.title.c_str());
  }
  PrintFiniteElementModel(c);
  PrintModel(c, check);
  if (!c.problem.records.empty()) PrintRecords(c);
  PrintAmbientRecords(c);
  PrintFrequencyResponses(c);
  PrintPeaks(check);
  PrintQuestions(check);
  PrintCandidates(c);
  PrintMeasuredModes(c, check);
  for (const std::string& remark : c.problem.description.remarks) {
    Print("  %s\n", remark.c_str());
  }
  if (check.has_measurements) PrintAssessment(check);
}

}  // namespace pinode
