#include "pinode/case/sections/finite_element_section.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/case/sections/exported_group.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/case/sections/named_dofs.h"

namespace pinode {
namespace {

constexpr double kDefaultFrequencyTolerance = 0.01;
// Largest number of DOFs without a reduction: all become states of the
// identification.
constexpr int kLargestWhole = 100;
// Largest number of DOFs in a response file; larger text files are impractical.
constexpr int kMostExpanded = 5000;
// Largest number of modes that may be asked for. The modes of a model are
// vectors of its size, all in memory at a time.
constexpr int kMostModes = 10000;
// Largest number of names that are compared for a hint, which must be quick.
constexpr int kLargestHinted = 5000;

struct MethodName {
  const char* name;
  ReductionMethod method;
};
constexpr MethodName kMethods[] = {
    {"guyan", ReductionMethod::kGuyan},
    {"serep", ReductionMethod::kSerep},
    {"craig_bampton", ReductionMethod::kCraigBampton},
    {"modal", ReductionMethod::kModal}};

std::string HintAmong(const std::string& name,
                      const FiniteElementModel& model) {
  return model.num_dofs() <= kLargestHinted
             ? NameHint(name, model.dof_names)
             : ", expected a name such as '" + model.dof_names.front() + "'";
}

// Returns the direction at the end of a name such as "12.3" or "12.3#1"; 0 if
// there is none.
int DirectionOf(const std::string& name) {
  const std::string plain = name.substr(0, name.find('#'));
  const size_t point = plain.rfind('.');
  if (point == std::string::npos || point + 2 != plain.size()) return 0;
  const char digit = plain[point + 1];
  return digit >= '1' && digit <= '6' ? digit - '0' : 0;
}

class SectionReader {
 public:
  SectionReader(const TomlTable& root, const TomlTable& model_table,
                const UnitSystem& units, FiniteElementSection* section)
      : root_(root),
        model_table_(model_table),
        table_(model_table.Table("finite_element", "[model.finite_element]")),
        reduction_(model_table.Table("reduction", "[model.reduction]")),
        units_(units),
        section_(section),
        structure_(section->structure) {}

  bool Read() {
    return ReadExport() && RemoveNamedDofs() && ReadMethod() && FindKept() &&
           ReadExpected() && ReadBasisPoint() && MakeSmall() &&
           CheckExpected() && ReadInfluence();
  }

 private:
  bool ReadExport() {
    if (!table_.AllowKeys() ||
        !table_.RequireKey("mass", "the file of the mass matrix") ||
        !table_.RequireKey("stiffness", "the file of the stiffness matrix")) {
      return false;
    }
    for (const char* key :
         {"dofs", "mass", "stiffness", "influence", "expected_hz"}) {
      if (model_table_.Has(key)) {
        return model_table_.Fail(key,
                                 std::string("'") + key +
                                     "' and [model.finite_element] are both "
                                     "given; move it there, or leave it out");
      }
    }
    MatrixSource names;
    FiniteElementFiles& files = section_->files;
    const TomlValue* dofs = table_.Find("dofs");
    const bool listed =
        dofs != nullptr && dofs->type == TomlValue::Type::kArray;
    if (listed && !ReadDofNames(table_, &files.names)) return false;
    if (!ReadSource(table_, "mass", &files.mass) ||
        !ReadSource(table_, "damping", &files.damping) ||
        !ReadSource(table_, "stiffness", &files.stiffness) ||
        (!listed && !ReadSource(table_, "dofs", &names))) {
      return false;
    }
    files.dof_names = names.path;
    std::string error;
    if (!ReadFiniteElementModel(files, &structure_.exported, &error)) {
      return table_.errors()->FailAsIs(error);
    }
    return true;
  }

