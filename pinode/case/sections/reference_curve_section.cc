#include "pinode/case/sections/reference_curve_section.h"

#include <utility>

#include "pinode/base/strings.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/case/text/case_data.h"
#include "pinode/record/table.h"

namespace pinode {
namespace {

// An acceleration g of DOF i alone takes the force M(i,i) g if M couples that
// DOF to no other.
bool DrivesOneMass(const Matrix& outputs, const Matrix& mass) {
  if (outputs.cols() != 1 || (outputs.array() != 0.0).count() != 1) {
    return false;
  }
  return ((mass * outputs).array() != 0.0).count() == 1;
}

bool CheckTerm(const TomlTable& table, const std::string& name,
               const StructuralDynamics& dynamics) {
  std::vector<std::string> names;
  const auto check = [&](const Matrix& outputs, ActsAs acts_as) {
    if (outputs.cols() != 1) {
      return table.Fail("term", "'" + name +
                                    "' has several outputs, expected a term "
                                    "with one");
    }
    if (acts_as == ActsAs::kAcceleration &&
        !DrivesOneMass(outputs, dynamics.model().mass)) {
      return table.Fail("term", "'" + name +
                                    "' is an acceleration of coupled masses, "
                                    "expected a term that acts as a force");
    }
    return true;
  };
  for (const LawTerm& term : dynamics.laws()) {
    if (term.name == name) return check(term.outputs, term.acts_as);
    names.push_back(term.name);
  }
  for (const NetworkTerm& term : dynamics.networks()) {
    if (term.name == name) return check(term.outputs, term.acts_as);
    names.push_back(term.name);
  }
  return table.Fail("term", "there is no element, library or network '" + name +
                                "'" + NameHint(name, names));
}

}  // namespace

bool ReadReferenceCurves(const TomlTable& root,
                         const StructuralDynamics& dynamics,
                         std::vector<ReferenceCurve>* curves) {
  for (const TomlTable& table : root.Tables("reference_curve")) {
    if (!table.AllowKeys()) {
      return false;
    }
    ReferenceCurve curve;
    curve.term = table.RequiredString("term");
    curve.name = table.String("name", "reference");
    const std::string file = table.RequiredString("file");
    const std::string deformation = table.String("deformation", "deformation");
    const std::string force = table.String("force", "force");
    if (!table.errors()->ok() || !CheckTerm(table, curve.term, dynamics)) {
      return false;
    }
    Table values;
    std::string error;
    if (!ReadColumns(table.errors()->data(), ResolvePath(table, file),
                     {deformation, force}, &values, &error)) {
      return table.errors()->FailAsIs(error);
    }
    curve.deformation = values.values.col(values.FindColumn(deformation));
    curve.force = values.values.col(values.FindColumn(force));
    if (curve.force.size() < 2 || !values.values.allFinite()) {
      return table.Fail("file", "'" + file +
                                    "' is not a curve, expected at least two "
                                    "rows and a number in every cell");
    }
    curves->push_back(std::move(curve));
  }
  return root.errors()->ok();
}

}  // namespace pinode
