#include "pinode/integrate/tangent_step.h"

#include "pinode/base/logging.h"
#include "pinode/base/small_matrix.h"

namespace pinode {
namespace {

// Columns per state up to which a sensitivity is carried through the stages: 8
// ns^2 columns multiplications against 14 ns^3 + 2 ns^2 columns.
constexpr int kFewColumns = 2;
}  // namespace

TangentStep::TangentStep(const StructuralDynamics& dynamics)
    : dynamics_(dynamics),
      stages_{dynamics.MakeLinearization(), dynamics.MakeLinearization(),
              dynamics.MakeLinearization(), dynamics.MakeLinearization()},
      scratch_(dynamics.MakeTangentScratch(dynamics.num_states())),
      observation_scratch_(dynamics.MakeTangentScratch(1)),
      forward_scratch_(dynamics.MakeTangentScratch(dynamics.num_states() -
                                                   dynamics.num_dofs())),
      lower_(Matrix::Identity(dynamics.num_states(), dynamics.num_states())
                 .bottomRows(dynamics.num_states() - dynamics.num_dofs())) {
  const int ns = dynamics.num_states();
  for (Matrix& weight : weights_) weight = Matrix::Zero(ns, ns);
  transition_ = Matrix::Zero(ns, ns);
  product_ = Matrix::Zero(ns, ns);
  next_ = Matrix::Zero(ns, ns + dynamics.num_tangent_columns());
  stage_state_ = Vector::Zero(ns);
  if (dynamics.num_switches() > 0) switched_.emplace(dynamics);
}

void TangentStep::Begin(const StructuralDynamics::Prepared& prepared,
                        double time, const double* input, const double* state) {
  if (switched_.has_value()) switched_->Begin(prepared, time, input, state);
}

const StructuralDynamics::Linearization& TangentStep::LinearizeAt(
    const StructuralDynamics::Prepared& prepared, double time,
    const double* input, const double* state) {
  dynamics_.Linearize(prepared, time, input, state, &stages_[0]);
  return stages_[0];
}

void TangentStep::AddParameterTangents(
    const StructuralDynamics::Prepared& prepared, const Matrix& left,
    Matrix* result) {
  DCHECK_EQ(result->rows(), left.rows());
  if (observation_scratch_.rows != left.rows()) {
    observation_scratch_ =
        dynamics_.MakeTangentScratch(static_cast<int>(left.rows()));
  }
  const StructuralDynamics::Linearization* stage = &stages_[0];
  const Matrix* lefts[] = {&left};
  dynamics_.AddParameterTangents(prepared, &stage, lefts, 1,
                                 &observation_scratch_, result->data());
}

void TangentStep::Step(const StructuralDynamics::Prepared& prepared,
                       const IntegrationGrid& grid, Eigen::Index interval,
                       int substep, bool linearized, bool with_parameters,
                       Vector* state, Matrix* sensitivity) {
  if (switched_.has_value()) {
    StepInPieces(prepared, grid, interval, substep, with_parameters, state,
                 sensitivity);
    return;
  }
  const Span span{grid.step_time(interval, substep), grid.step(),
                  grid.AtNode(interval, substep, 0),
                  grid.AtNode(interval, substep, 1),
                  grid.AtNode(interval, substep, 2)};
  StepOver(prepared, span, linearized, with_parameters, state, sensitivity);
}

void TangentStep::SetBranches(const char* branches) {
  for (StructuralDynamics::Linearization& stage : stages_) {
    dynamics_.SetBranches(branches, &stage);
  }
}

void TangentStep::StepInPieces(const StructuralDynamics::Prepared& prepared,
                               const IntegrationGrid& grid,
                               Eigen::Index interval, int substep,
                               bool with_parameters, Vector* state,
                               Matrix* sensitivity) {
  // Most steps have one piece. If this one has more, it is done again.
  const Vector start = *state;
  const Span whole{grid.step_time(interval, substep), grid.step(),
                   grid.AtNode(interval, substep, 0),
                   grid.AtNode(interval, substep, 1),
                   grid.AtNode(interval, substep, 2)};
  SetBranches(switched_->branches().data());
  StepOver(prepared, whole, false, with_parameters, state, sensitivity);
  if (switched_->MayEndAt(prepared, whole.time + whole.duration, whole.end,
                          *state)) {
    SetBranches(nullptr);
    return;
  }
  *state = start;
  sensitivity->swap(next_);  // StepOver leaves the former one there
  Vector end = start;
  switched_->Step(prepared, grid, interval, substep, &end);
  const std::vector<SwitchedStep::Piece>& pieces = switched_->pieces();
  SwitchedStep::Nodes nodes;
  for (size_t p = 0; p < pieces.size(); ++p) {
    const SwitchedStep::Piece& piece = pieces[p];
    SwitchedStep::NodesOf(grid, interval, substep, piece, &nodes);
    const double time = grid.step_time(interval, substep) + piece.begin;
    SetBranches(piece.branches.empty() ? nullptr : piece.branches.data());
    StepOver(prepared,
             {time, piece.duration, nodes.begin.data(), nodes.middle.data(),
              nodes.end.data()},
             false, with_parameters, state, sensitivity);
    if (piece.switched < 0 || p + 1 == pieces.size()) continue;
    // The jump of the sensitivities.
    const auto rate_on = [&](const SwitchedStep::Piece& side) {
      dynamics_.SetBranches(side.branches.data(), &stages_[0]);
      Vector rate(dynamics_.num_states());
      dynamics_.Rate(prepared, time + piece.duration, nodes.end.data(),
                     state->data(), rate.data(), &stages_[0]);
      return rate;
    };
    const Vector jump = rate_on(pieces[p + 1]) - rate_on(piece);
    Vector gradient(dynamics_.num_states());
    dynamics_.SwitchGradient(piece.switched, prepared, time + piece.duration,
                             nodes.end.data(), state->data(), gradient.data());
    const Eigen::RowVectorXd earlier =
        gradient.transpose() * *sensitivity / piece.slope;
    *sensitivity += jump * earlier;
  }
  SetBranches(nullptr);
}

void TangentStep::StepOver(const StructuralDynamics::Prepared& prepared,
                           const Span& span, bool linearized,
                           bool with_parameters, Vector* state,
                           Matrix* sensitivity) {
  const int ns = dynamics_.num_states();
  const double dt = span.duration;
  const double time = span.time;
  const double* begin = span.begin;
  const double* middle = span.middle;
  const double* end = span.end;

  if (!linearized) {
    dynamics_.Linearize(prepared, time, begin, state->data(), &stages_[0]);
  }
  stage_state_ = *state + 0.5 * dt * stages_[0].rate;
  dynamics_.Linearize(prepared, time + 0.5 * dt, middle, stage_state_.data(),
                      &stages_[1]);
  stage_state_ = *state + 0.5 * dt * stages_[1].rate;
  dynamics_.Linearize(prepared, time + 0.5 * dt, middle, stage_state_.data(),
                      &stages_[2]);
  stage_state_ = *state + dt * stages_[2].rate;
  dynamics_.Linearize(prepared, time + dt, end, stage_state_.data(),
                      &stages_[3]);
  *state += dt / 6.0 *
            (stages_[0].rate + 2.0 * stages_[1].rate + 2.0 * stages_[2].rate +
             stages_[3].rate);
  dynamics_.Prescribe(end, state->data());

  next_.resize(ns, sensitivity->cols());
  // Networks have factored derivatives that need all stages at once, and
  // prescribed motion has its own rates.
  if (dynamics_.networks().empty() && dynamics_.prescribed().empty() &&
      sensitivity->cols() < kFewColumns * ns) {
    AdvanceThroughStages(prepared, dt, with_parameters, *sensitivity);
  } else {
    AdvanceByTransition(prepared, dt, with_parameters, *sensitivity);
  }
  dynamics_.PrescribeSensitivity(&next_);
  sensitivity->swap(next_);
}

void TangentStep::AdvanceByTransition(
    const StructuralDynamics::Prepared& prepared, double dt,
    bool with_parameters, const Matrix& sensitivity) {
  // Backwards through the stages: each G_s J_s is a term of A and also gives
  // G_(s-1).
  product_ = dt / 6.0 * stages_[3].jacobian;  // G4 J4
  transition_ = product_;
  const double shares[] = {0.5 * dt, 0.5 * dt, dt};
  const double diagonals[] = {dt / 6.0, dt / 3.0, dt / 3.0};
  for (const size_t s : {2, 1, 0}) {
    weights_[s] = shares[s] * product_;
    weights_[s].diagonal().array() += diagonals[s];
    Multiply(weights_[s], stages_[s].jacobian, product_);
    transition_ += product_;
  }
  transition_.diagonal().array() += 1.0;
  weights_[3].setZero();
  weights_[3].diagonal().array() = dt / 6.0;
  Multiply(transition_, sensitivity, next_);
  if (with_parameters) AddParameterColumns(prepared);
}

void TangentStep::AdvanceThroughStages(
    const StructuralDynamics::Prepared& prepared, double dt,
    bool with_parameters, const Matrix& sensitivity) {
  const int ns = dynamics_.num_states();
  const int n = dynamics_.num_dofs();
  const int np = with_parameters ? dynamics_.num_tangent_columns() : 0;
  const double next_stage[] = {0.5 * dt, 0.5 * dt, dt};
  const double weights[] = {dt / 6.0, dt / 3.0, dt / 3.0, dt / 6.0};
  stage_rate_.resize(ns, sensitivity.cols());
  stage_sensitivity_ = sensitivity;
  next_ = sensitivity;
  for (size_t s = 0; s < 4; ++s) {
    // The rates of displacements are velocities.
    stage_rate_.topRows(n) = stage_sensitivity_.middleRows(n, n);
    stage_rate_.bottomRows(ns - n).noalias() =
        stages_[s].jacobian.bottomRows(ns - n) * stage_sensitivity_;
    if (np > 0) {
      const StructuralDynamics::Linearization* stage = &stages_[s];
      const Matrix* left = &lower_;
      parameter_rate_.setZero(ns - n, np);
      dynamics_.AddParameterTangents(prepared, &stage, &left, 1,
                                     &forward_scratch_, parameter_rate_.data());
      stage_rate_.bottomRightCorner(ns - n, np) += parameter_rate_;
    }
    next_ += weights[s] * stage_rate_;
    if (s < 3) stage_sensitivity_ = sensitivity + next_stage[s] * stage_rate_;
  }
}

void TangentStep::AddParameterColumns(
    const StructuralDynamics::Prepared& prepared) {
  const int np = dynamics_.num_tangent_columns();
  DCHECK_GE(next_.cols(), np);
  const StructuralDynamics::Linearization* stages[] = {
      &stages_[0], &stages_[1], &stages_[2], &stages_[3]};
  const Matrix* lefts[] = {&weights_[0], &weights_[1], &weights_[2],
                           &weights_[3]};
  dynamics_.AddParameterTangents(prepared, stages, lefts, 4, &scratch_,
                                 next_.rightCols(np).data());
}

}  // namespace pinode
