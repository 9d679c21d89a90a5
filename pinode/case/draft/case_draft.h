// A first case for the records of loggers: what it says, and how it follows
// from the files and a user's answers.

#ifndef PINODE_CASE_DRAFT_CASE_DRAFT_H_
#define PINODE_CASE_DRAFT_CASE_DRAFT_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/draft/deck_draft.h"
#include "pinode/case/draft/load_interpolation.h"
#include "pinode/case/draft/log_file.h"

namespace pinode {

// Answers of a user. Each member is the flag of this name; empty: not given.
struct DraftRequest {
  // Files of the structure as it is now, and of a later state.
  std::vector<std::string> logs;
  std::vector<std::string> later_logs;
  // File that is held out of the fit, or "none". Default: the last of several.
  std::string holdout;
  // Case files to be written, for both states.
  std::string case_path = "case.toml";
  std::string later_case_path = "case_later.toml";

  std::string title;
  std::string storeys;
  std::string weights;
  std::string stiffness;
  std::string first_mode_hz;
  std::string damping_ratio = "0.02";
  // Free damping: "storeys" (a factor each, and one in proportion to mass),
  // "rayleigh" (two factors) or "modes" (ratios). Empty: storeys if the records
  // show them, else rayleigh.
  std::string damping;

  // A deck in place of storeys; the units of its numbers, "N, m", and the
  // factor with which properties of sets were exported.
  std::string deck;
  std::string deck_units;
  std::string factor;

  std::string base;     // a column, or "none"
  std::string sensors;  // "acc_1=1,acc_2=-2": floors, "-": upside down
  // "F=3": measured forces, at floors or DOFs.
  std::string force;
  std::string force_unit;
  std::string base_direction;  // of a deck: x, y or z
  std::string ignore;          // columns, separated by commas
  // Unit of columns whose unit the files do not state, or a scale changes.
  std::string unit;
  LogOptions time;  // of all files
};

// One signal of a record.
struct DraftSignal {
  std::string column;
  std::string unit;
  bool unit_is_stated = false;  // by the file
  double scale = 1.0;           // number of the file times scale is in `unit`
  int floor = 0;                // 0: the base, or a DOF of a deck
  std::string dof;              // "u3"; of the base its direction
  bool is_by_name = false;      // place found by the column's name
  bool is_upside_down = false;
  // True if it moves against most others in the first mode.
  bool moves_against = false;
  bool remove_offset = false;
};

struct DraftRecord {
  std::string name;
  std::string file;  // as the user gave it
  bool is_holdout = false;
  bool starts_at_rest = false;
  double step = 0.0;      // s
  double duration = 0.0;  // s
  std::string time_column;
  std::string time_unit;
  double sampling_rate_hz = 0.0;    // without a time column
  TextFormat format;                // as the user gave it
  LoadInterpolation interpolation;  // of base and forces
  std::vector<DraftSignal> base;    // none or one
  std::vector<DraftSignal> forces;
  std::vector<DraftSignal> floors;  // or other places of sensors
};

// Source of the initial stiffnesses.
enum class StiffnessOrigin { kGiven, kFirstMode, kGivenFirstMode };

struct CaseDraft {
  std::string path;  // of the case file
  std::string title;
  UnitSystem units;
  std::vector<double> masses;
  std::string masses_origin;
  std::vector<double> stiffnesses;
  StiffnessOrigin stiffness_origin = StiffnessOrigin::kGiven;
  double first_mode_hz = 0.0;  // of the records; 0: no peak
  double damping_ratio = 0.02;
  // Coefficients of Rayleigh's damping C = a0 M + a1 K, if it is drafted; both
  // are 0 if the ratios of modes are. a1 = 0 for one storey.
  double rayleigh_mass = 0.0;
  double rayleigh_stiffness = 0.0;
  // True: a1 K has a factor for each storey. False: one factor.
  bool storeys_are_damped = false;
  // Modes whose damping ratio is free, from 1 on, each with a group of its own;
  // and the first of the higher modes that share one group (0: none).
  std::vector<int> damped_modes;
  int damped_from = 0;
  // True if modes or storeys are left out whose damping the records do not
  // show.
  bool some_damping_is_hidden = false;
  // Model of a deck in place of masses and stiffnesses; null: storeys.
  std::shared_ptr<const DeckModel> deck;
  double deck_factor = 0.0;
  std::vector<DraftRecord> records;
  // Sentences for the user: what was assumed, and what looks odd.
  std::vector<std::string> assumptions;
  std::vector<std::string> remarks;

  int num_storeys() const { return static_cast<int>(masses.size()); }
};

// Drafts the case of a shear building or a deck, and that of its later state if
// there are files of one, with the same model. Reads the files.
//
// Returns false with a question in *question if something is not clear, else
// with one line in *error.
[[nodiscard]] bool DraftCases(const DraftRequest& request,
                              std::vector<CaseDraft>* drafts,
                              DraftQuestion* question, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_DRAFT_CASE_DRAFT_H_