  bool RemoveNamedDofs() {
    const FiniteElementModel& exported = structure_.exported;
    for (const std::string& name : table_.Strings("remove_dofs")) {
      const int dof = exported.DofIndex(name);
      if (dof < 0) {
        return table_.Fail("remove_dofs",
                           "'" + name +
                               "' is not a DOF of the finite-element model" +
                               HintAmong(name, exported));
      }
      structure_.removed_dofs.push_back(dof);
    }
    if (!table_.errors()->ok()) return false;
    std::vector<int>& removed = structure_.removed_dofs;
    std::sort(removed.begin(), removed.end());
    removed.erase(std::unique(removed.begin(), removed.end()), removed.end());
    if (static_cast<int>(removed.size()) == exported.num_dofs()) {
      return table_.Fail("remove_dofs",
                         "'remove_dofs' names every DOF, expected one to stay");
    }
    structure_.model =
        removed.empty() ? exported : RemoveDofs(exported, removed);
    structure_.export_notes = exported.notes;
    for (std::string& note : DescribeSpecialDofs(structure_.model)) {
      structure_.export_notes.push_back(std::move(note));
    }
    return true;
  }

  bool ReadMethod() {
    if (!reduction_.AllowKeys()) {
      return false;
    }
    ReductionOptions& options = structure_.options;
    structure_.is_reduced = model_table_.Has("reduction");
    options.method = ReductionMethod::kGuyan;
    if (!structure_.is_reduced) return true;
    if (!reduction_.RequireKey("method",
                               "guyan, serep, craig_bampton or modal")) {
      return false;
    }
    const std::string method = reduction_.String("method");
    for (const MethodName& entry : kMethods) {
      if (method == entry.name) options.method = entry.method;
    }
    reduction_.Choice("method", {"guyan", "serep", "craig_bampton", "modal"},
                      method);
    options.num_modes = reduction_.Integer("modes", 0, 0, kMostModes);
    options.num_compared_modes = reduction_.Integer(
        "compare", options.num_compared_modes, 1, kMostModes);
    structure_.renew_basis = reduction_.Boolean("renew", false);
    return reduction_.errors()->ok() && ReadExpanded();
  }

  // Reads "all", or names of DOFs.
  bool ReadExpanded() {
    const FiniteElementModel& exported = structure_.exported;
    const TomlValue* value = reduction_.Find("expand");
    if (value == nullptr) return true;
    std::vector<int>& dofs = structure_.expanded_dofs;
    if (value->type == TomlValue::Type::kString) {
      if (value->text != "all") {
        return reduction_.Fail("expand", "'expand' is '" + value->text +
                                             "', expected \"all\" or names of "
                                             "DOFs [\"...\", ...]");
      }
      if (exported.num_dofs() > kMostExpanded) {
        return reduction_.Fail(
            "expand",
            "'expand' is \"all\" of " + std::to_string(exported.num_dofs()) +
                " DOFs, expected at most " + std::to_string(kMostExpanded) +
                "; name the DOFs that you need");
      }
      dofs.resize(static_cast<size_t>(exported.num_dofs()));
      std::iota(dofs.begin(), dofs.end(), 0);
      return true;
    }
    for (const std::string& name : reduction_.Strings("expand")) {
      dofs.push_back(exported.DofIndex(name));
      if (dofs.back() >= 0) continue;
      return reduction_.Fail(
          "expand", "'" + name + "' is not a DOF of the finite-element model" +
                        HintAmong(name, exported));
    }
    return reduction_.errors()->ok();
  }

