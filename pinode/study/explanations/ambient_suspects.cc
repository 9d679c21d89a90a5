#include "pinode/study/explanations/ambient_suspects.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/estimate/ambient/ambient_cost.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {
namespace {

using Kind = Suspect::Kind;

// Smallest change of a scale that is worth a refit.
constexpr double kLeastScale = 0.05;
// Number of exchanges, and of turns, for which loads are fitted anew: all up to
// ten, which five sensors have. Of more only the first few by their gains at
// the loads of the wrong samples, for every fit of loads has the size of a step
// of the model's fit.
constexpr size_t kFewChanges = 10;
constexpr size_t kMostWithNewLoads = 3;

// The lines of a record at a fit: sums over them of what sensors would change.
class LinesAtFit {
 public:
  // False if the model fails there.
  bool Sum(const IdentificationProblem& problem, const IdentifiedModel& model,
           size_t record, int num_threads) {
    const ParameterLayout layout(problem);
    if (model.parameters.size() != layout.num_parameters()) return false;
    AmbientCost cost(problem.ambient[record], *problem.dynamics, layout,
                     num_threads);
    if (!cost.SetPoint(layout.Free(model.parameters))) return false;
    cost.CompleteTransfer();
    const AmbientLoads& loads = cost.loads();
    const std::vector<Matrix> knots = loads.KnotCovariances();
    const Eigen::Index size = loads.num_channels();
    like_ = Matrix::Zero(size, size);
    cross_ = Matrix::Zero(size, size);
    own_ = with_predicted_ = predicted_ = Vector::Zero(size);
    for (Eigen::Index line = 0; line < cost.lines().size(); ++line) {
      ComplexFactor factor;
      const Matrix covariance =
          loads.Covariance(cost.lines().frequency(line), knots);
      if (!cost.likelihood().FactorizeLine(line, loads, covariance, &factor)) {
        return false;
      }
      Add(factor.solve(Eigen::MatrixXcd::Identity(size, size)),
          cost.lines().products(line));
    }
    return true;
  }

  // Gain of the log-likelihood if channels a and b change places.
  double GainOfExchange(Eigen::Index a, Eigen::Index b) const {
    return like_(std::max(a, b), std::min(a, b));
  }
  double GainOfTurn(Eigen::Index c) const {
    return 4.0 * (cross_.row(c).sum() - cross_(c, c));
  }
  // Regression of a channel on its prediction; NaN if it is not predicted.
  double ScaleOf(Eigen::Index c) const {
    return predicted_[c] > 0.0 ? with_predicted_[c] / predicted_[c] : kNaN;
  }
  double CorrelationOf(Eigen::Index c) const {
    const double size = own_[c] * predicted_[c];
    return size > 0.0 ? with_predicted_[c] / std::sqrt(size) : 0.0;
  }
  Eigen::Index size() const { return own_.size(); }

 private:
  void Add(const Eigen::MatrixXcd& inverse, const Eigen::MatrixXcd& products) {
    const Eigen::Index n = own_.size();
    const Eigen::MatrixXcd both = inverse * products;
    const Eigen::MatrixXcd residual = both * inverse;
    for (Eigen::Index c = 0; c < n; ++c) {
      const double weight = inverse(c, c).real();
      const double own = products(c, c).real();
      const double along = both(c, c).real() / weight;
      own_[c] += weight * own;
      with_predicted_[c] += weight * (own - along);
      predicted_[c] +=
          weight * (own - 2.0 * along) + residual(c, c).real() / weight;
    }
    cross_ += (inverse.array() * products.transpose().array()).real().matrix();
    Eigen::MatrixXcd moved;
    for (Eigen::Index a = 0; a < n; ++a) {
      for (Eigen::Index b = 0; b < a; ++b) {
        moved = products;
        moved.row(a).swap(moved.row(b));
        moved.col(a).swap(moved.col(b));
        like_(a, b) +=
            (inverse.array() * (products - moved).transpose().array())
                .real()
                .sum();
      }
    }
  }

