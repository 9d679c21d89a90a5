#include "pinode/record/files/loggers/mini_seed.h"

#ifdef PINODE_WITH_MSEED
#include <libmseed.h>
#endif

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/record/files/loggers/mini_seed_3.h"
#include "pinode/record/files/loggers/seed_records.h"

namespace pinode {

#ifdef PINODE_WITH_MSEED

namespace {

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

int64_t WholeSeconds(hptime_t ticks) {
  const int64_t seconds = ticks / HPTMODULUS;
  return ticks % HPTMODULUS < 0 ? seconds - 1 : seconds;
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

class MiniSeedParser {
 public:
  MiniSeedParser(const std::string& bytes, const std::string& path,
                 const ChannelFilter& wanted)
      : bytes_(bytes), path_(path), wanted_(wanted), records_(path) {}

  bool Parse(LoggedFile* file, std::string* error) {
    QuietLibrary();
    return ReadRecords(error) && records_.MakeFile(wanted_, file, error);
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
    size_t position = 0;
    while (position < bytes_.size()) {
      RecordPointer record;
      if (!ParseRecord(position, false, &record, error)) return false;
      SeedSource* source = records_.Source(NameOf(*record), record->samprate);
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

  bool TakeRecord(size_t position, SeedSource* source, RecordPointer* record,
                  std::string* error) {
    const int64_t seconds = WholeSeconds((*record)->starttime);
    const std::string fault =
        SeedRecords::Add(source, (*record)->samprate, seconds,
                         ((*record)->starttime - seconds * HPTMODULUS) *
                             (kSeedTicks / HPTMODULUS),
                         static_cast<Eigen::Index>((*record)->samplecnt));
    if (!fault.empty()) return FailAt(position, fault, error);
    std::vector<double>* values = &source->pieces.back().values;
    if (wanted_(source->Outline())) {
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
      values->reserve(static_cast<size_t>(r.numsamples));
      for (int64_t i = 0; i < r.numsamples; ++i) {
        const double value =
            r.sampletype == 'i'
                ? static_cast<double>(
                      static_cast<const int32_t*>(r.datasamples)[i])
            : r.sampletype == 'f'
                ? static_cast<double>(
                      static_cast<const float*>(r.datasamples)[i])
                : static_cast<const double*>(r.datasamples)[i];
        values->push_back(std::isfinite(value) ? value : std::nan(""));
      }
    }
    return true;
  }

  std::string bytes_;  // a copy: the library takes records as not constant
  const std::string& path_;
  const ChannelFilter& wanted_;
  SeedRecords records_;
};

}  // namespace

bool CanReadMiniSeed() { return true; }

bool ParseMiniSeed(const std::string& bytes, const std::string& path,
                   const ChannelFilter& wanted, LoggedFile* file,
                   std::string* error) {
  if (IsMiniSeed3(bytes)) {
    return ParseMiniSeed3(bytes, path, wanted, file, error);
  }
  return MiniSeedParser(bytes, path, wanted).Parse(file, error);
}

#else

bool CanReadMiniSeed() { return false; }

bool ParseMiniSeed(const std::string& bytes, const std::string& path,
                   const ChannelFilter& wanted, LoggedFile* file,
                   std::string* error) {
  if (IsMiniSeed3(bytes)) {
    return ParseMiniSeed3(bytes, path, wanted, file, error);
  }
  *error = path +
           ": is miniSEED 2, and this pinode was built without libmseed 2. "
           "Convert the file to SAC, or build pinode with libmseed-dev";
  return false;
}

#endif

bool IsMiniSeedHeader(std::string_view begin) {
  if (IsMiniSeed3(begin)) return true;
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
