#include "pinode/case/sections/unknown_force_section.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/case/text/case_data.h"
#include "pinode/case/text/parameter_keys.h"
#include "pinode/record/files/array_table.h"
#include "pinode/record/table.h"
#include "pinode/record/time_column.h"

namespace pinode {
namespace {

// Largest number of knots: the coefficients of a spline are solved for
// together.
constexpr int kMostKnots = 2000;

// Standard deviation of the motion outside the band, as a share of `scale`.
constexpr double kOutsideBand = 0.06;

std::vector<std::string> RecordNames(
    const std::vector<RecordSection>& sections) {
  std::vector<std::string> names;
  for (const RecordSection& section : sections) names.push_back(section.name);
  return names;
}

class UnknownForceReader {
 public:
  UnknownForceReader(const TomlTable& table, const TermsContext& context,
                     const std::vector<RecordSection>& sections)
      : table_(table), context_(context), sections_(sections) {}

  bool Read(StructuralDynamics* dynamics) {
    const StructuralModel& model = context_.model->model;
    if (!CheckName(table_, "name", table_.String("name"))) return false;
    term_.name = table_.String("name");
    term_.parameters.name = term_.name;
    std::string error;
    if (!UnitFactor("s", Dimension::kTime, *context_.units, &seconds_,
                    &error)) {
      return table_.Fail("name", error);
    }
    if (!table_.RequireKey("dof", "the DOF at which the force acts")) {
      return false;
    }
    const std::string dof = table_.String("dof");
    if (!table_.errors()->ok()) return false;
    const int index = model.DofIndex(dof);
    if (index < 0) {
      return table_.Fail("dof", "'" + dof + "' is not a DOF of the model" +
                                    NameHint(dof, model.dof_names));
    }
    term_.outputs = Vector::Unit(model.num_dofs(), index);
    if (sections_.size() > 1) {
      const std::string name = RecordSwitchName(table_.String("record"));
      for (int i = 0; i < dynamics->num_inputs(); ++i) {
        if (dynamics->inputs()[static_cast<size_t>(i)].name == name) {
          term_.input = i;
        }
      }
    }
    const std::string shape =
        table_.Choice("shape", {"cubic", "linear", "half_sine"}, "cubic");
    if (!table_.errors()->ok()) return false;
    if (!(shape == "half_sine" ? ReadPulse() : ReadSpline(shape))) return false;
    if (!dynamics->AddUnknownForce(std::move(term_), &error)) {
      return table_.Fail("name", error);
    }
    return table_.errors()->ok();
  }

 private:
  bool Refuse(const std::vector<std::string>& keys, const std::string& why) {
    for (const std::string& key : keys) {
      if (table_.Has(key)) {
        return table_.Fail(key, "'" + key + "' cannot be combined with " + why);
      }
    }
    return true;
  }

  bool ReadSpline(const std::string& shape) {
    if (!Refuse({"parameters"},
                "a spline, which needs 'window', 'knot_spacing' and 'scale'")) {
      return false;
    }
    for (const char* key : {"window", "knot_spacing", "scale"}) {
      if (!table_.RequireKey(
              key,
              key == std::string("window")
                  ? "[first, last] time at which the force may act, in "
                    "seconds"
              : key == std::string("scale")
                  ? "the approximate size of the force, in the model's unit"
                  : "the time between knots, in seconds")) {
        return false;
      }
    }
    const std::vector<double> window =
        table_.Numbers("window", 2, "end of the window");
    const double spacing = table_.PositiveNumber("knot_spacing", 1.0);
    SplineForce::Options options;
    options.scale = table_.PositiveNumber("scale", 1.0);
    if (!table_.errors()->ok()) return false;
    const double intervals = std::round((window[1] - window[0]) / spacing);
    if (!(intervals >= 2.0)) {
      return table_.Fail("window",
                         "expected a window of at least two 'knot_spacing'");
    }
    if (intervals >= kMostKnots) {
      return table_.Fail("knot_spacing", "the window would have " +
                                             FormatNumber(intervals + 1.0, 6) +
                                             " knots, expected at most " +
                                             std::to_string(kMostKnots));
    }
    options.degree = shape == "cubic" ? 3 : 1;
    options.start = window[0] * seconds_;
    options.spacing = spacing * seconds_;
    options.num_knots = static_cast<int>(intervals) + 1;
    if (!ReadPrior(options, spacing)) return false;

    const std::vector<double> values =
        table_.Numbers("values", options.num_knots, "knot");
    const bool free = table_.Boolean("free", true);
    if (!table_.errors()->ok()) return false;
    term_.parameters.named = false;
    for (int k = 0; k < options.num_knots; ++k) {
      Parameter parameter;
      parameter.name = term_.name + "[" + std::to_string(k) + "]";
      parameter.free = free;
      if (!values.empty()) {
        parameter.value = values[static_cast<size_t>(k)] / options.scale;
      }
      term_.parameters.parameters.push_back(parameter);
    }
    term_.history = std::make_shared<SplineForce>(options);
    if (free) AddRemark();
    return true;
  }

