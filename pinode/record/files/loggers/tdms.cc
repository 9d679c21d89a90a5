#include "pinode/record/files/loggers/tdms.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/record/files/loggers/tdms_objects.h"

namespace pinode {
namespace {

// Input of a scale that takes the numbers of the file.
constexpr double kRawInput = 4294967295.0;
constexpr int kMostScales = 64;
constexpr int kMostCoefficients = 64;

// TdmsProperties of a channel, and of its group and file where it has none.
class TdmsProperties {
 public:
  void Add(const TdmsObject* object) {
    if (object != nullptr) objects_.push_back(object);
  }
  const TdmsProperty* Find(const std::string& name) const {
    for (const TdmsObject* object : objects_) {
      const auto found = object->properties.find(name);
      if (found != object->properties.end()) return &found->second;
    }
    return nullptr;
  }
  bool Number(const std::string& name, double* number) const {
    const TdmsProperty* property = Find(name);
    if (property == nullptr || !property->is_number ||
        !std::isfinite(property->number)) {
      return false;
    }
    *number = property->number;
    return true;
  }
  std::string Text(const std::string& name) const {
    const TdmsProperty* property = Find(name);
    return property == nullptr ? "" : property->text;
  }

 private:
  std::vector<const TdmsObject*> objects_;
};

// TdmsScales of unscaled numbers: the last one counts. Each takes the numbers
// of the file or the values of one before it. All are polynomials here.
class TdmsScales {
 public:
  // Returns false with a sentence if a scale cannot be read.
  bool Read(const TdmsProperties& properties, std::string* fault) {
    double count = 0.0;
    if (!properties.Number("NI_Number_Of_Scales", &count) || count < 1.0 ||
        properties.Text("NI_Scaling_Status") == "scaled") {
      return true;
    }
    if (count > kMostScales) {
      *fault = "it has more than 64 scales";
      return false;
    }
    for (int i = 0; i < static_cast<int>(count); ++i) {
      Scale scale;
      const std::string start = "NI_Scale[" + std::to_string(i) + "]_";
      const std::string type = properties.Text(start + "Scale_Type");
      if (!(type == "Linear"       ? ReadLinear(properties, start, &scale)
            : type == "Polynomial" ? ReadPolynomial(properties, start, &scale)
                                   : false)) {
        *fault = "its scale '" + type +
                 "' is neither linear nor polynomial, or is incomplete. Export "
                 "the file again with scaled numbers";
        return false;
      }
      if (scale.input != kRawInput &&
          !(scale.input >= 0.0 && scale.input < static_cast<double>(i))) {
        *fault = "its scale refers to a later one";
        return false;
      }
      scales_.push_back(std::move(scale));
    }
    return true;
  }

  double Apply(double raw) const {
    return scales_.empty() ? raw : ApplyUpTo(scales_.size() - 1, raw);
  }
  bool empty() const { return scales_.empty(); }

 private:
  struct Scale {
    double input = kRawInput;
    std::vector<double> coefficients;
  };

  static bool ReadLinear(const TdmsProperties& properties,
                         const std::string& start, Scale* scale) {
    scale->coefficients.resize(2);
    properties.Number(start + "Linear_Input_Source", &scale->input);
    return properties.Number(start + "Linear_Y_Intercept",
                             &scale->coefficients[0]) &&
           properties.Number(start + "Linear_Slope", &scale->coefficients[1]);
  }

  static bool ReadPolynomial(const TdmsProperties& properties,
                             const std::string& start, Scale* scale) {
    const std::string name = start + "Polynomial_Coefficients";
    double size = 4.0;  // what the format assumes
    properties.Number(name + "_Size", &size);
    properties.Number(start + "Polynomial_Input_Source", &scale->input);
    if (!(size >= 1.0 && size <= kMostCoefficients)) return false;
    scale->coefficients.resize(static_cast<size_t>(size));
    for (size_t i = 0; i < scale->coefficients.size(); ++i) {
      if (!properties.Number(name + "[" + std::to_string(i) + "]",
                             &scale->coefficients[i])) {
        return false;
      }
    }
    return true;
  }

  // Inputs come before their scales, so that this ends.
  double ApplyUpTo(size_t place, double raw) const {
    const Scale& scale = scales_[place];
    const double input = scale.input == kRawInput
                             ? raw
                             : ApplyUpTo(static_cast<size_t>(scale.input), raw);
    double value = 0.0;
    for (size_t i = scale.coefficients.size(); i-- > 0;) {
      value = value * input + scale.coefficients[i];
    }
    return value;
  }

  std::vector<Scale> scales_;
};

std::string TdmsFault(const TdmsObject& object) {
  if (object.has_several_types) {
    return "its numbers change their type within the file. Export it again";
  }
  switch (object.type) {
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

// Reads the numbers of a channel from its places in the file.
void ReadTdmsValues(const std::string& bytes, const TdmsObject& object,
                    const TdmsScales& scales, LoggerChannel* channel) {
  channel->values.resize(channel->size);
  StartTime first;
  Eigen::Index i = 0;
  for (const TdmsRun& run : object.runs) {
    for (uint64_t k = 0; k < run.count; ++k) {
      const char* at =
          bytes.data() + run.position + static_cast<size_t>(k * run.stride);
      double value = 0.0;
      if (object.type == TdmsType::kTimestamp) {
        const StartTime time = TdmsTimeAt(at, run.is_big_endian);
        if (i == 0) first = time;
        value = time.is_known && first.is_known
                    ? static_cast<double>(time.seconds - first.seconds) +
                          (time.fraction - first.fraction)
                    : std::nan("");
      } else {
        value = scales.Apply(TdmsNumberAt(object.type, at, run.is_big_endian));
      }
      channel->values[i++] = std::isfinite(value) ? value : std::nan("");
    }
  }
}

// Makes the channel of an object. Its start time is that of wf_start_time.
LoggerChannel TdmsChannel(const std::string& bytes, const TdmsObject& object,
                          const TdmsProperties& properties,
                          const ChannelFilter& wanted, StartTime* start) {
  LoggerChannel channel;
  channel.name = Join(object.path, "/");
  channel.short_name = object.path.back();
  channel.unit = properties.Text("unit_string");
  if (channel.unit.empty()) {
    channel.unit = properties.Text("NI_UnitDescription");
  }
  channel.fault = TdmsFault(object);
  channel.size = static_cast<Eigen::Index>(object.count);
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
  if (IsTdmsNumber(object.type) && !scales.Read(properties, &fault)) {
    channel.fault = fault;
  }
  if (channel.fault.empty() && wanted(channel)) {
    ReadTdmsValues(bytes, object, scales, &channel);
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
    if (object.path.size() != 2 || object.count == 0) continue;
    TdmsProperties properties;
    properties.Add(&object);
    const auto group = groups.find(object.path[0]);
    if (group != groups.end()) properties.Add(group->second);
    properties.Add(root);
    StartTime start;
    result.channels.push_back(
        TdmsChannel(bytes, object, properties, wanted, &start));
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