  // Finds the DOFs to keep: those that the case names must be kept and, without
  // `keep`, are all that is kept.
  bool FindKept() {
    const FiniteElementModel& model = structure_.model;
    std::vector<std::string>& kept = structure_.options.kept_dofs;
    if (!structure_.is_reduced) {
      if (model.num_dofs() > kLargestWhole) {
        return table_.Fail("stiffness",
                           "the finite-element model has " +
                               std::to_string(model.num_dofs()) +
                               " DOFs, too many without a [model.reduction]; "
                               "expected at most " +
                               std::to_string(kLargestWhole) + "");
      }
      kept = model.dof_names;
    } else if (reduction_.Has("keep")) {
      kept = reduction_.Strings("keep");
      if (!reduction_.errors()->ok()) return false;
    }
    const bool given = !kept.empty();
    const auto is_dof = [&model](const std::string& name) {
      return model.DofIndex(name) >= 0;
    };
    for (const NamedDof& dof : NamedDofs(root_.entries(), is_dof)) {
      if (IsModeName(dof.name)) continue;
      if (!is_dof(dof.name)) {
        const bool removed = structure_.exported.DofIndex(dof.name) >= 0;
        return root_.errors()->Fail(
            dof.line, "'" + dof.name +
                          "' is not a DOF of the finite-element model" +
                          (removed ? ": [model.finite_element] removes it"
                                   : HintAmong(dof.name, model)));
      }
      if (!given) {
        kept.push_back(dof.name);
      } else if (std::find(kept.begin(), kept.end(), dof.name) == kept.end()) {
        return root_.errors()->Fail(
            dof.line, "'" + dof.name +
                          "' is not among the DOFs that [model.reduction] "
                          "keeps; add it there");
      }
    }
    if (kept.empty()) KeepShapes(&kept);
    if (structure_.is_reduced && !HasMatrixOfCoordinates()) SortAsExported();
    return true;
  }

  // True if the case gives a matrix or a start by the positions of the kept
  // DOFs: their order is then the user's.
  bool HasMatrixOfCoordinates() const {
    for (const char* key : {"influence", "support_mass_coupling"}) {
      if (model_table_.Find(key) != nullptr) return true;
    }
    const TomlValue* records = root_.Find("record");
    if (records != nullptr && records->IsArrayOfTables() &&
        std::any_of(records->elements.begin(), records->elements.end(),
                    [](const TomlValue& record) {
                      const TomlValue* start = record.Find("start");
                      return start != nullptr && start->IsTable();
                    })) {
      return true;
    }
    const TomlValue* damping = model_table_.Find("damping");
    if (damping != nullptr && damping->type != TomlValue::Type::kString &&
        !(damping->IsTable() && (damping->Find("rayleigh") != nullptr ||
                                 damping->Find("ratios") != nullptr))) {
      return true;
    }
    const TomlValue* groups = root_.Find("group");
    return groups != nullptr && groups->IsArrayOfTables() &&
           std::any_of(groups->elements.begin(), groups->elements.end(),
                       [](const TomlValue& group) {
                         return group.Find("matrix") != nullptr;
                       });
  }

  // Sorts the kept DOFs as in the export. Two cases of one structure may name
  // them in different orders; their matrices can then still be compared.
  void SortAsExported() {
    std::vector<std::string>& kept = structure_.options.kept_dofs;
    std::vector<std::pair<int, std::string>> places;
    for (std::string& name : kept) {
      places.emplace_back(structure_.model.DofIndex(name), std::move(name));
    }
    std::stable_sort(
        places.begin(), places.end(),
        [](const auto& a, const auto& b) { return a.first < b.first; });
    for (size_t i = 0; i < places.size(); ++i) {
      kept[i] = std::move(places[i].second);
    }
  }

  // Modes alone: keeps the DOFs of their shapes. A mode's shape may be in a
  // file, which says nothing here.
  void KeepShapes(std::vector<std::string>* kept) const {
    const TomlValue* modes = root_.Find("mode");
    if (modes == nullptr) return;
    for (const TomlValue& mode : modes->elements) {
      const TomlValue* shape = mode.Find("shape");
      if (shape == nullptr) continue;
      for (const auto& [name, value] : shape->entries) {
        (void)value;
        if (structure_.model.DofIndex(name) >= 0 &&
            std::find(kept->begin(), kept->end(), name) == kept->end()) {
          kept->push_back(name);
        }
      }
    }
  }

  // True for q1, q2, ..., the names of modes.
  bool IsModeName(const std::string& name) const {
    if (structure_.model.DofIndex(name) >= 0 || name.size() < 2 ||
        name[0] != 'q') {
      return false;
    }
    double number = 0.0;
    return ParseDouble(name.substr(1), &number) && number >= 1.0 &&
           number <= structure_.options.num_modes;
  }

