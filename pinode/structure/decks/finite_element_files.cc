#include "pinode/structure/decks/finite_element_files.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrices/abaqus_matrix.h"
#include "pinode/structure/matrices/calculix.h"
#include "pinode/structure/matrices/mat_file.h"
#include "pinode/structure/matrices/matrix_container.h"
#include "pinode/structure/matrices/matrix_io.h"
#include "pinode/structure/matrices/matrix_market.h"
#include "pinode/structure/matrices/matrix_text.h"
#include "pinode/structure/matrices/npz.h"
#include "pinode/structure/matrices/op4.h"

namespace pinode {
namespace {

enum Role { kMass, kDamping, kStiffness, kNumRoles };

const char* RoleName(int role) {
  static const char* const kNames[] = {"mass", "damping", "stiffness"};
  return kNames[role];
}

// Returns the usual names of a matrix, in lower case.
const std::vector<std::string>& UsualNames(int role) {
  static const std::vector<std::string> kUsual[] = {
      {"m", "mass", "mgg", "maa", "mff", "mhh", "mxx"},
      {"c", "damping", "d", "bgg", "baa", "bff", "damp"},
      {"k", "stiffness", "kgg", "kaa", "kff", "khh", "kxx", "stiff"}};
  return kUsual[role];
}

std::string Extension(const std::string& path) {
  return LowerCase(std::filesystem::path(WithoutGz(path)).extension().string());
}

// A matrix as in its file.
struct LoadedMatrix {
  enum class Kind { kAbsent, kWhole, kIndexed, kAbaqus };

  Kind kind = Kind::kAbsent;
  SparseMatrix matrix;  // kWhole
  // kIndexed: the size is known only when all files have been read.
  std::vector<MatrixEntry> entries;
  bool mirrored = false;
  int size = 0;
  AbaqusMatrix abaqus;  // kAbaqus
};

class ModelReader {
 public:
  ModelReader(const FiniteElementFiles& files, std::string* error)
      : sources_{&files.mass, &files.damping, &files.stiffness},
        names_path_(files.dof_names),
        error_(error),
        names_(files.names),
        are_names_listed_(!files.names.empty()),
        has_set_(files.has_set),
        names_source_(files.names.empty() ? "" : "the list of DOFs") {}

  bool Read(FiniteElementModel* model) {
    for (const int role : {kMass, kStiffness}) {
      if (sources_[role]->path.empty()) {
        *error_ = std::string("no file for the ") + RoleName(role) +
                  " matrix, expected one";
        return false;
      }
    }
    for (int role = 0; role < kNumRoles; ++role) {
      if (!sources_[role]->path.empty() && !Load(role)) return false;
    }
    if (!ReadNames()) return false;
    const bool abaqus = loaded_[kStiffness].kind == LoadedMatrix::Kind::kAbaqus;
    for (const LoadedMatrix& loaded : loaded_) {
      if (loaded.kind != LoadedMatrix::Kind::kAbsent &&
          (loaded.kind == LoadedMatrix::Kind::kAbaqus) != abaqus) {
        *error_ = sources_[kStiffness]->path +
                  ": matrices of Abaqus name their DOFs, others go by "
                  "position, expected files of one kind";
        return false;
      }
    }
    if (!(abaqus ? MergeByName() : MergeByPosition())) return false;
    if (are_names_listed_ && !AreListedOnce()) return false;
    model_.dof_names = NumberRepeatedNames(std::move(names_), &model_.notes);
    std::string what;
    const SparseMatrix* culprit = nullptr;
    // No matrix is at fault where DOFs are without mass and stiffness, and all
    // of them have names of their own here.
    if (!model_.IsValid(&what, &culprit) &&
        !(has_set_ && culprit == nullptr && HasNames())) {
      const int role = culprit == &model_.mass      ? kMass
                       : culprit == &model_.damping ? kDamping
                                                    : kStiffness;
      return Fail(sources_[role]->path, what);
    }
    for (std::string& sentence : DescribeSpecialDofs(model_)) {
      model_.notes.push_back(std::move(sentence));
    }
    *model = std::move(model_);
    return true;
  }

 private:
  bool HasNames() const {
    const std::vector<std::string>& names = model_.dof_names;
    return !names.empty() &&
           std::find(names.begin(), names.end(), "") == names.end();
  }

