#include "pinode/record/files/loggers/mini_seed.h"

#ifdef PINODE_WITH_MSEED
#include <libmseed.h>
#endif

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"

namespace pinode {

#ifdef PINODE_WITH_MSEED

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

// Last message of libmseed in this thread.
std::string* LastMessage() {
  thread_local std::string message;
  return &message;
}

void KeepMessage(char* message) { *LastMessage() = message; }

// libmseed prints to standard error unless it is told otherwise, once.
void QuietLibrary() {
  static std::once_flag once;
  std::call_once(once, [] { ms_loginit(&KeepMessage, "", &KeepMessage, ""); });
}

struct RecordCloser {
  void operator()(MSRecord* record) const { msr_free(&record); }
};
using RecordPointer = std::unique_ptr<MSRecord, RecordCloser>;

// Returns the bytes of a sample by the record's encoding (SEED, blockette
// 1000); 0 for packed ones, -1 for unknown ones and text.
int BytesOfSample(int encoding) {
  switch (encoding) {
    case DE_STEIM1:
    case DE_STEIM2:
      return 0;
    case DE_INT16:
    case DE_GEOSCOPE163:
    case DE_GEOSCOPE164:
    case DE_CDSN:
    case DE_SRO:
    case DE_DWWSSN:
      return 2;
    case DE_GEOSCOPE24:
      return 3;
    case DE_INT32:
    case DE_FLOAT32:
      return 4;
    case DE_FLOAT64:
      return 8;
    default:
      return -1;
  }
}

// Samples of one record.
struct RecordPiece {
  int64_t start = 0;  // in ticks of libmseed (us)
  Eigen::Index size = 0;
  std::vector<double> values;
};

struct RecordSource {
  std::string name;
  std::string short_name;
  double rate = 0.0;
  std::string fault;
  std::vector<RecordPiece> pieces;
};

class MiniSeedParser {
 public:
  MiniSeedParser(const std::string& bytes, const std::string& path,
                 const ChannelFilter& wanted)
      : bytes_(bytes), path_(path), wanted_(wanted) {}

  bool Parse(LoggedFile* file, std::string* error) {
    QuietLibrary();
    if (!ReadRecords(error)) return false;
    file_.format = "miniSEED";
    std::vector<StartTime> starts;
    for (RecordSource& source : sources_) {
      LoggerChannel channel;
      StartTime start;
      if (!MakeChannel(&source, &channel, &start, error)) return false;
      file_.channels.push_back(std::move(channel));
      starts.push_back(start);
    }
    file_.remarks.emplace_back("values as recorded, without a unit");
    MakeNamesUnique(&file_);
    SetStartTimes(starts, &file_);
    *file = std::move(file_);
    return true;
  }

 private:
  bool FailAt(size_t position, const std::string& message,
              std::string* error) const {
    *error =
        path_ + ": record at byte " + std::to_string(position) + ": " + message;
    return false;
  }

  // Parses one record. `with_samples`: unpacks its samples too.
  bool ParseRecord(size_t position, bool with_samples, RecordPointer* record,
                   std::string* error) {
    constexpr size_t kMostBytes = 1 << 20;  // SEED: 2^20 at most
    const size_t left = std::min(kMostBytes, bytes_.size() - position);
    MSRecord* parsed = record->release();
    LastMessage()->clear();
    const int code = msr_parse(bytes_.data() + position, static_cast<int>(left),
                               &parsed, 0, with_samples ? 1 : 0, 0);
    record->reset(parsed);
    if (code == MS_NOERROR && parsed != nullptr && parsed->reclen > 0 &&
        static_cast<size_t>(parsed->reclen) <= left) {
      return true;
    }
    std::string why(StripBlanks(*LastMessage()));
    if (FirstInvalidUtf8(why) != std::string::npos) why.clear();
    return FailAt(
        position,
        (code > 0
             ? std::string("the file ends inside it")
             : "it cannot be read" + (why.empty() ? "" : " (" + why + ")")) +
            ", expected complete records of miniSEED 2. Copy the file again",
        error);
  }