  bool ReadExpected() {
    structure_.expected_hz = table_.Numbers("expected_frequencies");
    tolerance_ = table_.PositiveNumber("frequency_tolerance",
                                       kDefaultFrequencyTolerance);
    if (!table_.errors()->ok()) return false;
    int& compared = structure_.options.num_compared_modes;
    compared =
        std::max(compared, static_cast<int>(structure_.expected_hz.size()));
    return true;
  }

  // Sets M and K of the basis point.
  bool ReadBasisPoint() {
    std::vector<GroupAtBasis> at_basis;
    const TomlTable at =
        reduction_.Table("basis_at", "[model.reduction] basis_at");
    const std::vector<TomlTable> groups = root_.Tables("group");
    for (const auto& [name, value] : at.entries()) {
      (void)value;
      const double alpha = at.Number(name, 0.0);
      if (!at.errors()->ok()) return false;
      const auto table = std::find_if(groups.begin(), groups.end(),
                                      [&name = name](const TomlTable& group) {
                                        return group.String("name") == name;
                                      });
      MatrixGroup::Target target = MatrixGroup::Target::kDamping;
      ReducedStructure::Group group;
      if (table != groups.end() &&
          ParseTarget(table->String("adds_to"), &target) &&
          target != MatrixGroup::Target::kDamping &&
          !ReadGroupOverAll(*table, target, &group)) {
        return false;
      }
      if (group.matrix.rows() == 0) {
        return at.Fail(
            name,
            "'" + name +
                "' is not a group of mass or stiffness over the DOFs of the "
                "finite-element model (changed_export, set_export, between)");
      }
      ReducedStructure::Group& kept = section_->groups_at_basis[name];
      kept = std::move(group);
      at_basis.push_back({name, target, &kept.matrix, alpha});
    }
    std::string error;
    return SetBasisPoint(at_basis, &structure_, &error) ||
           reduction_.Fail("basis_at",
                           "with the groups at 'basis_at' " + error);
  }

  bool HasBasisPoint() const { return !structure_.basis_at.empty(); }

  // Reads the matrix of a [[group]] over all DOFs before there is a basis; 0 x
  // 0 if it is not given over all DOFs.
  bool ReadGroupOverAll(const TomlTable& table, MatrixGroup::Target target,
                        ReducedStructure::Group* group) {
    if (table.Has("changed_export") || table.Has("set_export")) {
      return ReadSetMatrix(table, *section_, target, group);
    }
    if (!table.Has("between")) return true;
    std::vector<int> ends;
    const std::vector<std::string>& kept = structure_.options.kept_dofs;
    for (const std::string& name : table.Strings("between")) {
      const auto place = std::find(kept.begin(), kept.end(), name);
      ends.push_back(
          place == kept.end() ? -1 : static_cast<int>(place - kept.begin()));
    }
    const double scale = table.PositiveNumber("scale", 1.0);
    if (!table.errors()->ok()) return false;
    if (ends.size() == 2) {
      *group = SpringGroup(structure_, scale, ends[0], ends[1]);
    }
    return true;
  }

  bool MakeSmall() {
    std::string error;
    if (Reduce(&structure_, &error)) return true;
    return structure_.is_reduced
               ? reduction_.Fail(reduction_.Has("keep") ? "keep" : "method",
                                 error)
               : table_.Fail("stiffness", error);
  }

  int NumModes() const {
    const Vector diagonal = structure_.model.mass.diagonal();
    return static_cast<int>((diagonal.array() > 0.0).count());
  }

