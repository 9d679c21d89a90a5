#include "pinode/record/files/text_layout.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/file_text.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/base/unit_names.h"
#include "pinode/record/files/text_header.h"
#include "pinode/record/files/text_rows.h"
#include "pinode/record/files/text_sentences.h"
#include "pinode/record/files/text_thousands.h"
#include "pinode/record/table.h"

namespace pinode {
namespace {

// Lines that are searched for rows.
constexpr size_t kMostLines = 2000;
// A reading of the text with this fraction of the numbers of the best one is
// as good.
constexpr double kAsGood = 0.67;

class LayoutFinder {
 public:
  LayoutFinder(std::string_view text, const std::string& path,
               const TextFormat& format, TextLayout* layout, std::string* error)
      : text_(text),
        path_(path),
        format_(format),
        layout_(layout),
        error_(error) {}

  bool Find() {
    lines_ = FirstLines(text_, kMostLines + static_cast<size_t>(std::max(
                                                format_.header_lines, 0)));
    SkipFirstLine();
    if (format_.header_lines > static_cast<int>(lines_.size())) {
      return Fail(0, "has fewer lines than `header_lines` says");
    }
    runs_ = FindRowRuns(lines_, format_);
    if (runs_.empty()) return RefuseWithoutRows();
    if (!Choose()) return false;
    Fill();
    return true;
  }

 private:
  // Skips the first line "sep=;", which is for spreadsheets, and that of pairs
  // of time and value by ObsPy.
  void SkipFirstLine() {
    if (lines_.empty() || format_.header_lines >= 0) return;
    const std::string_view line = StripBlanks(lines_[0].text);
    const bool is_delimiter = line.size() <= 5 && line.substr(0, 4) == "sep=";
    const bool are_pairs = line.substr(0, 11) == "TIMESERIES " &&
                           line.find(", TSPAIR,") != std::string_view::npos;
    if (!is_delimiter && !are_pairs) return;
    lines_.erase(lines_.begin());
    has_first_line_ = true;
  }

  // Refuses the samples of one motion, several a line.
  bool CheckWrapped() {
    const size_t cells = run_.kinds.size();
    if (format_.header_lines >= 0 || cells < 2) return true;
    size_t above = run_.first;
    while (above > 0 && StripBlanks(lines_[above - 1].text).empty()) --above;
    if (above == 0) return true;
    const TextLine& line = lines_[above - 1];
    const std::string why =
        WhyWrapped(line.text, cells, lines_[run_.first].number);
    return why.empty() || Fail(line.number, why);
  }

  bool Fail(int64_t line, const std::string& message) {
    *error_ = path_ + (line > 0 ? ":" + std::to_string(line) : std::string()) +
              ": " + message;
    return false;
  }

  bool RefuseWithoutRows() {
    const bool blank =
        std::all_of(lines_.begin(), lines_.end(),
                    [](const TextLine& line) { return IsNoRow(line.text); });
    if (blank) {
      return Fail(0,
                  "is empty, expected a header line with the columns' names "
                  "and one line a sample");
    }
    std::vector<std::string_view> cells;
    std::vector<std::string> storage;
    for (const TextLine& line : lines_) {
      for (const char delimiter : {',', ';', '\t', '|'}) {
        if (!SplitCells(line.text, delimiter, &cells, &storage)) continue;
        const auto lakh =
            std::find_if(cells.begin(), cells.end(), IsLakhNumber);
        if (lakh != cells.end()) return Fail(line.number, WhyNoLakh(*lakh));
      }
    }
    return Fail(0,
                "no rows of numbers were found. Set `delimiter`, `decimal` and "
                "`header_lines` (number of lines above the first row), and "
                "`time_format` for unusual clock times");
  }

  // Keeps one run, or refuses.
  bool Choose() {
    for (const RowRun& run : runs_) {
      for (const RowRun& other : runs_) {
        if (run.delimiter == other.delimiter && run.decimal != other.decimal &&
            run.first == other.first && run.kinds == other.kinds) {
          if (run.delimiter != ',') open_decimals_ += run.delimiter;
        }
      }
    }
    DropSameReadings(&runs_);
    size_t best = 0;
    size_t most_rows = 0;
    for (const RowRun& run : runs_) {
      best = std::max(best, run.Score());
      most_rows = std::max(most_rows, std::min(run.rows, kEnoughRows));
    }
    std::vector<RowRun> good;
    for (RowRun& run : runs_) {
      const double score = static_cast<double>(run.Score());
      if (score >= kAsGood * static_cast<double>(best) ||
          CanBeDecimalCommas(run, most_rows)) {
        good.push_back(std::move(run));
      }
    }
    std::vector<TextHeader> headers;
    for (const RowRun& run : good)
      headers.push_back(FindTextHeader(lines_, format_, run));
    if (good.size() > 1) KeepThoseWithHeaders(&good, &headers);
    if (good.size() > 1) return RefuseSeveral(good);
    run_ = std::move(good[0]);
    header_ = std::move(headers[0]);
    run_.first = header_.first_row;
    return CheckHeader();
  }

