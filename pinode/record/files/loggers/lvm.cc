#include "pinode/record/files/loggers/lvm.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/record/files/loggers/text_lines.h"

namespace pinode {
namespace {

constexpr std::string_view kHeaderEnd = "***End_of_Header***";
constexpr std::string_view kLabviewTitle = "LabVIEW Measurement";
// Largest distance of a segment's start from the clock of the one before it, as
// a fraction of the step.
constexpr double kLargestSegmentJitter = 0.1;

// Largest difference of the starts of channels with one X column, as a fraction
// of the step, up to which they are samples of one time.
constexpr double kLargestSkew = 0.5;

// Rows of a header by their first cell.
using HeaderRows = std::vector<std::vector<std::string>>;

const std::vector<std::string>* FindRow(const HeaderRows& rows,
                                        std::string_view name) {
  for (const std::vector<std::string>& row : rows) {
    if (row[0] == name) return &row;
  }
  return nullptr;
}

std::string CellOf(const HeaderRows& rows, std::string_view name,
                   size_t column) {
  const std::vector<std::string>* row = FindRow(rows, name);
  return row != nullptr && column < row->size() ? (*row)[column] : "";
}

// One channel of one segment.
struct SegmentPart {
  size_t column = 0;  // of the values
  StartTime date;
  double x0 = 0.0;
  double step = 0.0;
  int64_t samples = 0;
  std::vector<double> values;
};

class LvmParser {
 public:
  LvmParser(const std::string& text, const std::string& path,
            const ChannelFilter& wanted)
      : lines_(text, path), wanted_(wanted) {}

  bool Parse(LoggedFile* file, std::string* error) {
    if (!ReadFileHeader(error)) return false;
    std::string_view line;
    while (lines_.Next(&line)) {
      if (StripBlanks(line).empty()) continue;
      if (!ReadSegment(line, error)) return false;
    }
    if (file_.channels.empty()) {
      return lines_.Fail(
          "no complete segment follows, expected lines from 'Channels' to "
          "'***End_of_Header***', the names and rows of numbers",
          error);
    }
    for (size_t i = 0; i < file_.channels.size(); ++i) {
      LoggerChannel* channel = &file_.channels[i];
      channel->size = static_cast<Eigen::Index>(values_[i].size());
      if (!wanted_(*channel)) continue;
      channel->values =
          Eigen::Map<const Vector>(values_[i].data(), channel->size);
    }
    if (gaps_ > 0.0) {
      file_.remarks.push_back("segments are up to " + FormatNumber(gaps_, 4) +
                              " s apart");
    }
    if (skew_ > 0.0) {
      file_.remarks.push_back("start times of the channels differ by up to " +
                              FormatNumber(skew_, 2) +
                              " s, that of the first one is used");
    }
    file_.format = "LVM";
    file_.time_names = {"X_Value"};
    MakeNamesUnique(&file_);
    SetStartTimes(starts_, &file_);
    *file = std::move(file_);
    return true;
  }

 private:
  std::vector<std::string> Cells(std::string_view line) const {
    std::vector<std::string> cells;
    for (const std::string_view cell : Split(line, separator_)) {
      cells.emplace_back(StripBlanks(cell));
    }
    return cells;
  }

  bool ParseNumber(std::string cell, double* value) const {
    if (decimal_ == ',') std::replace(cell.begin(), cell.end(), ',', '.');
    return ParseDouble(cell, value);
  }

  // Reads rows up to the end of a header.
  bool ReadRows(HeaderRows* rows, std::string* error) {
    std::string_view line;
    while (lines_.Next(&line)) {
      if (line.substr(0, kHeaderEnd.size()) == kHeaderEnd) return true;
      if (!StripBlanks(line).empty()) rows->push_back(Cells(line));
    }
    return lines_.Fail("the file ends inside a header, expected '" +
                           std::string(kHeaderEnd) + "'",
                       error);
  }

  bool ReadFileHeader(std::string* error) {
    std::string_view line;
    if (!lines_.Next(&line) ||
        line.substr(0, kLabviewTitle.size()) != kLabviewTitle) {
      return lines_.Fail("expected 'LabVIEW Measurement' at the beginning",
                         error);
    }
    if (line.size() > kLabviewTitle.size() &&
        line[kLabviewTitle.size()] == ',') {
      separator_ = ',';
    }
    if (!ReadRows(&header_, error)) return false;
    const std::string decimal = CellOf(header_, "Decimal_Separator", 1);
    // Between commas, a decimal comma would be an empty cell.
    if (decimal == ",") decimal_ = ',';
    const std::string columns = CellOf(header_, "X_Columns", 1);
    is_multi_ = columns == "Multi";
    if (decimal_ == ',' && separator_ == ',') {
      return lines_.Fail(
          "commas are both separators and decimal signs. Export the file again "
          "with tabs",
          error);
    }
    return true;
  }