  bool ReadPrior(const SplineForce::Options& options, double spacing) {
    if (!table_.Has("band_hz")) {
      const int neighbourhood = table_.Integer("neighbourhood", 1, 1, 1000000);
      const double relaxation =
          table_.Has("relaxation")
              ? spacing / table_.PositiveNumber("relaxation", 1.0)
              : 0.0;
      if (!table_.errors()->ok()) return false;
      term_.prior =
          SmoothnessPrior(options.num_knots, neighbourhood, relaxation);
      return true;
    }
    if (!Refuse({"neighbourhood", "relaxation"},
                "'band_hz', which is itself a prior")) {
      return false;
    }
    const std::vector<double> band = table_.Numbers("band_hz", 2, "corner");
    if (!table_.errors()->ok()) return false;
    const double highest = 0.5 / spacing;
    if (!(band[0] >= 0.0) || !(band[0] < band[1]) || !(band[1] <= highest)) {
      return table_.Fail("band_hz", "expected 0 <= lowest < highest <= " +
                                        FormatNumber(highest, 6) +
                                        " Hz, half the rate of the knots");
    }
    term_.prior = BandPrior(options.num_knots, spacing, band[0], band[1],
                            1.0 / (kOutsideBand * kOutsideBand));
    return true;
  }

  bool ReadPulse() {
    if (!Refuse({"window", "knot_spacing", "scale", "neighbourhood",
                 "relaxation", "band_hz", "values", "free"},
                "a half-sine pulse, which needs parameters.start, "
                "parameters.duration and parameters.amplitude")) {
      return false;
    }
    const std::vector<std::string> names = {"start", "duration", "amplitude"};
    const TomlTable parameters =
        table_.Table("parameters", table_.name() + ", parameters");
    if (!table_.errors()->ok() || !parameters.AllowKeys()) return false;
    for (const std::string& name : names) {
      const bool is_force = name == "amplitude";
      const double factor = is_force ? 1.0 : seconds_;
      Parameter parameter;
      parameter.name = term_.name + "." + name;
      parameter.unit = UnitName(is_force ? Dimension::kForce : Dimension::kTime,
                                *context_.units);
      if (name == "duration") parameter.lower = 0.0;
      const TomlValue* value = parameters.Find(name);
      if (value == nullptr || !(value->IsNumber() || value->Find("initial"))) {
        return (value != nullptr ? parameters : table_)
            .Fail(value != nullptr ? name : "shape",
                  "parameter '" + name +
                      "' needs a value, expected parameters." + name +
                      " = {initial = ...}, or a number that stays fixed");
      }
      if (value->IsNumber()) {
        parameter.free = false;
        parameter.value = factor * parameters.Number(name, 0.0);
        parameter.prior_mean = parameter.value;
      } else {
        const TomlTable keys =
            parameters.Table(name, table_.name() + ", parameter " + name);
        if (!table_.errors()->ok() || !keys.AllowKeys() ||
            !ReadParameterKeys(keys, factor, &parameter)) {
          return false;
        }
      }
      if (!table_.errors()->ok()) return false;
      if (name == "duration" && !(parameter.value > 0.0)) {
        return parameters.Fail(name, "expected a positive duration");
      }
      term_.parameters.parameters.push_back(parameter);
    }
    term_.history = std::make_shared<HalfSinePulse>();
    return true;
  }

