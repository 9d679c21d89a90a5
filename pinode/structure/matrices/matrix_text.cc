#include "pinode/structure/matrices/matrix_text.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Places of entries, column by column and by rows within each.
struct ColumnOrder {
  std::vector<size_t> begins;  // of each column, and the end
  std::vector<size_t> places;
};

// Most files have the entries of a row or column together and in order. They
// are dealt to their columns, and only columns out of order are sorted.
ColumnOrder OrderByColumns(const std::vector<MatrixEntry>& entries,
                           int columns) {
  ColumnOrder order;
  order.begins.assign(static_cast<size_t>(columns) + 1, 0);
  for (const MatrixEntry& entry : entries) {
    ++order.begins[static_cast<size_t>(entry.column) + 1];
  }
  for (size_t c = 1; c < order.begins.size(); ++c) {
    order.begins[c] += order.begins[c - 1];
  }
  std::vector<size_t> next(order.begins.begin(), order.begins.end() - 1);
  order.places.resize(entries.size());
  for (size_t k = 0; k < entries.size(); ++k) {
    order.places[next[static_cast<size_t>(entries[k].column)]++] = k;
  }
  const auto ascending = [&entries](size_t a, size_t b) {
    if (entries[a].row != entries[b].row)
      return entries[a].row < entries[b].row;
    return entries[a].line < entries[b].line;
  };
  for (size_t c = 0; c + 1 < order.begins.size(); ++c) {
    const auto begin =
        order.places.begin() + static_cast<std::ptrdiff_t>(order.begins[c]);
    const auto end =
        order.places.begin() + static_cast<std::ptrdiff_t>(order.begins[c + 1]);
    if (!std::is_sorted(begin, end, ascending)) {
      std::sort(begin, end, ascending);
    }
  }
  return order;
}

}  // namespace

LineReader::LineReader(const std::string& path, std::string_view text)
    : path_(path), rest_(text) {
  // Windows programs often begin a file with a byte order mark.
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (rest_.substr(0, kByteOrderMark.size()) == kByteOrderMark) {
    rest_.remove_prefix(kByteOrderMark.size());
  }
}

bool LineReader::NextRaw(std::string_view* line) {
  if (rest_.empty()) return false;
  const size_t end = std::min(rest_.find('\n'), rest_.size());
  *line = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  ++number_;
  return true;
}

bool LineReader::Next(std::string_view* line) {
  if (!NextRaw(line)) return false;
  *line = StripBlanks(*line);
  return true;
}

bool LineReader::NextContent(char comment, std::string_view* line) {
  while (Next(line)) {
    if (!line->empty() && line->front() != comment) return true;
  }
  return false;
}

std::string LineReader::Place() const {
  return path_ + ":" + std::to_string(std::max(number_, 1));
}

bool LineReader::Fail(const std::string& message, std::string* error) const {
  return FailAt(std::max(number_, 1), message, error);
}

bool LineReader::FailAt(int line, const std::string& message,
                        std::string* error) const {
  *error = path_ + ":" + std::to_string(line) + ": " + message;
  return false;
}

std::string EntryText(Eigen::Index row, Eigen::Index column) {
  return "(" + std::to_string(row + 1) + ", " + std::to_string(column + 1) +
         ")";
}

std::string SizeText(Eigen::Index rows, Eigen::Index columns) {
  return std::to_string(rows) + " x " + std::to_string(columns);
}

std::vector<std::string_view> SplitBlanks(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r\v\f";
  std::vector<std::string_view> tokens;
  size_t begin = line.find_first_not_of(kBlanks);
  while (begin != std::string_view::npos) {
    const size_t end =
        std::min(line.find_first_of(kBlanks, begin), line.size());
    tokens.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
  return tokens;
}

bool ParseEntry(const LineReader& lines, std::string_view text,
                Eigen::Index row, Eigen::Index column, double* value,
                std::string* error) {
  if (!ParseDouble(text, value)) {
    return lines.Fail("entry " + EntryText(row, column) + " is " + Quote(text) +
                          ", expected a number",
                      error);
  }
  if (!std::isfinite(*value)) {
    return lines.Fail("entry " + EntryText(row, column) + " is " + Quote(text) +
                          ", expected a finite number",
                      error);
  }
  return true;
}

bool AssembleMatrix(int rows, int columns, bool mirrored,
                    std::vector<MatrixEntry>* entries, SparseMatrix* matrix,
                    MatrixEntry* duplicate) {
  if (mirrored) {
    CHECK_EQ(rows, columns) << "only a square matrix has mirror images";
    const size_t given = entries->size();
    for (size_t k = 0; k < given; ++k) {
      MatrixEntry mirror = (*entries)[k];
      if (mirror.row == mirror.column) continue;
      std::swap(mirror.row, mirror.column);
      mirror.mirror = true;
      entries->push_back(mirror);
    }
  }
  for (const MatrixEntry& entry : *entries) {
    CHECK(entry.row >= 0 && entry.row < rows && entry.column >= 0 &&
          entry.column < columns)
        << "entry " << EntryText(entry.row, entry.column) << " lies outside "
        << SizeText(rows, columns);
  }
  const ColumnOrder order = OrderByColumns(*entries, columns);
  // Among several entries, the first one in the file, as it is there.
  const MatrixEntry* first = nullptr;
  for (size_t k = 1; k < order.places.size(); ++k) {
    const MatrixEntry& entry = (*entries)[order.places[k]];
    const MatrixEntry& before = (*entries)[order.places[k - 1]];
    if (entry.row == before.row && entry.column == before.column &&
        (first == nullptr || entry.line < first->line ||
         (entry.line == first->line && first->mirror))) {
      first = &entry;
    }
  }
  if (first != nullptr) {
    *duplicate = *first;
    return false;
  }
  SparseMatrix result(rows, columns);
  result.reserve(static_cast<Eigen::Index>(entries->size()));
  for (int column = 0; column < columns; ++column) {
    result.startVec(column);
    const auto c = static_cast<size_t>(column);
    for (size_t k = order.begins[c]; k < order.begins[c + 1]; ++k) {
      const MatrixEntry& entry = (*entries)[order.places[k]];
      result.insertBack(entry.row, column) = entry.value;
    }
  }
  result.finalize();
  matrix->swap(result);
  return true;
}

}  // namespace pinode