  // Reads a segment whose header begins with `first`.
  bool ReadSegment(std::string_view first, std::string* error) {
    HeaderRows rows = {Cells(first)};
    if (rows[0][0] != "Channels") {
      return lines_.Fail(Quote(StripBlanks(first)) +
                             ", expected a segment's header, which begins "
                             "with 'Channels'",
                         error);
    }
    int64_t count = 0;
    if (rows[0].size() < 2 || !ParseInt(rows[0][1], &count) || count < 1 ||
        count > static_cast<int64_t>(lines_.bytes())) {
      return lines_.Fail("expected the number of channels behind 'Channels'",
                         error);
    }
    if (!ReadRows(&rows, error)) return false;
    std::string_view line;
    if (!lines_.Next(&line)) {
      return lines_.Fail("the file ends before the names of the channels",
                         error);
    }
    const std::vector<std::string> names = Cells(line);
    const size_t per_channel = is_multi_ ? 2 : 1;
    if (names.size() < 1 + per_channel * static_cast<size_t>(count - 1) + 1) {
      return lines_.Fail(std::to_string(count) +
                             " channels, expected as many names in this line",
                         error);
    }
    std::vector<SegmentPart> parts;
    for (int64_t i = 0; i < count; ++i) {
      SegmentPart part;
      part.column = 1 + per_channel * static_cast<size_t>(i);
      if (!ReadPart(rows, &part, error)) return false;
      parts.push_back(std::move(part));
    }
    if (!is_multi_) JoinStarts(&parts);
    if (!ReadValues(&parts, error)) return false;
    return file_.channels.empty() ? TakeFirst(rows, names, &parts, error)
                                  : TakeNext(names, &parts, error);
  }

  // Reads what the header says of a channel.
  bool ReadPart(const HeaderRows& rows, SegmentPart* part, std::string* error) {
    const size_t column = part->column;
    if (!ParseInt(CellOf(rows, "Samples", column), &part->samples) ||
        part->samples < 0 ||
        part->samples > static_cast<int64_t>(lines_.bytes()) ||
        !ParseNumber(CellOf(rows, "Delta_X", column), &part->step) ||
        !(part->step > 0.0) || !std::isfinite(1.0 / part->step)) {
      return lines_.Fail(
          "the segment's header has no 'Samples' and positive 'Delta_X' for "
          "each channel. Set `header_lines` in the record to read the file as "
          "text",
          error);
    }
    const std::string dimension = CellOf(rows, "X_Dimension", column);
    if (!dimension.empty() && LowerCase(dimension).substr(0, 4) != "time") {
      return lines_.Fail(
          "X_Dimension is " + Quote(dimension) + ", expected records over time",
          error);
    }
    const std::string x0 = CellOf(rows, "X0", column);
    if (!x0.empty() &&
        (!ParseNumber(x0, &part->x0) || !std::isfinite(part->x0))) {
      return lines_.Fail("X0 is " + Quote(x0) + ", expected a number", error);
    }
    std::string date = CellOf(rows, "Date", column);
    std::string time = CellOf(rows, "Time", column);
    if (date.empty() || time.empty()) {
      date = CellOf(header_, "Date", 1);
      time = CellOf(header_, "Time", 1);
    }
    part->date = ParseDate(date, time);
    return true;
  }

  // Gives the channels of one X column the start of the first one. Cards that
  // sample one channel after the other state starts that are microseconds
  // apart.
  void JoinStarts(std::vector<SegmentPart>* parts) {
    const SegmentPart& first = parts->front();
    double largest = 0.0;
    for (const SegmentPart& part : *parts) {
      const double later =
          static_cast<double>(part.date.seconds - first.date.seconds) +
          part.date.fraction - first.date.fraction;
      if (!part.date.is_known || !first.date.is_known || part.x0 != first.x0 ||
          part.step != first.step ||
          std::abs(later) > kLargestSkew * part.step) {
        return;
      }
      largest = std::max(largest, std::abs(later));
    }
    for (SegmentPart& part : *parts) part.date = first.date;
    skew_ = std::max(skew_, largest);
  }

  // Parses "2024/03/01" and "12:00:00,0051".
  static StartTime ParseDate(const std::string& date, std::string time) {
    StartTime start;
    const std::vector<std::string_view> fields = Split(date, '/');
    std::array<int, 3> numbers = {0, 0, 0};
    if (fields.size() != 3) return start;
    for (size_t i = 0; i < 3; ++i) {
      if (!ParseInt(fields[i], &numbers[i]) || numbers[i] < 1 ||
          numbers[i] > 9999) {
        return start;
      }
    }
    std::replace(time.begin(), time.end(), ',', '.');
    int64_t of_day = 0;
    if (numbers[0] < 1904 || numbers[1] > 12 || numbers[2] > 31 ||
        !ParseTimeOfDay(time, &of_day, &start.fraction)) {
      return start;
    }
    start.seconds = SecondsOfDate(numbers[0], numbers[1], numbers[2]) + of_day;
    start.is_known = true;
    return start;
  }