  // Adds a remark on a problem that no prior can solve.
  void AddRemark() const {
    for (const RecordSection& section : sections_) {
      if (!ActsIn(section)) continue;
      const bool sees = std::any_of(
          section.channels.begin(), section.channels.end(),
          [](const ChannelSection& channel) {
            return channel.fit &&
                   (channel.quantity == Quantity::kDisplacement ||
                    channel.quantity == Quantity::kAbsoluteDisplacement ||
                    channel.quantity == Quantity::kStrain);
          });
      if (sees) continue;
      context_.remarks->push_back(
          "The static part of the unknown force " + term_.name +
          " cannot be seen: record " + section.name +
          " has no channel of displacement or strain. Well below the first "
          "natural frequency the result is only the prior (" +
          (table_.Has("band_hz") ? "band_hz"
           : table_.Has("relaxation")
               ? "relaxation"
               : "smoothness, which allows drift: give band_hz or relaxation") +
          "), and its band grows there.");
    }
  }

  bool ActsIn(const RecordSection& section) const {
    return sections_.size() == 1 || section.name == table_.String("record");
  }

  const TomlTable& table_;
  const TermsContext& context_;
  const std::vector<RecordSection>& sections_;
  double seconds_ = 1.0;
  UnknownForceTerm term_;
};

}  // namespace

std::string RecordSwitchName(const std::string& record) {
  return "record_" + record;
}

bool AddRecordSwitches(const TomlTable& root,
                       const std::vector<RecordSection>& sections,
                       std::vector<InputSpec>* inputs) {
  const std::vector<std::string> names = RecordNames(sections);
  for (TomlTable& table : root.Tables("unknown_force")) {
    const std::string name = table.RequiredString("name");
    if (!root.errors()->ok()) return false;
    table.set_name("unknown force '" + name + "'");
    if (sections.size() > 1 &&
        !table.RequireKey("record", "the record in which it acts")) {
      return false;
    }
    if (!table.Has("record")) continue;
    const std::string record = table.String("record");
    if (!root.errors()->ok()) return false;
    const auto found = std::find(names.begin(), names.end(), record);
    if (found == names.end()) {
      return table.Fail("record", "there is no record '" + record + "'" +
                                      NameHint(record, names));
    }
    if (sections.size() == 1) continue;
    const InputSpec spec = {InputSpec::Kind::kRecordSwitch,
                            static_cast<int>(found - names.begin()),
                            RecordSwitchName(record)};
    if (std::none_of(inputs->begin(), inputs->end(),
                     [&spec](const InputSpec& other) {
                       return other.name == spec.name;
                     })) {
      inputs->push_back(spec);
    }
  }
  return root.errors()->ok();
}

bool ReadUnknownForces(const TomlTable& root, const TermsContext& context,
                       const std::vector<RecordSection>& sections,
                       StructuralDynamics* dynamics) {
  std::set<std::string> seen;
  for (TomlTable& table : root.Tables("unknown_force")) {
    if (!table.AllowKeys()) {
      return false;
    }
    const std::string name = table.RequiredString("name");
    if (!root.errors()->ok()) return false;
    table.set_name("unknown force '" + name + "'");
    if (!seen.insert(name).second) {
      return table.Fail("name",
                        "this name is used twice, expected different names");
    }
    if (!UnknownForceReader(table, context, sections).Read(dynamics)) {
      return false;
    }
  }
  return root.errors()->ok();
}

bool ReadForceTruths(const TomlTable& root, const UnitSystem& units,
                     const std::vector<RecordSection>& sections,
                     std::vector<ForceTruth>* truths) {
  for (const char* kind : {"unknown_force", "network"}) {
    for (const TomlTable& table : root.Tables(kind)) {
      if (!table.Has("truth")) continue;
      ForceTruth truth;
      truth.name = table.RequiredString("name");
      const std::string column = table.RequiredString("truth");
      // A network acts in all records.
      const std::string record =
          table.Takes("record") ? table.String("record") : "";
      if (!root.errors()->ok()) return false;
      const auto section = std::find_if(
          sections.begin(), sections.end(), [&](const RecordSection& s) {
            return record.empty() ? s.role == IdentificationRecord::Role::kTrain
                                  : s.name == record;
          });
      if (section == sections.end() || section->file.empty() ||
          IsAt2File(section->file)) {
        return table.Fail("truth", "its record has no file with columns");
      }
      std::vector<std::string> columns = {column};
      if (!section->time_column.empty()) {
        columns.insert(columns.begin(), section->time_column);
      }
      Table values;
      TimeGrid grid;
      TimeColumnOptions options;
      options.factor = section->time_factor;
      options.unit = units.time;
      options.interpolate_irregular = true;
      std::string error;
      const auto& arrays = table.errors()->data().tables;
      const auto array = arrays.find(section->file);
      if (!(array != arrays.end()
                ? SelectColumns(array->second, columns, &values, &error)
                : ReadTable(section->file, columns, section->text_format,
                            &values, &error))) {
        return table.errors()->FailAsIs(error);
      }
      if (!values.time_unit.empty() &&
          !UnitFactor(values.time_unit, Dimension::kTime, units,
                      &options.factor, &error)) {
        return table.errors()->FailAsIs(error);
      }
      if (!(section->time_column.empty()
                ? TimeGridFromStep(values, section->sampling_step, &grid,
                                   &error)
                : FindTimeGrid(values, section->time_column, options, &grid,
                               &error))) {
        return table.errors()->FailAsIs(error);
      }
      truth.values = OnTimeGrid(values, values.FindColumn(column), grid);
      truth.times.resize(truth.values.size());
      for (Eigen::Index i = 0; i < truth.times.size(); ++i) {
        truth.times[i] = grid.start_time + static_cast<double>(i) * grid.step;
      }
      truths->push_back(std::move(truth));
    }
  }
  return true;
}

void SpreadNetworksOfTime(const TomlTable& root,
                          const IdentificationProblem& problem,
                          StructuralDynamics* dynamics) {
  double begin = std::numeric_limits<double>::infinity();
  double end = -begin;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    begin = std::min(begin, record.excitation->time(0));
    end = std::max(end, record.excitation->time(record.num_samples() - 1));
  }
  std::vector<TomlTable> tables = root.Tables("network");
  // Networks with memory are laws.
  tables.erase(std::remove_if(
                   tables.begin(), tables.end(),
                   [](const TomlTable& table) { return table.Has("memory"); }),
               tables.end());
  Vector theta = dynamics->Parameters();
  for (size_t j = 0; j < dynamics->networks().size(); ++j) {
    const NetworkTerm& term = dynamics->networks()[j];
    const NetworkArchitecture& architecture = term.network->architecture();
    const bool of_time = std::all_of(
        term.features.begin(), term.features.end(), [](const Feature& feature) {
          return feature.kind == Feature::Kind::kTime;
        });
    if (!of_time || tables[j].Has("weights") || architecture.IsLinear() ||
        !architecture.bias || architecture.activation == Activation::kSine) {
      continue;
    }
    const WeightLayout& layout = term.network->layout();
    const WeightLayout::Part& weights = layout.weights.front();
    const WeightLayout::Part& biases = layout.biases.front();
    const int offset =
        dynamics->block_offset(dynamics->network_block(static_cast<int>(j)));
    const double scale =
        architecture.input_scale.size() > 0 ? architecture.input_scale[0] : 1.0;
    for (int i = 0; i < weights.rows; ++i) {
      const double middle = begin + (end - begin) * (i + 0.5) / weights.rows;
      for (int k = 0; k < weights.cols; ++k) {
        theta[offset + weights.offset + k * weights.rows + i] =
            k == 0 ? 1.0 : 0.0;
      }
      theta[offset + biases.offset + i] = -middle / scale;
    }
  }
  dynamics->SetParameters(theta);
}

