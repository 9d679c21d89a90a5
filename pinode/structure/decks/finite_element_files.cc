#include "pinode/structure/decks/finite_element_files.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/decks/matrix_choice.h"
#include "pinode/structure/matrices/abaqus_matrix.h"
#include "pinode/structure/matrices/calculix.h"
#include "pinode/structure/matrices/dmig.h"
#include "pinode/structure/matrices/dof_matrix.h"
#include "pinode/structure/matrices/harwell_boeing.h"
#include "pinode/structure/matrices/mat_file.h"
#include "pinode/structure/matrices/matrix_container.h"
#include "pinode/structure/matrices/matrix_io.h"
#include "pinode/structure/matrices/matrix_market.h"
#include "pinode/structure/matrices/matrix_text.h"
#include "pinode/structure/matrices/npz.h"
#include "pinode/structure/matrices/op4.h"

namespace pinode {
namespace {

std::string Extension(const std::string& path) {
  return LowerCase(std::filesystem::path(WithoutGz(path)).extension().string());
}

// A matrix as in its file.
struct LoadedMatrix {
  enum class Kind { kAbsent, kWhole, kIndexed, kByDof };

  Kind kind = Kind::kAbsent;
  SparseMatrix matrix;  // kWhole
  // kIndexed: the size is known only when all files have been read.
  std::vector<MatrixEntry> entries;
  bool mirrored = false;
  int size = 0;
  DofMatrix by_dof;  // kByDof
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
    for (const int role : {kMassMatrix, kStiffnessMatrix}) {
      if (sources_[role]->path.empty()) {
        *error_ = std::string("no file for the ") + RoleName(role) +
                  " matrix, expected one";
        return false;
      }
    }
    for (int role = 0; role < kNumMatrixRoles; ++role) {
      if (!sources_[role]->path.empty() && !Load(role)) return false;
    }
    if (!ReadNames()) return false;
    const bool by_dof =
        loaded_[kStiffnessMatrix].kind == LoadedMatrix::Kind::kByDof;
    for (const LoadedMatrix& loaded : loaded_) {
      if (loaded.kind != LoadedMatrix::Kind::kAbsent &&
          (loaded.kind == LoadedMatrix::Kind::kByDof) != by_dof) {
        *error_ = sources_[kStiffnessMatrix]->path +
                  ": matrices of Abaqus and DMIG name their DOFs, others go by "
                  "position, expected files of one kind";
        return false;
      }
    }
    if (!(by_dof ? MergeByName() : MergeByPosition())) return false;
    if (are_names_listed_ && !AreListedOnce()) return false;
    model_.dof_names = NumberRepeatedNames(std::move(names_), &model_.notes);
    std::string what;
    const SparseMatrix* culprit = nullptr;
    // No matrix is at fault where DOFs are without mass and stiffness, and all
    // of them have names of their own here.
    if (!model_.IsValid(&what, &culprit) &&
        !(has_set_ && culprit == nullptr && HasNames())) {
      const int role = culprit == &model_.mass      ? kMassMatrix
                       : culprit == &model_.damping ? kDampingMatrix
                                                    : kStiffnessMatrix;
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
                    "this compressed file is not text (.mtx, .sti, .mas, .csv, "
                    "...); unpack it");
      }
      return LoadFromContainer(role, extension, &loaded);
    }
    if (extension == ".pch" || extension == ".dmig") {
      return LoadDmig(role, &loaded);
    }
    if (!sources_[role]->variable.empty()) {
      return Fail(path, "a matrix is named (" +
                            Quote(sources_[role]->variable) +
                            ") in a file that holds only one, expected none");
    }
    if (extension == ".sti" || extension == ".mas") {
      loaded.kind = LoadedMatrix::Kind::kIndexed;
      TakeNamesBeside(path, ".dof");
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
    if (IsHarwellBoeing(path)) {
      loaded.kind = LoadedMatrix::Kind::kWhole;
      TakeNamesBeside(path, ".mapping");
      return ReadHarwellBoeing(path, kMaxFiniteElementDofs, &loaded.matrix,
                               error_);
    }
    return Fail(path,
                "unknown kind of matrix file, expected .mtx (Matrix Market, "
                "Abaqus), .sti or .mas (CalculiX), .op4 or .pch (Nastran), "
                ".matrix, .hb or .rsa (Harwell-Boeing), .mat, .npz or .csv");
  }

