// [[record]]: description of a record in the case file, before its numbers are
// read.

#ifndef PINODE_CASE_SECTIONS_RECORD_SECTION_H_
#define PINODE_CASE_SECTIONS_RECORD_SECTION_H_

#include <optional>
#include <string>
#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/sections/input_section.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/case/sections/signal_section.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/dynamics/observation.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/record/excitation.h"
#include "pinode/record/files/text_format.h"
#include "pinode/record/filter.h"

namespace pinode {

struct ChannelSection {
  SignalSection signal;
  std::string name;
  Quantity quantity = Quantity::kDisplacement;
  Vector weights;  // num_dofs
  std::string location;
  bool fit = true;
  // Gain by which the samples are divided, in a record of unmeasured loads.
  double known_gain = 1.0;

  explicit ChannelSection(const TomlTable& t) : signal(t) {}
};

struct RecordSection {
  TomlTable table;
  std::string name;
  IdentificationRecord::Role role = IdentificationRecord::Role::kTrain;
  std::string file;             // as opened; empty: none
  std::string time_column;      // empty: sampling_step is given, or AT2
  std::string time_unit = "s";  // of the key; the file may have its own
  double time_factor = 1.0;     // model time per file time
  TextFormat text_format;       // of text files, with time_column
  double sampling_step = 0.0;   // model time; 0: from the file
  double duration = 0.0;        // model time; simulations without a file
  std::optional<double> window_from, window_to;  // model time
  double resampling_step = 0.0;  // model time; 0: the record's own
  Interpolation interpolation = Interpolation::kLinear;
  bool periodic = false;
  IdentificationRecord::Start start = IdentificationRecord::Start::kFree;
  Vector start_x, start_v;         // kKnown
  Eigen::Index start_samples = 0;  // of a hold-out; 0: chosen
  int substeps = 0;                // 0: chosen
  std::optional<Integrator> integrator;
  std::vector<InputSection> inputs;
  std::vector<ChannelSection> channels;
  std::optional<FilterOptions> filter;  // frequencies per model time
  // excitation = "ambient": the loads were not measured.
  bool ambient = false;
  // excitation = "none": no loads act, the structure vibrates freely.
  bool free_decay = false;

  explicit RecordSection(const TomlTable& t) : table(t) {}
  bool has_excitation() const;
};

// Purpose for which records are read.
enum class RecordPurpose {
  kFit,
  kSimulation,  // measured responses are not read; no file is needed
  kPlanning,    // as a simulation; no channel is needed
  // Measured responses alone: a channel needs no DOF, and its name is its
  // place.
  kResponses,
};

// Reads all [[record]] sections, and checks them on their own and against the
// model.
[[nodiscard]] bool ReadRecordSections(const TomlTable& root,
                                      const UnitSystem& units,
                                      const StructuralModel& model,
                                      RecordPurpose purpose,
                                      std::vector<RecordSection>* sections);

// Returns the inputs of the dynamics: all inputs of the records, each once, the
// ground displacement if a channel needs it, and the derivatives of prescribed
// motions. Names: ground_<direction>, force_<dof>, motion_<dof> and so on, the
// covariate's own, ground_displacement_<direction>.
std::vector<InputSpec> CollectInputs(const std::vector<RecordSection>& sections,
                                     const StructuralModel& model);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_RECORD_SECTION_H_