  // Numbers with decimal commas in one column also read as two columns of
  // whole numbers, which have more values.
  static bool CanBeDecimalCommas(const RowRun& run, size_t most_rows) {
    return run.decimal == ',' && run.kinds.size() == 1 && run.rows >= most_rows;
  }

  // Drops readings that give the same numbers as another one, and those with
  // blanks where there is a delimiter.
  void DropSameReadings(std::vector<RowRun>* runs) const {
    const auto splits = [](const RowRun& run) {
      return run.delimiter != ' ' && run.delimiter != 0 && run.kinds.size() > 1;
    };
    std::vector<RowRun> kept;
    for (const RowRun& run : *runs) {
      const bool dropped =
          std::any_of(runs->begin(), runs->end(), [&](const RowRun& other) {
            if (&other == &run) return false;
            if (other.delimiter == run.delimiter && other.first == run.first &&
                other.kinds == run.kinds) {
              return other.decimal == '.' && run.decimal == ',';
            }
            // Without a delimiter in the rows all of them say the same.
            if (run.kinds.size() == 1 && other.kinds.size() == 1 &&
                run.decimal == other.decimal && run.first == other.first) {
              return &other < &run;
            }
            return run.delimiter == ' ' && splits(other) &&
                   2 * other.Values() >= run.Values() &&
                   other.rows >= std::min(run.rows, kEnoughRows) &&
                   other.first <= run.first;
          });
      if (!dropped) kept.push_back(run);
    }
    if (!kept.empty()) *runs = std::move(kept);
  }

  // With one reading whose rows have names above them, the others are wrong.
  void KeepThoseWithHeaders(std::vector<RowRun>* runs,
                            std::vector<TextHeader>* headers) const {
    std::vector<size_t> named;
    for (size_t i = 0; i < runs->size(); ++i) {
      const TextHeader& header = (*headers)[i];
      if (!header.found) continue;
      // A single name with the other reading's delimiter is several names.
      const bool several =
          (*runs)[i].kinds.size() == 1 &&
          std::any_of(runs->begin(), runs->end(), [&](const RowRun& other) {
            return other.kinds.size() > 1 && other.delimiter != 0 &&
                   header.cells[0].find(other.delimiter) != std::string::npos;
          });
      if (!several) named.push_back(i);
    }
    if (named.size() != 1) return;
    RowRun run = (*runs)[named[0]];
    TextHeader header = (*headers)[named[0]];
    *runs = {std::move(run)};
    *headers = {std::move(header)};
  }

  bool RefuseSeveral(const std::vector<RowRun>& runs) {
    const TextLine& line = lines_[runs[0].first];
    const bool delimiters =
        std::any_of(runs.begin(), runs.end(), [&runs](const RowRun& run) {
          return run.delimiter != runs[0].delimiter;
        });
    return Fail(line.number,
                Quote(line.text) + " can be read in several ways. Set " +
                    (delimiters ? "`delimiter` and `decimal`" : "`decimal`"));
  }

  // True for a first row like "0,1,2" above rows with fractions: it may be the
  // names of the columns.
  bool MayBeNumberedNames() {
    if (header_.found || format_.header_lines >= 0 || run_.rows < 2) {
      return false;
    }
    std::vector<std::string_view> first;
    std::vector<std::string> storage;
    if (!SplitCells(lines_[run_.first].text, run_.delimiter, &first,
                    &storage)) {
      return false;
    }
    for (const int begin : {0, 1}) {
      bool counts = first.size() > 1;
      for (size_t i = 0; i < first.size(); ++i) {
        counts =
            counts && first[i] == std::to_string(begin + static_cast<int>(i));
      }
      if (counts) return true;
    }
    return false;
  }

  // The number that all cells of the row number `i` of the run have; NaN if
  // they differ.
  double CommonNumber(size_t i) {
    size_t row = 0;
    for (size_t line = run_.first; line < lines_.size(); ++line) {
      if (IsNoRow(lines_[line].text) || row++ < i) continue;
      std::vector<std::string_view> cells;
      std::vector<std::string> storage;
      double common = kNaN;
      if (!SplitCells(lines_[line].text, run_.delimiter, &cells, &storage)) {
        return kNaN;
      }
      for (size_t c = 0; c < cells.size(); ++c) {
        double number = kNaN;
        if (!ParseCell(cells[c], run_.decimal, &number) ||
            (c > 0 && number != common)) {
          return kNaN;
        }
        common = number;
      }
      return common;
    }
    return kNaN;
  }

