#include "pinode/case/result_files.h"

#include <cmath>
#include <filesystem>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/case/checkpoint.h"
#include "pinode/case/csv_file.h"
#include "pinode/case/finite_element_result.h"
#include "pinode/case/model_case.h"
#include "pinode/estimate/parameter_layout.h"
#include "pinode/structure/matrix_io.h"
#include "pinode/structure/symmetric.h"
#include "pinode/study/folded_matrices.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;

class ResultWriter {
 public:
  ResultWriter(const Case& c, const IdentificationSummary& summary,
               const IdentifiedModel& model, const ResultFolder& folder,
               std::string* error)
      : c_(c),
        summary_(summary),
        model_(model),
        folder_(folder),
        error_(error) {}

  bool Write() {
    std::string json;
    return WriteModelCase(c_, model_, folder_.working_path(),
                          folder_.final_path(), error_) &&
           WriteFiniteElementResult(c_, summary_, model_,
                                    folder_.working_path(), error_) &&
           WriteFolded() && WriteText("parameters.csv", Parameters()) &&
           WriteText("covariance.csv", Covariance()) &&
           WriteText("history.csv", History()) && WritePredictions() &&
           WriteForces() && WriteText("initial_states.csv", InitialStates()) &&
           WriteFinalCheckpoint() &&
           FormatResultJson(c_, summary_, model_, &json, error_) &&
           WriteText("result.json", json);
  }

 private:
  std::string Path(const std::string& name) const {
    return (fs::path(folder_.working_path()) / name).string();
  }
  bool WriteText(const std::string& name, const std::string& text) {
    return WriteFileAtomically(Path(name), text, error_);
  }

  bool WriteFolded() {
    const StructuralDynamics& dynamics = *c_.problem.dynamics;
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

  std::string Parameters() const {
    std::string text =
        "name,unit,initial,value,sigma,lower95,upper95,free,at_bound\n";
    for (const ParameterEstimate& p : summary_.parameters) {
      text += CsvCell(p.name) + "," + CsvCell(p.unit) + "," +
              CsvCell(p.initial) + "," + CsvCell(p.value) + "," +
              CsvCell(p.sigma) + "," + CsvCell(p.lower95) + "," +
              CsvCell(p.upper95) + "," + (p.free ? "1" : "0") + "," +
              (p.at_bound ? "1" : "0") + "\n";
    }
    return text;
  }

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

  std::string History() const {
    std::string text =
        "stage,segment_samples,iteration,cost,gradient_norm,step_norm,"
        "trust_region_radius,largest_gap,accepted,seconds\n";
    for (const IterationRecord& it : summary_.iterations) {
      text +=
          std::to_string(it.stage) + "," + std::to_string(it.segment_samples) +
          "," + std::to_string(it.iteration) + "," + CsvCell(it.cost) + "," +
          CsvCell(it.gradient_norm) + "," + CsvCell(it.step_norm) + "," +
          CsvCell(it.trust_region_radius) + "," + CsvCell(it.largest_gap) +
          "," + (it.accepted ? "1" : "0") + "," + CsvCell(it.seconds) + "\n";
    }
    return text;
  }

  bool WritePredictions() {
    for (size_t r = 0; r < summary_.records.size(); ++r) {
      const RecordScore& score = summary_.records[r];
      const IdentificationRecord& record = c_.problem.records[r];
      // A run that never became finite has nothing to show.
      if (score.prediction.cols() != record.num_samples()) continue;
      std::vector<CsvColumn> columns = {{"time", FileTimes(record)}};
      for (size_t i = 0; i < record.channels.size(); ++i) {
        const MeasuredChannel& channel = record.channels[i];
        const std::string& name = channel.observation.name;
        const double factor = channel.description.factor;
        columns.push_back({name + "_measured", channel.values / factor});
        columns.push_back(
            {name + "_predicted",
             score.prediction.row(static_cast<Eigen::Index>(i)).transpose() /
                 factor});
      }
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
          force.times / c_.problem.records[static_cast<size_t>(force.record)]
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
    for (const std::string& name : c_.problem.dynamics->StateNames()) {
      text += "," + CsvCell(name);
    }
    text += "\n";
    for (const RecordScore& score : summary_.records) {
      if (score.start.size() != c_.problem.dynamics->num_states()) continue;
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
    return WriteCheckpoint(Path("checkpoint.json"), CaseHash(c_), checkpoint,
                           error_);
  }

  const Case& c_;
  const IdentificationSummary& summary_;
  const IdentifiedModel& model_;
  const ResultFolder& folder_;
  std::string* error_;
};

}  // namespace

Vector FileTimes(const IdentificationRecord& record) {
  const Excitation& excitation = *record.excitation;
  Vector times(excitation.num_samples());
  for (int i = 0; i < excitation.num_samples(); ++i) {
    times[i] = excitation.time(i) / record.description.time_factor;
  }
  return times;
}

bool WriteResultFiles(const Case& c, const IdentificationSummary& summary,
                      const IdentifiedModel& model, const ResultFolder& folder,
                      std::string* error) {
  const ParameterLayout layout(c.problem);
  // A fit that could not begin leaves no model; the one before it then stands.
  IdentifiedModel complete = model;
  if (complete.parameters.size() != layout.num_parameters() ||
      !complete.parameters.allFinite()) {
    complete.parameters = layout.InitialValues();
  }
  return ResultWriter(c, summary, complete, folder, error).Write();
}

}  // namespace pinode
