#include "pinode/record/files/loggers/tdms.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/record/files/loggers/tdms_objects.h"
#include "pinode/record/files/loggers/tdms_scales.h"

namespace pinode {
namespace {

std::string TdmsFault(const TdmsObject& object) {
  for (const TdmsSeries& series : object.series) {
    if (series.has_several_types) {
      return "its numbers change their type within the file. Export it again";
    }
  }
  switch (object.series[0].type) {
    case TdmsType::kString:
      return "it holds text, expected numbers";
    case TdmsType::kComplexFloat:
    case TdmsType::kComplexDouble:
      return "it holds complex numbers, expected real ones";
    case TdmsType::kExtended:
      return "it holds numbers of 80 or 128 bits. Export it as double";
    default:
      return "";
  }
}

// Reads the first numbers of a series. Clock times are seconds from the first
// one.
Vector ReadTdmsSeries(const std::string& bytes, const TdmsSeries& series,
                      uint64_t count) {
  Vector values(static_cast<Eigen::Index>(count));
  StartTime first;
  Eigen::Index i = 0;
  for (const TdmsRun& run : series.runs) {
    for (uint64_t k = 0; k < run.count && i < values.size(); ++k) {
      const char* at =
          bytes.data() + run.position + static_cast<size_t>(k * run.stride);
      double value = 0.0;
      if (series.type == TdmsType::kTimestamp) {
        const StartTime time = TdmsTimeAt(at, run.is_big_endian);
        if (i == 0) first = time;
        value = time.is_known && first.is_known
                    ? static_cast<double>(time.seconds - first.seconds) +
                          (time.fraction - first.fraction)
                    : std::nan("");
      } else if (series.bit >= 0) {
        value = (static_cast<unsigned char>(*at) >> series.bit) & 1;
      } else {
        value = TdmsNumberAt(series.type, at, run.is_big_endian);
      }
      values[i++] = value;
    }
  }
  return values;
}

// Reads the values of a channel, scaled.
void ReadTdmsValues(const std::string& bytes, const TdmsObject& object,
                    const TdmsScales& scales, LoggerChannel* channel) {
  TdmsScales::Series series;
  for (const TdmsSeries& s : object.series) {
    series[s.scale] = ReadTdmsSeries(bytes, s, object.count());
  }
  channel->values = scales.Apply(std::move(series)).unaryExpr([](double value) {
    return std::isfinite(value) ? value : std::nan("");
  });
}

// Makes the channel of an object. Its start time is that of wf_start_time.
LoggerChannel TdmsChannel(const std::string& bytes, const TdmsObject& object,
                          const TdmsProperties& properties,
                          const ChannelFilter& wanted, StartTime* start,
                          std::vector<std::string>* remarks) {
  LoggerChannel channel;
  channel.name = Join(object.path, "/");
  channel.short_name = object.path.back();
  channel.unit = properties.Text("unit_string");
  if (channel.unit.empty()) {
    channel.unit = properties.Text("NI_UnitDescription");
  }
  channel.fault = TdmsFault(object);
  channel.size = static_cast<Eigen::Index>(object.count());
  const auto own = [&object](const std::string& name) {
    const auto found = object.properties.find(name);
    return found == object.properties.end() ? TdmsProperty() : found->second;
  };
  const double step = own("wf_increment").number;
  if (step > 0.0 && std::isfinite(step) && std::isfinite(1.0 / step)) {
    channel.step = step;
    const double offset = own("wf_start_offset").number;
    if (std::isfinite(offset)) channel.start = offset;
    *start = own("wf_start_time").time;
  }
  TdmsScales scales;
  std::string fault;
  if (IsTdmsNumber(object.series[0].type) &&
      !scales.Read(object, properties, &fault)) {
    channel.fault = fault;
  }
  if (channel.fault.empty() && wanted(channel)) {
    ReadTdmsValues(bytes, object, scales, &channel);
    const TdmsSeries& series = object.series[0];
    if (series.is_daqmx && series.bit < 0 && scales.empty()) {
      remarks->push_back("'" + channel.name + "' holds counts without a scale");
    }
  }
  return channel;
}

}  // namespace

bool ParseTdms(const std::string& bytes, const std::string& path,
               const ChannelFilter& wanted, LoggedFile* file,
               std::string* error) {
  if (bytes.compare(0, 4, "TDSh") == 0) {
    *error = path +
             ": is the index of a TDMS file, expected the .tdms file beside "
             "it";
    return false;
  }
  TdmsStructure structure;
  if (!ReadTdmsStructure(bytes, path, &structure, error)) return false;
  std::map<std::string, const TdmsObject*> groups;
  const TdmsObject* root = nullptr;
  for (const TdmsObject& object : structure.objects) {
    if (object.path.empty()) root = &object;
    if (object.path.size() == 1) groups[object.path[0]] = &object;
  }
  LoggedFile result;
  result.format = "TDMS";
  std::vector<StartTime> starts;
  for (const TdmsObject& object : structure.objects) {
    if (object.path.size() != 2 || object.count() == 0) continue;
    TdmsProperties properties;
    properties.Add(&object);
    const auto group = groups.find(object.path[0]);
    if (group != groups.end()) properties.Add(group->second);
    properties.Add(root);
    StartTime start;
    result.channels.push_back(TdmsChannel(bytes, object, properties, wanted,
                                          &start, &result.remarks));
    starts.push_back(start);
  }
  if (structure.is_unfinished) {
    result.remarks.emplace_back("the last segment is not finished");
  }
  MakeNamesUnique(&result);
  SetStartTimes(starts, &result);
  *file = std::move(result);
  return true;
}

}  // namespace pinode