  bool ReadRecords(std::string* error) {
    if (bytes_.compare(0, 3, "MS\x03") == 0) {
      *error = path_ +
               ": is miniSEED of version 3, expected version 2. Convert it "
               "with `mseedconvert -F 2`";
      return false;
    }
    size_t position = 0;
    while (position < bytes_.size()) {
      RecordPointer record;
      if (!ParseRecord(position, false, &record, error)) return false;
      RecordSource* source = FindSource(*record);
      const size_t length = static_cast<size_t>(record->reclen);
      if (record->samplecnt > 0 && source->fault.empty() &&
          !TakeRecord(position, source, &record, error)) {
        return false;
      }
      position += length;
    }
    return true;
  }

  static std::string NameOf(const MSRecord& record) {
    std::string name = std::string(record.network) + "." + record.station +
                       "." + record.location + "." + record.channel;
    for (char& c : name) {
      if (c < ' ' || c > '~') c = '?';
    }
    return name;
  }

  RecordSource* FindSource(const MSRecord& record) {
    const std::string name = NameOf(record);
    const auto [found, is_new] = by_name_.emplace(name, sources_.size());
    if (is_new) {
      RecordSource source;
      source.name = name;
      source.short_name = name.substr(name.rfind('.') + 1);
      source.rate = record.samprate;
      if (!(source.rate > kLowestRate && source.rate < kHighestRate)) {
        source.fault = "it has no sampling rate";
      }
      sources_.push_back(std::move(source));
    }
    return &sources_[found->second];
  }

  bool TakeRecord(size_t position, RecordSource* source, RecordPointer* record,
                  std::string* error) {
    RecordPiece piece;
    piece.start = (*record)->starttime;
    piece.size = static_cast<Eigen::Index>((*record)->samplecnt);
    if (std::abs((*record)->samprate / source->rate - 1.0) > 1e-6) {
      return FailAt(position,
                    "the rate of '" + source->name + "' changes from " +
                        FormatNumber(source->rate, 6) + " to " +
                        FormatNumber((*record)->samprate, 6) +
                        " Hz. Split the file there",
                    error);
    }
    LoggerChannel channel;
    channel.name = source->name;
    channel.short_name = source->short_name;
    if (wanted_(channel)) {
      // The library reads behind a record that has fewer samples than it says.
      const int bytes = BytesOfSample((*record)->encoding);
      if (bytes < 0) {
        source->fault =
            "it holds text or an unknown encoding, expected numbers";
        return true;
      }
      const int64_t room =
          (*record)->fsdh == nullptr
              ? -1
              : int64_t{(*record)->reclen} - (*record)->fsdh->data_offset;
      if (room < 0 || (*record)->samplecnt * bytes > room) {
        return FailAt(position,
                      "is too short for its " +
                          std::to_string((*record)->samplecnt) +
                          " samples. Copy the file again",
                      error);
      }
      if (!ParseRecord(position, true, record, error)) return false;
      const MSRecord& r = **record;
      if (r.numsamples != r.samplecnt) {
        return FailAt(position,
                      "holds " + std::to_string(r.numsamples) + " of " +
                          std::to_string(r.samplecnt) +
                          " samples. Copy the file again",
                      error);
      }
      if (r.sampletype != 'i' && r.sampletype != 'f' && r.sampletype != 'd') {
        source->fault = "it holds text, expected numbers";
        return true;
      }
      piece.values.reserve(static_cast<size_t>(r.numsamples));
      for (int64_t i = 0; i < r.numsamples; ++i) {
        const double value =
            r.sampletype == 'i'
                ? static_cast<double>(
                      static_cast<const int32_t*>(r.datasamples)[i])
            : r.sampletype == 'f'
                ? static_cast<double>(
                      static_cast<const float*>(r.datasamples)[i])
                : static_cast<const double*>(r.datasamples)[i];
        piece.values.push_back(std::isfinite(value) ? value : std::nan(""));
      }
    }
    source->pieces.push_back(std::move(piece));
    return true;
  }