  Matrix like_;   // gain of each exchange, below the diagonal
  Matrix cross_;  // P_ij Y_j Y_i*
  Vector own_, with_predicted_, predicted_;
};

// Moves the best to *suspects. Leaves out gains that are not finite, which have
// no order.
void KeepBest(std::vector<std::pair<double, Suspect>>* ranked, size_t most,
              std::vector<Suspect>* suspects) {
  ranked->erase(std::remove_if(ranked->begin(), ranked->end(),
                               [](const auto& change) {
                                 return !std::isfinite(change.first);
                               }),
                ranked->end());
  std::stable_sort(
      ranked->begin(), ranked->end(),
      [](const auto& a, const auto& b) { return a.first > b.first; });
  if (ranked->size() > most) ranked->resize(most);
  for (auto& [unused, suspect] : *ranked) {
    suspects->push_back(std::move(suspect));
  }
}

// Returns the ambient record that a suspect changes.
int RecordOf(const Suspect& suspect) {
  return suspect.ambient_exchanged.empty()
             ? suspect.ambient_scales.front().record
             : suspect.ambient_exchanged.front().record;
}

// Changes of the sensors of a record, each with its gain.
struct Ranked {
  std::vector<std::pair<double, Suspect>> exchanges, turns;
};

// The turns of all channels of record `r` and the exchanges of all that measure
// the same, with their gains at `lines`.
Ranked RankChanges(const LinesAtFit& lines, const AmbientRecord& record,
                   int r) {
  Ranked ranked;
  for (int c = 0; c < static_cast<int>(lines.size()); ++c) {
    const Observation& own = record.channels[static_cast<size_t>(c)];
    Suspect turned;
    turned.kind = Kind::kSensorGain;
    turned.place = own.name;
    turned.what = "sensor '" + own.name + "' mounted upside down";
    turned.ambient_scales = {{r, c, -1.0}};
    ranked.turns.emplace_back(lines.GainOfTurn(c), std::move(turned));
    for (int d = 0; d < c; ++d) {
      const Observation& other = record.channels[static_cast<size_t>(d)];
      if (other.quantity != own.quantity) continue;
      Suspect swapped;
      swapped.kind = Kind::kExchange;
      swapped.place = other.name + "," + own.name;
      swapped.what =
          "sensors '" + other.name + "' and '" + own.name + "' swapped";
      swapped.ambient_exchanged = {{r, d, c}};
      ranked.exchanges.emplace_back(lines.GainOfExchange(c, d),
                                    std::move(swapped));
    }
  }
  return ranked;
}

// Takes out the changes that gain nothing.
void KeepGains(std::vector<std::pair<double, Suspect>>* ranked) {
  ranked->erase(
      std::remove_if(ranked->begin(), ranked->end(),
                     [](const auto& change) { return !(change.first > 0.0); }),
      ranked->end());
}

// Adds the suspects of record `r` that are likeliest at `lines`. A gain is a
// regression on the prediction, which only a fit has.
void AddSuspectsAt(const LinesAtFit& lines, const AmbientRecord& record, int r,
                   bool is_fit, size_t most, std::vector<Suspect>* suspects) {
  Ranked ranked = RankChanges(lines, record, r);
  std::vector<std::pair<double, Suspect>> scales;
  for (int c = 0; is_fit && c < static_cast<int>(lines.size()); ++c) {
    const std::string& name = record.channels[static_cast<size_t>(c)].name;
    const double scale = lines.ScaleOf(c);
    if (!(scale > 0.0) || std::abs(scale - 1.0) <= kLeastScale) continue;
    Suspect scaled;
    scaled.kind = Kind::kSensorGain;
    scaled.place = name;
    scaled.what = "the gain of sensor '" + name + "'";
    scaled.ambient_scales = {{r, c, 1.0 / scale}};
    scales.emplace_back(std::abs(std::log(scale)) * lines.CorrelationOf(c),
                        std::move(scaled));
  }
  for (auto* changes : {&ranked.exchanges, &ranked.turns}) {
    KeepGains(changes);
    KeepBest(changes, most, suspects);
  }
  KeepBest(&scales, most, suspects);
}

// Cost of record `r` at the initial values, with the loads and noise that make
// it smallest; infinite if the model fails there.
double InitialCost(const IdentificationProblem& problem, size_t r,
                   int num_threads) {
  const ParameterLayout layout(problem);
  AmbientCost cost(problem.ambient[r], *problem.dynamics, layout, num_threads);
  double value = kInfinity;
  return cost.Evaluate(layout.Free(layout.InitialValues()), &value) ? value
                                                                    : kInfinity;
}

// Replaces the gains by those with loads and noise fitted anew, and keeps the
// best. All of the samples' spectra can be called loads, so that the loads of
// wrong samples contradict every change: the right exchange lost 8.7e3, and
// gains 2.7e4 with loads of its own.
void KeepBestWithNewLoads(const IdentificationProblem& problem, size_t r,
                          double own_cost, int num_threads, size_t most,
                          std::vector<std::pair<double, Suspect>>* ranked,
                          std::vector<Suspect>* suspects) {
  std::vector<Suspect> tried;
  const size_t count = ranked->size();
  KeepBest(ranked, count > kFewChanges ? kMostWithNewLoads : count, &tried);
  ranked->clear();
  for (Suspect& suspect : tried) {
    IdentificationProblem changed = problem;
    std::string unused;
    if (!AddSuspects({suspect}, &changed, &unused)) continue;
    ranked->emplace_back(own_cost - InitialCost(changed, r, num_threads),
                         std::move(suspect));
  }
  KeepGains(ranked);
  KeepBest(ranked, most, suspects);
}

// Adds the suspects of `found` that are not yet among *suspects.
void AddUnknown(std::vector<Suspect> found, std::vector<Suspect>* suspects) {
  for (Suspect& suspect : found) {
    const bool is_known = std::any_of(
        suspects->begin(), suspects->end(), [&](const Suspect& other) {
          return other.what == suspect.what &&
                 other.ambient_exchanged.empty() ==
                     suspect.ambient_exchanged.empty() &&
                 RecordOf(other) == RecordOf(suspect);
        });
    if (!is_known) suspects->push_back(std::move(suspect));
  }
}

}  // namespace

