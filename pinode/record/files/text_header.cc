#include "pinode/record/files/text_header.h"

#include <algorithm>
#include <utility>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/base/unit_names.h"
#include "pinode/record/files/text_time.h"
#include "pinode/record/number_rows.h"

namespace pinode {
namespace {

// Lines above the rows that are searched for names and units.
constexpr size_t kMostHeaderLines = 6;

// Units that stand beside those of the table, of temperatures for instance. In
// brackets any unit may.
bool IsOtherUnit(const std::string& cell) {
  for (const char* unit :
       {"\u00B0C", "C",   "degC", "\u00B0F", "degF", "K",   "\u00B0",
        "deg",     "rad", "rpm",  "1/min",   "Hz",   "bar", "mbar",
        "hPa",     "kPa", "Pa",   "MPa",     "Nm",   "kNm", "A",
        "mA",      "W",   "kW",   "%RH"}) {
    if (cell == unit) return true;
  }
  return false;
}

// Number of names that state a known unit: "acc [mg]".
size_t NumUnits(const std::vector<std::string>& names) {
  return static_cast<size_t>(
      std::count_if(names.begin(), names.end(), [](const std::string& name) {
        std::string plain;
        std::string unit;
        SplitUnitOfName(name, &plain, &unit);
        return !unit.empty();
      }));
}

// True for the rows of types that stand between names and rows, such as
// "float;float;float".
bool AreTypes(const std::vector<std::string>& cells) {
  return std::all_of(cells.begin(), cells.end(), [](const std::string& cell) {
    const std::string lower = LowerCase(cell);
    for (const char* type : {"", "float", "double", "single", "real", "int",
                             "integer", "float32", "float64"}) {
      if (lower == type) return true;
    }
    return false;
  });
}

// True for the last header line of Campbell's loggers: "","","Smp","Avg".
// In other files these words may be names.
bool AreAverages(const std::vector<std::string>& cells) {
  return std::all_of(cells.begin(), cells.end(), [](const std::string& cell) {
    const std::string lower = LowerCase(cell);
    for (const char* word : {"", "smp", "avg", "max", "min", "std", "tot"}) {
      if (lower == word) return true;
    }
    return false;
  });
}

// Splits the units off the names of a header line.
std::vector<std::string> PlainNames(const std::vector<std::string>& names) {
  std::vector<std::string> plain(names.size());
  std::string unit;
  for (size_t i = 0; i < names.size(); ++i) {
    SplitUnitOfName(names[i], &plain[i], &unit);
  }
  return plain;
}

bool HasNameOfTime(const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(), IsNameOfTime);
}

// True for names of ranges, such as "2 [g]" and "\u00B12 [g]".
bool AreRanges(const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(), [](const std::string& name) {
    double number = 0.0;
    return ParseCell(name, '.', &number) || ParseCell(name, ',', &number) ||
           name.rfind("\u00B1", 0) == 0 || name.rfind("+-", 0) == 0 ||
           name.rfind("+/-", 0) == 0;
  });
}

bool IsUnitRow(const std::vector<std::string>& cells) {
  size_t known = 0;
  size_t filled = 0;
  for (const std::string& cell : cells) {
    // Campbell's loggers have TS and RN over times and row numbers.
    if (cell.empty() || cell == "-" || cell == "[-]" || cell == "TS" ||
        cell == "RN") {
      continue;
    }
    ++filled;
    double number = 0.0;
    if (!ParseDouble(cell, &number) && !UnitOfCell(cell).empty()) {
      ++known;
    } else if (cell.front() != '[' && cell.front() != '(' &&
               !IsOtherUnit(cell)) {
      return false;
    }
  }
  return known > 0 && 2 * known >= filled;
}

// True for the words that loggers write in front of a row of units.
bool IsLabelOfUnits(const std::string& cell) {
  std::string lower = LowerCase(cell);
  if (!lower.empty() && lower.back() == ':') lower.pop_back();
  for (const char* label :
       {"unit",       "units",      "[unit]",      "[units]",   "einheit",
        "einheiten",  "unit\u00E9", "unit\u00E9s", "unidad",    "unidades",
        "unit\u00E0", "unidade",    "eenheid",     "jednostka", "единица",
        "Единица",    "ед. изм.",   "Ед. изм.",    "单位",      "單位",
        "単位",       "단위"}) {
    if (lower == label) return true;
  }
  return false;
}