  // Lets the DOFs' names come from the file of the same name with another
  // extension, if there is one and the user names none.
  void TakeNamesBeside(const std::string& path, const char* extension) {
    const std::string beside = std::filesystem::path(WithoutGz(path))
                                   .replace_extension(extension)
                                   .string();
    std::error_code status;
    std::vector<std::string>& known = default_names_paths_;
    if (std::filesystem::is_regular_file(beside, status) &&
        std::find(known.begin(), known.end(), beside) == known.end()) {
      known.push_back(beside);
    }
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
    loaded->kind = LoadedMatrix::Kind::kByDof;
    return ReadAbaqusMatrixText(path, content, &loaded->by_dof, error_);
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
    std::vector<std::string> names;
    for (const NamedMatrix& matrix : container.matrices) {
      names.push_back(matrix.name);
    }
    size_t index = 0;
    if (!ChooseMatrix(role, *sources_[role], names, UsedBy(path) == 1, &index,
                      error_)) {
      return false;
    }
    const NamedMatrix* const chosen = &container.matrices[index];
    if (!chosen->fault.empty())
      return FailByFault(role, chosen->name, chosen->fault);
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

  bool LoadDmig(int role, LoadedMatrix* loaded) {
    const std::string& path = sources_[role]->path;
    auto found = dmig_.find(path);
    if (found == dmig_.end()) {
      std::vector<DmigMatrix> matrices;
      if (!ReadDmig(path, &matrices, error_)) return false;
      found = dmig_.emplace(path, std::move(matrices)).first;
    }
    std::vector<std::string> names;
    for (const DmigMatrix& matrix : found->second) {
      names.push_back(matrix.name);
    }
    size_t index = 0;
    if (!ChooseMatrix(role, *sources_[role], names, UsedBy(path) == 1, &index,
                      error_)) {
      return false;
    }
    const DmigMatrix& chosen = found->second[index];
    if (!chosen.fault.empty()) {
      return FailByFault(role, chosen.name, chosen.fault);
    }
    loaded->kind = LoadedMatrix::Kind::kByDof;
    loaded->by_dof = chosen.matrix;
    return true;
  }

  bool FailByFault(int role, const std::string& name,
                   const std::string& fault) {
    return Fail(sources_[role]->path, std::string("the ") + RoleName(role) +
                                          " matrix " + Quote(name) +
                                          " cannot be used: " + fault);
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
    std::vector<std::string> paths = {names_path_};
    if (names_path_.empty()) {
      if (!names_.empty() || default_names_paths_.empty()) return true;
      paths = default_names_paths_;
    }
    names_source_ = paths[0];
    for (const std::string& path : paths) {
      std::vector<std::string> names;
      if (!(Extension(path) == ".mapping"
                ? ReadRowMapping(path, &names, error_)
                : ReadDofNames(path, &names, error_))) {
        return false;
      }
      if (names_.empty()) names_ = names;
      if (names != names_) {
        return Fail(path, "the DOFs are other ones than those of " +
                              names_source_ + ", expected files of one job");
      }
    }
    return true;
  }

  SparseMatrix& Target(int role) {
    return role == kMassMatrix      ? model_.mass
           : role == kDampingMatrix ? model_.damping
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
    for (int role = 0; role < kNumMatrixRoles; ++role) {
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
                  "matrices of Abaqus and DMIG name their DOFs themselves, "
                  "expected no list of names");
    }
    std::vector<const DofMatrix*> matrices;
    for (const LoadedMatrix& loaded : loaded_) {
      matrices.push_back(&loaded.by_dof);
    }
    const std::vector<NodeDirection> dofs = AllDofs(matrices);
    if (dofs.size() > static_cast<size_t>(kMaxFiniteElementDofs)) {
      return Fail(sources_[kStiffnessMatrix]->path,
                  std::to_string(dofs.size()) +
                      " DOFs in all files, expected at most " +
                      std::to_string(kMaxFiniteElementDofs));
    }
    for (const NodeDirection& dof : dofs) names_.push_back(dof.Name());
    for (int role = 0; role < kNumMatrixRoles; ++role) {
      LoadedMatrix& loaded = loaded_[role];
      if (loaded.kind == LoadedMatrix::Kind::kAbsent) continue;
      loaded.by_dof.Renumber(dofs);
      if (!Assemble(sources_[role]->path, static_cast<int>(dofs.size()),
                    loaded.by_dof.mirrored, &loaded.by_dof.entries,
                    &Target(role))) {
        return false;
      }
    }
    return true;
  }

  const MatrixSource* const sources_[kNumMatrixRoles];
  const std::string names_path_;
  std::string* const error_;

  LoadedMatrix loaded_[kNumMatrixRoles];
  std::map<std::string, MatrixContainer> containers_;
  std::map<std::string, std::vector<DmigMatrix>> dmig_;
  std::vector<std::string> names_;
  const bool are_names_listed_;
  const bool has_set_;
  std::string names_source_;
  std::vector<std::string> default_names_paths_;
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
