#include "pinode/record/files/loggers/logged_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/base/unit_names.h"
#include "pinode/record/files/clock.h"
#include "pinode/record/resample.h"

namespace pinode {
namespace {

// Largest distance of a sample from its place, as a fraction of the step.
// Record files of one case are held to the same (RecordFiles::Align).
constexpr double kLargestLoggerShift = 1e-3;
// Latest start (s, some thousand years) that is a time and no broken number.
constexpr double kLatestStart = 1e11;
// Ratio of rates from which on a slow channel is a series of readings.
constexpr double kSlowRatio = 10.0;

bool IsTimeName(const LoggedFile& file, const std::string& name) {
  return name == "t" ||
         std::find(file.time_names.begin(), file.time_names.end(), name) !=
             file.time_names.end();
}

// Finds a channel by its name, or by a short name that occurs once.
const LoggerChannel* FindLoggerChannel(const LoggedFile& file,
                                       const std::string& name,
                                       std::string* what) {
  std::vector<const LoggerChannel*> found;
  std::vector<std::string> known = {"t"};
  for (const LoggerChannel& channel : file.channels) {
    if (channel.name == name) return &channel;
    if (channel.short_name == name) found.push_back(&channel);
    if (channel.fault.empty()) known.push_back(channel.name);
  }
  if (found.size() == 1) return found[0];
  *what = found.empty()
              ? "no channel is called '" + name + "'" + NameHint(name, known)
              : "several channels are called '" + name +
                    "', expected one of '" + found[0]->name + "', '" +
                    found[1]->name + "'";
  return nullptr;
}

// Channels of a table and the clock to which they are brought.
class LoggerClock {
 public:
  LoggerClock(const std::string& path,
              std::vector<const LoggerChannel*> channels)
      : path_(path), channels_(std::move(channels)) {}

  // Finds the common clock.
  bool Find(std::string* error) {
    const LoggerChannel* timed = nullptr;
    const LoggerChannel* untimed = nullptr;
    for (const LoggerChannel* c : channels_) {
      (c->step > 0.0 ? timed : untimed) = c;
    }
    if (timed != nullptr && untimed != nullptr) {
      *error = path_ + ": channel '" + untimed->name +
               "' has no sampling step but '" + timed->name +
               "' has one. Leave one of them out";
      return false;
    }
    for (const LoggerChannel* c : channels_) {
      if (std::abs(c->start) < kLatestStart) continue;
      *error = path_ + ": channel '" + c->name + "' starts at " +
               FormatNumber(c->start, 6) + " s. The file is broken";
      return false;
    }
    for (const LoggerChannel* c : channels_) {
      if (c->is_dated == channels_[0]->is_dated) continue;
      *error = path_ + ": one of the channels '" + c->name + "' and '" +
               channels_[0]->name +
               "' has no start time, expected channels of one clock. Leave one "
               "of them out";
      return false;
    }
    return timed != nullptr ? FindTimed(error) : FindUntimed(error);
  }

  bool is_timed() const { return step_ > 0.0; }
  double step() const { return step_; }
  double start() const { return start_; }
  Eigen::Index size() const { return size_; }

  // Returns a channel's samples on the clock.
  bool Values(const LoggerChannel& channel, Vector* values,
              std::vector<std::string>* remarks, std::string* error) const {
    if (!is_timed()) {
      *values = channel.values;
      return true;
    }
    if (IsSlow(channel)) return Readings(channel, values, remarks, error);
    Eigen::Index skipped = 0;
    if (!FindSkipped(channel, &skipped, error)) return false;
    *values = channel.values.tail(channel.size - skipped);
    if (!HasStep(channel, step_)) {
      *values = Resample(*values, channel.step, step_);
      remarks->push_back("'" + channel.name + "' resampled from " +
                         FormatNumber(1.0 / channel.step, 6) + " to " +
                         FormatNumber(1.0 / step_, 6) + " Hz");
    }
    values->conservativeResize(size_);
    return true;
  }