  // Reads the rows of a segment: as many as its longest channel has.
  bool ReadValues(std::vector<SegmentPart>* parts, std::string* error) {
    int64_t rows = 0;
    for (const SegmentPart& part : *parts) rows = std::max(rows, part.samples);
    std::string_view line;
    for (int64_t i = 0; i < rows; ++i) {
      if (!lines_.Next(&line) || StripBlanks(line).empty()) {
        return lines_.Fail("the segment ends after " + std::to_string(i) +
                               " of " + std::to_string(rows) +
                               " rows. The file is not whole: copy it again",
                           error);
      }
      const std::vector<std::string_view> cells = Split(line, separator_);
      for (SegmentPart& part : *parts) {
        if (i >= part.samples) continue;
        const std::string cell(
            part.column < cells.size() ? StripBlanks(cells[part.column]) : "");
        double value = std::numeric_limits<double>::quiet_NaN();
        if (!cell.empty() &&
            (!ParseNumber(cell, &value) || std::isinf(value))) {
          return lines_.Fail(Quote(cell) + " is not a number", error);
        }
        part.values.push_back(value);
      }
    }
    return true;
  }

  bool TakeFirst(const HeaderRows& rows, const std::vector<std::string>& names,
                 std::vector<SegmentPart>* parts, std::string* error) {
    for (SegmentPart& part : *parts) {
      LoggerChannel channel;
      channel.name = names[part.column];
      if (channel.name.empty()) {
        return lines_.Fail("a channel without a name in column " +
                               std::to_string(part.column + 1),
                           error);
      }
      channel.short_name = channel.name;
      channel.unit = CellOf(rows, "Y_Unit_Label", part.column);
      channel.step = part.step;
      channel.start = part.x0;
      file_.channels.push_back(std::move(channel));
      starts_.push_back(part.date);
      values_.push_back(std::move(part.values));
    }
    names_ = names;
    first_ = *parts;
    next_x0_.clear();
    for (const SegmentPart& part : first_) next_x0_.push_back(NextX0(part));
    return true;
  }

  static double NextX0(const SegmentPart& part) {
    return part.x0 + static_cast<double>(part.samples) * part.step;
  }

  // Appends a segment to the channels.
  bool TakeNext(const std::vector<std::string>& names,
                std::vector<SegmentPart>* parts, std::string* error) {
    if (names != names_ || parts->size() != first_.size()) {
      return lines_.Fail(
          "this segment has other channels than before. Split the file there",
          error);
    }
    for (size_t i = 0; i < parts->size(); ++i) {
      const SegmentPart& part = (*parts)[i];
      const SegmentPart& first = first_[i];
      if (std::abs(part.step / first.step - 1.0) > 1e-9) {
        return lines_.Fail(
            "the rate changes with this segment. Split the file there", error);
      }
      double gap = 0.0;
      const double continued = (part.x0 - next_x0_[i]) / part.step;
      if (std::abs(continued) > kLargestSegmentJitter || part.x0 == first.x0) {
        const double later =
            part.date.is_known && first.date.is_known
                ? static_cast<double>(part.date.seconds - first.date.seconds) +
                      part.date.fraction - first.date.fraction
                : std::numeric_limits<double>::quiet_NaN();
        gap = (later + part.x0 - first.x0) / part.step -
              static_cast<double>(values_[i].size());
        if (!(std::abs(gap - std::round(gap)) <= kLargestSegmentJitter) ||
            gap < -kLargestSegmentJitter ||
            gap > static_cast<double>(values_[i].size())) {
          return lines_.Fail(
              "by X0 or date and time, this segment does not continue the one "
              "before. Split the file there, or log all in one segment",
              error);
        }
      }
      gap = std::round(gap);
      gaps_ = std::max(gaps_, gap * part.step);
      values_[i].resize(values_[i].size() + static_cast<size_t>(gap),
                        std::numeric_limits<double>::quiet_NaN());
      values_[i].insert(values_[i].end(), part.values.begin(),
                        part.values.end());
      next_x0_[i] = NextX0(part);
    }
    return true;
  }

  TextLines lines_;
  const ChannelFilter& wanted_;
  char separator_ = '\t';
  char decimal_ = '.';
  bool is_multi_ = false;
  HeaderRows header_;
  LoggedFile file_;
  std::vector<StartTime> starts_;
  std::vector<std::vector<double>> values_;
  std::vector<std::string> names_;
  std::vector<SegmentPart> first_;  // without values
  std::vector<double> next_x0_;
  double skew_ = 0.0;  // s
  double gaps_ = 0.0;
};

}  // namespace

bool ParseLvm(const std::string& text, const std::string& path,
              const ChannelFilter& wanted, LoggedFile* file,
              std::string* error) {
  return LvmParser(text, path, wanted).Parse(file, error);
}

}  // namespace pinode
