#include "pinode/case/sections/ambient_section.h"

#include <string>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/case/sections/record_data.h"
#include "pinode/record/channel_faults.h"

namespace pinode {
namespace {

class AmbientReader {
 public:
  AmbientReader(const RecordSection& section, const UnitSystem& units,
                const StructuralDynamics& dynamics, AmbientRecord* record)
      : section_(section),
        units_(units),
        dynamics_(dynamics),
        table_(
            section.table.Table("ambient", section.table.name() + ", ambient")),
        record_(record) {}

  bool Read(std::vector<std::string>* remarks) {
    if (!section_.table.errors()->ok() || !table_.AllowKeys()) {
      return false;
    }
    IdentificationRecord measured;
    if (!ReadRecordData(section_, units_, dynamics_, /*simulation=*/false,
                        &measured, /*faults=*/nullptr)) {
      return false;
    }
    record_->name = section_.name;
    record_->sampling_step = measured.sampling_step();
    record_->samples.resize(static_cast<Eigen::Index>(measured.channels.size()),
                            measured.num_samples());
    for (size_t c = 0; c < measured.channels.size(); ++c) {
      record_->channels.push_back(measured.channels[c].observation);
      record_->samples.row(static_cast<Eigen::Index>(c)) =
          measured.channels[c].values.transpose();
    }
    // Groups may follow measured covariates, and time.
    if (section_.has_excitation() || !dynamics_.IsLinear()) {
      record_->inputs = measured.excitation;
      record_->filter = measured.filter;
    }
    for (const std::string& remark : measured.description.remarks) {
      remarks->push_back("Record '" + section_.name + "': " + remark);
    }
    if (!ReadLoads() || !ReadBand() || !Check()) return false;
    std::vector<std::string> names;
    for (const Observation& channel : record_->channels) {
      names.push_back(channel.name);
    }
    for (const std::string& fault :
         FindChannelFaults(names, record_->samples)) {
      remarks->push_back("Record '" + section_.name + "': " + fault);
    }
    return true;
  }

 private:
  bool ReadLoads() {
    const char* given = nullptr;
    for (const char* key : {"dofs", "areas", "proportional_to_mass"}) {
      if (!table_.Has(key)) continue;
      if (given != nullptr) {
        return table_.Fail(given, "'" + std::string(given) + "' and '" + key +
                                      "' are both given, expected one of them");
      }
      given = key;
    }
    const StructuralModel& model = dynamics_.model();
    for (const std::string& name : table_.Strings("dofs")) {
      int dof = -1;
      if (!FindDof(model, table_, "dofs", name, false, &dof)) return false;
      AddLoad(name, Vector::Unit(model.num_dofs(), dof));
    }
    if (table_.Has("areas") && !ReadAreas()) return false;
    for (const std::string& name : table_.Strings("proportional_to_mass")) {
      const int direction = model.DirectionIndex(name);
      if (direction < 0) {
        return table_.Fail("proportional_to_mass",
                           "'" + name + "' is not a direction of the model");
      }
      AddLoad("mass in " + name, model.mass * model.influence.col(direction));
    }
    for (const std::string& name : table_.Strings("base")) {
      const int direction = model.DirectionIndex(name);
      if (direction < 0) {
        return table_.Fail("base",
                           "'" + name + "' is not a direction of the model");
      }
      const Eigen::Index before = record_->base.cols();
      record_->base.conservativeResize(model.num_dofs(), before + 1);
      record_->base.col(before) = model.influence.col(direction);
    }
    record_->correlated = table_.Boolean("correlated", true);
    record_->knots = table_.Integer("knots", 0, 0, 10000);
    return table_.errors()->ok();
  }

  // Reads areas, each a list of DOFs with equal forces, or a table of their
  // shares.
  bool ReadAreas() {
    const StructuralModel& model = dynamics_.model();
    const TomlTable areas = table_.Table("areas", table_.name() + ", areas");
    if (!table_.errors()->ok()) return false;
    for (const auto& [name, value] : areas.entries()) {
      Vector load = Vector::Zero(model.num_dofs());
      const auto add = [&](const TomlTable& from, const std::string& dof_name,
                           const std::string& key, double weight) {
        int dof = -1;
        if (!FindDof(model, from, key, dof_name, false, &dof)) return false;
        load[dof] += weight;
        return true;
      };
      if (value.type == TomlValue::Type::kTable) {
        const TomlTable shares = areas.Table(name, areas.name() + ", " + name);
        for (const auto& entry : shares.entries()) {
          const double weight = shares.Number(entry.first, 0.0);
          if (!shares.errors()->ok() ||
              !add(shares, entry.first, entry.first, weight)) {
            return false;
          }
        }
      } else {
        for (const std::string& dof : areas.Strings(name)) {
          if (!add(areas, dof, name, 1.0)) return false;
        }
      }
      if (!table_.errors()->ok()) return false;
      if (load.isZero(0.0)) {
        return areas.Fail(
            name,
            "'" + name + "' has no DOF with a share, expected at least one");
      }
      AddLoad(name, load);
    }
    return true;
  }

  void AddLoad(const std::string& name, const Vector& load) {
    record_->loads.conservativeResize(load.size(), record_->loads.cols() + 1);
    record_->loads.rightCols(1) = load;
    record_->areas.push_back(name);
  }

  bool ReadBand() {
    if (!table_.Has("band_hz")) return table_.errors()->ok();
    const std::vector<double> band =
        table_.Numbers("band_hz", 2, "end: from and to");
    double second = 1.0;
    std::string message;
    if (!table_.errors()->ok()) return false;
    if (!UnitFactor("s", Dimension::kTime, units_, &second, &message)) {
      return table_.Fail("band_hz", message);
    }
    record_->lowest_frequency = band[0] / second;
    record_->highest_frequency = band[1] / second;
    if (!(band[0] > 0.0) || !(band[1] > band[0])) {
      return table_.Fail("band_hz",
                         "expected two frequencies, the first "
                         "positive and smaller");
    }
    return true;
  }

  bool Check() {
    std::string message;
    return record_->IsValid(dynamics_, &message) ||
           section_.table.Fail(table_.Has("band_hz") ? "ambient" : "name",
                               message);
  }

  const RecordSection& section_;
  const UnitSystem& units_;
  const StructuralDynamics& dynamics_;
  const TomlTable table_;
  AmbientRecord* record_;
};

}  // namespace

bool ReadAmbientRecords(const std::vector<RecordSection>& sections,
                        const UnitSystem& units,
                        const StructuralDynamics& dynamics,
                        IdentificationProblem* problem) {
  for (const RecordSection& section : sections) {
    if (!section.ambient) continue;
    AmbientRecord record;
    if (!AmbientReader(section, units, dynamics, &record)
             .Read(&problem->description.remarks)) {
      return false;
    }
    problem->ambient.push_back(std::move(record));
  }
  return true;
}

}  // namespace pinode
