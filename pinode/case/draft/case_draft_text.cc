#include "pinode/case/draft/case_draft_text.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/case/text/toml_value.h"

namespace pinode {
namespace {

constexpr char kFirstLine[] = "# Drafted by pinode_new";
constexpr size_t kCommentColumn = 40;
// Modes of the reduction of a deck's model, beside the DOFs of sensors and
// forces. With the eight of data/frame they leave 1 % of error in the first six
// frequencies.
constexpr int kReducedModes = 8;

// Appends "key = value", with a comment in its own column.
void AppendLine(const std::string& text, const std::string& comment,
                std::string* out) {
  std::string line = text;
  if (!comment.empty()) {
    line.resize(std::max(line.size() + 2, kCommentColumn), ' ');
    line += "# " + comment;
  }
  *out += line + "\n";
}

std::string TomlText(const std::string& value) {
  TomlValue table = TomlValue::Table();
  table.Set("k", TomlValue::String(value));
  std::string text = FormatToml(table);
  // "k = ..." and the end of the line.
  text = text.substr(text.find('=') + 1);
  return std::string(StripBlanks(text));
}

std::string TomlNumber(double value, int digits = 7) {
  std::string text = FormatNumber(value, digits);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string TomlNumbers(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(TomlNumber(value));
  return "[" + Join(texts, ", ") + "]";
}

// Path of a record as its case has it.
std::string PathInCase(const std::string& file, const std::string& case_path) {
  std::error_code status;
  const std::filesystem::path absolute =
      std::filesystem::absolute(file, status).lexically_normal();
  const std::filesystem::path folder =
      std::filesystem::absolute(case_path, status)
          .lexically_normal()
          .parent_path();
  const std::filesystem::path relative = absolute.lexically_proximate(folder);
  return relative.generic_string();
}

std::string PercentOf(double share) {
  return FormatNumber(100.0 * share, 3) + " %";
}

std::string StiffnessComment(const CaseDraft& draft) {
  const std::string hz = FormatNumber(draft.first_mode_hz, 4) + " Hz";
  switch (draft.stiffness_origin) {
    case StiffnessOrigin::kGiven:
      return "from --stiffness";
    case StiffnessOrigin::kFirstMode:
      return "all equal, so that the first mode is at " + hz +
             ", the first peak of the records";
    case StiffnessOrigin::kGivenFirstMode:
      return "all equal, so that the first mode is at " + hz +
             " (--first_mode_hz)";
  }
  return "";
}

// Adds the model of a deck: its exports, and how they become small.
void AddDeck(const CaseDraft& draft, std::string* out) {
  const DeckModel& deck = *draft.deck;
  *out += "\n# Matrices exported from the deck.\n";
  *out += "[model.finite_element]\n";
  AppendLine("mass      = " + TomlText(PathInCase(deck.mass, draft.path)), "",
             out);
  AppendLine("stiffness = " + TomlText(PathInCase(deck.stiffness, draft.path)),
             "", out);
  *out +=
      "\n# Keeps the DOFs of sensors and forces, and modes of the rest. "
      "pinode_check says\n# how accurate that is.\n[model.reduction]\n";
  AppendLine("method  = \"craig_bampton\"", "", out);
  const std::string modes = std::to_string(kReducedModes);
  AppendLine("modes   = " + modes, "", out);
  AppendLine("compare = " + modes, "modes compared with the full model", out);
  AppendLine("renew   = true", "the basis follows the result of the fit", out);
}

// Adds the groups of a deck, one a changed export.
void AddDeckGroups(const CaseDraft& draft, std::string* out) {
  *out +=
      "\n# The unknowns. 0.1 means: the set's stiffness (mass) is 10 % more "
      "than in the deck.\n";
  for (const DeckGroup& group : draft.deck->groups) {
    *out += "[[group]]\n";
    AppendLine("name           = " + TomlText(group.name), "", out);
    AppendLine(std::string("adds_to        = ") +
                   (group.is_mass ? "\"mass\"" : "\"stiffness\""),
               "", out);
    AppendLine(
        "changed_export = " + TomlText(PathInCase(group.file, draft.path)), "",
        out);
    AppendLine("factor         = " + TomlNumber(draft.deck_factor),
               "factor on the property of the set in this export", out);
    AppendLine("lower          = -0.95", "", out);
    *out += "\n";
  }
}

// Adds where the model is, for pictures and the updated deck.
void AddGeometry(const CaseDraft& draft, std::string* out) {
  *out += "\n[geometry]\n";
  AppendLine("file = " + TomlText(PathInCase(draft.deck->deck, draft.path)), "",
             out);
  std::vector<std::string> sets;
  for (const DeckGroup& group : draft.deck->groups) {
    if (group.set != group.name) {
      sets.push_back(TomlText(group.name) + " = " + TomlText(group.set));
    }
  }
  if (sets.empty()) return;
  AppendLine("groups = {" + Join(sets, ", ") + "}", "", out);
}

void AddModel(const CaseDraft& draft, std::string* out) {
  const UnitSystem& units = draft.units;
  *out += "\n# Units of the model. Records have units of their own.\n[units]\n";
  AppendLine("force  = " + TomlText(units.force), "", out);
  AppendLine("length = " + TomlText(units.length), "", out);
  AppendLine("time   = " + TomlText(units.time), "", out);
  *out += "\n[model]\n";
  const bool is_free = draft.rayleigh_mass > 0.0 ||
                       !draft.damped_modes.empty() || draft.damped_from > 0;
  const std::string rule =
      draft.rayleigh_mass > 0.0
          ? "rayleigh = [" + TomlNumber(draft.rayleigh_mass) + ", " +
                TomlNumber(draft.rayleigh_stiffness) + "]"
          : "ratios = [" + TomlNumber(draft.damping_ratio) + "]";
  AppendLine("damping = {" + rule + "}",
             PercentOf(draft.damping_ratio) + " of critical, a guess" +
                 (is_free ? "; the fit updates it" : ""),
             out);
  if (draft.deck != nullptr) {
    AddDeck(draft, out);
    return;
  }
  *out +=
      "\n# From the lowest storey up: u1 is the floor above the first "
      "storey.\n[model.shear_building]\n";
  *out += "# " + MassUnitName(units) + ": " + draft.masses_origin + "\n";
  AppendLine("masses      = " + TomlNumbers(draft.masses), "", out);
  *out +=
      "# " + StiffnessUnitName(units) + ": " + StiffnessComment(draft) + "\n";
  AppendLine("stiffnesses = " + TomlNumbers(draft.stiffnesses), "", out);
}

// Adds the storeys.
void AddStoreys(const CaseDraft& draft, std::string* out) {
  *out +=
      "\n# The unknowns. k1 = 0.1 means: the first storey is 10 % stiffer "
      "than above.\n";
  for (int i = 1; i <= draft.num_storeys(); ++i) {
    const std::string storey = std::to_string(i);
    *out += "[[group]]\n";
    AppendLine("name    = " + TomlText("k" + storey), "", out);
    AppendLine("adds_to = \"stiffness\"", "", out);
    AppendLine("storey  = " + storey, "", out);
    AppendLine("lower   = -0.95", i == 1 ? "a storey keeps some stiffness" : "",
               out);
    *out += "\n";
  }
}

// Adds the damping of each storey, with a factor on its initial value.
void AddDampers(const CaseDraft& draft, std::string* out) {
  const UnitSystem& units = draft.units;
  std::string below = "ground";
  for (int i = 1; i <= draft.num_storeys(); ++i) {
    const std::string floor = "u" + std::to_string(i);
    *out += "\n[[group]]\n";
    AppendLine("name    = " + TomlText(DraftedDamperName(i)),
               i == 1 ? "the damping of each storey" : "", out);
    AppendLine("adds_to = \"damping\"", "", out);
    AppendLine("between = [" + TomlText(below) + ", " + TomlText(floor) + "]",
               "", out);
    AppendLine(
        "scale   = " +
            TomlNumber(draft.rayleigh_stiffness *
                       draft.stiffnesses[static_cast<size_t>(i - 1)]),
        i == 1 ? units.force + "*" + units.time + "/" + units.length : "", out);
    AppendLine("lower   = -1.0", "", out);
    below = floor;
  }
}

// Adds the factors on Rayleigh's damping.
void AddRayleigh(const CaseDraft& draft, std::string* out) {
  *out +=
      draft.storeys_are_damped
          ? "# The parts of the damping, each with a factor: -1 removes "
            "it.\n"
          : "# The two parts of the damping, each with a factor: -1 removes "
            "it.\n";
  if (!draft.storeys_are_damped && draft.some_damping_is_hidden) {
    *out += "# The records do not show the damping of each storey.\n";
  }
  *out += "[[group]]\n";
  AppendLine("name            = " + TomlText(kDraftedMassDamping), "", out);
  AppendLine("adds_to         = \"damping\"", "", out);
  AppendLine("proportional_to = \"mass\"", "", out);
  AppendLine("scale           = " + TomlNumber(draft.rayleigh_mass), "", out);
  AppendLine("lower           = -1.0", "", out);
  if (draft.storeys_are_damped) {
    AddDampers(draft, out);
    return;
  }
  if (draft.rayleigh_stiffness <= 0.0) return;
  *out += "\n[[group]]\n";
  AppendLine("name            = \"c_stiffness\"", "", out);
  AppendLine("adds_to         = \"damping\"", "", out);
  AppendLine("proportional_to = \"stiffness\"", "", out);
  AppendLine("scale           = " + TomlNumber(draft.rayleigh_stiffness), "",
             out);
  AppendLine("lower           = -1.0", "", out);
}

// Adds the damping ratios.
void AddDamping(const CaseDraft& draft, std::string* out) {
  std::vector<int> modes = draft.damped_modes;
  if (draft.damped_from > 0) modes.push_back(draft.damped_from);
  if (!modes.empty()) {
    *out += "# The damping of the modes. 0.5 means: " +
            PercentOf(1.5 * draft.damping_ratio) + " instead of " +
            PercentOf(draft.damping_ratio) + "; -1 removes it.\n";
  }
  for (size_t i = 0; i < modes.size(); ++i) {
    if (i > 0) *out += "\n";
    *out += "[[group]]\n";
    const int mode = modes[i];
    AppendLine("name    = " + TomlText(DraftedRatioName(draft, mode)), "", out);
    AppendLine("adds_to = \"damping\"", "", out);
    if (mode == draft.damped_from) {
      AppendLine("modes_from = " + std::to_string(mode),
                 "this mode and all higher ones", out);
    } else {
      AppendLine("mode    = " + std::to_string(mode), "", out);
    }
    AppendLine("ratio   = " + TomlNumber(draft.damping_ratio), "", out);
    AppendLine("lower   = -1.0", "", out);
  }
  if (draft.some_damping_is_hidden) {
    *out += "# The records do not show the damping of " +
            std::string(modes.empty() ? "any mode" : "other modes") +
            ": it stays at " + PercentOf(draft.damping_ratio) + ".\n";
  }
}

void AddGroups(const CaseDraft& draft, std::string* out) {
  if (draft.deck != nullptr) {
    AddDeckGroups(draft, out);
  } else {
    AddStoreys(draft, out);
  }
  if (draft.rayleigh_mass > 0.0) {
    AddRayleigh(draft, out);
  } else {
    AddDamping(draft, out);
  }
}

void AddSignal(const DraftSignal& signal, std::string* out) {
  AppendLine("  unit      = " + TomlText(signal.unit),
             signal.unit_is_stated ? "as the file states" : "as given", out);
  if (signal.scale != 1.0) {
    AppendLine("  scale     = " + TomlNumber(signal.scale, 15),
               "factor on the column's numbers, as given", out);
  }
  if (signal.is_upside_down) {
    AppendLine("  sign      = -1", "the sensor is upside down", out);
  }
  if (signal.moves_against) {
    AppendLine(
        signal.is_upside_down ? "  # without sign = -1?" : "  # sign    = -1",
        "moves against the others in the first mode: upside down?", out);
  }
  if (signal.remove_offset) {
    AppendLine("  remove_offset = true", "the mean is not zero", out);
  }
}

// Adds the interpolation of the load between samples, with its reason.
void AppendInterpolation(const LoadInterpolation& found, std::string* out) {
  const auto percent = [](double error) {
    return FormatNumber(100.0 * error, 2) + " %";
  };
  const std::string errors = found.linear_error > 0.0
                                 ? "samples left out: cubic misses " +
                                       percent(found.cubic_error) +
                                       ", linear " + percent(found.linear_error)
                                 : "of the load between samples";
  AppendLine(std::string("interpolation = ") +
                 (found.is_cubic ? "\"cubic\"" : "\"linear\""),
             errors, out);
}

void AddRecord(const DraftRecord& record, const std::string& case_path,
               std::string* out) {
  *out += "\n[[record]]\n";
  AppendLine("name = " + TomlText(record.name), "", out);
  AppendLine(std::string("role = ") +
                 (record.is_holdout ? "\"holdout\"" : "\"train\""),
             record.is_holdout
                 ? "not fitted: shows the quality of the prediction"
                 : "",
             out);
  AppendLine("file = " + TomlText(PathInCase(record.file, case_path)),
             FormatNumber(record.duration, 4) + " s at " +
                 FormatNumber(1.0 / record.step, 5) + " Hz",
             out);
  if (record.time_column.empty()) {
    AppendLine("sampling_rate_hz = " + TomlNumber(record.sampling_rate_hz), "",
               out);
  } else {
    AppendLine("time = " + TomlText(record.time_column), "", out);
    if (!record.time_unit.empty()) {
      AppendLine("time_unit = " + TomlText(record.time_unit), "", out);
    }
  }
  for (const auto& [key, value] : record.format.Keys()) {
    AppendLine(key + " = " + (key == "header_lines" ? value : TomlText(value)),
               "", out);
  }
  if (record.base.empty() && record.forces.empty()) {
    AppendLine("excitation = \"ambient\"", "no load was measured", out);
  } else {
    if (record.starts_at_rest) {
      AppendLine("start = \"rest\"", "the record begins before the motion",
                 out);
    } else {
      AppendLine("start = \"free\"", "the record begins in motion: estimated",
                 out);
    }
    AppendInterpolation(record.interpolation, out);
  }
  for (const DraftSignal& signal : record.base) {
    *out += "\n  [[record.ground]]\n";
    AppendLine("  direction = " + TomlText(signal.dof), "", out);
    AppendLine("  column    = " + TomlText(signal.column),
               signal.is_by_name ? "the base, by its name" : "the base", out);
    AddSignal(signal, out);
  }
  for (const DraftSignal& signal : record.forces) {
    *out += "\n  [[record.force]]\n";
    AppendLine("  column    = " + TomlText(signal.column), "", out);
    AppendLine("  dof       = " + TomlText(signal.dof), "", out);
    AddSignal(signal, out);
  }
  for (const DraftSignal& signal : record.floors) {
    *out += "\n  [[record.channel]]\n";
    AppendLine("  column    = " + TomlText(signal.column), "", out);
    AppendLine("  quantity  = \"absolute_acceleration\"", "", out);
    AppendLine("  dof       = " + TomlText(signal.dof),
               signal.is_by_name ? "by the column's name" : "", out);
    AddSignal(signal, out);
  }
}

std::string TitleOf(const CaseDraft& draft) {
  if (!draft.title.empty()) return draft.title;
  if (draft.deck != nullptr) {
    return std::filesystem::path(draft.deck->deck).stem().string();
  }
  return "Building of " + std::to_string(draft.num_storeys()) + " storeys";
}

}  // namespace

std::string CaseDraftText(const CaseDraft& draft, const std::string& command) {
  // A comment is one line.
  std::string one_line = command;
  for (char& c : one_line) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  std::string text = std::string(kFirstLine) + ":\n#   " + one_line +
                     "\n# Check it and correct what is wrong. All keys: "
                     "pinode/case/README.md (case_files.md).\n";
  text += "title = " + TomlText(TitleOf(draft)) + "\n";
  AddModel(draft, &text);
  AddGroups(draft, &text);
  for (const DraftRecord& record : draft.records) {
    AddRecord(record, draft.path, &text);
  }
  if (draft.deck != nullptr) AddGeometry(draft, &text);
  if (!draft.remarks.empty()) text += "\n# Please check:\n";
  for (const std::string& remark : draft.remarks) {
    text += "# - " + remark + "\n";
  }
  return text;
}

std::string DraftedDamperName(int storey) {
  return "c" + std::to_string(storey);
}

std::string DraftedRatioName(const CaseDraft& draft, int mode) {
  return mode == draft.damped_from ? "zeta_rest"
                                   : "zeta" + std::to_string(mode);
}

bool ReadCaseDraft(const std::string& text, const std::string& path, Case* c,
                   std::string* error) {
  TomlValue root;
  return ParseToml(text, path, &root, error) &&
         ReadCaseTree(root, path, nullptr, CasePurpose::kCheck, c, error);
}

bool IsCaseDraft(const std::string& text) {
  return text.rfind(kFirstLine, 0) == 0;
}

}  // namespace pinode
