#include "pinode/record/files/loggers/tdms_scales.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// Limits that real files stay far below. A file that exceeds one is damaged.
constexpr int kMostScales = 64;
constexpr int kMostCoefficients = 64;
constexpr int kMostTableRows = 4096;

bool HasSeries(const TdmsObject& object, uint32_t scale) {
  return std::any_of(object.series.begin(), object.series.end(),
                     [scale](const TdmsSeries& s) { return s.scale == scale; });
}

// Reads the numbers "<name>[0]" to "<name>[size - 1]".
bool ReadList(const TdmsProperties& properties, const std::string& name,
              double size, int most, std::vector<double>* list) {
  if (!(size >= 1.0 && size <= most)) return false;
  list->resize(static_cast<size_t>(size));
  for (size_t i = 0; i < list->size(); ++i) {
    if (!properties.Number(name + "[" + std::to_string(i) + "]", &(*list)[i])) {
      return false;
    }
  }
  return true;
}

// Reads the number of a scale's input. It stays as it is if none is stated.
bool ReadInput(const TdmsProperties& properties, const std::string& name,
               uint32_t* input) {
  double number = 0.0;
  if (!properties.Number(name, &number)) return true;
  if (!(number >= 0.0 && number <= kTdmsRawSeries)) return false;
  *input = static_cast<uint32_t>(number);
  return true;
}

}  // namespace

void TdmsProperties::Add(const TdmsObject* object) {
  if (object != nullptr) objects_.push_back(object);
}

const TdmsProperty* TdmsProperties::Find(const std::string& name) const {
  for (const TdmsObject* object : objects_) {
    const auto found = object->properties.find(name);
    if (found != object->properties.end()) return &found->second;
  }
  return nullptr;
}

bool TdmsProperties::Number(const std::string& name, double* number) const {
  const TdmsProperty* property = Find(name);
  if (property == nullptr || !property->is_number ||
      !std::isfinite(property->number)) {
    return false;
  }
  *number = property->number;
  return true;
}

std::string TdmsProperties::Text(const std::string& name) const {
  const TdmsProperty* property = Find(name);
  return property == nullptr ? "" : property->text;
}

bool TdmsScales::Read(const TdmsObject& object,
                      const TdmsProperties& properties, std::string* fault) {
  double count = 0.0;
  if (!properties.Number("NI_Number_Of_Scales", &count) || count < 1.0 ||
      properties.Text("NI_Scaling_Status") == "scaled") {
    only_series_ = object.series[0].scale;
    if (object.series.size() == 1) return true;
    *fault =
        "it has several series of counts and no scale for them. Export the "
        "file again with scaled numbers";
    return false;
  }
  if (count > kMostScales) {
    *fault = "it has more than 64 scales";
    return false;
  }
  for (int i = 0; i < static_cast<int>(count); ++i) {
    Scale scale;
    const std::string start = "NI_Scale[" + std::to_string(i) + "]_";
    const std::string type = properties.Text(start + "Scale_Type");
    if (type.empty() && HasSeries(object, static_cast<uint32_t>(i))) {
      scale.kind = Kind::kSeries;
      scale.inputs = {static_cast<uint32_t>(i)};
    } else if (!ReadScale(properties, start, &scale)) {
      *fault = "its scale '" + type +
               "' is not linear, polynomial, a table, a sum or a difference, "
               "or is not whole. Export the file again with scaled numbers";
      return false;
    }
    for (const uint32_t input : scale.inputs) {
      const bool is_there =
          input == kTdmsRawSeries || scale.kind == Kind::kSeries
              ? HasSeries(object, input)
              : input < static_cast<uint32_t>(i);
      if (is_there) continue;
      *fault = "its scale takes the values of one that is not before it";
      return false;
    }
    scales_.push_back(std::move(scale));
  }
  return true;
}

bool TdmsScales::ReadScale(const TdmsProperties& properties,
                           const std::string& start, Scale* scale) {
  const std::string type = properties.Text(start + "Scale_Type");
  if (type == "Linear") {
    scale->coefficients.resize(2);
    return ReadInput(properties, start + "Linear_Input_Source",
                     scale->inputs.data()) &&
           properties.Number(start + "Linear_Y_Intercept",
                             &scale->coefficients[0]) &&
           properties.Number(start + "Linear_Slope", &scale->coefficients[1]);
  }
  if (type == "Polynomial") return ReadPolynomial(properties, start, scale);
  if (type == "Table") return ReadTable(properties, start, scale);
  if (type == "Add" || type == "Subtract") {
    scale->kind = type == "Add" ? Kind::kSum : Kind::kDifference;
    return ReadOperands(properties, start + type, scale);
  }
  return false;
}

