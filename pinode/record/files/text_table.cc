#include "pinode/record/files/text_table.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/base/text_encoding.h"
#include "pinode/record/files/text_clock.h"
#include "pinode/record/files/text_rows.h"
#include "pinode/record/files/text_sentences.h"
#include "pinode/record/files/text_thousands.h"
#include "pinode/record/files/text_time.h"
#include "pinode/record/number_rows.h"

namespace pinode {
namespace {

// Numbers of more digits are no exact doubles.
constexpr double kLargestExact = 9e15;
// Instruments with SCPI write 9.9e37 for an overflow and 9.91e37 for no number.
constexpr double kOverflow = 9.8e37;

bool HasName(const std::string& name, const std::vector<std::string>& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

class TextTableReader {
 public:
  TextTableReader(std::string text, const std::string& path,
                  const std::vector<std::string>& wanted,
                  const TextFormat& format, std::string* error)
      : text_(std::move(text)),
        path_(path),
        wanted_(wanted),
        format_(format),
        error_(error) {}

  bool Read(Table* table) {
    std::string what;
    if (!ConvertToUtf8(format_.encoding, &text_, &encoding_, &what)) {
      *error_ = path_ + ": " + what;
      return false;
    }
    NormaliseLines(&text_);
    if (encoding_.name != "UTF-8") said_ = "text in " + encoding_.AsText();
    if (!FindTextLayout(text_, path_, format_, &layout_, &what)) {
      return ReadWithoutLayout(what, table);
    }
    if (!layout_.IsClear(path_, error_) || !FindColumns()) return false;
    const bool plain =
        layout_.is_plain && !IsClock() && !HasLongTime() && !HasTimeOfText() &&
        !MayHaveThousands(std::string_view(text_).substr(layout_.first_row));
    if (!(plain ? ReadPlain() : ReadRows())) return false;
    if (!plain) Say(DescribeLayout(layout_));
    if (!FinishTime()) return false;
    table_.reading = std::move(said_);
    *table = std::move(table_);
    return true;
  }

 private:
  bool Fail(int64_t line, const std::string& message) {
    *error_ = path_ + ":" + std::to_string(line) + ": " + message;
    return false;
  }

  // Reports a column that is not found. Its name may be garbled.
  bool FailOnName(int64_t line, const std::string& message) {
    return Fail(line,
                message + (encoding_.is_guess
                               ? "; the text is read as " + encoding_.name +
                                     ", which is a guess: set "
                                     "`encoding` if names look wrong"
                               : ""));
  }

  void Say(const std::string& text) {
    said_ += (said_.empty() ? "" : ", ") + text;
  }

  bool IsClock() const {
    return clock_.has_value() && clock_->parts().IsClock();
  }

  bool IsPartOfTime(int column) const {
    return clock_.has_value() && clock_->parts().Has(column);
  }

  const TextColumn& ColumnAt(int i) const {
    return layout_.columns[static_cast<size_t>(i)];
  }

  // Finds the wanted columns, and the parts of the time.
  bool FindColumns() {
    const int64_t line =
        layout_.names_line > 0 ? layout_.names_line : layout_.first_row_line;
    std::string what;
    if (!format_.time_column.empty() &&
        (wanted_.empty() || HasName(format_.time_column, wanted_))) {
      time_ = layout_.FindColumn(format_.time_column, &what);
      if (time_ < 0) return FailOnName(line, what);
      clock_.emplace(layout_, format_, time_);
      unit_above_ = UnitOfTimeAbove(
          std::string_view(text_).substr(0, layout_.first_row),
          {layout_.names_line, layout_.units_line}, &unit_above_line_);
    }
    if (wanted_.empty()) {
      for (size_t i = 0; i < layout_.columns.size(); ++i) {
        const int place = static_cast<int>(i);
        const CellKind kind = layout_.columns[i].kind;
        if (place != time_ &&
            (IsPartOfTime(place) ||
             (kind != CellKind::kNumber && kind != CellKind::kMissing))) {
          continue;
        }
        places_.push_back(place);
        table_.columns.push_back(layout_.columns[i].name);
      }
    }
    for (const std::string& name : wanted_) {
      if (HasName(name, table_.columns)) continue;
      const int place = layout_.FindColumn(name, &what);
      if (place < 0) return FailOnName(line, what);
      places_.push_back(place);
      table_.columns.push_back(name);
    }
    table_.path = path_;
    for (const int place : places_) {
      table_.units.push_back(ColumnAt(place).unit);
    }
    return true;
  }

  // Reads a table whose layout is not found, such as one with names on several
  // lines, if it is CSV; else keeps the error of the layout.
  bool ReadWithoutLayout(const std::string& what, Table* table) {
    TextFormat plain;
    plain.time_column = format_.time_column;
    plain.time_unit = format_.time_unit;
    std::string other;
    if (plain.AsText() != format_.AsText() ||
        !ParseCsvTable(text_, path_, wanted_, &table_, &other)) {
      *error_ = what;
      return false;
    }
    table_.reading = said_;
    *table = std::move(table_);
    return true;
  }

  // True for times that are neither numbers nor clocks of a known form. The
  // message on them names other keys than that on a cell of plain CSV.
  bool HasTimeOfText() const {
    return time_ >= 0 && ColumnAt(time_).kind == CellKind::kText;
  }

  // True for times with more digits than a double has.
  bool HasLongTime() {
    if (time_ < 0) return false;
    const size_t end =
        std::min(text_.find('\n', layout_.first_row), text_.size());
    const std::string_view line(text_.data() + layout_.first_row,
                                end - layout_.first_row);
    double value = 0.0;
    return SplitCells(line, layout_.delimiter, &cells_, &storage_) &&
           cells_.size() > static_cast<size_t>(time_) &&
           ParseCell(cells_[static_cast<size_t>(time_)], layout_.decimal,
                     &value) &&
           std::abs(value) > kLargestExact;
  }

  bool ReadPlain() {
    std::vector<std::string> names;
    for (const int place : places_) names.push_back(ColumnAt(place).name);
    Table plain;
    if (!ParseCsvTable(std::move(text_), path_, names, &plain, error_)) {
      return false;
    }
    table_.values = std::move(plain.values);
    table_.line_numbers = std::move(plain.line_numbers);
    return CheckFinite();
  }

  // Reads all rows by the layout; once more with decimal commas where the first
  // rows left that open.
  bool ReadRows() {
    const auto begin = static_cast<ptrdiff_t>(layout_.first_row);
    const auto rows = std::count(text_.begin() + begin, text_.end(), '\n') + 1;
    table_.values.resize(rows, static_cast<Eigen::Index>(places_.size()));
    table_.line_numbers.clear();
    table_.line_numbers.reserve(static_cast<size_t>(rows));
    if (clock_.has_value()) clock_->Clear(static_cast<size_t>(rows));
    blank_line_ = 0;
    const NumberRow plain = PlainRow();
    Eigen::Index row = 0;
    int64_t line_number = layout_.first_row_line - 1;
    size_t at = layout_.first_row;
    while (at < text_.size()) {
      const size_t end = std::min(text_.find('\n', at), text_.size());
      const std::string_view line(text_.data() + at, end - at);
      at = end + 1;
      ++line_number;
      if (IsNoRow(line) && !IsRowOfTabs(line)) {
        if (StripBlanks(line).empty()) blank_line_ = line_number;
        continue;
      }
      if (blank_line_ > 0 && layout_.num_cells == 1 && row > 0) {
        return Fail(blank_line_,
                    "a blank line between rows of a single column may be a "
                    "missing value; write nan there, or delete the line");
      }
      if (row == 0 && !CheckHalves(line, line_number)) return false;
      if (!ReadPlainRow(plain, line, row) && !ReadRow(line, line_number, row)) {
        if (!reread_) return false;
        reread_ = false;
        error_->clear();
        layout_.is_decimal_open = false;
        layout_.decimal = ',';
        return ReadRows();
      }
      table_.line_numbers.push_back(line_number);
      ++row;
    }
    table_.values.conservativeResize(row, Eigen::NoChange);
    return CheckMeaning() && FinishClock();
  }

  // Refuses clock times whose half of the day stands in another column.
  bool CheckHalves(std::string_view line, int64_t line_number) {
    if (!IsClock() ||
        !SplitCells(line, layout_.delimiter, &cells_, &storage_) ||
        !clock_->HasHalfBeside(cells_, layout_.decimal)) {
      return true;
    }
    return Fail(line_number,
                "AM or PM stands in a column of its own, so the hours of '" +
                    ColumnAt(time_).name +
                    "' count to 12; write it behind the time, or give "
                    "`sampling_rate_hz`");
  }

  // Reader of rows whose wanted cells are plain numbers.
  NumberRow PlainRow() const {
    std::vector<int> columns(layout_.num_cells, -1);
    for (size_t j = 0; j < places_.size(); ++j) {
      if (places_[j] == time_ && IsClock()) continue;
      columns[static_cast<size_t>(places_[j])] = static_cast<int>(j);
    }
    return NumberRow(layout_.delimiter, layout_.decimal, std::move(columns));
  }

  // True if the time of a row has more digits than a double.
  bool IsLongTime(Eigen::Index row) const {
    const auto place = std::find(places_.begin(), places_.end(), time_);
    return place != places_.end() &&
           std::abs(table_.values(row, place - places_.begin())) >
               kLargestExact;
  }

  // Reads a row of plain numbers and, perhaps, a clock time. Returns false if
  // the row is another one, or if its numbers still tell how to read them.
  bool ReadPlainRow(const NumberRow& plain, std::string_view line,
                    Eigen::Index row) {
    if (layout_.is_decimal_open || places_.empty() ||
        (layout_.decimal == ',' && !commas_.is_decided()) ||
        !plain.Parse(line, table_.values.data() + row, table_.values.rows())) {
      return false;
    }
    if (!IsClock()) return !IsLongTime(row);
    // Only the cells up to the last one of the time.
    size_t end = 0;
    const int last = clock_->parts().Last();
    for (int i = 0; i <= last && end != std::string_view::npos; ++i) {
      end = line.find(layout_.delimiter, i == 0 ? 0 : end + 1);
    }
    std::string unused;
    return layout_.delimiter != ' ' &&
           SplitCells(line.substr(0, end), layout_.delimiter, &cells_,
                      &storage_) &&
           cells_.size() > static_cast<size_t>(last) &&
           clock_->Add(cells_, layout_.decimal, &unused);
  }

  bool ReadRow(std::string_view line, int64_t line_number, Eigen::Index row) {
    if (!SplitCells(line, layout_.delimiter, &cells_, &storage_)) {
      return Fail(
          line_number,
          "stray quote, expected cells quoted as a whole (\"...\", with "
          "a quote inside doubled), each on one line");
    }
    while (cells_.size() > layout_.num_cells && cells_.back().empty()) {
      cells_.pop_back();
    }
    if (cells_.size() + 1 == layout_.num_cells &&
        layout_.columns.size() < layout_.num_cells) {
      cells_.emplace_back();
    }
    if (cells_.size() != layout_.num_cells) {
      return Fail(line_number, WhyRagged(cells_.size(), layout_));
    }
    std::string what;
    if (IsClock() && !clock_->Add(cells_, layout_.decimal, &what)) {
      return Fail(line_number, what);
    }
    for (size_t j = 0; j < places_.size(); ++j) {
      if (places_[j] == time_ && IsClock()) continue;
      double value = 0.0;
      const std::string_view cell = cells_[static_cast<size_t>(places_[j])];
      if (!ParseNumber(cell, places_[j] == time_, &value)) {
        return RefuseCell(line_number, places_[j], cell);
      }
      table_.values(row, static_cast<Eigen::Index>(j)) = value;
    }
    return true;
  }

  // True for a row of missing values alone.
  bool IsRowOfTabs(std::string_view line) const {
    return layout_.delimiter == '\t' &&
           line.find('\t') != std::string_view::npos &&
           StripBlanks(line).empty();
  }

  // Parses a number. Of times that are too large for a double only the
  // distance from the first one is kept.
  bool ParseNumber(std::string_view cell, bool is_time, double* value) {
    if (!ParseCell(cell, layout_.decimal, value)) {
      // A user who gives the decimal sign says what the other one is.
      std::string joined;
      return format_.decimal != 0 &&
             JoinThousands(cell, layout_.decimal, true, &joined) &&
             ParseDouble(joined, value);
    }
    if (layout_.decimal == ',') commas_.Add(cell);
    if (layout_.is_decimal_open && cell.find('.') != std::string_view::npos) {
      layout_.is_decimal_open = false;
    }
    if (is_time && std::abs(*value) > kLargestExact) {
      int64_t whole = 0;
      if (!ParseInt(cell, &whole)) return true;
      if (first_ticks_ == 0) first_ticks_ = whole;
      // The first row keeps its size, by which its unit is told.
      *value = static_cast<double>(whole - first_ticks_);
    }
    return true;
  }

  bool RefuseCell(int64_t line_number, int place, std::string_view cell) {
    double value = 0.0;
    reread_ = layout_.is_decimal_open && layout_.decimal == '.' &&
              ParseCell(cell, ',', &value);
    return Fail(line_number, "column '" + ColumnAt(place).name + "': " +
                                 WhyNoNumber(cell, layout_.decimal,
                                             place == time_, HasTimeOfText()));
  }

  // Refuses infinite numbers, and marks of an overflow.
  bool CheckFinite() {
    for (Eigen::Index j = 0; j < table_.values.cols(); ++j) {
      if (clock_column(j)) continue;
      for (Eigen::Index i = 0; i < table_.values.rows(); ++i) {
        const double value = table_.values(i, j);
        if (!(std::abs(value) >= kOverflow)) continue;
        return Fail(table_.line_numbers[static_cast<size_t>(i)],
                    "column '" + table_.columns[static_cast<size_t>(j)] +
                        "': the number " +
                        (std::isinf(value)
                             ? "is not finite"
                             : FormatNumber(value) + " means an overflow") +
                        "; write nan for a missing value");
      }
    }
    return true;
  }

  // Refuses numbers that can be read in two ways, and infinite ones.
  bool CheckMeaning() {
    if (!CheckFinite()) return false;
    if (!commas_.doubtful().empty() && format_.decimal == 0) {
      return Fail(layout_.first_row_line, WhyDoubtful(commas_.doubtful(), ','));
    }
    return true;
  }

  bool clock_column(Eigen::Index j) const {
    return IsClock() && places_[static_cast<size_t>(j)] == time_;
  }

  bool FinishClock() {
    if (!IsClock()) return true;
    Vector times;
    size_t row = 0;
    std::string what;
    if (!clock_->Finish(&times, &table_.time_origin, &time_said_, &row,
                        &what)) {
      return Fail(table_.line_numbers[row], what);
    }
    for (size_t j = 0; j < places_.size(); ++j) {
      if (places_[j] == time_) {
        table_.values.col(static_cast<Eigen::Index>(j)) = times;
      }
    }
    table_.time_unit = "s";
    return true;
  }

  bool FinishTime() {
    if (!time_said_.empty()) Say(time_said_);
    if (time_ < 0 || IsClock()) return true;
    const int column = table_.FindColumn(format_.time_column);
    if (layout_.names_line == 0 && format_.time_unit.empty()) {
      Say("time '" + ColumnAt(time_).name + "' read as seconds");
    }
    std::string what;
    const bool is_stated = !format_.time_unit.empty() ||
                           !ColumnAt(time_).unit.empty() ||
                           !UnitOfTimeName(ColumnAt(time_).name).empty();
    if (!unit_above_.empty() && !is_stated) {
      return Fail(unit_above_line_,
                  "this line may state that the times are in " + unit_above_ +
                      ", but column '" + ColumnAt(time_).name +
                      "' has no unit; set `time_unit`");
    }
    if (!ReadTimeNumbers(format_, ColumnAt(time_).unit, column,
                         static_cast<double>(first_ticks_), &table_, &said_,
                         &what)) {
      return Fail(layout_.first_row_line, what);
    }
    return true;
  }

  std::string text_;
  const std::string& path_;
  const std::vector<std::string>& wanted_;
  TextEncoding encoding_;
  const TextFormat& format_;
  std::string* error_;
  TextLayout layout_;
  // Unit of the time that a line above the names may state.
  std::string unit_above_;
  int64_t unit_above_line_ = 0;
  Table table_;
  std::string said_;
  std::string time_said_;
  // Columns of the file, in the order of the table.
  std::vector<int> places_;
  int time_ = -1;
  std::optional<TextClock> clock_;
  int64_t first_ticks_ = 0;
  CommaWatch commas_;
  bool reread_ = false;
  int64_t blank_line_ = 0;
  std::vector<std::string_view> cells_;
  std::vector<std::string> storage_;
};

}  // namespace

bool ParseTextTable(std::string text, const std::string& path,
                    const std::vector<std::string>& wanted,
                    const TextFormat& format, Table* table,
                    std::string* error) {
  CHECK(table != nullptr);
  CHECK(error != nullptr);
  return TextTableReader(std::move(text), path, wanted, format, error)
      .Read(table);
}

bool ReadTextTable(const std::string& path,
                   const std::vector<std::string>& wanted,
                   const TextFormat& format, Table* table, std::string* error) {
  std::string text;
  return ReadTextOfAnyEncoding(path, &text, error) &&
         ParseTextTable(std::move(text), path, wanted, format, table, error);
}

}  // namespace pinode