  // True for rows without names whose first two are the start in seconds since
  // 1970 and the sampling rate, once for each column, as wristband loggers
  // write them.
  bool BeginsWithStartAndRate() {
    constexpr double kYear2000 = 946684800.0;
    constexpr double kYear2100 = 4102444800.0;
    if (header_.found || format_.header_lines >= 0 || run_.rows < 3) {
      return false;
    }
    const double start = CommonNumber(0);
    const double rate = CommonNumber(1);
    const double third = CommonNumber(2);
    return start > kYear2000 && start < kYear2100 && rate > 0.0 && rate < 1e6 &&
           !(third > kYear2000);
  }

  // True for whole numbers between commas that may be the two parts of numbers
  // with decimal commas: a part begins with a zero, or every second cell is
  // without a sign.
  bool MayBeDecimalCommas() {
    if (run_.delimiter != ',' || header_.found || format_.delimiter != 0 ||
        format_.decimal != 0) {
      return false;
    }
    bool has_zeros = false;
    bool can_be_pairs = run_.kinds.size() % 2 == 0;
    std::vector<std::string_view> cells;
    std::vector<std::string> storage;
    size_t rows = 0;
    for (size_t i = run_.first; i < lines_.size() && rows < run_.rows; ++i) {
      if (IsNoRow(lines_[i].text)) continue;
      ++rows;
      if (!SplitCells(lines_[i].text, ',', &cells, &storage)) continue;
      for (size_t c = 0; c < cells.size(); ++c) {
        const std::string_view cell = cells[c];
        if (cell.find_first_not_of("+-0123456789") != std::string_view::npos ||
            cell.empty()) {
          return false;
        }
        has_zeros = has_zeros || (cell.size() > 1 && cell[0] == '0');
        const bool is_signed = cell[0] == '-' || cell[0] == '+';
        can_be_pairs = can_be_pairs && !(c % 2 == 1 && is_signed);
      }
    }
    return has_zeros || can_be_pairs;
  }

  bool CheckHeader() {
    if (!CheckWrapped()) return false;
    if (MayBeDecimalCommas()) return RefuseSeveral({run_, RowRun()});
    if (MayBeNumberedNames()) {
      const int64_t line = lines_[run_.first].number;
      return Fail(line, Quote(lines_[run_.first].text) +
                            " may be a row or the names of the columns; set "
                            "`header_lines = " +
                            std::to_string(line - 1) + "` or `" +
                            std::to_string(line) + "`");
    }
    if (BeginsWithStartAndRate()) {
      const int64_t line = lines_[run_.first].number;
      return Fail(line,
                  "the first two rows look like a start time and a sampling "
                  "rate of " +
                      FormatNumber(CommonNumber(1)) +
                      " Hz. Set `header_lines = " + std::to_string(line + 1) +
                      "` and `sampling_rate_hz`; if they are samples, set "
                      "`header_lines = " +
                      std::to_string(line - 1) + "`");
    }
    if (header_.found || !header_.is_odd || format_.header_lines >= 0) {
      return true;
    }
    const size_t n = run_.kinds.size();
    const bool beside = std::all_of(
        lines_.begin() + static_cast<ptrdiff_t>(header_.odd) + 1,
        lines_.begin() + static_cast<ptrdiff_t>(run_.first),
        [](const TextLine& line) {
          return !StripBlanks(line.text).empty() && IsSeparatorLine(line.text);
        });
    // A line of text above a blank line is a title.
    if (!beside && header_.odd_cells <= 1) return true;
    const TextLine& row = lines_[run_.first];
    std::string message = std::to_string(n) + (n == 1 ? " cell" : " cells") +
                          ", expected " + std::to_string(header_.odd_cells) +
                          " as in the header line";
    if (run_.delimiter == ',' && n == 2 * header_.odd_cells) {
      message +=
          "; the numbers probably have decimal commas. Use decimal points or "
          "another delimiter";
    }
    return Fail(
        row.number,
        message + ". If line " + std::to_string(lines_[header_.odd].number) +
            " does not have the names of the columns, set `header_lines = " +
            std::to_string(row.number - 1) +
            "`; the columns are then column_1, column_2, "
            "...");
  }

