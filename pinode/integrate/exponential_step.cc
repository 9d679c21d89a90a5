#include "pinode/integrate/exponential_step.h"

#include <algorithm>
#include <string>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/integrate/forced_exponential.h"

namespace pinode {
namespace {

constexpr int kTerms = 3;  // of the polynomials

std::vector<int> RowsWithEntries(const Matrix& matrix) {
  std::vector<int> rows;
  for (int i = 0; i < matrix.rows(); ++i) {
    if (!matrix.row(i).isZero(0.0)) rows.push_back(i);
  }
  return rows;
}

// Returns the groups alone, with forces at these DOFs as inputs behind the
// others.
StructuralDynamics GroupsWithForces(const StructuralDynamics& dynamics,
                                    const std::vector<int>& forced) {
  std::vector<InputSpec> inputs = dynamics.inputs();
  for (const int dof : forced) {
    inputs.push_back(
        {InputSpec::Kind::kForce, dof,
         "laws at " + dynamics.model().dof_names[static_cast<size_t>(dof)]});
  }
  StructuralDynamics groups(dynamics.model(), inputs);
  std::string error;
  for (const GroupTerm& group : dynamics.groups()) {
    CHECK(groups.AddGroup(group, &error)) << error;
  }
  return groups;
}

Matrix StackRows(const std::vector<Matrix>& derivatives,
                 const std::vector<int>* rows, Eigen::Index columns) {
  const Eigen::Index count = rows != nullptr
                                 ? static_cast<Eigen::Index>(rows->size())
                             : derivatives.empty() ? 0
                                                   : derivatives[0].rows();
  Matrix stacked(count * static_cast<Eigen::Index>(derivatives.size()),
                 columns);
  for (size_t j = 0; j < derivatives.size(); ++j) {
    auto block =
        stacked.middleRows(static_cast<Eigen::Index>(j) * count, count);
    if (rows == nullptr) {
      block = derivatives[j];
    } else {
      block = derivatives[j](*rows, Eigen::all);
    }
  }
  return stacked;
}

}  // namespace

bool ExponentialStep::Suits(const StructuralDynamics& dynamics) {
  const size_t linear = dynamics.groups().empty() ? 0 : 1;
  // A linear part and laws that share an unknown are not stepped apart.
  const int num_groups = static_cast<int>(dynamics.groups().size());
  const bool shares = std::any_of(
      dynamics.ties().begin(), dynamics.ties().end(),
      [num_groups](const ParameterTie& tie) {
        return (tie.parameter < num_groups) != (tie.source < num_groups);
      });
  const bool constant =
      std::all_of(dynamics.groups().begin(), dynamics.groups().end(),
                  [](const GroupTerm& group) {
                    return group.follows == GroupTerm::Follows::kNothing;
                  });
  return constant && !shares && dynamics.prescribed().empty() &&
         !dynamics.laws().empty() &&
         static_cast<size_t>(dynamics.num_terms()) ==
             linear + dynamics.laws().size();
}

ExponentialStep::ExponentialStep(const StructuralDynamics& dynamics)
    : dynamics_(dynamics),
      laws_(dynamics),
      forced_(RowsWithEntries(laws_.forces())),
      linear_(GroupsWithForces(dynamics, forced_)),
      point_(Vector::Zero(dynamics.num_states())) {
  const int results = laws_.num_outputs() + laws_.num_internal();
  for (Vector& each : results_) each = Vector::Zero(results);
  for (Vector& each : arguments_) {
    each = Vector::Zero(2 * dynamics.num_dofs() +
                        kTerms * (dynamics.num_inputs() + laws_.num_outputs()));
  }
}

ParameterizedMap ExponentialStep::LinearPart(
    const StructuralDynamics::Prepared& prepared, bool with_parameters) const {
  StructuralDynamics::Prepared groups;
  std::string error;
  CHECK(linear_.Prepare(prepared.theta.head(linear_.num_parameters()), &groups,
                        &error))
      << error;
  ParameterizedMap map;
  GetLinearRate(linear_, groups, with_parameters, &map);
  const Eigen::Index kept = map.value.rows() + dynamics_.num_inputs();
  const auto count = static_cast<Eigen::Index>(forced_.size());
  const Matrix forces = laws_.forces()(forced_, Eigen::all);
  const auto with_results = [&](const Matrix& own, const Matrix& results) {
    Matrix all(own.rows(), kept + results.cols());
    all << own.leftCols(kept), results;
    return all;
  };
  for (Matrix& derivative : map.derivatives) {
    derivative = with_results(derivative, derivative.rightCols(count) * forces);
  }
  map.value = with_results(map.value, laws_.OutputMap(prepared));
  return map;
}

ExponentialStep::Response ExponentialStep::MakeResponse(
    const ParameterizedMap& map, bool with_all) const {
  Response response;
  response.all = map.value;
  response.local = map.value(laws_.states(), Eigen::all);
  if (with_all) {
    response.all_table = StackRows(map.derivatives, nullptr, map.value.cols());
  }
  response.local_table =
      StackRows(map.derivatives, &laws_.states(), map.value.cols());
  return response;
}

void ExponentialStep::Prepare(const StructuralDynamics::Prepared& prepared,
                              double step, bool with_parameters) {
  if (step == step_ && (has_parameters_ || !with_parameters) &&
      theta_.size() == prepared.theta.size() && theta_ == prepared.theta) {
    return;
  }
  const ParameterizedMap rate = LinearPart(prepared, with_parameters);
  ParameterizedMap half;
  whole_ =
      MakeResponse(ForcedExponential(rate, step, kTerms, &half), /*all=*/true);
  half_ = MakeResponse(half, /*all=*/false);
  theta_ = prepared.theta;
  step_ = step;
  has_parameters_ = with_parameters;
}

Eigen::Index ExponentialStep::ResultColumn(int k) const {
  return 2 * dynamics_.num_dofs() + dynamics_.num_inputs() +
         k * (dynamics_.num_inputs() + laws_.num_outputs());
}

Eigen::VectorBlock<Vector> ExponentialStep::ResultsOf(Stage stage, int k) {
  return arguments_[stage].segment(ResultColumn(k), laws_.num_outputs());
}

void ExponentialStep::BeginArgument(const Vector& state, const double* begin,
                                    const double* middle, const double* end,
                                    double share, Stage stage) {
  const int n = dynamics_.num_dofs();
  const int ni = dynamics_.num_inputs();
  Vector& argument = arguments_[stage];
  argument.head(2 * n) = state.head(2 * n);
  for (int i = 0; i < ni; ++i) {
    const double derivatives[] = {
        begin[i], share * (-3.0 * begin[i] + 4.0 * middle[i] - end[i]),
        share * share * 4.0 * (begin[i] - 2.0 * middle[i] + end[i])};
    for (int k = 0; k < kTerms; ++k) {
      argument[ResultColumn(k) - ni + i] = derivatives[k];
    }
  }
  for (int k = 0; k < kTerms; ++k) ResultsOf(stage, k).setZero();
}

void ExponentialStep::EvaluateLaws(const StructuralDynamics::Prepared& prepared,
                                   double time, const double* input,
                                   bool with_slopes, int stage) {
  const auto s = static_cast<size_t>(stage);
  if (with_slopes) {
    laws_.Linearize(prepared, time, input, point_.data(), results_[s].data(),
                    &slopes_[s]);
  } else {
    laws_.Evaluate(prepared, time, input, point_.data(), results_[s].data());
  }
}

void ExponentialStep::MovePoint(const Response& response, Stage stage,
                                const Vector& state, double duration) {
  const std::vector<int>& looked_at = laws_.states();
  for (size_t i = 0; i < looked_at.size(); ++i) {
    point_[looked_at[i]] =
        response.local.row(static_cast<Eigen::Index>(i)).dot(arguments_[stage]);
  }
  const int nz = laws_.num_internal();
  point_.tail(nz) = state.tail(nz) + duration * results_[stage].tail(nz);
}

void ExponentialStep::EvaluateStages(
    const StructuralDynamics::Prepared& prepared, const IntegrationGrid& grid,
    Eigen::Index interval, int substep, bool with_slopes, const Vector& state) {
  const double time = grid.step_time(interval, substep);
  const double* begin = grid.AtNode(interval, substep, 0);
  const double* middle = grid.AtNode(interval, substep, 1);
  const double* end = grid.AtNode(interval, substep, 2);
  const int no = laws_.num_outputs();

  for (const int index : laws_.states()) point_[index] = state[index];
  point_.tail(laws_.num_internal()) = state.tail(laws_.num_internal());
  EvaluateLaws(prepared, time, begin, with_slopes, 0);
  const auto r1 = results_[0].head(no);

  BeginArgument(state, begin, middle, end, 0.5, kSecond);
  ResultsOf(kSecond, 0) = r1;
  MovePoint(half_, kSecond, state, 0.5 * step_);
  EvaluateLaws(prepared, time + 0.5 * step_, middle, with_slopes, 1);
  const auto r2 = results_[1].head(no);

  arguments_[kThird] = arguments_[kSecond];
  ResultsOf(kThird, 1) = 2.0 * (r2 - r1);
  MovePoint(half_, kThird, state, 0.5 * step_);
  EvaluateLaws(prepared, time + 0.5 * step_, middle, with_slopes, 2);
  const auto r3 = results_[2].head(no);

  BeginArgument(state, begin, middle, end, 1.0, kFourth);
  ResultsOf(kFourth, 0) = r1;
  arguments_[kEnd] = arguments_[kFourth];
  ResultsOf(kFourth, 1) = 2.0 * (r3 - r1);
  MovePoint(whole_, kFourth, state, step_);
  EvaluateLaws(prepared, time + step_, end, with_slopes, 3);
  const auto r4 = results_[3].head(no);

  ResultsOf(kEnd, 1) = -3.0 * r1 + 2.0 * (r2 + r3) - r4;
  ResultsOf(kEnd, 2) = 4.0 * (r1 - r2 - r3 + r4);
}

void ExponentialStep::EndState(Vector* state) const {
  const int nz = laws_.num_internal();
  state->head(2 * dynamics_.num_dofs()).noalias() =
      whole_.all * arguments_[kEnd];
  state->tail(nz) += step_ / 6.0 *
                     (results_[0].tail(nz) + 2.0 * results_[1].tail(nz) +
                      2.0 * results_[2].tail(nz) + results_[3].tail(nz));
}

void ExponentialStep::Advance(const StructuralDynamics::Prepared& prepared,
                              const IntegrationGrid& grid,
                              Eigen::Index interval, int substep,
                              Vector* state) {
  EvaluateStages(prepared, grid, interval, substep, false, *state);
  EndState(state);
}

void ExponentialStep::RunBlock(const StructuralDynamics::Prepared& prepared,
                               const IntegrationGrid& grid,
                               Eigen::Index interval, Eigen::Index count,
                               bool with_parameters, const Vector& state) {
  states_.resize(state.size(), count + 1);
  block_slopes_.resize(4 * static_cast<size_t>(count));
  for (size_t s = 0; s < 4; ++s) {
    block_arguments_[s].resize(arguments_[s].size(), count);
  }
  Vector moved = state;
  states_.col(0) = moved;
  for (Eigen::Index k = 0; k < count; ++k) {
    EvaluateStages(prepared, grid, interval + k / grid.substeps(),
                   static_cast<int>(k % grid.substeps()), true, moved);
    EndState(&moved);
    states_.col(k + 1) = moved;
    for (size_t s = 0; s < 4; ++s) {
      block_arguments_[s].col(k) = arguments_[s];
      block_slopes_[4 * static_cast<size_t>(k) + s] = slopes_[s];
    }
  }
  if (!with_parameters || linear_.num_tangent_columns() == 0) return;
  const Matrix* tables[] = {&half_.local_table, &half_.local_table,
                            &whole_.local_table, &whole_.all_table};
  for (size_t s = 0; s < 4; ++s) {
    changes_[s].resize(tables[s]->rows(), count);
    changes_[s].noalias() = *tables[s] * block_arguments_[s];
  }
}

void ExponentialStep::LinearizeResults(int stage, const Matrix& slopes,
                                       int law_columns, const Matrix& q,
                                       const Matrix& z) {
  Matrix& rates = rates_[static_cast<size_t>(stage)];
  rates.noalias() = slopes.leftCols(q.rows()) * q;
  rates.noalias() += slopes.middleCols(q.rows(), z.rows()) * z;
  rates.rightCols(law_columns) += slopes.rightCols(law_columns);
}

void ExponentialStep::StepSensitivity(Eigen::Index k, bool with_parameters,
                                      Matrix* sensitivity) {
  const int ny = 2 * dynamics_.num_dofs();
  const int no = laws_.num_outputs();
  const int nz = laws_.num_internal();
  const int by_laws = with_parameters ? laws_.num_parameters() : 0;
  const int by_groups = with_parameters ? linear_.num_tangent_columns() : 0;
  const Eigen::Index first_group = sensitivity->cols() - by_laws - by_groups;
  const auto y = sensitivity->topRows(ny);
  const auto z = sensitivity->bottomRows(nz);
  const Matrix* slopes = &block_slopes_[4 * static_cast<size_t>(k)];

  // Adds the effect of the groups within the step to `sum`.
  const auto add_groups = [&](Stage stage, auto&& sum) {
    if (by_groups == 0) return;
    const Matrix& changes = changes_[stage];
    sum.middleCols(first_group, by_groups) += Eigen::Map<const Matrix>(
        changes.col(k).data(), changes.rows() / by_groups, by_groups);
  };
  const auto columns = [&](const auto& response, int term) {
    return response.middleCols(ResultColumn(term), no);
  };
  local_ = (*sensitivity)(laws_.states(), Eigen::all);
  internal_ = z;
  LinearizeResults(0, slopes[0], by_laws, local_, internal_);
  const auto r1 = rates_[0].topRows(no);

  local_half_.noalias() = half_.local.leftCols(ny) * y;
  local_half_.noalias() += columns(half_.local, 0) * r1;
  local_ = local_half_;
  add_groups(kSecond, local_);
  internal_ = z + 0.5 * step_ * rates_[0].bottomRows(nz);
  LinearizeResults(1, slopes[1], by_laws, local_, internal_);
  const auto r2 = rates_[1].topRows(no);

  local_ = local_half_ + columns(half_.local, 1) * (2.0 * (r2 - r1));
  add_groups(kThird, local_);
  internal_ = z + 0.5 * step_ * rates_[1].bottomRows(nz);
  LinearizeResults(2, slopes[2], by_laws, local_, internal_);
  const auto r3 = rates_[2].topRows(no);

  local_.noalias() = whole_.local.leftCols(ny) * y;
  local_ += columns(whole_.local, 0) * r1 +
            columns(whole_.local, 1) * (2.0 * (r3 - r1));
  add_groups(kFourth, local_);
  internal_ = z + step_ * rates_[2].bottomRows(nz);
  LinearizeResults(3, slopes[3], by_laws, local_, internal_);
  const auto r4 = rates_[3].topRows(no);

  next_.resize(sensitivity->rows(), sensitivity->cols());
  auto next_y = next_.topRows(ny);
  next_y.noalias() = whole_.all.leftCols(ny) * y;
  next_y.noalias() += columns(whole_.all, 0) * r1;
  next_y.noalias() +=
      columns(whole_.all, 1) * (-3.0 * r1 + 2.0 * (r2 + r3) - r4);
  next_y.noalias() += columns(whole_.all, 2) * (4.0 * (r1 - r2 - r3 + r4));
  add_groups(kEnd, next_y);
  next_.bottomRows(nz) =
      z + step_ / 6.0 *
              (rates_[0].bottomRows(nz) + 2.0 * rates_[1].bottomRows(nz) +
               2.0 * rates_[2].bottomRows(nz) + rates_[3].bottomRows(nz));
  sensitivity->swap(next_);
}

}  // namespace pinode