bool CheckUnknownForces(const TomlTable& root,
                        const std::vector<RecordSection>& sections,
                        const IdentificationProblem& problem,
                        IdentificationOptions* options) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  bool any_free = false;
  bool any_spline = false;
  for (const UnknownForceTerm& term : dynamics.unknown_forces()) {
    const auto& parameters = term.parameters.parameters;
    if (std::none_of(parameters.begin(), parameters.end(),
                     [](const Parameter& p) { return p.free; })) {
      continue;
    }
    any_free = true;
    const auto acts_in = [&](size_t r) {
      return term.input < 0 ||
             problem.records[r].excitation->samples()(term.input, 0) != 0.0;
    };
    for (size_t r = 0; r < sections.size(); ++r) {
      if (term.input >= 0 && acts_in(r) &&
          sections[r].role == IdentificationRecord::Role::kHoldout) {
        return sections[r].table.Fail(
            "role", "the unknown force '" + term.name +
                        "' acts in a hold-out record, which does not determine "
                        "it; set role = \"train\", or free = false");
      }
    }
    const auto* spline = dynamic_cast<const SplineForce*>(term.history.get());
    if (spline == nullptr) continue;
    any_spline = true;
    const Vector acceleration =
        dynamics.model().mass.ldlt().solve(term.outputs);
    for (size_t r = 0; r < sections.size(); ++r) {
      const IdentificationRecord& record = problem.records[r];
      if (record.role != IdentificationRecord::Role::kTrain || !acts_in(r)) {
        continue;
      }
      // With as many unknowns as samples the force can follow each sample.
      // Frequencies outside a band are no unknowns.
      const double per_sample = term.prior.ShareToBeChosen() *
                                record.sampling_step() /
                                spline->options().spacing;
      if (per_sample < 1.0 - 1e-9) continue;
      for (size_t c = 0; c < record.channels.size(); ++c) {
        const MeasuredChannel& channel = record.channels[c];
        const Quantity quantity = channel.observation.quantity;
        const double direct = channel.observation.weights.dot(acceleration);
        if (!channel.fit || channel.sigma > 0.0 ||
            (quantity != Quantity::kRelativeAcceleration &&
             quantity != Quantity::kAbsoluteAcceleration) ||
            std::abs(direct) < 1e-9 * acceleration.norm() *
                                   channel.observation.weights.norm()) {
          continue;
        }
        return sections[r].channels[c].signal.table.Fail(
            "column", "with the unknown force '" + term.name +
                          "' at this acceleration, which has a knot per "
                          "sample, its noise cannot be found. Give 'sigma', "
                          "'sigma_percent', wider knots or band_hz");
      }
    }
  }
  if (!any_free) return true;
  const TomlTable table = root.Table("options", "[options]");
  if (table.String("shooting") == "multiple") {
    return table.Fail("shooting",
                      "shooting = \"multiple\" cannot be combined with unknown "
                      "forces: the free starts of segments would replace them. "
                      "Use \"single\", the default here");
  }
  options->shooting = IdentificationOptions::Shooting::kSingle;
  if (any_spline &&
      options->covariance == IdentificationOptions::Covariance::kSandwich) {
    return table.Fail("covariance",
                      "covariance = \"sandwich\" cannot be combined with a "
                      "spline, which has more knots than there are blocks of "
                      "samples; use \"auto\" or \"plain\"");
  }
  return true;
}

}  // namespace pinode
