#include "pinode/record/files/loggers/seed_records.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Deviation of a record's time from the end of the record before it, in steps,
// up to which it follows without a gap. It is the tolerance of libmseed.
constexpr double kLargestDeviation = 0.5;
// Deviation from which on it is said, and up to which the samples behind a gap
// are on the grid.
constexpr double kLargestRecordJitter = 0.1;

// Rates (Hz) that a record may have. Channels of logs have rate 0.
constexpr double kLowestRate = 1e-6;
constexpr double kHighestRate = 1e9;
// Latest time (s) before and after 1970, in 2191, and the longest record (s).
// Their sum in ticks fits 64 bits.
constexpr int64_t kLatestRecord = 7000000000;
constexpr double kLongestRecord = 1e9;

double TotalSize(const SeedSource& source) {
  double size = 0.0;
  for (const SeedPiece& piece : source.pieces) {
    size += static_cast<double>(piece.size);
  }
  return size;
}

void SetStart(int64_t ticks, StartTime* start) {
  const int64_t modulus = kSeedTicks;
  int64_t whole = ticks / modulus;
  int64_t rest = ticks % modulus;
  if (rest < 0) {
    rest += modulus;
    --whole;
  }
  start->seconds = whole;
  start->fraction = static_cast<double>(rest) / static_cast<double>(modulus);
  start->is_known = true;
}

}  // namespace

LoggerChannel SeedSource::Outline() const {
  LoggerChannel channel;
  channel.name = name;
  channel.short_name = short_name;
  return channel;
}

SeedSource* SeedRecords::Source(const std::string& name, double rate) {
  const auto [found, is_new] = by_name_.emplace(name, sources_.size());
  if (is_new) {
    SeedSource source;
    source.name = name;
    source.short_name = name.substr(name.rfind('.') + 1);
    source.rate = rate;
    if (!(rate > kLowestRate && rate < kHighestRate)) {
      source.fault = "it has no sampling rate";
    }
    sources_.push_back(std::move(source));
  }
  return &sources_[found->second];
}

std::string SeedRecords::Add(SeedSource* source, double rate, int64_t seconds,
                             int64_t ticks, Eigen::Index size) {
  if (std::abs(rate / source->rate - 1.0) > 1e-6) {
    return "the rate of '" + source->name + "' changes from " +
           FormatNumber(source->rate, 6) + " to " + FormatNumber(rate, 6) +
           " Hz. Split the file there";
  }
  if (seconds < -kLatestRecord || seconds > kLatestRecord ||
      static_cast<double>(size) / rate > kLongestRecord) {
    return "its start or its length is no time. The file is broken";
  }
  SeedPiece piece;
  piece.start = seconds * kSeedTicks + ticks;
  piece.size = size;
  source->pieces.push_back(std::move(piece));
  return "";
}

bool SeedRecords::MakeFile(const ChannelFilter& wanted, LoggedFile* file,
                           std::string* error) {
  LoggedFile result;
  result.format = "miniSEED";
  std::vector<StartTime> starts;
  for (SeedSource& source : sources_) {
    LoggerChannel channel;
    StartTime start;
    if (!MakeChannel(&source, wanted, &channel, &start, error)) return false;
    result.channels.push_back(std::move(channel));
    starts.push_back(start);
  }
  result.remarks = std::move(remarks_);
  result.remarks.emplace_back("values as recorded, without a unit");
  MakeNamesUnique(&result);
  SetStartTimes(starts, &result);
  *file = std::move(result);
  return true;
}

// Puts the records of a source one behind the other.
bool SeedRecords::MakeChannel(SeedSource* source, const ChannelFilter& wanted,
                              LoggerChannel* channel, StartTime* start,
                              std::string* error) {
  *channel = source->Outline();
  channel->fault = source->fault;
  if (source->pieces.empty() || !channel->fault.empty()) {
    if (channel->fault.empty()) channel->fault = "it has no sample";
    return true;
  }
  channel->step = 1.0 / source->rate;
  std::stable_sort(
      source->pieces.begin(), source->pieces.end(),
      [](const SeedPiece& a, const SeedPiece& b) { return a.start < b.start; });
  std::vector<double> values;
  const double total = TotalSize(*source);
  Eigen::Index size = 0;
  double missing = 0.0;
  double jitter = 0.0;
  int64_t end = source->pieces[0].start;
  for (const SeedPiece& piece : source->pieces) {
    const double deviation =
        (static_cast<double>(piece.start) - static_cast<double>(end)) /
        kSeedTicks * source->rate;
    const double gap = std::round(deviation);
    if (deviation < -kLargestDeviation) {
      *error = path_ + ": records of '" + source->name +
               "' overlap, expected each sample once. Remove the records "
               "that occur twice";
      return false;
    }
    if (deviation <= kLargestDeviation) {
      jitter = std::max(jitter, std::abs(deviation));
    } else {
      missing += gap;
      if (std::abs(deviation - gap) > kLargestRecordJitter || missing > total) {
        *error = path_ + ": behind a gap of " +
                 FormatNumber(deviation / source->rate, 6) +
                 " s the samples of '" + source->name +
                 "' are not on the clock before it, or most samples are "
                 "missing. Split the file there";
        return false;
      }
      values.resize(
          values.size() + (piece.values.empty() ? 0 : static_cast<size_t>(gap)),
          std::nan(""));
      size += static_cast<Eigen::Index>(gap);
    }
    values.insert(values.end(), piece.values.begin(), piece.values.end());
    size += piece.size;
    end = piece.start +
          static_cast<int64_t>(std::llround(static_cast<double>(piece.size) /
                                            source->rate * kSeedTicks));
  }
  channel->size = size;
  if (wanted(*channel)) {
    channel->values = Eigen::Map<const Vector>(
        values.data(), static_cast<Eigen::Index>(values.size()));
  }
  SayFaults(*channel, missing, jitter);
  SetStart(source->pieces[0].start, start);
  return true;
}

void SeedRecords::SayFaults(const LoggerChannel& channel, double missing,
                            double jitter) {
  if (missing > 0.0) {
    remarks_.push_back("'" + channel.name + "' has gaps of " +
                       FormatNumber(missing * channel.step, 4) + " s in all");
  }
  if (jitter > kLargestRecordJitter) {
    remarks_.push_back("record times of '" + channel.name + "' are up to " +
                       FormatNumber(jitter * channel.step, 3) +
                       " s off an even clock, which is used");
  }
}

}  // namespace pinode