  bool Fail(const std::string& path, const std::string& message) {
    *error_ = path + ": " + message;
    return false;
  }

  // Names that a program writes several times are numbered. A list of names
  // must name each one.
  bool AreListedOnce() {
    std::unordered_map<std::string, size_t> first;
    for (size_t i = 0; i < names_.size(); ++i) {
      const auto [entry, is_new] = first.emplace(names_[i], i);
      if (is_new) continue;
      *error_ = names_source_ + " has " + Quote(names_[i]) + " at " +
                std::to_string(entry->second + 1) + " and at " +
                std::to_string(i + 1) + ", expected each name once";
      return false;
    }
    return true;
  }

  bool Load(int role) {
    const std::string& path = sources_[role]->path;
    const std::string extension = Extension(path);
    LoadedMatrix& loaded = loaded_[role];
    if (sources_[role]->array != nullptr) {
      loaded.kind = LoadedMatrix::Kind::kWhole;
      loaded.matrix = *sources_[role]->array;
      return true;
    }
    if (extension == ".op4" || extension == ".mat" || extension == ".npz") {
      if (WithoutGz(path) != path) {
        return Fail(path,
                    "this compressed file is not text (.mtx, .sti, .mas, "
                    ".csv); unpack it");
      }
      return LoadFromContainer(role, extension, &loaded);
    }
    if (!sources_[role]->variable.empty()) {
      return Fail(path, "a matrix is named (" +
                            Quote(sources_[role]->variable) +
                            ") in a file that holds only one, expected none");
    }
    if (extension == ".sti" || extension == ".mas") {
      loaded.kind = LoadedMatrix::Kind::kIndexed;
      if (default_names_path_.empty()) {
        const std::string beside = std::filesystem::path(WithoutGz(path))
                                       .replace_extension(".dof")
                                       .string();
        std::error_code status;
        if (std::filesystem::is_regular_file(beside, status)) {
          default_names_path_ = beside;
        }
      }
      return ReadIndexedEntries(path, &loaded.entries, &loaded.mirrored,
                                &loaded.size, error_);
    }
    if (extension == ".csv") {
      Matrix dense;
      if (!ReadMatrix(path, &dense, error_)) return false;
      loaded.matrix = dense.sparseView(0.0, 0.0);
      loaded.kind = LoadedMatrix::Kind::kWhole;
      return true;
    }
    if (extension == ".mtx") return LoadMtx(path, &loaded);
    return Fail(path,
                "unknown kind of matrix file, expected .mtx (Matrix Market, "
                "Abaqus), .sti or .mas (CalculiX), .op4, .mat, .npz or .csv");
  }

  bool LoadMtx(const std::string& path, LoadedMatrix* loaded) {
    std::string content;
    if (!ReadTextFile(path, &content, error_)) return false;
    LineReader lines(path, content);
    std::string_view line;
    if (lines.Next(&line) && line.substr(0, 2) == "%%") {
      loaded->kind = LoadedMatrix::Kind::kWhole;
      return ReadMatrixMarketText(path, content, kMaxFiniteElementDofs,
                                  &loaded->matrix, error_);
    }
    loaded->kind = LoadedMatrix::Kind::kAbaqus;
    return ReadAbaqusMatrixText(path, content, &loaded->abaqus, error_);
  }

  bool LoadFromContainer(int role, const std::string& extension,
                         LoadedMatrix* loaded) {
    const std::string& path = sources_[role]->path;
    auto found = containers_.find(path);
    if (found == containers_.end()) {
      MatrixContainer container;
      if (!(extension == ".op4"   ? ReadOp4(path, &container, error_)
            : extension == ".mat" ? ReadMatFile(path, &container, error_)
                                  : ReadNpz(path, &container, error_))) {
        return false;
      }
      found = containers_.emplace(path, std::move(container)).first;
    }
    const MatrixContainer& container = found->second;
    const NamedMatrix* chosen = nullptr;
    if (!Choose(role, container, &chosen)) return false;
    if (!chosen->fault.empty()) {
      return Fail(path, std::string("the ") + RoleName(role) + " matrix " +
                            Quote(chosen->name) +
                            " cannot be used: " + chosen->fault);
    }
    loaded->kind = LoadedMatrix::Kind::kWhole;
    loaded->matrix = chosen->matrix;
    if (!container.dof_names.empty()) {
      if (names_.empty()) {
        names_ = container.dof_names;
        names_source_ = path;
      } else if (names_ != container.dof_names) {
        return Fail(path, "the DOFs are other ones than those of " +
                              names_source_ + ", expected the same");
      }
    }
    return true;
  }