  // Returns the seconds at the ends of which some channel is alone.
  double seconds_cut() const { return seconds_cut_; }

 private:
  static double Seconds(const LoggerChannel& c) {
    return static_cast<double>(c.size - 1) * c.step;
  }
  // Returns true if the two steps keep the samples in their places.
  static bool HasStep(const LoggerChannel& c, double step) {
    return std::abs(c.step / step - 1.0) * static_cast<double>(c.size) <
           kLargestLoggerShift;
  }
  bool IsSlow(const LoggerChannel& c) const {
    return c.step > kSlowRatio * fastest_ * (1.0 + 1e-9);
  }

  bool FindUntimed(std::string* error) {
    size_ = channels_[0]->size;
    for (const LoggerChannel* c : channels_) {
      if (c->size == size_) continue;
      *error = path_ + ": channel '" + c->name + "' has " +
               std::to_string(c->size) + " samples and '" + channels_[0]->name +
               "' " + std::to_string(size_) +
               ", expected channels of one length. Leave one of them out";
      return false;
    }
    return true;
  }

  bool FindTimed(std::string* error) {
    fastest_ = std::numeric_limits<double>::infinity();
    for (const LoggerChannel* c : channels_) {
      fastest_ = std::min(fastest_, c->step);
    }
    start_ = -std::numeric_limits<double>::infinity();
    double end = std::numeric_limits<double>::infinity();
    double first = end;
    double last = start_;
    for (const LoggerChannel* c : channels_) {
      if (IsSlow(*c)) continue;
      step_ = std::max(step_, c->step);
      start_ = std::max(start_, c->start);
      first = std::min(first, c->start);
      end = std::min(end, c->start + Seconds(*c));
      last = std::max(last, c->start + Seconds(*c));
    }
    if (!(end > start_)) {
      *error = path_ +
               ": the channels have no time in common. Leave some of them out";
      return false;
    }
    size_ = std::numeric_limits<Eigen::Index>::max();
    for (const LoggerChannel* c : channels_) {
      if (IsSlow(*c)) continue;
      Eigen::Index skipped = 0;
      if (!FindSkipped(*c, &skipped, error)) return false;
      const Eigen::Index left = c->size - skipped;
      const Eigen::Index samples =
          HasStep(*c, step_)
              ? left
              : 1 + static_cast<Eigen::Index>(std::floor(
                        static_cast<double>(left - 1) * c->step / step_ +
                        1e-9));
      size_ = std::min(size_, samples);
    }
    seconds_cut_ = std::max(start_ - first, last - end);
    return true;
  }

  // Finds how many samples a channel has before the common start.
  bool FindSkipped(const LoggerChannel& c, Eigen::Index* skipped,
                   std::string* error) const {
    const double offset = (start_ - c.start) / c.step;
    const double rounded = std::round(offset);
    if (std::abs(offset - rounded) > kLargestLoggerShift) {
      return FailBetween(c, error);
    }
    *skipped = std::min(static_cast<Eigen::Index>(rounded), c.size - 1);
    return true;
  }

  bool FailBetween(const LoggerChannel& c, std::string* error) const {
    *error = path_ + ": the samples of channel '" + c.name +
             "' lie between those of the others, expected channels of one "
             "clock. Leave '" +
             c.name + "' out, or write it to a file of its own";
    return false;
  }

  // Puts the samples of a slow channel at their times.
  bool Readings(const LoggerChannel& c, Vector* values,
                std::vector<std::string>* remarks, std::string* error) const {
    *values = Vector::Constant(size_, std::numeric_limits<double>::quiet_NaN());
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < c.size; ++i) {
      const double place =
          (c.start + static_cast<double>(i) * c.step - start_) / step_;
      const double rounded = std::round(place);
      if (rounded < 0.0 || !(rounded < static_cast<double>(size_))) continue;
      if (std::abs(place - rounded) > kLargestLoggerShift) {
        return FailBetween(c, error);
      }
      (*values)[static_cast<Eigen::Index>(rounded)] = c.values[i];
      ++count;
    }
    if (count == 0) {
      *error = path_ + ": channel '" + c.name +
               "' has no sample in the time of the others. Leave it out";
      return false;
    }
    remarks->push_back("'" + c.name + "' has a reading every " +
                       FormatNumber(c.step, 6) +
                       " s; the samples between are missing");
    return true;
  }

