#include "pinode/case/results/result_files.h"

#include <cmath>
#include <filesystem>
#include <type_traits>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/case/results/checkpoint_file.h"
#include "pinode/case/results/model_files.h"
#include "pinode/case/text/csv_file.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/result_fields.h"
#include "pinode/structure/matrices/matrix_io.h"
#include "pinode/structure/model/symmetric.h"
#include "pinode/study/problem/folded_matrices.h"

namespace pinode {
namespace {

std::string Cell(const std::string& text) { return CsvCell(text); }
std::string Cell(double number) { return CsvCell(number); }
std::string Cell(bool value) { return value ? "1" : "0"; }
template <typename T>
std::enable_if_t<std::is_integral_v<T>, std::string> Cell(T number) {
  return std::to_string(number);
}

// A column per field of the struct, a row per element.
template <typename Struct>
std::string TableAsCsv(const std::vector<Struct>& rows) {
  std::string text;
  const auto end_line = [&text] { text.back() = '\n'; };
  VisitFields(Struct(), [&text](const char* name, const auto&) {
    text += std::string(name) + ",";
  });
  end_line();
  for (const Struct& row : rows) {
    VisitFields(row, [&text](const char*, const auto& value) {
      text += Cell(value) + ",";
    });
    end_line();
  }
  return text;
}

namespace fs = std::filesystem;

class ResultWriter {
 public:
  ResultWriter(const IdentificationProblem& problem,
               const IdentificationSummary& summary,
               const IdentifiedModel& model, const std::string& folder,
               std::string* error)
      : problem_(problem),
        summary_(summary),
        model_(model),
        folder_(folder),
        error_(error) {}

  bool Write() {
    std::string json;
    return WriteFolded() && WriteText("parameters.csv", Parameters()) &&
           WriteText("covariance.csv", Covariance()) &&
           (summary_.profiles.empty() ||
            WriteText("profiles.csv", ProfilePoints())) &&
           WriteText("history.csv", History()) && WritePredictions() &&
           WriteForces() && WriteText("initial_states.csv", InitialStates()) &&
           WriteFinalCheckpoint() &&
           FormatResultJson(problem_, summary_, model_, &json, error_) &&
           WriteText("result.json", json);
  }

 private:
  std::string Path(const std::string& name) const {
    return (fs::path(folder_) / name).string();
  }
  bool WriteText(const std::string& name, const std::string& text) {
    return WriteFileAtomically(Path(name), text, error_);
  }

  bool WriteFolded() {
    const StructuralDynamics& dynamics = *problem_.dynamics;
    const FoldedMatrices folded = FoldNetworks(
        dynamics, model_.parameters.head(dynamics.num_parameters()));
    if (!folded.any) return true;
    return WriteMatrixMarket(Path("K_folded.mtx"), folded.stiffness, error_) &&
           WriteMatrixMarket(Path("C_folded.mtx"), folded.damping, error_) &&
           WriteMatrixMarket(Path("K_folded_symmetric.mtx"),
                             SymmetricPart(folded.stiffness), error_) &&
           WriteMatrixMarket(Path("C_folded_symmetric.mtx"),
                             SymmetricPart(folded.damping), error_);
  }

  std::string Parameters() const { return TableAsCsv(summary_.parameters); }

  std::string Covariance() const {
    std::string text = "name";
    for (const std::string& name : summary_.covariance_names) {
      text += "," + CsvCell(name);
    }
    text += "\n";
    for (Eigen::Index i = 0; i < summary_.covariance.rows(); ++i) {
      text += CsvCell(summary_.covariance_names[static_cast<size_t>(i)]);
      for (Eigen::Index j = 0; j < summary_.covariance.cols(); ++j) {
        text += "," + CsvCell(summary_.covariance(i, j));
      }
      text += "\n";
    }
    return text;
  }

  std::string ProfilePoints() const {
    std::string text = "parameter,unit,value,likelihood_ratio\n";
    for (const ParameterProfile& profile : summary_.profiles) {
      for (const ParameterProfile::Point& point : profile.points) {
        text += CsvCell(profile.name) + "," + CsvCell(profile.unit) + "," +
                CsvCell(point.value) + "," + CsvCell(point.ratio) + "\n";
      }
    }
    return text;
  }

  std::string History() const { return TableAsCsv(summary_.iterations); }

  // Returns row `i` of `values`, which must outlive it, in the file's unit.
  static CsvColumn RowOf(const Matrix& values, size_t i, double factor,
                         std::string name) {
    const auto row = static_cast<Eigen::Index>(i);
    return {std::move(name), values.cols(),
            [&values, row, factor](Eigen::Index sample) {
              return values(row, sample) / factor;
            }};
  }

  // Adds deviations after the predictions, so that the latter keep their
  // columns.
  static void AddDeviations(const IdentificationRecord& record,
                            const RecordScore& score,
                            std::vector<CsvColumn>* columns) {
    if (score.deviations.size() != score.prediction.size()) return;
    for (size_t i = 0; i < record.channels.size(); ++i) {
      const MeasuredChannel& channel = record.channels[i];
      columns->push_back(RowOf(score.deviations, i,
                               std::abs(channel.description.factor),
                               channel.observation.name + "_deviation"));
    }
  }