  bool CheckExpected() {
    if (structure_.expected_hz.empty()) return true;
    // The modes are in the model's unit of time.
    double second = 1.0;
    std::string error;
    if (!UnitFactor("s", Dimension::kTime, units_, &second, &error)) {
      return table_.Fail("expected_frequencies", error);
    }
    // Modes of the export itself. Rigid-body modes come first, and have no
    // expected frequency.
    SparseModes in_hz = structure_.reduced.whole_modes;
    const auto needed = static_cast<int>(structure_.expected_hz.size()) +
                        in_hz.num_rigid_body_modes;
    if ((HasBasisPoint() || in_hz.eigenvalues.size() < needed) &&
        needed <= NumModes()) {
      if (!ComputeLowestModes(structure_.model.mass, structure_.model.stiffness,
                              needed, &in_hz, &error)) {
        return table_.Fail("expected_frequencies", error);
      }
      if (!HasBasisPoint()) structure_.reduced.whole_modes = in_hz;
    }
    in_hz.frequency_hz *= second;
    if (!CheckExpectedFrequencies(in_hz, structure_.expected_hz, tolerance_,
                                  &error)) {
      return table_.Fail("expected_frequencies", error);
    }
    return true;
  }

  // Reads r over all DOFs, one column per direction of ground motion.
  bool ReadInfluence() {
    std::vector<std::string>* directions = &structure_.directions;
    Matrix* influence = &structure_.influence;
    const FiniteElementModel& model = structure_.model;
    const int n = model.num_dofs();
    std::vector<int> direction_of;
    bool has_directions = true;
    for (const std::string& name : model.dof_names) {
      direction_of.push_back(DirectionOf(name));
      has_directions = has_directions && direction_of.back() > 0;
    }
    std::vector<int> numbers;
    if (table_.Has("ground_directions")) {
      const TomlTable inner = table_.Table("ground_directions",
                                           "[model.finite_element] "
                                           "ground_directions");
      for (const auto& [name, value] : inner.entries()) {
        (void)value;
        directions->push_back(name);
        numbers.push_back(inner.Integer(name, 1, 1, 1000000000));
        if (!table_.errors()->ok()) return false;
        if (numbers.back() > 3) {
          return inner.Fail(name, "'" + name + "' is " +
                                      std::to_string(numbers.back()) +
                                      ", expected 1, 2 or 3, the number "
                                      "behind the point in names of DOFs");
        }
      }
      if (!table_.errors()->ok()) return false;
      if (!has_directions) {
        return table_.Fail("ground_directions",
                           "'ground_directions' needs names of DOFs with a "
                           "direction, expected node.direction such as 12.3");
      }
    } else if (has_directions) {
      for (int number = 1; number <= 3; ++number) {
        if (std::find(direction_of.begin(), direction_of.end(), number) ==
            direction_of.end()) {
          continue;
        }
        directions->push_back(std::string(1, "xyz"[number - 1]));
        numbers.push_back(number);
      }
    } else {
      *directions = {"x"};
      *influence = Matrix::Ones(n, 1);
      return true;
    }
    *influence = Matrix::Zero(n, static_cast<Eigen::Index>(directions->size()));
    for (size_t d = 0; d < numbers.size(); ++d) {
      for (int i = 0; i < n; ++i) {
        if (direction_of[static_cast<size_t>(i)] == numbers[d]) {
          (*influence)(i, static_cast<Eigen::Index>(d)) = 1.0;
        }
      }
    }
    return true;
  }

  const TomlTable& root_;
  const TomlTable& model_table_;
  const TomlTable table_;
  const TomlTable reduction_;
  const UnitSystem& units_;
  FiniteElementSection* section_;
  ReducedStructure& structure_;
  double tolerance_ = kDefaultFrequencyTolerance;
};

}  // namespace

const char* ReductionMethodName(ReductionMethod method) {
  for (const MethodName& entry : kMethods) {
    if (entry.method == method) return entry.name;
  }
  return "";
}

bool ReadFiniteElementSection(const TomlTable& root, const TomlTable& table,
                              const UnitSystem& units,
                              std::shared_ptr<FiniteElementSection>* section) {
  auto result = std::make_shared<FiniteElementSection>();
  if (!SectionReader(root, table, units, result.get()).Read()) return false;
  *section = std::move(result);
  return true;
}

}  // namespace pinode
