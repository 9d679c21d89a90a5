#include "pinode/integrate/modal_response.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "pinode/base/entries_in_use.h"
#include "pinode/base/logging.h"
#include "pinode/base/parallel_for.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Two eigenvalues nearer than this share of the larger one count as equal. The
// error of the mean of their p is of second order in the share. The rounding
// error of a division by their difference is of first order in its inverse.
constexpr double kNearShare = 1e-6;

// Returns W * change * V, at the cost of the rows and columns that change.
ComplexMatrix InModes(const ModalBasis& basis,
                      const Eigen::Ref<const Matrix>& change) {
  const std::vector<int> rows = RowsInUse(change);
  const std::vector<int> columns = ColumnsInUse(change);
  const auto nr = static_cast<Eigen::Index>(rows.size());
  const auto nc = static_cast<Eigen::Index>(columns.size());
  const Eigen::Index ns = basis.num_states();
  ComplexMatrix left(ns, nr);
  ComplexMatrix right(nc, ns);
  ComplexMatrix core(nr, nc);
  for (Eigen::Index i = 0; i < nr; ++i) {
    left.col(i) = basis.inverse_modes().col(rows[static_cast<size_t>(i)]);
    for (Eigen::Index k = 0; k < nc; ++k) {
      core(i, k) =
          change(rows[static_cast<size_t>(i)], columns[static_cast<size_t>(k)]);
    }
  }
  for (Eigen::Index k = 0; k < nc; ++k) {
    right.row(k) = basis.modes().row(columns[static_cast<size_t>(k)]);
  }
  return left * (core * right);
}

ComplexVector Kept(const ModalBasis& basis, const ComplexVector& all) {
  ComplexVector kept(basis.num_kept());
  for (int m = 0; m < basis.num_kept(); ++m) {
    kept[m] = all[basis.kept()[static_cast<size_t>(m)]];
  }
  return kept;
}

}  // namespace

bool ModalResponse::Prepare(const StructuralDynamics& dynamics,
                            const StructuralDynamics::Prepared& prepared,
                            const IntegrationGrid& grid, bool with_parameters) {
  const bool same = theta_.size() == prepared.theta.size() &&
                    theta_ == prepared.theta && step_ == grid.step() &&
                    substeps_ == grid.substeps() &&
                    integrator_ == grid.integrator() && rate_.value.size() > 0;
  if (same && (has_parameters_ || !with_parameters)) return ok_;
  GetLinearRate(dynamics, prepared, with_parameters, &rate_);
  has_parameters_ = with_parameters;
  if (same) return ok_;
  theta_ = prepared.theta;
  step_ = grid.step();
  substeps_ = grid.substeps();
  integrator_ = grid.integrator();
  num_inputs_ = dynamics.num_inputs();
  const int ns = dynamics.num_states();
  ok_ = basis_.Compute(rate_.value.leftCols(ns), grid);
  if (!ok_) return false;
  inverse_gaps_ = ComplexMatrix::Zero(ns, ns);
  near_.clear();
  const ComplexVector& lambda = basis_.eigenvalues();
  const Vector squares = lambda.cwiseAbs2();
  for (int m = 0; m < ns; ++m) {
    for (int k = 0; k < ns; ++k) {
      if (k == m) continue;
      const Complex gap = lambda[k] - lambda[m];
      const double square = std::norm(gap);
      if (square < kNearShare * kNearShare * std::max(squares[k], squares[m])) {
        near_.emplace_back(k, m);
      } else {
        inverse_gaps_(k, m) = std::conj(gap) / square;
      }
    }
  }
  return true;
}

int ModalResponse::NumRows(const Contents& contents) const {
  return first_input_row(contents) + num_inputs_ + 1;
}

ModalResponse::State ModalResponse::Begin(const Contents& contents) const {
  State state;
  state.z = ComplexMatrix::Zero(basis_.num_kept(), num_sources(contents));
  if (contents.with_start) state.z.rightCols(1).setOnes();
  if (contents.with_slopes) {
    state.p = ComplexMatrix::Zero(basis_.num_kept(), num_sources(contents));
  }
  return state;
}