// True for a row of units behind another cell, which is a label or the name of
// the time. Without such a word the units must repeat, which names do not:
// "x;mm;mm".
bool IsUnitRowBehindCell(const std::vector<std::string>& cells) {
  if (cells.size() < 2 || cells[0].empty() || !UnitOfCell(cells[0]).empty()) {
    return false;
  }
  const std::vector<std::string> units(cells.begin() + 1, cells.end());
  if (!IsUnitRow(units)) return false;
  if (IsLabelOfUnits(cells[0])) return true;
  for (size_t i = 0; i < units.size(); ++i) {
    if (!units[i].empty() &&
        std::count(units.begin(), units.end(), units[i]) > 1) {
      return true;
    }
  }
  return false;
}

class HeaderFinder {
 public:
  HeaderFinder(const std::vector<TextLine>& lines, const TextFormat& format)
      : lines_(lines), format_(format) {}

  TextHeader FindHeader(const RowRun& run) {
    TextHeader header;
    header.first_row = run.first;
    size_t first_row = run.first;
    size_t seen = 0;
    for (size_t i = run.first; i-- > 0 && seen < kMostHeaderLines;) {
      const std::string_view line = lines_[i].text;
      if (IsNoRow(line)) {
        // A blank line above the rows ends a header.
        continue;
      }
      ++seen;
      if (IsSeparatorLine(line)) continue;
      std::vector<std::string> cells = CellsAbove(run, line);
      const size_t own = cells.size();
      if (!Fits(run, &cells)) {
        header.is_odd = true;
        header.odd = i;
        header.odd_cells = own;
        return header;
      }
      if (!header.has_units && i > 0 && IsUnitRow(cells) &&
          HasNamesAbove(run, i)) {
        header.has_units = true;
        header.units = i;
        header.unit_cells = std::move(cells);
        continue;
      }
      if (!header.has_units && i > 0 && IsUnitRowBehindCell(cells) &&
          HasNamesAbove(run, i)) {
        header.first_row = first_row;
        TakeUnitsBehindCell(run, i, std::move(cells), &header);
        return header;
      }
      // The first line of a file with a text in it is always one of names.
      const bool are_names = AreNames(cells) || (IsFirst(i) && HasText(cells));
      if (are_names &&
          (AreTypes(cells) || (AreAverages(cells) && IsOfCampbell(run, i))) &&
          HasNamesAbove(run, i)) {
        continue;
      }
      if (!are_names && MayBeBrokenRow(run, cells)) {
        // The rows begin earlier; reading them names the cell.
        first_row = i;
        --seen;
        continue;
      }
      if (!are_names) {
        header.is_odd = true;
        header.odd = i;
        header.odd_cells = own;
        return header;
      }
      header.found = true;
      header.names = i;
      header.first_row = first_row;
      header.cells = std::move(cells);
      if (!header.has_units && NumUnits(header.cells) == 0) {
        TakeNamesWithUnits(run, i, &header);
      }
      if (!header.has_units && i > 0 && header.names == i) {
        TakeUnitsAbove(run, i, &header);
      }
      return header;
    }
    header.first_row = first_row;
    FindHeaderInComment(run, &header);
    return header;
  }

 private:
  std::vector<std::string> Cells(std::string_view line, char delimiter) {
    std::vector<std::string> cells;
    if (!SplitCells(line, delimiter, &cells_, &storage_)) return cells;
    for (const std::string_view cell : cells_) cells.emplace_back(cell);
    return cells;
  }

  // True for the names of columns with one of a time among them. A piece in
  // brackets is the unit of another.
  static bool AreNamesWithTime(const std::vector<std::string>& cells) {
    return HasNameOfTime(PlainNames(cells)) &&
           std::none_of(cells.begin(), cells.end(),
                        [](const std::string& cell) {
                          return cell.front() == '(' || cell.front() == '[';
                        });
  }

  // Splits a line above the rows. Above columns between blanks, names with
  // blanks stand two or more of them apart. Titles and ragged names may do so
  // too: only names with a time, and units, are split there.
  std::vector<std::string> CellsAbove(const RowRun& run,
                                      std::string_view line) {
    std::vector<std::string> cells = Cells(line, run.delimiter);
    const size_t n = run.kinds.size();
    if (run.delimiter != ' ' || n < 2 || cells.size() <= n) return cells;
    std::string wide(StripBlanks(line));
    ReplaceAll("  ", "\t", &wide);
    std::vector<std::string> apart;
    for (std::string& cell : Cells(wide, '\t')) {
      if (!cell.empty()) apart.push_back(std::move(cell));
    }
    return apart.size() == n && (AreNamesWithTime(apart) || IsUnitRow(apart))
               ? apart
               : cells;
  }