  bool WritePredictions() {
    for (size_t r = 0; r < summary_.records.size(); ++r) {
      const RecordScore& score = summary_.records[r];
      const IdentificationRecord& record = problem_.records[r];
      // A run that was never finite has no prediction.
      if (score.prediction.cols() != record.num_samples()) continue;
      std::vector<CsvColumn> columns = {
          {"time", record.num_samples(), [&record](Eigen::Index sample) {
             return FileTime(record, sample);
           }}};
      for (size_t i = 0; i < record.channels.size(); ++i) {
        const MeasuredChannel& channel = record.channels[i];
        const std::string& name = channel.observation.name;
        const double factor = channel.description.factor;
        columns.push_back({name + "_measured", channel.values.size(),
                           [&channel, factor](Eigen::Index sample) {
                             return channel.values[sample] / factor;
                           }});
        columns.push_back(
            RowOf(score.prediction, i, factor, name + "_predicted"));
      }
      AddDeviations(record, score, &columns);
      if (!WriteCsv(Path("prediction_" + record.name + ".csv"), columns,
                    error_)) {
        return false;
      }
    }
    return true;
  }

  bool WriteForces() {
    for (const ForceEstimate& force : summary_.forces) {
      const Vector times =
          force.times / problem_.records[static_cast<size_t>(force.record)]
                            .description.time_factor;
      if (!WriteCsv(Path("force_" + force.name + ".csv"),
                    {{"time", times},
                     {"force", force.value},
                     {"lower95", force.lower95},
                     {"upper95", force.upper95}},
                    error_)) {
        return false;
      }
    }
    return true;
  }

  std::string InitialStates() const {
    std::string text = "record";
    for (const std::string& name : problem_.dynamics->StateNames()) {
      text += "," + CsvCell(name);
    }
    text += "\n";
    for (const RecordScore& score : summary_.records) {
      if (score.start.size() != problem_.dynamics->num_states()) continue;
      text += CsvCell(score.name);
      for (const double value : score.start) text += "," + CsvCell(value);
      text += "\n";
    }
    return text;
  }

  bool WriteFinalCheckpoint() {
    Checkpoint checkpoint;
    checkpoint.iteration = summary_.num_iterations;
    checkpoint.cost = summary_.final_cost;
    checkpoint.model = model_;
    checkpoint.profiles = summary_.profiles;
    checkpoint.choice = summary_.choice;
    return WriteCheckpoint(Path("checkpoint.json"), ProblemIdentity(problem_),
                           checkpoint, error_);
  }

  const IdentificationProblem& problem_;
  const IdentificationSummary& summary_;
  const IdentifiedModel& model_;
  const std::string folder_;
  std::string* error_;
};

// True if a summary can belong to `problem`: its records have the same sizes.
bool IsSummaryOf(const IdentificationProblem& problem,
                 const IdentificationSummary& summary, std::string* error) {
  const size_t num_records = problem.records.size();
  const auto named = static_cast<Eigen::Index>(summary.covariance_names.size());
  // There may be no covariance.
  bool good =
      summary.records.size() <= num_records &&
      (summary.covariance.size() == 0 || (summary.covariance.rows() == named &&
                                          summary.covariance.cols() == named));
  for (size_t r = 0; good && r < summary.records.size(); ++r) {
    const size_t num_channels = problem.records[r].channels.size();
    const Matrix& prediction = summary.records[r].prediction;
    good = summary.records[r].channels.size() <= num_channels &&
           (prediction.size() == 0 ||
            prediction.rows() == static_cast<Eigen::Index>(num_channels));
  }
  for (const ForceEstimate& force : summary.forces) {
    good = good && force.record >= 0 &&
           force.record < static_cast<int>(num_records) &&
           force.times.size() > 1 && force.value.size() == force.times.size() &&
           force.lower95.size() == force.times.size() &&
           force.upper95.size() == force.times.size();
  }
  if (!good) *error = "the summary is not of this problem: its sizes differ";
  return good;
}

}  // namespace

double FileTime(const IdentificationRecord& record, Eigen::Index sample) {
  return record.excitation->time(sample) / record.description.time_factor;
}

Vector FileTimes(const IdentificationRecord& record) {
  return Vector::NullaryExpr(
      record.excitation->num_samples(),
      [&record](Eigen::Index sample) { return FileTime(record, sample); });
}

bool WriteTables(const IdentificationProblem& problem,
                 const IdentificationSummary& summary,
                 const IdentifiedModel& model, const std::string& folder,
                 std::string* error) {
  return IsSummaryOf(problem, summary, error) &&
         ResultWriter(problem, summary, model, folder, error).Write();
}

IdentifiedModel CompleteModel(const IdentificationProblem& problem,
                              const IdentifiedModel& model) {
  const ParameterLayout layout(problem);
  IdentifiedModel complete = model;
  if (complete.parameters.size() != layout.num_parameters() ||
      !complete.parameters.allFinite()) {
    complete.parameters = layout.InitialValues();
  }
  return complete;
}

bool WriteResultFiles(const IdentificationProblem& problem,
                      const IdentificationSummary& summary,
                      const IdentifiedModel& model, const std::string& folder,
                      std::string* error) {
  if (!problem.IsValid(error) || !IsSummaryOf(problem, summary, error)) {
    return false;
  }
  std::error_code status;
  fs::create_directories(folder, status);
  if (status) {
    *error = folder + ": cannot be created: " + status.message();
    return false;
  }
  const IdentifiedModel complete = CompleteModel(problem, model);
  StructuralDynamics updated = *problem.dynamics;
  updated.SetParameters(complete.parameters.head(updated.num_parameters()));
  return WriteModelFiles(updated, folder, error) &&
         WriteTables(problem, summary, complete, folder, error);
}

}  // namespace pinode