void ModalResponse::Advance(const Contents& contents,
                            const IntegrationGrid& grid, Eigen::Index first,
                            Eigen::Index count, State* state,
                            Matrix* histories) const {
  const Eigen::Index kept = basis_.num_kept();
  const Eigen::Index rows = rows_per_source(contents);
  const Eigen::Index steps = std::min(count, grid.num_intervals() - first);
  if (histories != nullptr) histories->resize(NumRows(contents), count);
  const auto put = [&](int source, Eigen::Index i, const ComplexVector& z,
                       const ComplexVector& p) {
    if (histories == nullptr) return;
    auto column = histories->col(i).segment(source * rows, rows);
    column.head(kept) = z.real();
    column.segment(kept, kept) = z.imag();
    if (!contents.with_slopes) return;
    column.segment(2 * kept, kept) = p.real();
    column.tail(kept) = p.imag();
  };
  const auto rho = basis_.advance().array();
  const auto rho_slope = basis_.advance_slope().array();
  ComplexMatrix forcing, forcing_slope;
  ComplexVector p;
  Matrix all_nodes;
  if (num_inputs_ > 0)
    grid.GetNodes(first, std::max<Eigen::Index>(0, steps), &all_nodes);
  for (int source = 0; source < num_sources(contents); ++source) {
    const bool forced = source < num_inputs_;
    if (forced) {
      // This input at the nodes of each interval.
      const Matrix nodes =
          Eigen::Map<const Matrix, 0,
                     Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>(
              all_nodes.data() + source, 3 * substeps_, all_nodes.cols(),
              Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>(all_nodes.rows(),
                                                            num_inputs_));
      forcing.noalias() = basis_.forcing() * nodes;
      if (contents.with_slopes) {
        forcing_slope.noalias() = basis_.forcing_slope() * nodes;
      }
    }
    ComplexVector z = state->z.col(source);
    if (contents.with_slopes) p = state->p.col(source);
    for (Eigen::Index i = 0; i < count; ++i) {
      put(source, i, z, p);
      if (i >= steps) break;
      if (contents.with_slopes) {
        p.array() = rho * p.array() + rho_slope * z.array();
        if (forced) p += forcing_slope.col(i);
      }
      z.array() *= rho;
      if (forced) z += forcing.col(i);
    }
    state->z.col(source) = z;
    if (contents.with_slopes) state->p.col(source) = p;
  }
  if (histories == nullptr) return;
  histories->middleRows(first_input_row(contents), num_inputs_) =
      Eigen::Map<const Matrix>(grid.AtSample(first), num_inputs_, count);
  histories->row(ConstantRow(contents)).setOnes();
}

ComplexMatrix ModalResponse::Participation(const Contents& contents,
                                           const Vector& start) const {
  const Eigen::Index ns = basis_.num_states();
  Matrix sources(ns, num_sources(contents));
  sources.leftCols(num_inputs_) = rate_.value.rightCols(num_inputs_);
  if (contents.with_start) sources.col(num_inputs_) = start;
  return basis_.inverse_modes() * sources;
}

ComplexMatrix ModalResponse::ChannelModes(
    const ObservationMap& observation) const {
  Matrix map = observation.state_map();
  const std::vector<int>& rows = observation.acceleration_rows();
  const Matrix rates =
      observation.rate_map() * rate_.value.leftCols(basis_.num_states());
  for (size_t r = 0; r < rows.size(); ++r) {
    map.row(rows[r]) += rates.row(static_cast<Eigen::Index>(r));
  }
  return map * basis_.modes();
}

void ModalResponse::AddCombination(const Contents& contents, int source,
                                   bool slopes, const ComplexVector& a,
                                   Eigen::Ref<Vector> combination) const {
  const Eigen::Index kept = basis_.num_kept();
  const Eigen::Index first =
      source * rows_per_source(contents) + (slopes ? 2 * kept : 0);
  const auto weights = basis_.weights().array();
  combination.segment(first, kept).array() += weights * a.real().array();
  combination.segment(first + kept, kept).array() -= weights * a.imag().array();
}

void ModalResponse::AddModes(const Contents& contents,
                             const ComplexMatrix& modes,
                             const ComplexMatrix& participation,
                             Matrix* combinations) const {
  for (Eigen::Index k = 0; k < modes.rows(); ++k) {
    for (int source = 0; source < num_sources(contents); ++source) {
      const ComplexVector a =
          modes.row(k).transpose().cwiseProduct(participation.col(source));
      AddCombination(contents, source, false, Kept(basis_, a),
                     combinations->col(k));
    }
  }
}

Matrix ModalResponse::Values(const Contents& contents,
                             const ObservationMap& observation,
                             const Vector& start) const {
  const ComplexMatrix channels = ChannelModes(observation);
  const ComplexMatrix participation = Participation(contents, start);
  Matrix values = Matrix::Zero(NumRows(contents), observation.num_channels());
  for (Eigen::Index c = 0; c < values.cols(); ++c) {
    for (int source = 0; source < num_sources(contents); ++source) {
      const ComplexVector a =
          channels.row(c).transpose().cwiseProduct(participation.col(source));
      AddCombination(contents, source, false, Kept(basis_, a), values.col(c));
    }
  }
  auto direct = values.middleRows(first_input_row(contents), num_inputs_);
  direct = observation.input_map().transpose();
  const std::vector<int>& rows = observation.acceleration_rows();
  const Matrix rates =
      observation.rate_map() * rate_.value.rightCols(num_inputs_);
  for (size_t r = 0; r < rows.size(); ++r) {
    direct.col(rows[r]) += rates.row(static_cast<Eigen::Index>(r)).transpose();
  }
  return values;
}