  // Brings a header line to the number of cells of the rows, if it can be one.
  bool Fits(const RowRun& run, std::vector<std::string>* cells) const {
    const size_t n = run.kinds.size();
    while (cells->size() > n && cells->back().empty()) cells->pop_back();
    // LabVIEW names a column of comments that its rows do not have.
    if (cells->size() == n + 1 && cells->back() == "Comment") cells->pop_back();
    // Rows may end with a delimiter.
    if (cells->size() + 1 == n && run.kinds.back() == CellKind::kMissing) {
      cells->emplace_back();
    }
    // One name over a date and a time with a blank between.
    if (run.delimiter == ' ' && n >= 2 && cells->size() + 1 == n &&
        run.kinds[0] == CellKind::kDate &&
        run.kinds[1] == CellKind::kTimeOfDay) {
      cells->insert(cells->begin(), std::string());
    }
    return cells->size() == n;
  }

  // True for what is written like a value: a clock time, or a number of a form
  // that is not read, such as "1'234.5".
  static bool MayBeValue(const std::string& cell) {
    constexpr const char* kMinusSign = "\u2212";
    const size_t begin = cell.rfind(kMinusSign, 0) == 0 ? 3 : 0;
    return begin < cell.size() &&
           std::string("0123456789+-(").find(cell[begin]) !=
               std::string::npos &&
           cell.find_first_not_of("0123456789+-().,:/' TZDEde", begin) ==
               std::string::npos &&
           cell.find_first_of("0123456789") != std::string::npos;
  }

  // True for texts, most of all. Numbers may be names beside them if they count
  // channels: "t,1,2,3".
  static bool AreNames(const std::vector<std::string>& cells) {
    size_t filled = 0;
    size_t texts = 0;
    bool count = true;
    double number = 0.0;
    double last = -1.0;
    for (const std::string& cell : cells) {
      if (cell.empty()) continue;
      ++filled;
      if (ParseCell(cell, '.', &number) || ParseCell(cell, ',', &number)) {
        count = count && texts > 0 &&
                (last < 0.0 ? number <= 1.0 : number == last + 1.0);
        last = number;
      } else if (!MayBeValue(cell)) {
        ++texts;
      }
    }
    return texts > 0 && 2 * filled >= cells.size() &&
           (2 * texts > filled || (count && texts + 1 < filled));
  }

  static bool HasText(const std::vector<std::string>& cells) {
    double number = 0.0;
    return std::any_of(
        cells.begin(), cells.end(), [&number](const std::string& cell) {
          return !cell.empty() && !ParseCell(cell, '.', &number) &&
                 !ParseCell(cell, ',', &number);
        });
  }

  // True if nothing but comments stands above a line.
  bool IsFirst(size_t line) const {
    return std::all_of(
        lines_.begin(), lines_.begin() + static_cast<ptrdiff_t>(line),
        [](const TextLine& above) { return IsNoRow(above.text); });
  }

  // True for a line that would be a row but for a few of its cells.
  bool MayBeBrokenRow(const RowRun& run,
                      const std::vector<std::string>& cells) {
    size_t numbers = 0;
    double number = 0.0;
    for (const std::string& cell : cells) {
      if (!IsMissing(cell) &&
          (ParseCell(cell, run.decimal, &number) || MayBeValue(cell))) {
        ++numbers;
      }
    }
    return numbers > 0 && format_.header_lines < 0;
  }

  bool HasNamesAbove(const RowRun& run, size_t line) {
    for (size_t i = line; i-- > 0;) {
      if (IsNoRow(lines_[i].text) || IsSeparatorLine(lines_[i].text)) continue;
      std::vector<std::string> cells = CellsAbove(run, lines_[i].text);
      return Fits(run, &cells) && AreNames(cells);
    }
    return false;
  }

  // Takes the units from the line above that of the names, if it has them.
  void TakeUnitsAbove(const RowRun& run, size_t line, TextHeader* header) {
    std::vector<std::string> above =
        Cells(lines_[line - 1].text, run.delimiter);
    if (!Fits(run, &above) || !IsUnitRow(above)) return;
    header->has_units = true;
    header->units = line - 1;
    header->unit_cells = std::move(above);
    // The nearer line may be that of start times and modules.
    if (line < 2 || IsNoRow(lines_[line - 2].text)) return;
    std::vector<std::string> high = Cells(lines_[line - 2].text, run.delimiter);
    if (!Fits(run, &high) || !AreNames(high) ||
        !AreBetterNames(high, header->cells)) {
      return;
    }
    header->names = line - 2;
    header->cells = std::move(high);
  }