  const std::string& path_;
  const std::vector<const LoggerChannel*> channels_;
  double fastest_ = 0.0;
  double step_ = 0.0;
  double start_ = 0.0;
  double seconds_cut_ = 0.0;
  Eigen::Index size_ = 0;
};

// Returns the names to read: those wanted once each, or all that were measured.
std::vector<std::string> LoggerColumns(const LoggedFile& file,
                                       const std::vector<std::string>& wanted) {
  if (wanted.empty()) return AllLoggerColumns(file);
  std::vector<std::string> names;
  for (const std::string& name : wanted) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      names.push_back(name);
    }
  }
  return names;
}

// Finds the channels of the columns, null for the time.
bool FindLoggerChannels(const LoggedFile& file, const std::string& path,
                        const std::vector<std::string>& columns,
                        std::vector<const LoggerChannel*>* of_columns,
                        std::vector<const LoggerChannel*>* channels,
                        std::string* error) {
  for (const std::string& name : columns) {
    of_columns->push_back(nullptr);
    std::string what;
    const LoggerChannel* channel = FindLoggerChannel(file, name, &what);
    if (channel == nullptr) {
      if (IsTimeName(file, name)) continue;
      *error = path + ": " + what;
      return false;
    }
    std::string fault = channel->fault;
    if (fault.empty() && channel->size < 2) {
      fault = "it has fewer than two samples";
    }
    if (!fault.empty()) {
      *error = path + ": channel '" + channel->name + "': " + fault;
      return false;
    }
    CHECK_EQ(channel->values.size(), channel->size);
    of_columns->back() = channel;
    channels->push_back(channel);
  }
  // The time alone is that of the first channel which has one.
  for (size_t i = 0; channels->empty() && i < file.channels.size(); ++i) {
    const LoggerChannel& c = file.channels[i];
    if (c.fault.empty() && c.size >= 2 && c.step > 0.0) channels->push_back(&c);
  }
  if (!channels->empty()) return true;
  *error = path + ": has no channel of numbers (" + file.format +
           "), expected time histories";
  return false;
}

std::string LoggerReading(const LoggedFile& file, const LoggerClock& clock,
                          const std::vector<std::string>& remarks) {
  std::string text = file.format;
  if (clock.is_timed()) {
    text += ", " + FormatNumber(1.0 / clock.step(), 6) + " Hz";
    if (file.origin.kind == TimeOrigin::Kind::kDate) {
      text += " from " + ClockText(file.origin.seconds + clock.start(), true);
    }
  }
  std::vector<std::string> parts = {text};
  parts.insert(parts.end(), file.remarks.begin(), file.remarks.end());
  parts.insert(parts.end(), remarks.begin(), remarks.end());
  if (clock.seconds_cut() > 0.5 * clock.step()) {
    parts.push_back("channels start or end up to " +
                    FormatNumber(clock.seconds_cut(), 4) +
                    " s apart; the common part is used");
  }
  return Join(parts, "; ") + ".";
}

}  // namespace

int64_t SecondsOfDate(int64_t year, int64_t month, int64_t day) {
  // Days from civil: years begin in March, so that the leap day is the last.
  const int64_t months = (month + 9) % 12;
  const int64_t years = year + (month - 1) / 12 - (months >= 10 ? 1 : 0);
  const int64_t era = (years >= 0 ? years : years - 399) / 400;
  const int64_t of_era = years - era * 400;
  const int64_t of_year = (153 * months + 2) / 5 + day - 1;
  const int64_t days = of_era * 365 + of_era / 4 - of_era / 100 + of_year;
  return (era * 146097 + days - 719468) * 86400;
}

