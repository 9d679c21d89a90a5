#include "pinode/structure/matrices/dmig.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrices/fortran_text.h"
#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {
namespace {

// Width of the fields of an entry. The first one is always narrow.
constexpr size_t kNarrow = 8;
constexpr size_t kWide = 16;
// Fields of a line behind the first one: eight narrow or four wide ones. An
// entry of a DMIG column takes four, as do the names in front of them.
constexpr size_t kFieldsOfEntry = 4;

// One line of bulk data, cut into fields without blanks.
struct BulkLine {
  std::string_view first;  // name of the entry, or the mark of a continuation
  std::vector<std::string_view> fields;
};

BulkLine CutIntoFields(std::string_view line) {
  line = line.substr(0, line.find('$'));
  BulkLine cut;
  if (line.find(',') != std::string_view::npos) {
    const std::vector<std::string_view> words = Split(line, ',');
    cut.first = StripBlanks(words[0]);
    const bool is_wide = !cut.first.empty() && cut.first.back() == '*';
    const size_t most = is_wide ? kFieldsOfEntry : 2 * kFieldsOfEntry;
    for (size_t i = 1; i < words.size() && i <= most; ++i) {
      cut.fields.push_back(StripBlanks(words[i]));
    }
    cut.fields.resize(most);
    return cut;
  }
  cut.first = StripBlanks(line.substr(0, kNarrow));
  const bool is_wide = !cut.first.empty() &&
                       (cut.first.back() == '*' || cut.first.front() == '*');
  const size_t width = is_wide ? kWide : kNarrow;
  const size_t count = is_wide ? kFieldsOfEntry : 2 * kFieldsOfEntry;
  for (size_t i = 0; i < count; ++i) {
    const size_t begin = kNarrow + i * width;
    cut.fields.push_back(begin < line.size()
                             ? StripBlanks(line.substr(begin, width))
                             : std::string_view());
  }
  return cut;
}

bool IsContinuation(std::string_view first) {
  return first.empty() || first[0] == '+' || first[0] == '*';
}

// A matrix while its columns are read.
struct OpenMatrix {
  std::string name;
  bool is_symmetric = false;
  std::vector<DofEntry> entries;
  std::string fault;
};

// Moves the entries of a symmetric matrix below the diagonal: Nastran may give
// each on either side. Entries with an equal mirror image are kept once.
void GatherBelowDiagonal(std::vector<DofEntry>* entries) {
  struct Placed {
    DofEntry entry;
    bool was_above = false;
  };
  std::vector<Placed> placed;
  for (const DofEntry& entry : *entries) {
    placed.push_back({entry, entry.row < entry.column});
    DofEntry& moved = placed.back().entry;
    if (placed.back().was_above) std::swap(moved.row, moved.column);
  }
  std::stable_sort(placed.begin(), placed.end(),
                   [](const Placed& a, const Placed& b) {
                     return a.entry.column == b.entry.column
                                ? a.entry.row < b.entry.row
                                : a.entry.column < b.entry.column;
                   });
  entries->clear();
  const Placed* before = nullptr;
  for (const Placed& here : placed) {
    const bool is_image = before != nullptr &&
                          here.entry.row == before->entry.row &&
                          here.entry.column == before->entry.column &&
                          here.entry.value == before->entry.value &&
                          here.was_above != before->was_above;
    if (!is_image) entries->push_back(here.entry);
    before = is_image ? nullptr : &here;
  }
}

class DmigReader {
 public:
  DmigReader(const std::string& path, const std::string& content,
             std::string* error)
      : lines_(path, content), error_(error) {}

  bool Read(std::vector<DmigMatrix>* matrices) {
    std::string_view line;
    while (lines_.NextRaw(&line)) {
      const BulkLine cut = CutIntoFields(line);
      if (IsContinuation(cut.first)) {
        if (is_open_ && !Append(cut.fields)) return false;
        continue;
      }
      Close();
      const std::string name = LowerCase(cut.first);
      is_open_ = name == "dmig" || name == "dmig*";
      if (is_open_ && !Append(cut.fields)) return false;
    }
    if (open_.empty()) {
      return Fail("the file has no DMIG entries, expected matrices");
    }
    std::vector<DmigMatrix> read;
    for (OpenMatrix& from : open_) read.push_back(Finished(&from));
    matrices->swap(read);
    return true;
  }

 private:
  bool Fail(const std::string& message) { return lines_.Fail(message, error_); }

  // Takes the fields of a line. The first four and each following four are a
  // unit: a header or the column's DOF, then its entries.
  bool Append(const std::vector<std::string_view>& fields) {
    for (size_t i = 0; i < fields.size(); i += kFieldsOfEntry) {
      const std::string_view* const unit = &fields[i];
      if (!is_started_) {
        is_started_ = true;
        if (!Start(unit)) return false;
      } else if (is_header_) {
        continue;
      } else if (!TakeEntry(unit)) {
        return false;
      }
    }
    return true;
  }

