#include "pinode/dynamics/structural_dynamics.h"

#include <ceres/jet.h>

#include <algorithm>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/dynamics/elements.h"
#include "pinode/dynamics/prescribed_motion.h"

namespace pinode {

StructuralDynamics::StructuralDynamics(StructuralModel model,
                                       std::vector<InputSpec> inputs)
    : linear_(std::move(model), std::move(inputs)),
      prescribed_(PrescribedDofs(linear_.inputs())) {}

std::unique_ptr<StructuralDynamics> StructuralDynamics::Create(
    StructuralModel model, std::vector<InputSpec> inputs, std::string* error) {
  if (!LinearDynamics::IsValid(model, inputs, error)) return nullptr;
  return std::make_unique<StructuralDynamics>(std::move(model),
                                              std::move(inputs));
}

StructuralDynamics::StructuralDynamics(const StructuralDynamics& other)
    : linear_(other.linear_), prescribed_(other.prescribed_) {
  for (const auto& term : other.terms_) terms_.push_back(term->Clone());
  Layout();
}

StructuralDynamics& StructuralDynamics::operator=(
    const StructuralDynamics& other) {
  if (this != &other) *this = StructuralDynamics(other);
  return *this;
}

int StructuralDynamics::FirstOf(TermKind kind) const {
  const auto first =
      std::find_if(terms_.begin(), terms_.end(),
                   [kind](const auto& term) { return term->kind() >= kind; });
  return static_cast<int>(first - terms_.begin());
}

bool StructuralDynamics::AddTerm(std::unique_ptr<Term> term,
                                 std::string* error) {
  if (term == nullptr) {
    *error = "there is no term to be added";
    return false;
  }
  if (term->kind() == TermKind::kGroups && !groups().empty()) {
    *error = "all groups are one term: add to it by AddGroup";
    return false;
  }
  if (!term->IsValid(model(), num_inputs(), error) ||
      !LeavesPrescribedMasses(*term, error)) {
    return false;
  }
  // Insert it behind all terms of its kind.
  const auto behind = std::find_if(terms_.begin(), terms_.end(),
                                   [kind = term->kind()](const auto& other) {
                                     return other->kind() > kind;
                                   });
  terms_.insert(behind, std::move(term));
  Layout();
  return true;
}

// All groups form one term.
bool StructuralDynamics::AddGroup(GroupTerm term, std::string* error) {
  GroupTerms alone;
  if (!alone.Add(term, model(), num_inputs(), error) ||
      !LeavesPrescribedMasses(alone, error)) {
    return false;
  }
  if (groups().empty()) {
    auto groups = std::make_unique<GroupTerms>();
    return groups->Add(std::move(term), model(), num_inputs(), error) &&
           AddTerm(std::move(groups), error);
  }
  auto* groups = static_cast<GroupTerms*>(terms_.front().get());
  if (!groups->Add(std::move(term), model(), num_inputs(), error)) return false;
  Layout();
  return true;
}

bool StructuralDynamics::AddLaw(LawTerm term, std::string* error) {
  return AddTerm(MakeTerm(std::move(term)), error);
}

bool StructuralDynamics::AddUnknownForce(UnknownForceTerm term,
                                         std::string* error) {
  return AddTerm(MakeTerm(std::move(term)), error);
}

bool StructuralDynamics::AddGroupCurve(GroupCurve curve, std::string* error) {
  const auto& known = groups();
  if (std::none_of(known.begin(), known.end(), [&curve](const GroupTerm& term) {
        return term.group.name == curve.name &&
               term.follows == GroupTerm::Follows::kNothing;
      })) {
    *error = "a curve of '" + curve.name +
             "', expected a group of that name that follows nothing else";
    return false;
  }
  return AddTerm(MakeTerm(std::move(curve)), error);
}

bool StructuralDynamics::AddForceScale(ForceScaleTerm term,
                                       std::string* error) {
  std::unique_ptr<Term> made = MakeTerm(std::move(term), inputs(), error);
  return made != nullptr && AddTerm(std::move(made), error);
}

bool StructuralDynamics::AddNetwork(NetworkTerm term, std::string* error) {
  return AddTerm(MakeTerm(std::move(term)), error);
}

bool StructuralDynamics::SetNetworkScales(int network, const Vector& input,
                                          const Vector& output,
                                          std::string* error) {
  if (network < 0 || network >= static_cast<int>(networks().size())) {
    *error = "network " + std::to_string(network) + ", and there are " +
             std::to_string(networks().size());
    return false;
  }
  NetworkTerm term = networks()[static_cast<size_t>(network)];
  NetworkArchitecture architecture = term.network->architecture();
  architecture.input_scale = input;
  architecture.output_scale = output;
  if (!architecture.IsValid(error)) {
    *error = "'" + term.name + "': " + *error;
    return false;
  }
  term.network = std::make_shared<Network>(std::move(architecture));
  terms_[Index(network_block(network))] = MakeTerm(std::move(term));
  return true;
}

bool StructuralDynamics::AddElement(const std::string& name,
                                    const std::string& type, int from, int to,
                                    const std::vector<double>& values,
                                    std::string* error) {
  LawTerm term;
  return MakeElement(name, type, num_dofs(), from, to, values, &term, error) &&
         AddLaw(std::move(term), error);
}

bool StructuralDynamics::LeavesPrescribedMasses(const Term& term,
                                                std::string* error) const {
  for (const MatrixChange& change : term.MatrixChanges()) {
    if (change.group->target != MatrixGroup::Target::kMass) continue;
    for (const PrescribedDof& p : prescribed_) {
      if (change.group->matrix.col(p.dof).isZero(0.0)) continue;
      *error = "the mass of DOF '" + model().dof_names[Index(p.dof)] +
               "', whose motion is prescribed, cannot change";
      return false;
    }
  }
  return true;
}

const double* StructuralDynamics::Prescribed(const double* input,
                                             const double* state,
                                             Vector* copy) const {
  if (prescribed_.empty()) return state;
  *copy = Eigen::Map<const Vector>(state, num_states());
  Prescribe(input, copy->data());
  return copy->data();
}

void StructuralDynamics::PrescribeSensitivity(Matrix* sensitivity) const {
  for (const PrescribedDof& p : prescribed_) {
    sensitivity->row(p.dof).setZero();
    sensitivity->row(num_dofs() + p.dof).setZero();
  }
}

const std::vector<GroupTerm>& StructuralDynamics::groups() const {
  static const auto* none = new std::vector<GroupTerm>;
  if (terms_.empty() || terms_.front()->kind() != TermKind::kGroups) {
    return *none;
  }
  return static_cast<const GroupTerms&>(*terms_.front()).groups();
}

void StructuralDynamics::SetTies() {
  std::vector<const ParameterBlock*> blocks;
  for (const auto& term : terms_) blocks.push_back(&term->parameters());
  ties_ = FindTies(blocks);
  if (ties_.empty()) return;
  Vector theta(num_parameters_);
  for (size_t b = 0; b < blocks.size(); ++b) {
    theta.segment(offsets_[b].parameter, blocks[b]->size()) =
        blocks[b]->Values();
  }
  ApplyTies(ties_, theta.data());
  for (size_t b = 0; b < terms_.size(); ++b) {
    terms_[b]->SetParameters(
        theta.segment(offsets_[b].parameter, blocks[b]->size()));
  }
}

void StructuralDynamics::SetTermColumns() {
  tangent_columns_.clear();
  term_columns_.clear();
  std::vector<int> column_of(Index(num_parameters_), -1);
  std::vector<int> place_of(Index(num_parameters_), -1);  // in term_columns_
  int parameter = 0;
  for (size_t t = 0; t < terms_.size(); ++t) {
    offsets_[t].column = static_cast<int>(term_columns_.size());
    for (const Parameter& p : terms_[t]->parameters().parameters) {
      if (p.free) {
        column_of[Index(parameter)] = num_tangent_columns();
        tangent_columns_.push_back(parameter);
      }
      if (p.free || p.IsTied()) {
        place_of[Index(parameter)] = static_cast<int>(term_columns_.size());
        term_columns_.push_back({column_of[Index(parameter)], 1.0});
      }
      ++parameter;
    }
  }
  for (const ParameterTie& tie : ties_) {
    term_columns_[Index(place_of[Index(tie.parameter)])] = {
        column_of[Index(tie.source)], tie.factor};
  }
}

void StructuralDynamics::Layout() {
  offsets_.clear();
  num_parameters_ = 0;
  num_internal_ = 0;
  num_switches_ = 0;
  for (const auto& term : terms_) {
    num_switches_ += term->num_switches();
    Offsets offsets;
    offsets.parameter = num_parameters_;
    offsets.place.num_dofs = num_dofs();
    offsets.place.first_internal = num_states();
    num_parameters_ += term->parameters().size();
    num_internal_ += static_cast<int>(term->InternalNames().size());
    offsets_.push_back(offsets);
  }
  SetTies();
  SetTermColumns();
  blocks_.clear();
  std::vector<MatrixChange> changes;
  for (size_t t = 0; t < terms_.size(); ++t) {
    blocks_.push_back(terms_[t]->parameters());
    for (MatrixChange change : terms_[t]->MatrixChanges()) {
      change.parameter += offsets_[t].parameter;
      if (change.column >= 0) {
        const TermColumn& to =
            term_columns_[Index(offsets_[t].column + change.column)];
        change.column = to.column;
        change.factor = to.factor;
      }
      changes.push_back(change);
    }
  }
  linear_.SetChanges(std::move(changes));
}

bool StructuralDynamics::IsLinear() const {
  return prescribed_.empty() &&
         std::all_of(terms_.begin(), terms_.end(),
                     [](const auto& term) { return term->IsConstant(); });
}

StructuralDynamics StructuralDynamics::Averaged(const Conditions& over) const {
  CHECK_EQ(over.inputs.rows(), num_inputs());
  StructuralDynamics averaged(*this);
  for (auto& term : averaged.terms_) term = term->Averaged(over);
  averaged.Layout();
  return averaged;
}

std::vector<std::string> StructuralDynamics::CovariateParameters() const {
  std::vector<std::string> names;
  for (const GroupTerm& term : groups()) {
    if (term.follows == GroupTerm::Follows::kCovariate) {
      names.push_back(term.group.name);
    }
  }
  for (const GroupCurve& curve : group_curves()) {
    for (const Parameter& parameter : curve.parameters.parameters) {
      names.push_back(parameter.name);
    }
  }
  return names;
}

StructuralDynamics StructuralDynamics::WithGroupParameters(
    const std::function<void(Parameter*)>& change) const {
  StructuralDynamics result(model(), inputs());
  std::string error;
  for (GroupTerm group : groups()) {
    change(&group.alpha);
    CHECK(result.AddGroup(std::move(group), &error)) << error;
  }
  for (const auto& term : terms_) {
    if (term->kind() == TermKind::kGroups) continue;
    if (term->kind() != TermKind::kGroupCurve) {
      CHECK(result.AddTerm(term->Clone(), &error)) << error;
      continue;
    }
    GroupCurve curve =
        static_cast<const TermOf<GroupCurve>&>(*term).description();
    for (Parameter& parameter : curve.parameters.parameters) change(&parameter);
    CHECK(result.AddGroupCurve(std::move(curve), &error)) << error;
  }
  return result;
}

std::vector<std::string> StructuralDynamics::StateNames() const {
  std::vector<std::string> names;
  for (const std::string& dof : model().dof_names) {
    names.push_back("x[" + dof + "]");
  }
  for (const std::string& dof : model().dof_names) {
    names.push_back("v[" + dof + "]");
  }
  for (const auto& term : terms_) {
    for (std::string& name : term->InternalNames()) {
      names.push_back(std::move(name));
    }
  }
  return names;
}

Vector StructuralDynamics::Parameters() const {
  Vector theta(num_parameters_);
  for (size_t b = 0; b < blocks_.size(); ++b) {
    theta.segment(offsets_[b].parameter, blocks_[b].size()) =
        blocks_[b].Values();
  }
  return theta;
}

void StructuralDynamics::SetParameters(const Vector& theta) {
  CHECK_EQ(theta.size(), num_parameters_);
  for (size_t b = 0; b < blocks_.size(); ++b) {
    terms_[b]->SetParameters(
        theta.segment(offsets_[b].parameter, blocks_[b].size()));
  }
  Layout();
}

StructuralModel StructuralDynamics::CorrectedModel(const Vector& theta) const {
  CHECK_EQ(theta.size(), num_parameters_);
  if (ties_.empty()) return linear_.ChangedModel(theta);
  Vector tied = theta;
  ApplyTies(ties_, tied.data());
  return linear_.ChangedModel(tied);
}

StructuralModel StructuralDynamics::HeldModel(const Vector& theta) const {
  return WithoutPrescribed(CorrectedModel(theta), prescribed_);
}

bool StructuralDynamics::Prepare(const Vector& theta, Prepared* prepared,
                                 std::string* error) const {
  if (theta.size() != num_parameters_) {
    *error = std::to_string(theta.size()) + " values of parameters, expected " +
             std::to_string(num_parameters_);
    return false;
  }
  prepared->theta = theta;
  ApplyTies(ties_, prepared->theta.data());
  prepared->terms.clear();
  if (!linear_.Prepare(prepared->theta, &prepared->linear, error)) return false;
  for (size_t i = 0; i < terms_.size(); ++i) {
    prepared->terms.push_back(terms_[i]->Prepare(
        prepared->linear, prepared->theta.data() + offsets_[i].parameter));
  }
  return true;
}

StructuralDynamics::Linearization StructuralDynamics::MakeLinearization()
    const {
  Linearization linearization;
  linearization.rate = Vector::Zero(num_states());
  linearization.jacobian = Matrix::Zero(num_states(), num_states());
  linearization.force_acceleration = Vector::Zero(num_dofs());
  if (!prescribed_.empty()) {
    linearization.prescribed_state = Vector::Zero(num_states());
  }
  linearization.change_forces =
      Matrix::Zero(num_dofs(), linear_.num_free_changes());
  for (size_t i = 0; i < terms_.size(); ++i) {
    linearization.terms.push_back(
        terms_[i]->MakeLinearization(offsets_[i].place));
  }
  return linearization;
}

template <typename T>
TermPoint<T> StructuralDynamics::PointOf(int term, double time,
                                         const double* input, const T* state,
                                         const T* theta) const {
  const Offsets& offsets = offsets_[Index(term)];
  return {offsets.place, time, input, state, theta + offsets.parameter};
}

template <typename T>
TermRate<T> StructuralDynamics::RateOf(int term, T* rate,
                                       T* force_acceleration) const {
  const TermPlace& place = offsets_[Index(term)].place;
  return {rate + place.num_dofs, force_acceleration,
          rate + place.first_internal};
}

void StructuralDynamics::Rate(const Prepared& prepared, double time,
                              const double* input, const double* state,
                              double* rate, Linearization* scratch) const {
  state = Prescribed(input, state, &scratch->prescribed_state);
  linear_.Rate(prepared.linear, input, state, rate);
  for (int i = 0; i < num_terms(); ++i) {
    auto sums = RateOf(i, rate, scratch->force_acceleration.data());
    terms_[Index(i)]->AddRate(
        *prepared.terms[Index(i)],
        PointOf(i, time, input, state, prepared.theta.data()), &sums,
        scratch->terms[Index(i)].get());
  }
}

void StructuralDynamics::Rate(const Prepared& prepared, double time,
                              const double* input, const WideJet* state,
                              const WideJet* theta, WideJet* rate) const {
  const int n = num_dofs();
  std::vector<WideJet> copy;
  if (!prescribed_.empty()) {
    copy.assign(state, state + num_states());
    Prescribe(input, copy.data());
    state = copy.data();
  }
  linear_.Rate(prepared.linear, input, state, rate);
  std::vector<WideJet> force_acceleration(rate + n, rate + 2 * n);
  for (int i = 0; i < num_terms(); ++i) {
    auto sums = RateOf(i, rate, force_acceleration.data());
    terms_[Index(i)]->AddRate(*prepared.terms[Index(i)],
                              PointOf(i, time, input, state, theta), &sums);
  }
  linear_.AddVariation(prepared.linear, input, state, theta,
                       force_acceleration.data(), rate + n);
}

void StructuralDynamics::Switches(const Prepared& prepared, double time,
                                  const double* input, const double* state,
                                  double* values) const {
  for (int i = 0; i < num_terms(); ++i) {
    const int count = term(i).num_switches();
    if (count == 0) continue;
    term(i).Switches(PointOf(i, time, input, state, prepared.theta.data()),
                     values);
    values += count;
  }
}

void StructuralDynamics::SwitchGradient(int j, const Prepared& prepared,
                                        double time, const double* input,
                                        const double* state,
                                        double* gradient) const {
  std::fill(gradient, gradient + num_states(), 0.0);
  for (int i = 0; i < num_terms(); ++i) {
    if (j < term(i).num_switches()) {
      term(i).AddSwitchGradient(
          j, PointOf(i, time, input, state, prepared.theta.data()), gradient);
      return;
    }
    j -= term(i).num_switches();
  }
}

void StructuralDynamics::SetBranches(const char* branches,
                                     Linearization* linearization) const {
  for (int i = 0; i < num_terms(); ++i) {
    const int count = term(i).num_switches();
    if (count == 0) continue;
    term(i).SetBranches(branches, linearization->terms[Index(i)].get());
    if (branches != nullptr) branches += count;
  }
}

void StructuralDynamics::Linearize(const Prepared& prepared, double time,
                                   const double* input, const double* state,
                                   Linearization* linearization) const {
  const int n = num_dofs();
  Linearization& at = *linearization;
  state = Prescribed(input, state, &at.prescribed_state);
  linear_.Rate(prepared.linear, input, state, at.rate.data());
  if (num_internal_ > 0) {
    at.jacobian.setZero();
    at.jacobian.topLeftCorner(2 * n, 2 * n) = prepared.linear.state_jacobian;
  } else {
    at.jacobian = prepared.linear.state_jacobian;
  }
  // The mass groups and the sensors refer to the accelerations that forces
  // cause. Terms that act as an acceleration are added afterwards.
  at.force_acceleration = at.rate.segment(n, n);
  for (int i = 0; i < num_terms(); ++i) {
    auto sums = RateOf(i, at.rate.data(), at.force_acceleration.data());
    terms_[Index(i)]->Linearize(
        *prepared.terms[Index(i)],
        PointOf(i, time, input, state, prepared.theta.data()), &sums,
        &at.jacobian, at.terms[Index(i)].get());
  }
  linear_.ChangeForces(input, state, at.force_acceleration, &at.change_forces);
  for (const PrescribedDof& p : prescribed_) {
    at.jacobian.col(p.dof).setZero();
    at.jacobian.col(n + p.dof).setZero();
  }
}

StructuralDynamics::TangentScratch StructuralDynamics::MakeTangentScratch(
    int rows) const {
  TangentScratch scratch;
  scratch.rows = rows;
  scratch.linear = linear_.MakeTangentScratch(rows);
  for (size_t i = 0; i < terms_.size(); ++i) {
    scratch.terms.push_back(
        terms_[i]->MakeTangentScratch(offsets_[i].place, rows));
  }
  if (term_columns_.size() != tangent_columns_.size()) {
    scratch.by_terms =
        Matrix::Zero(rows, static_cast<Eigen::Index>(term_columns_.size()));
  }
  return scratch;
}

void StructuralDynamics::AddParameterTangents(
    const Prepared& prepared, const Linearization* const* points,
    const Matrix* const* lefts, int num_points, TangentScratch* scratch,
    double* result) const {
  DCHECK_LE(num_points, Term::kMostStages);
  for (int s = 0; s < num_points; ++s) {
    linear_.AddParameterTangents(prepared.linear, points[s]->change_forces,
                                 *lefts[s], &scratch->linear, result);
  }
  // Terms do not know of ties: their columns are collected, then added to those
  // of the sources.
  const bool tied = scratch->by_terms.size() > 0;
  if (tied) scratch->by_terms.setZero();
  double* by_terms = tied ? scratch->by_terms.data() : result;
  const TermLinearization* kept[Term::kMostStages];
  for (size_t i = 0; i < terms_.size(); ++i) {
    for (int s = 0; s < num_points; ++s) kept[s] = points[s]->terms[i].get();
    terms_[i]->AddParameterTangents(
        offsets_[i].place, *prepared.terms[i], kept, lefts, num_points,
        scratch->terms[i].get(), by_terms + scratch->rows * offsets_[i].column);
  }
  for (size_t c = 0; tied && c < term_columns_.size(); ++c) {
    const TermColumn& to = term_columns_[c];
    if (to.column < 0) continue;
    Eigen::Map<Vector>(result + scratch->rows * to.column, scratch->rows) +=
        to.factor * scratch->by_terms.col(static_cast<Eigen::Index>(c));
  }
}

}  // namespace pinode