bool TdmsScales::ReadPolynomial(const TdmsProperties& properties,
                                const std::string& start, Scale* scale) {
  const std::string name = start + "Polynomial_Coefficients";
  double size = 4.0;  // what the format assumes
  // Without the property the size stays.
  if (!properties.Number(name + "_Size", &size)) size = 4.0;
  return ReadInput(properties, start + "Polynomial_Input_Source",
                   scale->inputs.data()) &&
         ReadList(properties, name, size, kMostCoefficients,
                  &scale->coefficients);
}

bool TdmsScales::ReadTable(const TdmsProperties& properties,
                           const std::string& start, Scale* scale) {
  scale->kind = Kind::kTable;
  const std::string inputs = start + "Table_Scaled_Values";
  const std::string outputs = start + "Table_Pre_Scaled_Values";
  double num_inputs = 0.0;
  double num_outputs = 0.0;
  if (!ReadInput(properties, start + "Table_Input_Source",
                 scale->inputs.data()) ||
      !properties.Number(inputs + "_Size", &num_inputs) ||
      !properties.Number(outputs + "_Size", &num_outputs) ||
      num_inputs != num_outputs ||
      !ReadList(properties, inputs, num_inputs, kMostTableRows,
                &scale->table_inputs) ||
      !ReadList(properties, outputs, num_outputs, kMostTableRows,
                &scale->coefficients)) {
    return false;
  }
  if (scale->table_inputs.front() > scale->table_inputs.back()) {
    std::reverse(scale->table_inputs.begin(), scale->table_inputs.end());
    std::reverse(scale->coefficients.begin(), scale->coefficients.end());
  }
  return std::adjacent_find(scale->table_inputs.begin(),
                            scale->table_inputs.end(), [](double a, double b) {
                              return !(a < b);
                            }) == scale->table_inputs.end();
}

bool TdmsScales::ReadOperands(const TdmsProperties& properties,
                              const std::string& start, Scale* scale) {
  scale->inputs = {kTdmsRawSeries, kTdmsRawSeries};
  return properties.Find(start + "_Left_Operand_Input_Source") != nullptr &&
         properties.Find(start + "_Right_Operand_Input_Source") != nullptr &&
         ReadInput(properties, start + "_Left_Operand_Input_Source",
                   &scale->inputs[0]) &&
         ReadInput(properties, start + "_Right_Operand_Input_Source",
                   &scale->inputs[1]);
}

Vector TdmsScales::Evaluate(const Scale& scale,
                            const std::vector<const Vector*>& inputs) {
  const Vector& input = *inputs[0];
  switch (scale.kind) {
    case Kind::kSum:
      return input + *inputs[1];
    case Kind::kDifference:
      return *inputs[1] - input;
    case Kind::kSeries:
      return input;
    case Kind::kTable: {
      const std::vector<double>& x = scale.table_inputs;
      const std::vector<double>& y = scale.coefficients;
      return input.unaryExpr([&x, &y](double value) {
        if (!(value > x.front())) return y.front();
        if (value >= x.back()) return y.back();
        const auto above = std::upper_bound(x.begin(), x.end(), value);
        const size_t i = static_cast<size_t>(above - x.begin());
        const double part = (value - x[i - 1]) / (x[i] - x[i - 1]);
        return y[i - 1] + part * (y[i] - y[i - 1]);
      });
    }
    case Kind::kPolynomial:
      break;
  }
  Vector value = Vector::Zero(input.size());
  for (size_t i = scale.coefficients.size(); i-- > 0;) {
    value = value.cwiseProduct(input).array() + scale.coefficients[i];
  }
  return value;
}

Vector TdmsScales::Apply(Series series) const {
  if (scales_.empty()) return std::move(series.at(only_series_));
  // Scales that the last one needs, in their order: inputs come first.
  std::set<size_t> needed = {scales_.size() - 1};
  for (size_t i = scales_.size(); i-- > 0;) {
    if (needed.count(i) == 0 || scales_[i].kind == Kind::kSeries) continue;
    for (const uint32_t input : scales_[i].inputs) {
      if (input != kTdmsRawSeries) needed.insert(input);
    }
  }
  std::vector<Vector> values(scales_.size());
  for (const size_t i : needed) {
    const Scale& scale = scales_[i];
    std::vector<const Vector*> inputs;
    for (const uint32_t input : scale.inputs) {
      const bool is_series =
          input == kTdmsRawSeries || scale.kind == Kind::kSeries;
      inputs.push_back(is_series ? &series.at(input) : &values[input]);
    }
    values[i] = Evaluate(scale, inputs);
  }
  return std::move(values.back());
}

}  // namespace pinode