  void Fill() {
    layout_->delimiter = run_.delimiter;
    layout_->decimal = run_.decimal;
    layout_->is_decimal_open =
        open_decimals_.find(run_.delimiter) != std::string::npos &&
        run_.decimal == '.' && format_.decimal == 0;
    layout_->first_row = lines_[run_.first].offset;
    layout_->first_row_line = lines_[run_.first].number;
    layout_->names_line = header_.found ? lines_[header_.names].number : 0;
    layout_->units_line = header_.has_units ? lines_[header_.units].number : 0;
    layout_->num_cells = run_.kinds.size();
    if (format_.decimal == 0) {
      const DoubtfulNumber doubtful = DoubtfulThousands(
          text_.substr(layout_->first_row), layout_->first_row_line, run_);
      layout_->doubtful_number = doubtful.text;
      layout_->doubtful_line = doubtful.line;
    }
    std::vector<std::string> names = header_.cells;
    names.resize(run_.kinds.size());
    // Columns without a name and without values are no columns.
    size_t num_columns = names.size();
    while (num_columns > 0 && names[num_columns - 1].empty() &&
           run_.kinds[num_columns - 1] == CellKind::kMissing) {
      --num_columns;
    }
    names.resize(num_columns);
    layout_->columns.clear();
    bool unique = true;
    for (size_t i = 0; i < num_columns; ++i) {
      TextColumn column;
      column.kind = run_.kinds[i];
      column.name = names[i];
      SplitUnitOfName(names[i], &column.short_name, &column.unit);
      if (header_.has_units) {
        const std::string unit = UnitOfCell(header_.unit_cells[i]);
        if (!unit.empty() && !column.unit.empty() && unit != column.unit) {
          layout_->doubtful_units.push_back(column.name);
          column.unit.clear();
        } else if (!unit.empty()) {
          column.unit = unit;
        }
      }
      if (column.name.empty()) {
        column.name = "column_" + std::to_string(i + 1);
        column.short_name = column.name;
        unique = false;
      } else if (std::count(names.begin(), names.end(), names[i]) > 1) {
        const auto place = names.begin() + static_cast<ptrdiff_t>(i);
        column.name +=
            "[" +
            std::to_string(1 + std::count(names.begin(), place, names[i])) +
            "]";
        column.short_name = column.name;
        unique = false;
      }
      layout_->columns.push_back(std::move(column));
    }
    layout_->is_plain = unique && IsPlain();
  }

  bool IsPlain() const {
    if (!header_.found || header_.in_comment || header_.has_units ||
        has_first_line_ || run_.decimal != '.' || layout_->is_decimal_open ||
        format_.header_lines >= 0 || !format_.time_format.empty()) {
      return false;
    }
    for (size_t i = 0; i < header_.names; ++i) {
      if (!IsNoRow(lines_[i].text)) return false;
    }
    for (size_t i = header_.names + 1; i < run_.first; ++i) {
      if (!IsNoRow(lines_[i].text)) return false;
    }
    for (size_t i = 0; i < run_.kinds.size(); ++i) {
      if (run_.kinds[i] != CellKind::kNumber &&
          run_.kinds[i] != CellKind::kMissing &&
          run_.kinds[i] != CellKind::kText) {
        return false;
      }
    }
    // "+ 0.08" is no number there.
    if (lines_[run_.first].text.find("+ ") != std::string_view::npos ||
        lines_[run_.first].text.find("- ") != std::string_view::npos) {
      return false;
    }
    return run_.delimiter == 0 || run_.delimiter == CsvDelimiter(text_);
  }

  std::string_view text_;
  const std::string& path_;
  const TextFormat& format_;
  TextLayout* layout_;
  std::string* error_;
  std::vector<TextLine> lines_;
  bool has_first_line_ = false;
  std::vector<RowRun> runs_;
  // Delimiters with which the rows that were looked at have no decimal sign.
  std::string open_decimals_;
  RowRun run_;
  TextHeader header_;
};

}  // namespace

bool FindTextLayout(std::string_view text, const std::string& path,
                    const TextFormat& format, TextLayout* layout,
                    std::string* error) {
  CHECK(layout != nullptr);
  CHECK(error != nullptr);
  TextLayout found;
  if (!LayoutFinder(text, path, format, &found, error).Find()) return false;
  *layout = std::move(found);
  return true;
}

bool TextLayout::IsClear(const std::string& path, std::string* error) const {
  if (doubtful_number.empty()) return true;
  *error = path + ":" + std::to_string(doubtful_line) + ": " +
           WhyDoubtful(doubtful_number, '.');
  return false;
}

int TextLayout::FindColumn(const std::string& name, std::string* error) const {
  std::vector<std::string> names;
  int found = -1;
  int matches = 0;
  for (size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].name == name) return static_cast<int>(i);
    names.push_back(columns[i].name);
    if (columns[i].short_name != name) continue;
    found = static_cast<int>(i);
    ++matches;
  }
  if (matches == 1) return found;
  if (matches > 1) {
    *error = "'" + name + "' is the name of several columns";
    return -1;
  }
  const std::string first = name + "[1]";
  if (std::find(names.begin(), names.end(), first) != names.end()) {
    *error = "the name '" + name + "' occurs twice, expected '" + first +
             "' or '" + name + "[2]'";
    return -1;
  }
  *error = "no column is named '" + name + "'" + NameHint(name, names);
  return -1;
}

}  // namespace pinode