  // Puts the records of a source one behind the other.
  bool MakeChannel(RecordSource* source, LoggerChannel* channel,
                   StartTime* start, std::string* error) {
    channel->name = source->name;
    channel->short_name = source->short_name;
    channel->fault = source->fault;
    if (source->pieces.empty() || !channel->fault.empty()) {
      if (channel->fault.empty()) channel->fault = "it has no sample";
      return true;
    }
    channel->step = 1.0 / source->rate;
    std::stable_sort(source->pieces.begin(), source->pieces.end(),
                     [](const RecordPiece& a, const RecordPiece& b) {
                       return a.start < b.start;
                     });
    std::vector<double> values;
    const double total = TotalSize(*source);
    Eigen::Index size = 0;
    double missing = 0.0;
    double jitter = 0.0;
    int64_t end = source->pieces[0].start;
    for (const RecordPiece& piece : source->pieces) {
      const double deviation =
          (static_cast<double>(piece.start) - static_cast<double>(end)) /
          HPTMODULUS * source->rate;
      const double gap = std::round(deviation);
      if (deviation < -kLargestDeviation) {
        *error = path_ + ": records of '" + source->name +
                 "' overlap. Remove the records that occur twice";
        return false;
      }
      if (deviation <= kLargestDeviation) {
        jitter = std::max(jitter, std::abs(deviation));
      } else {
        missing += gap;
        if (std::abs(deviation - gap) > kLargestRecordJitter ||
            missing > total) {
          *error = path_ + ": behind a gap of " +
                   FormatNumber(deviation / source->rate, 6) +
                   " s, the samples of '" + source->name +
                   "' do not continue the clock, or most samples are missing. "
                   "Split the file there";
          return false;
        }
        values.resize(values.size() +
                          (piece.values.empty() ? 0 : static_cast<size_t>(gap)),
                      std::nan(""));
        size += static_cast<Eigen::Index>(gap);
      }
      values.insert(values.end(), piece.values.begin(), piece.values.end());
      size += piece.size;
      end = piece.start +
            static_cast<int64_t>(std::llround(static_cast<double>(piece.size) /
                                              source->rate * HPTMODULUS));
    }
    channel->size = size;
    if (wanted_(*channel)) {
      channel->values = Eigen::Map<const Vector>(
          values.data(), static_cast<Eigen::Index>(values.size()));
    }
    SayFaults(*channel, missing, jitter);
    SetStart(source->pieces[0].start, start);
    return true;
  }

  static double TotalSize(const RecordSource& source) {
    double size = 0.0;
    for (const RecordPiece& piece : source.pieces) {
      size += static_cast<double>(piece.size);
    }
    return size;
  }

  void SayFaults(const LoggerChannel& channel, double missing, double jitter) {
    if (missing > 0.0) {
      file_.remarks.push_back("'" + channel.name + "' has gaps of " +
                              FormatNumber(missing * channel.step, 4) +
                              " s in all");
    }
    if (jitter > kLargestRecordJitter) {
      file_.remarks.push_back("record times of '" + channel.name +
                              "' are up to " +
                              FormatNumber(jitter * channel.step, 3) +
                              " s off an even clock; the even clock is used");
    }
  }

  static void SetStart(int64_t ticks, StartTime* start) {
    const int64_t modulus = HPTMODULUS;
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

  std::string bytes_;  // a copy: the library takes records as not constant
  const std::string& path_;
  const ChannelFilter& wanted_;
  LoggedFile file_;
  std::map<std::string, size_t> by_name_;
  std::vector<RecordSource> sources_;
};

}  // namespace

bool CanReadMiniSeed() { return true; }

bool ParseMiniSeed(const std::string& bytes, const std::string& path,
                   const ChannelFilter& wanted, LoggedFile* file,
                   std::string* error) {
  return MiniSeedParser(bytes, path, wanted).Parse(file, error);
}

#else

bool CanReadMiniSeed() { return false; }

bool ParseMiniSeed(const std::string&, const std::string& path,
                   const ChannelFilter&, LoggedFile*, std::string* error) {
  *error = path +
           ": is miniSEED, but this pinode was built without libmseed 2. "
           "Convert the file to SAC, or build pinode with libmseed-dev";
  return false;
}

#endif

bool IsMiniSeedHeader(std::string_view begin) {
  if (begin.substr(0, 3) == "MS\x03") return true;
  // Six digits, the quality, and a blank.
  if (begin.size() < 48) return false;
  for (size_t i = 0; i < 6; ++i) {
    if (begin[i] < '0' || begin[i] > '9') return false;
  }
  const std::string_view qualities = "DRQM";
  return qualities.find(begin[6]) != std::string_view::npos &&
         (begin[7] == ' ' || begin[7] == '\0');
}

}  // namespace pinode