std::vector<Suspect> MakeAmbientSuspects(const IdentificationProblem& problem,
                                         const IdentifiedModel& model,
                                         const std::vector<bool>& is_poor,
                                         int num_threads, size_t most) {
  CHECK_EQ(is_poor.size(), problem.ambient.size());
  std::vector<Suspect> suspects;
  // A fit may have adapted to a wrong sensor, or have lost itself.
  IdentifiedModel initial = model;
  initial.parameters = ParameterLayout(problem).InitialValues();
  for (size_t r = 0; r < problem.ambient.size(); ++r) {
    const AmbientRecord& record = problem.ambient[r];
    std::vector<Suspect> found;
    for (const IdentifiedModel* at :
         {static_cast<const IdentifiedModel*>(&initial), &model}) {
      LinesAtFit lines;
      if (!lines.Sum(problem, *at, r, num_threads)) continue;
      AddSuspectsAt(lines, record, static_cast<int>(r), at == &model, most,
                    &found);
      if (at == &model || !is_poor[r]) continue;
      Ranked ranked = RankChanges(lines, record, static_cast<int>(r));
      const double own_cost = InitialCost(problem, r, num_threads);
      if (!std::isfinite(own_cost)) continue;
      for (auto* changes : {&ranked.exchanges, &ranked.turns}) {
        KeepBestWithNewLoads(problem, r, own_cost, num_threads, most, changes,
                             &found);
      }
    }
    AddUnknown(std::move(found), &suspects);
  }
  return suspects;
}

double AmbientScale(const IdentificationProblem& problem,
                    const IdentifiedModel& model, int record, int channel,
                    int num_threads) {
  LinesAtFit lines;
  if (!lines.Sum(problem, model, static_cast<size_t>(record), num_threads)) {
    return 1.0;
  }
  const double scale = lines.ScaleOf(channel);
  return scale > 0.0 ? 1.0 / scale : 1.0;
}

}  // namespace pinode
