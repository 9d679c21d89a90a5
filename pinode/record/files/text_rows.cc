#include "pinode/record/files/text_rows.h"

#include <utility>

#include "pinode/record/files/clock.h"
#include "pinode/record/files/text_thousands.h"
#include "pinode/record/number_rows.h"

namespace pinode {
namespace {

// True for text made of the characters of numbers and clock times only: one or
// several of them, which this reading of the file does not understand.
bool IsBrokenNumber(std::string_view cell, char delimiter) {
  // Between blanks there is no other delimiter.
  if (delimiter == ' ' && cell.find_first_of(",;|") != std::string_view::npos) {
    return true;
  }
  constexpr std::string_view kSigns = "0123456789+-.,;:|/ \t\"";
  constexpr std::string_view kMinus = "\u2212";
  if (kSigns.find(cell.front()) == std::string_view::npos &&
      cell.substr(0, kMinus.size()) != kMinus) {
    return false;
  }
  // Apostrophes and narrow blanks stand between thousands.
  return cell.find_first_not_of(
             "0123456789+-.,;:|/ "
             "\t\"'eEdDTZAPM\u2212\u2019\u00A0\u2009\u202F") ==
         std::string_view::npos;
}

CellKind KindOf(std::string_view cell, char decimal, const TextFormat& format) {
  double number = 0.0;
  if (ParseCell(cell, decimal, &number)) {
    return IsMissing(cell) ? CellKind::kMissing : CellKind::kNumber;
  }
  std::string joined;
  if (format.decimal != 0 && JoinThousands(cell, decimal, true, &joined)) {
    return CellKind::kNumber;
  }
  ClockCell clock;
  if (ParseClock(cell, &clock) ||
      (!format.time_format.empty() &&
       ParseClockBy(format.time_format, cell, &clock))) {
    return !clock.has_time   ? CellKind::kDate
           : !clock.has_date ? CellKind::kTimeOfDay
                             : CellKind::kDateTime;
  }
  return CellKind::kText;
}

// Adds a row's kinds to those of the run; false if they do not go together.
bool Merge(const std::vector<CellKind>& row, std::vector<CellKind>* run) {
  if (row.size() != run->size()) return false;
  for (size_t i = 0; i < row.size(); ++i) {
    if (row[i] != (*run)[i] && row[i] != CellKind::kMissing &&
        (*run)[i] != CellKind::kMissing) {
      return false;
    }
  }
  for (size_t i = 0; i < row.size(); ++i) {
    if ((*run)[i] == CellKind::kMissing) (*run)[i] = row[i];
  }
  return true;
}

class RowRunFinder {
 public:
  RowRunFinder(const std::vector<TextLine>& lines, const TextFormat& format)
      : lines_(lines), format_(format) {}

  // Tries all delimiters and decimal signs.
  std::vector<RowRun> Find() {
    for (const char delimiter : {'\t', ';', ',', '|', ' ', '\0'}) {
      if (format_.delimiter != 0 && delimiter != format_.delimiter) continue;
      for (const char decimal : {'.', ','}) {
        if (format_.decimal != 0 && decimal != format_.decimal) continue;
        RowRun run;
        run.delimiter = delimiter;
        run.decimal = decimal;
        if (FindRun(&run)) runs_.push_back(std::move(run));
      }
    }
    // Files with a delimiter that is given may have one column alone.
    if (runs_.empty() && format_.delimiter != 0) {
      RowRun run;
      run.decimal = format_.decimal != 0 ? format_.decimal : '.';
      if (FindRun(&run)) runs_.push_back(std::move(run));
    }
    return std::move(runs_);
  }

 private:
  // Finds the kinds of a line's cells; false if it is no row. *values is the
  // number of cells with a number or time.
  bool ClassifyRow(const TextLine& line, RowRun* run,
                   std::vector<CellKind>* kinds, size_t* values) {
    if (!SplitCells(line.text, run->delimiter, &cells_, &storage_)) {
      return false;
    }
    kinds->clear();
    *values = 0;
    for (const std::string_view cell : cells_) {
      const CellKind kind = KindOf(cell, run->decimal, format_);
      if (kind == CellKind::kText && IsBrokenNumber(cell, run->delimiter)) {
        return false;
      }
      // Between blanks a hyphen is a sign that stands apart.
      if (run->delimiter == ' ' && cell == "-") return false;
      if (kind != CellKind::kText && kind != CellKind::kMissing) ++*values;
      if (run->delimiter == ',' && run->decimal == ',' &&
          kind == CellKind::kNumber &&
          cell.find(',') != std::string_view::npos) {
        run->quotes_commas = true;
      }
      kinds->push_back(kind);
    }
    return true;
  }

  // Finds the first run of enough rows without text, or else the one with the
  // most values.
  bool FindRun(RowRun* found) {
    RowRun best = *found;
    RowRun now = *found;
    const auto finish = [&] {
      if (now.Score() > best.Score()) best = now;
      now.rows = 0;
    };
    std::vector<CellKind> kinds;
    size_t values = 0;
    const size_t begin = static_cast<size_t>(std::max(format_.header_lines, 0));
    for (size_t i = begin; i < lines_.size(); ++i) {
      if (IsNoRow(lines_[i].text)) continue;
      // A row of missing values is one only among others.
      if (!ClassifyRow(lines_[i], &now, &kinds, &values) ||
          (values == 0 && (now.rows == 0 || !Merge(kinds, &now.kinds)))) {
        finish();
        if (format_.header_lines >= 0) break;
        continue;
      }
      if (now.rows == 0 || (values > 0 && !Merge(kinds, &now.kinds))) {
        finish();
        if (format_.header_lines >= 0 && best.rows > 0) break;
        now.first = i;
        now.kinds = kinds;
      }
      ++now.rows;
      if (now.rows >= kEnoughRows && !now.HasText()) break;
    }
    finish();
    // Rows of missing values may come first.
    for (size_t i = best.first; best.rows > 0 && i-- > begin;) {
      if (IsNoRow(lines_[i].text)) continue;
      if (!ClassifyRow(lines_[i], &best, &kinds, &values) ||
          std::count(kinds.begin(), kinds.end(), CellKind::kMissing) == 0 ||
          !Merge(kinds, &best.kinds)) {
        break;
      }
      best.first = i;
      ++best.rows;
    }
    *found = best;
    return best.rows > 0 && (found->delimiter != ',' || found->decimal != ',' ||
                             found->quotes_commas);
  }
  const std::vector<TextLine>& lines_;
  const TextFormat& format_;
  std::vector<RowRun> runs_;
  std::vector<std::string_view> cells_;
  std::vector<std::string> storage_;
};

}  // namespace

void NormaliseLines(std::string* text) {
  constexpr char kEndOfFile = 0x1A;
  while (!text->empty() && text->back() == kEndOfFile) text->pop_back();
  // Files of some old instruments have lines that end with a carriage return
  // alone.
  if (text->find('\n') == std::string::npos) {
    std::replace(text->begin(), text->end(), '\r', '\n');
  }
}

std::vector<TextLine> FirstLines(std::string_view text, size_t most) {
  std::vector<TextLine> lines;
  size_t at = 0;
  while (at < text.size() && lines.size() < most) {
    const size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    lines.push_back({line, at, static_cast<int64_t>(lines.size()) + 1});
    at = end + 1;
  }
  return lines;
}

std::vector<RowRun> FindRowRuns(const std::vector<TextLine>& lines,
                                const TextFormat& format) {
  return RowRunFinder(lines, format).Find();
}

}  // namespace pinode