  bool Choose(int role, const MatrixContainer& container,
              const NamedMatrix** chosen) {
    const MatrixSource& source = *sources_[role];
    std::vector<std::string> names;
    for (const NamedMatrix& matrix : container.matrices) {
      names.push_back(matrix.name);
    }
    const std::vector<std::string> wanted =
        source.variable.empty()
            ? UsualNames(role)
            : std::vector<std::string>{LowerCase(source.variable)};
    int count = 0;  // of the name that is chosen
    for (const NamedMatrix& matrix : container.matrices) {
      if (std::find(wanted.begin(), wanted.end(), LowerCase(matrix.name)) ==
          wanted.end()) {
        continue;
      }
      if (*chosen != nullptr && (*chosen)->name == matrix.name) {
        if (++count == source.occurrence) *chosen = &matrix;
        continue;
      }
      if (*chosen != nullptr) {
        return Fail(source.path,
                    "the " + std::string(RoleName(role)) + " matrix may be " +
                        Quote((*chosen)->name) + " or " + Quote(matrix.name) +
                        ", expected the name of one");
      }
      *chosen = &matrix;
      count = 1;
    }
    if (*chosen != nullptr && source.occurrence > count) {
      return Fail(source.path,
                  Quote((*chosen)->name) + " occurs " +
                      (count == 1 ? std::string("once")
                                  : std::to_string(count) + " times") +
                      ", and occurrence = " +
                      std::to_string(source.occurrence) + " is beyond that");
    }
    if (count > 1 && source.occurrence == 0) {
      return Fail(source.path, Quote((*chosen)->name) + " occurs " +
                                   std::to_string(count) +
                                   " times, expected occurrence = 1 to " +
                                   std::to_string(count) + " beside its name");
    }
    if (*chosen == nullptr && source.variable.empty() &&
        container.matrices.size() == 1 && UsedBy(source.path) == 1) {
      *chosen = &container.matrices[0];
    }
    if (*chosen != nullptr) return true;
    return Fail(
        source.path,
        "no matrix " +
            (source.variable.empty()
                 ? "with a usual name of the " + std::string(RoleName(role)) +
                       " matrix (" + Join(wanted, ", ") + ")"
                 : Quote(source.variable)) +
            ", expected one of these: " +
            (names.empty() ? "(the file has none)" : Join(names, ", ")));
  }

  // Returns the number of matrices that are read from this file.
  int UsedBy(const std::string& path) const {
    int count = 0;
    for (const MatrixSource* source : sources_) {
      count += source->path == path ? 1 : 0;
    }
    return count;
  }

  bool ReadNames() {
    std::string path = names_path_;
    if (path.empty() && names_.empty()) path = default_names_path_;
    if (path.empty()) return true;
    names_source_ = path;
    return ReadDofNames(path, &names_, error_);
  }

  SparseMatrix& Target(int role) {
    return role == kMass      ? model_.mass
           : role == kDamping ? model_.damping
                              : model_.stiffness;
  }