  // Takes a row of units behind another cell, and the names above it. The name
  // of the time may be that cell.
  void TakeUnitsBehindCell(const RowRun& run, size_t line,
                           std::vector<std::string> units, TextHeader* header) {
    size_t names = line - 1;
    while (IsNoRow(lines_[names].text) || IsSeparatorLine(lines_[names].text)) {
      --names;
    }
    std::vector<std::string> cells = CellsAbove(run, lines_[names].text);
    if (!Fits(run, &cells)) return;  // HasNamesAbove() has seen that it does.
    if (IsNameOfTime(units[0])) cells[0] = units[0];
    units[0].clear();
    header->found = true;
    header->names = names;
    header->cells = std::move(cells);
    header->has_units = true;
    header->units = line;
    header->unit_cells = std::move(units);
  }

  // True for a line below a row of units, and in a file that begins with TOA5.
  bool IsOfCampbell(const RowRun& run, size_t line) {
    const std::string_view first = lines_[0].text;
    if (first.substr(0, 6) == "\"TOA5\"" || first.substr(0, 5) == "TOA5,") {
      return true;
    }
    if (line == 0) return false;
    std::vector<std::string> above =
        Cells(lines_[line - 1].text, run.delimiter);
    return Fits(run, &above) && IsUnitRow(above);
  }

  // True if a line of texts with units is that of the names, and not the line
  // `near` below it. The nearer line then has empty or equal cells, such as
  // those of slots, or only the higher one names the time.
  static bool AreBetterNames(const std::vector<std::string>& high,
                             const std::vector<std::string>& near) {
    const std::vector<std::string> names = PlainNames(high);
    if (AreRanges(names) || HasNameOfTime(near) > HasNameOfTime(names)) {
      return false;
    }
    for (size_t i = 0; i < near.size(); ++i) {
      if (near[i].empty() ||
          std::count(near.begin(), near.end(), near[i]) > 1) {
        return true;
      }
    }
    return HasNameOfTime(names) && !HasNameOfTime(near);
  }

  // Takes the names from a higher line if they state units there. A line of
  // slots or modules may stand between it and the rows.
  void TakeNamesWithUnits(const RowRun& run, size_t line, TextHeader* header) {
    for (size_t i = line; i-- > 0 && line - i < kMostHeaderLines;) {
      if (IsNoRow(lines_[i].text)) return;
      std::vector<std::string> cells = CellsAbove(run, lines_[i].text);
      if (!Fits(run, &cells)) return;
      // "Range [g]" in each column is no name.
      const bool is_title =
          std::adjacent_find(cells.begin(), cells.end()) != cells.end();
      if (is_title || !AreNames(cells) || 2 * NumUnits(cells) < cells.size() ||
          !AreBetterNames(cells, header->cells)) {
        continue;
      }
      header->names = i;
      header->cells = std::move(cells);
      return;
    }
  }

  // Looks for names in the last comment above the rows.
  void FindHeaderInComment(const RowRun& run, TextHeader* header) {
    for (size_t i = run.first; i-- > 0;) {
      std::string_view line = StripBlanks(lines_[i].text);
      if (line.empty() || line.front() != '#') continue;
      line.remove_prefix(std::min(line.find_first_not_of("# "), line.size()));
      std::vector<std::string> cells = Cells(line, run.delimiter);
      // "#" is the name of row numbers in "#,Time,Acc".
      if (cells.size() > 1 && cells[0].empty()) cells[0] = "#";
      // "# Rate: 200 Hz" is no line of names.
      const bool are_names =
          std::all_of(cells.begin(), cells.end(), [](const std::string& cell) {
            double number = 0.0;
            return !cell.empty() && !ParseCell(cell, '.', &number) &&
                   cell.find(':') == std::string::npos;
          });
      if (cells.size() != run.kinds.size() || !are_names) return;
      header->found = true;
      header->in_comment = true;
      header->names = i;
      header->cells = std::move(cells);
      return;
    }
  }
  const std::vector<TextLine>& lines_;
  const TextFormat& format_;
  std::vector<std::string_view> cells_;
  std::vector<std::string> storage_;
};

}  // namespace

std::string UnitOfCell(std::string_view cell) {
  if (cell.size() > 2 && ((cell.front() == '[' && cell.back() == ']') ||
                          (cell.front() == '(' && cell.back() == ')'))) {
    cell = StripBlanks(cell.substr(1, cell.size() - 2));
  }
  return CanonicalUnit(cell);
}

bool IsSeparatorLine(std::string_view line) {
  return line.find_first_not_of("-=_*+~;,| \t\"") == std::string_view::npos;
}

TextHeader FindTextHeader(const std::vector<TextLine>& lines,
                          const TextFormat& format, const RowRun& run) {
  return HeaderFinder(lines, format).FindHeader(run);
}

}  // namespace pinode
