// Channels from the records of seismic recorders, whatever their encoding.

#ifndef PINODE_RECORD_FILES_LOGGERS_SEED_RECORDS_H_
#define PINODE_RECORD_FILES_LOGGERS_SEED_RECORDS_H_

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/record/files/loggers/logged_file.h"

namespace pinode {

// Ticks of the records' start times in a second.
constexpr int64_t kSeedTicks = 1000000000;

// Samples of one record.
struct SeedPiece {
  int64_t start = 0;  // ticks since 1970
  Eigen::Index size = 0;
  std::vector<double> values;  // empty if not wanted
};

// Channel of a recorder.
struct SeedSource {
  std::string name;  // NET.STA.LOC.CHA
  std::string short_name;
  double rate = 0.0;  // Hz
  std::string fault;
  std::vector<SeedPiece> pieces;

  // Returns the channel without its samples.
  LoggerChannel Outline() const;
};

// Puts records one behind the other. Gaps become missing samples.
class SeedRecords {
 public:
  explicit SeedRecords(const std::string& path) : path_(path) {}

  // Returns the source of this name. A new one gets `rate`, and a fault if that
  // is none.
  SeedSource* Source(const std::string& name, double rate);

  // Adds the outline of a record to its source: `seconds` since 1970 and a rest
  // below a second in ticks. Returns what is wrong with it, or an empty text.
  static std::string Add(SeedSource* source, double rate, int64_t seconds,
                         int64_t ticks, Eigen::Index size);

  // Makes the channels of all sources. Refuses records that overlap, and gaps
  // that are longer than the records.
  [[nodiscard]] bool MakeFile(const ChannelFilter& wanted, LoggedFile* file,
                              std::string* error);

 private:
  bool MakeChannel(SeedSource* source, const ChannelFilter& wanted,
                   LoggerChannel* channel, StartTime* start,
                   std::string* error);
  void SayFaults(const LoggerChannel& channel, double missing, double jitter);

  const std::string& path_;
  std::map<std::string, size_t> by_name_;
  std::vector<SeedSource> sources_;
  std::vector<std::string> remarks_;
};

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_SEED_RECORDS_H_