std::vector<std::string> AllLoggerColumns(const LoggedFile& file) {
  std::map<std::string, int> count;
  bool has_steps = false;
  bool has_measured = false;
  for (const LoggerChannel& c : file.channels) {
    ++count[c.short_name];
    if (!c.fault.empty() || c.size < 2) continue;
    has_steps = has_steps || c.step > 0.0;
    has_measured = has_measured || !c.is_derived;
  }
  std::vector<std::string> names;
  if (has_steps) names.emplace_back("t");
  for (const LoggerChannel& c : file.channels) {
    if (!c.fault.empty() || c.size < 2 || (has_steps && !(c.step > 0.0)) ||
        (has_measured && c.is_derived)) {
      continue;
    }
    names.push_back(count[c.short_name] == 1 ? c.short_name : c.name);
  }
  return names;
}

void SetStartTimes(const std::vector<StartTime>& times, LoggedFile* file) {
  CHECK_EQ(times.size(), file->channels.size());
  int64_t earliest = std::numeric_limits<int64_t>::max();
  for (const StartTime& time : times) {
    if (time.is_known) earliest = std::min(earliest, time.seconds);
  }
  if (earliest == std::numeric_limits<int64_t>::max()) return;
  file->origin.kind = TimeOrigin::Kind::kDate;
  file->origin.seconds = static_cast<double>(earliest);
  for (size_t i = 0; i < times.size(); ++i) {
    if (!times[i].is_known) continue;
    file->channels[i].is_dated = true;
    // As doubles: what a broken file says may be far apart.
    file->channels[i].start += (static_cast<double>(times[i].seconds) -
                                static_cast<double>(earliest)) +
                               times[i].fraction;
  }
}

void MakeNamesUnique(LoggedFile* file) {
  std::map<std::string, int> count;
  for (LoggerChannel& channel : file->channels) {
    const int number = ++count[channel.name];
    if (number == 1) continue;
    const std::string end = "[" + std::to_string(number) + "]";
    channel.name += end;
    channel.short_name += end;
    ++count[channel.name];
  }
}

bool MakeLoggerTable(const LoggedFile& file, const std::string& path,
                     const std::vector<std::string>& wanted, Table* table,
                     std::string* error) {
  CHECK(table != nullptr);
  CHECK(error != nullptr);
  Table result;
  result.path = path;
  result.columns = LoggerColumns(file, wanted);
  std::vector<const LoggerChannel*> of_columns;
  std::vector<const LoggerChannel*> channels;
  if (!FindLoggerChannels(file, path, result.columns, &of_columns, &channels,
                          error)) {
    return false;
  }
  LoggerClock clock(path, channels);
  if (!clock.Find(error)) return false;
  std::vector<std::string> remarks;
  result.values.resize(clock.size(),
                       static_cast<Eigen::Index>(of_columns.size()));
  for (size_t i = 0; i < of_columns.size(); ++i) {
    Vector values;
    if (of_columns[i] != nullptr) {
      if (!clock.Values(*of_columns[i], &values, &remarks, error)) return false;
      result.units.push_back(CanonicalUnit(of_columns[i]->unit));
    } else if (clock.is_timed()) {
      values = Vector::LinSpaced(clock.size(), 0.0,
                                 static_cast<double>(clock.size() - 1));
      values = clock.start() + clock.step() * values.array();
      result.units.emplace_back("s");
    } else {
      *error = path + ": channel '" + channels[0]->name +
               "' has no sampling step. Give `sampling_rate_hz`, or name the "
               "channel of the times as `time`";
      return false;
    }
    result.values.col(static_cast<Eigen::Index>(i)) = values;
  }
  result.line_numbers.resize(static_cast<size_t>(clock.size()));
  std::iota(result.line_numbers.begin(), result.line_numbers.end(), int64_t{1});
  if (clock.is_timed()) {
    result.time_unit = "s";
    if (channels[0]->is_dated) result.time_origin = file.origin;
  }
  result.reading = LoggerReading(file, clock, remarks);
  *table = std::move(result);
  return true;
}

}  // namespace pinode