  bool MergeByPosition() {
    // Known bounds of the number of DOFs: names, whole matrices, indices.
    Eigen::Index n = static_cast<Eigen::Index>(names_.size());
    bool known = n > 0;
    for (const LoadedMatrix& loaded : loaded_) {
      if (known || loaded.kind != LoadedMatrix::Kind::kWhole) continue;
      n = loaded.matrix.rows();
      known = true;
    }
    if (!known) {
      for (const LoadedMatrix& loaded : loaded_) {
        n = std::max<Eigen::Index>(n, loaded.size);
      }
      model_.notes.push_back("the files do not say how many DOFs there are; " +
                             std::to_string(n) +
                             " is the largest index in them");
    }
    for (int role = 0; role < kNumRoles; ++role) {
      LoadedMatrix& loaded = loaded_[role];
      const std::string& path = sources_[role]->path;
      if (loaded.kind == LoadedMatrix::Kind::kWhole) {
        if (loaded.matrix.rows() != n || loaded.matrix.cols() != n) {
          return Fail(
              path, "the " + std::string(RoleName(role)) + " matrix is " +
                        SizeText(loaded.matrix.rows(), loaded.matrix.cols()) +
                        ", expected " + SizeText(n, n) + " by " + SizeSource());
        }
        Target(role).swap(loaded.matrix);
      } else if (loaded.kind == LoadedMatrix::Kind::kIndexed) {
        if (loaded.size > n) {
          return Fail(path, "the " + std::string(RoleName(role)) +
                                " matrix has an entry of DOF " +
                                std::to_string(loaded.size) + ", expected " +
                                std::to_string(n) + " DOFs by " + SizeSource());
        }
        if (!Assemble(path, static_cast<int>(n), loaded.mirrored,
                      &loaded.entries, &Target(role))) {
          return false;
        }
      }
    }
    if (names_.empty()) names_ = DefaultDofNames(static_cast<int>(n));
    return true;
  }

  // Returns the source of the expected number of DOFs.
  std::string SizeSource() const {
    if (!names_source_.empty()) return names_source_;
    return "the other matrices";
  }

  bool Assemble(const std::string& path, int n, bool mirrored,
                std::vector<MatrixEntry>* entries, SparseMatrix* matrix) {
    MatrixEntry twice;
    if (AssembleMatrix(n, n, mirrored, entries, matrix, &twice)) return true;
    *error_ = path + ":" + std::to_string(twice.line) + ": entry " +
              EntryText(twice.row, twice.column) +
              (mirrored ? " or its mirror image" : "") +
              " was given before, expected each entry once";
    return false;
  }

  bool MergeByName() {
    if (!names_path_.empty() || !names_.empty()) {
      return Fail(names_path_.empty() ? names_source_ : names_path_,
                  "matrices of Abaqus name their DOFs themselves, expected no "
                  "list of names");
    }
    std::set<NodeDirection> all;
    for (const LoadedMatrix& loaded : loaded_) {
      all.insert(loaded.abaqus.dofs.begin(), loaded.abaqus.dofs.end());
    }
    if (all.size() > static_cast<size_t>(kMaxFiniteElementDofs)) {
      return Fail(sources_[kStiffness]->path,
                  std::to_string(all.size()) +
                      " DOFs in all files, expected at most " +
                      std::to_string(kMaxFiniteElementDofs));
    }
    const std::vector<NodeDirection> dofs(all.begin(), all.end());
    const int n = static_cast<int>(dofs.size());
    for (const NodeDirection& dof : dofs) names_.push_back(dof.Name());
    for (int role = 0; role < kNumRoles; ++role) {
      LoadedMatrix& loaded = loaded_[role];
      if (loaded.kind == LoadedMatrix::Kind::kAbsent) continue;
      std::vector<int> position;
      for (const NodeDirection& dof : loaded.abaqus.dofs) {
        position.push_back(static_cast<int>(
            std::lower_bound(dofs.begin(), dofs.end(), dof) - dofs.begin()));
      }
      for (MatrixEntry& entry : loaded.abaqus.entries) {
        entry.row = position[static_cast<size_t>(entry.row)];
        entry.column = position[static_cast<size_t>(entry.column)];
      }
      if (!Assemble(sources_[role]->path, n, loaded.abaqus.mirrored,
                    &loaded.abaqus.entries, &Target(role))) {
        return false;
      }
    }
    return true;
  }

  const MatrixSource* const sources_[kNumRoles];
  const std::string names_path_;
  std::string* const error_;

  LoadedMatrix loaded_[kNumRoles];
  std::map<std::string, MatrixContainer> containers_;
  std::vector<std::string> names_;
  const bool are_names_listed_;
  const bool has_set_;
  std::string names_source_;
  std::string default_names_path_;
  FiniteElementModel model_;
};

}  // namespace

bool ReadFiniteElementModel(const FiniteElementFiles& files,
                            FiniteElementModel* model, std::string* error) {
  CHECK(model != nullptr);
  CHECK(error != nullptr);
  ModelReader reader(files, error);
  return reader.Read(model);
}

}  // namespace pinode