Matrix ModalResponse::States(const Contents& contents,
                             const Vector& start) const {
  const ComplexMatrix participation = Participation(contents, start);
  Matrix states = Matrix::Zero(NumRows(contents), basis_.num_states());
  AddModes(contents, basis_.modes(), participation, &states);
  return states;
}

void ModalResponse::AddParameter(const Contents& contents,
                                 const ObservationMap& observation,
                                 const ComplexMatrix& channel_modes,
                                 const ComplexMatrix& participation, int j,
                                 Eigen::Index column,
                                 std::vector<Matrix>* tables) const {
  const Eigen::Index ns = basis_.num_states();
  const Matrix& change = rate_.derivatives[static_cast<size_t>(j)];
  ComplexMatrix in_modes = InModes(basis_, change.leftCols(ns));
  // Pairs of nearly equal modes, and each mode with itself.
  ComplexMatrix near_participation =
      in_modes.diagonal().asDiagonal() * participation;
  ComplexMatrix near_channels = ComplexMatrix::Zero(channel_modes.rows(), ns);
  for (const auto& [k, m] : near_) {
    near_participation.row(k) += 0.5 * in_modes(k, m) * participation.row(m);
    near_channels.col(m) += 0.5 * in_modes(k, m) * channel_modes.col(k);
  }
  in_modes.array() *= inverse_gaps_.array();
  const ComplexMatrix far_participation = in_modes * participation;
  const ComplexMatrix far_channels = channel_modes * in_modes;
  const ComplexMatrix forcing =
      basis_.inverse_modes() * change.rightCols(num_inputs_);
  // Direct effect on the channels themselves.
  const std::vector<int>& rows = observation.acceleration_rows();
  const Matrix direct = observation.rate_map() * change;
  const ComplexMatrix direct_modes = direct.leftCols(ns) * basis_.modes();

  ComplexMatrix moved = ComplexMatrix::Zero(channel_modes.rows(), ns);
  for (size_t r = 0; r < rows.size(); ++r) {
    moved.row(rows[r]) = direct_modes.row(static_cast<Eigen::Index>(r));
    (*tables)[static_cast<size_t>(rows[r])].col(column).segment(
        first_input_row(contents), num_inputs_) =
        direct.row(static_cast<Eigen::Index>(r)).tail(num_inputs_).transpose();
  }
  for (Eigen::Index c = 0; c < channel_modes.rows(); ++c) {
    Matrix& table = (*tables)[static_cast<size_t>(c)];
    const auto own = channel_modes.row(c).transpose();
    for (int source = 0; source < num_sources(contents); ++source) {
      const auto part = participation.col(source);
      ComplexVector z =
          (moved.row(c) - far_channels.row(c)).transpose().cwiseProduct(part) +
          own.cwiseProduct(far_participation.col(source));
      if (source < num_inputs_) z += own.cwiseProduct(forcing.col(source));
      const ComplexVector p =
          own.cwiseProduct(near_participation.col(source)) +
          near_channels.row(c).transpose().cwiseProduct(part);
      AddCombination(contents, source, false, Kept(basis_, z),
                     table.col(column));
      AddCombination(contents, source, true, Kept(basis_, p),
                     table.col(column));
    }
  }
}

std::vector<Matrix> ModalResponse::Derivatives(
    const Contents& contents, const ObservationMap& observation,
    const Vector& start, bool by_start, bool by_parameters,
    int num_threads) const {
  CHECK(!by_parameters || (has_parameters_ && contents.with_slopes));
  CHECK(!by_start || contents.with_start);
  const Eigen::Index ns = basis_.num_states();
  const Eigen::Index first = by_start ? ns : 0;
  const auto np =
      by_parameters ? static_cast<Eigen::Index>(rate_.derivatives.size()) : 0;
  const ComplexMatrix channels = ChannelModes(observation);
  std::vector<Matrix> tables(static_cast<size_t>(channels.rows()),
                             Matrix::Zero(NumRows(contents), first + np));
  for (Eigen::Index c = 0; by_start && c < channels.rows(); ++c) {
    for (Eigen::Index k = 0; k < ns; ++k) {
      const ComplexVector a = channels.row(c).transpose().cwiseProduct(
          basis_.inverse_modes().col(k));
      AddCombination(contents, num_inputs_, false, Kept(basis_, a),
                     tables[static_cast<size_t>(c)].col(k));
    }
  }
  const ComplexMatrix participation = Participation(contents, start);
  ParallelFor(static_cast<int>(np), num_threads, [&](int j, int) {
    AddParameter(contents, observation, channels, participation, j, first + j,
                 &tables);
  });
  return tables;
}

}  // namespace pinode