  bool Start(const std::string_view* unit) {
    const std::string name(unit[0]);
    if (name.empty()) return Fail("the DMIG entry names no matrix");
    is_header_ = unit[1] == "0";
    if (is_header_) return StartMatrix(name, unit);
    const auto found = index_.find(LowerCase(name));
    if (found == index_.end()) {
      return Fail("matrix " + Quote(name) + " has no header, expected 'DMIG, " +
                  name + ", 0, form, type' before its columns");
    }
    current_ = found->second;
    return ReadDof(unit[1], unit[2], "column", &column_);
  }

  bool StartMatrix(const std::string& name, const std::string_view* unit) {
    int form = 0;
    int type = 0;
    if (!ParseInt(unit[2], &form) || !ParseInt(unit[3], &type)) {
      return Fail("the header of matrix " + Quote(name) + " has form " +
                  Quote(unit[2]) + " and type " + Quote(unit[3]) +
                  ", expected two numbers");
    }
    if (!index_.emplace(LowerCase(name), open_.size()).second) {
      return Fail("matrix " + Quote(name) +
                  " has two headers, expected each matrix once");
    }
    OpenMatrix matrix;
    matrix.name = name;
    matrix.is_symmetric = form == 6;
    if (form != 1 && form != 6) {
      matrix.fault = "it is rectangular (form " + std::to_string(form) + ")";
    } else if (type == 3 || type == 4) {
      matrix.fault = "it is complex (type " + std::to_string(type) + ")";
    }
    open_.push_back(std::move(matrix));
    return true;
  }

  bool ReadDof(std::string_view node, std::string_view direction,
               const char* what, NodeDirection* dof) {
    int component = 0;
    if (!ParseInt(node, &dof->node) || dof->node < 1 ||
        (!direction.empty() && !ParseInt(direction, &component)) ||
        component < 0 || component > 6) {
      return Fail(std::string("the ") + what + " is point " + Quote(node) +
                  ", component " + Quote(direction) +
                  ", expected a number and 0 to 6");
    }
    dof->direction = component;
    return true;
  }

  bool TakeEntry(const std::string_view* unit) {
    OpenMatrix& matrix = open_[current_];
    if (unit[0].empty() && unit[1].empty() && unit[2].empty()) return true;
    // The entries of a matrix with a fault are not used.
    if (!matrix.fault.empty()) return true;
    DofEntry entry;
    entry.column = column_;
    entry.line = lines_.number();
    if (!ReadDof(unit[0], unit[1], "row", &entry.row)) return false;
    if (!ParseFortranDouble(unit[2], &entry.value) ||
        !std::isfinite(entry.value)) {
      return Fail("the value is " + Quote(unit[2]) +
                  ", expected a finite number");
    }
    matrix.entries.push_back(entry);
    return true;
  }

  void Close() {
    is_open_ = false;
    is_started_ = false;
    is_header_ = false;
  }

  DmigMatrix Finished(OpenMatrix* from) const {
    DmigMatrix result;
    result.name = from->name;
    result.fault = from->fault;
    if (!result.fault.empty()) return result;
    if (from->entries.empty()) {
      result.fault = "it has no entries";
      return result;
    }
    if (from->is_symmetric) GatherBelowDiagonal(&from->entries);
    int line = 0;
    std::string what;
    if (!MakeDofMatrix(from->entries, &result.matrix, &line, &what)) {
      result.fault = "line " + std::to_string(line) + ": " + what;
      return result;
    }
    // A square matrix states both triangles. With one of them it is not
    // symmetric, which is for the check of the model to say.
    if (!from->is_symmetric && result.matrix.mirrored) {
      result.matrix.mirrored = false;
    }
    return result;
  }

  LineReader lines_;
  std::string* const error_;
  std::vector<OpenMatrix> open_;
  // Index into open_ by name in lower case, as Nastran does not tell cases
  // apart.
  std::map<std::string, size_t> index_;
  bool is_open_ = false;     // within a DMIG entry
  bool is_started_ = false;  // its first unit was read
  bool is_header_ = false;
  size_t current_ = 0;
  NodeDirection column_;
};

}  // namespace

bool ReadDmigText(const std::string& path, const std::string& content,
                  std::vector<DmigMatrix>* matrices, std::string* error) {
  CHECK(matrices != nullptr);
  CHECK(error != nullptr);
  return DmigReader(path, content, error).Read(matrices);
}

bool ReadDmig(const std::string& path, std::vector<DmigMatrix>* matrices,
              std::string* error) {
  CHECK(error != nullptr);
  std::string content;
  return ReadTextFile(path, &content, error) &&
         ReadDmigText(path, content, matrices, error);
}

}  // namespace pinode
