#include "pinode/structure/matrices/calculix.h"

#include <algorithm>
#include <string_view>
#include <tuple>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {

bool FindTriangle(std::vector<MatrixEntry>* entries, bool* mirrored,
                  MatrixEntry* at, std::string* what) {
  // Mirror images become neighbours.
  const auto place = [](const MatrixEntry& entry) {
    return std::make_pair(std::min(entry.row, entry.column),
                          std::max(entry.row, entry.column));
  };
  std::sort(entries->begin(), entries->end(),
            [&place](const MatrixEntry& a, const MatrixEntry& b) {
              return std::make_tuple(place(a), a.row, a.line) <
                     std::make_tuple(place(b), b.row, b.line);
            });
  const MatrixEntry* alone = nullptr;
  const MatrixEntry* paired = nullptr;
  const size_t count = entries->size();
  for (size_t k = 0; k < count;) {
    const MatrixEntry& entry = (*entries)[k];
    size_t next = k + 1;
    bool has_mirror = false;
    while (next < count && place((*entries)[next]) == place(entry)) {
      has_mirror = has_mirror || (*entries)[next].row != entry.row;
      ++next;
    }
    k = next;
    if (entry.row == entry.column) continue;
    const MatrixEntry*& example = has_mirror ? paired : alone;
    if (example == nullptr) example = &entry;
  }
  if (alone != nullptr && paired != nullptr) {
    *at = *alone;
    *what = "entry " + EntryText(alone->row, alone->column) +
            " has no mirror image in the file, but entry " +
            EntryText(paired->row, paired->column) +
            " has; one triangle was expected, or both whole";
    return false;
  }
  *mirrored = paired == nullptr;
  return true;
}

bool ReadIndexedEntriesText(const std::string& path, const std::string& content,
                            std::vector<MatrixEntry>* entries, bool* mirrored,
                            int* size, std::string* error) {
  CHECK(entries != nullptr);
  CHECK(error != nullptr);
  LineReader lines(path, content);
  std::vector<MatrixEntry> read;
  int largest = 0;
  std::string_view line;
  while (lines.NextContent('#', &line)) {
    const std::vector<std::string_view> words = SplitBlanks(line);
    MatrixEntry entry;
    if (words.size() != 3 || !ParseInt(words[0], &entry.row) ||
        !ParseInt(words[1], &entry.column)) {
      return lines.Fail(
          "the line is " + Quote(line) + ", expected 'row column value'",
          error);
    }
    if (entry.row < 1 || entry.row > kMaxFiniteElementDofs ||
        entry.column < 1 || entry.column > kMaxFiniteElementDofs) {
      return lines.Fail("entry (" + std::to_string(entry.row) + ", " +
                            std::to_string(entry.column) +
                            ") lies outside, expected indices from 1 to " +
                            std::to_string(kMaxFiniteElementDofs),
                        error);
    }
    largest = std::max({largest, entry.row, entry.column});
    --entry.row;
    --entry.column;
    entry.line = lines.number();
    if (!ParseEntry(lines, words[2], entry.row, entry.column, &entry.value,
                    error)) {
      return false;
    }
    read.push_back(entry);
  }
  if (read.empty()) {
    return lines.Fail("the file has no entries, expected a matrix", error);
  }
  MatrixEntry at;
  std::string what;
  if (!FindTriangle(&read, mirrored, &at, &what)) {
    return lines.FailAt(at.line, what, error);
  }
  *size = largest;
  *entries = std::move(read);
  return true;
}

bool ReadIndexedEntries(const std::string& path,
                        std::vector<MatrixEntry>* entries, bool* mirrored,
                        int* size, std::string* error) {
  CHECK(error != nullptr);
  std::string content;
  return ReadTextFile(path, &content, error) &&
         ReadIndexedEntriesText(path, content, entries, mirrored, size, error);
}

bool ReadDofNames(const std::string& path, std::vector<std::string>* names,
                  std::string* error) {
  CHECK(names != nullptr);
  CHECK(error != nullptr);
  std::string content;
  if (!ReadTextFile(path, &content, error)) return false;
  LineReader lines(path, content);
  std::vector<std::string> read;
  std::string_view line;
  while (lines.NextContent('#', &line)) {
    const std::vector<std::string_view> words = SplitBlanks(line);
    if (words.size() != 1) {
      return lines.Fail(
          "the line is " + Quote(line) + ", expected the name of one DOF",
          error);
    }
    if (static_cast<int>(read.size()) == kMaxFiniteElementDofs) {
      return lines.Fail("more than " + std::to_string(kMaxFiniteElementDofs) +
                            " DOFs, expected at most as many",
                        error);
    }
    read.emplace_back(words[0]);
  }
  if (read.empty()) {
    return lines.Fail("the file is empty, expected the names of DOFs", error);
  }
  *names = std::move(read);
  return true;
}

}  // namespace pinode
